#include "sim/lidar/spinning_lidar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

#include "sim/lidar/counter_noise.h"
#include "sim/lidar/worker_pool.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

constexpr std::size_t kLanes = 8;
constexpr double kTurn = 2.0 * std::numbers::pi;
/// Reflectance of the target that the maximum range is stated for.
constexpr float kReferenceReflectance = 0.9F;
/// Beyond the maximum range a hit may still come into it by its noise.
constexpr double kNoiseReach_sigma = 6.0;

using Lanes = std::array<float, kLanes>;

/// Eight consecutive firings side by side, at the instant of their first laser, in Embree's
/// coordinates.
struct FiringBlock {
  std::size_t first = 0;     ///< Index into the firings of this cast.
  std::size_t count = 0;     ///< 1 .. 8.
  std::array<Lanes, 9> R{};  ///< Columns of R_WS one after the other.
  std::array<Lanes, 3> p{};  ///< m
  std::array<Lanes, 3> v{};  ///< m/s
  std::array<Lanes, 3> w{};  ///< rad/s
  Lanes cos_azimuth{};
  Lanes sin_azimuth{};
  Lanes time{};  ///< Share of the slice.
};

struct LaserConstants {
  float cos_elevation = 0.0F;
  float sin_elevation = 0.0F;
  float offset_m = 0.0F;
  float delay_s = 0.0F;
  float cos_turn = 0.0F;  ///< Of the rotor during the delay.
  float sin_turn = 0.0F;
  float delay_share = 0.0F;  ///< Of the slice.
};

/// Which firing of the block and which laser a lane carries.
struct LaneMap {
  std::array<std::uint8_t, kLanes> firing{};
  std::array<std::uint8_t, kLanes> laser{};
};

}  // namespace

struct SpinningLidar::Slice {
  explicit Slice(int threads) : workers(threads) {}

  std::array<LaserConstants, kMaxLasers> lasers{};
  std::array<std::uint8_t, kMaxLasers> by_elevation{};
  std::size_t laser_count = 0;
  std::vector<FiringBlock> blocks;
  std::uint64_t first_number = 0;  ///< Of the first firing, counted from the plan's first.
  float near_m = 0.0F;
  float far_m = 0.0F;
  WorkerPool workers;

  [[nodiscard]] std::size_t packets(const FiringBlock& block) const {
    return (block.count * laser_count + kLanes - 1) / kLanes;
  }

  /// Rays in order of elevation, then of firing: neighbours in a packet are neighbours in space.
  /// The last packet repeats its last ray in lanes left over.
  [[nodiscard]] LaneMap lanes(const FiringBlock& block, std::size_t packet) const {
    LaneMap map;
    const std::size_t last = block.count * laser_count - 1;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t index = std::min(packet * kLanes + lane, last);
      map.firing[lane] = static_cast<std::uint8_t>(index % block.count);
      map.laser[lane] = by_elevation[index / block.count];
    }
    return map;
  }

  void fill(const FiringBlock& block, const LaneMap& map, std::uint32_t mask,
            RTCRayHit8& packet) const;
};

void SpinningLidar::Slice::fill(const FiringBlock& block, const LaneMap& map, std::uint32_t mask,
                                RTCRayHit8& packet) const {
  RTCRay8& ray = packet.ray;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t f = map.firing[lane];
    const LaserConstants& laser = lasers[map.laser[lane]];
    const float cosine =
        block.cos_azimuth[f] * laser.cos_turn - block.sin_azimuth[f] * laser.sin_turn;
    const float sine =
        block.sin_azimuth[f] * laser.cos_turn + block.cos_azimuth[f] * laser.sin_turn;
    const float x_S = laser.cos_elevation * cosine;
    const float y_S = -laser.cos_elevation * sine;
    const float z_S = laser.sin_elevation;
    const float dt = laser.delay_s;
    std::array<float, 3> d{};
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = block.R[i][f] * x_S + block.R[3 + i][f] * y_S + block.R[6 + i][f] * z_S;
    }
    ray.dir_x[lane] = d[0] + dt * (block.w[1][f] * d[2] - block.w[2][f] * d[1]);
    ray.dir_y[lane] = d[1] + dt * (block.w[2][f] * d[0] - block.w[0][f] * d[2]);
    ray.dir_z[lane] = d[2] + dt * (block.w[0][f] * d[1] - block.w[1][f] * d[0]);
    ray.org_x[lane] = block.p[0][f] + dt * block.v[0][f] + laser.offset_m * block.R[6][f];
    ray.org_y[lane] = block.p[1][f] + dt * block.v[1][f] + laser.offset_m * block.R[7][f];
    ray.org_z[lane] = block.p[2][f] + dt * block.v[2][f] + laser.offset_m * block.R[8][f];
    ray.time[lane] = std::min(block.time[f] + laser.delay_share, 1.0F);
    ray.tnear[lane] = near_m;
    ray.tfar[lane] = far_m;
    ray.mask[lane] = mask;
    ray.id[lane] = 0;
    ray.flags[lane] = 0;
    packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
}

void validate(const SpinningLidarParameters& parameters) {
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("spinning lidar: " + what);
  };
  if (!(parameters.range_sigma_m >= 0.0 && parameters.range_sigma_m <= 1.0)) {
    refuse("range_sigma_m is " + std::to_string(parameters.range_sigma_m) + ", allowed: 0 to 1");
  }
  if (!(parameters.housing_radius_m >= 0.0 && parameters.housing_radius_m <= 1.0)) {
    refuse("housing_radius_m is " + std::to_string(parameters.housing_radius_m) +
           ", allowed: 0 to 1");
  }
  if (parameters.threads < 1 || parameters.threads > 64) {
    refuse("threads is " + std::to_string(parameters.threads) + ", allowed: 1 to 64");
  }
}

SpinningLidar::SpinningLidar(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                             const SamplePlan& plan, double rotor_rate_radps, std::uint64_t seed,
                             std::string_view name)
    : parameters_(parameters),
      pattern_(pattern),
      plan_(plan),
      rotor_rate_radps_(rotor_rate_radps),
      noise_key_(RandomStream(seed, std::string(name) + "/range").bits()) {
  validate(parameters);
  if (pattern.lasers.empty() || pattern.lasers.size() > kMaxLasers) {
    throw std::invalid_argument("spinning lidar: the pattern has " +
                                std::to_string(pattern.lasers.size()) + " lasers, allowed: 1 to " +
                                std::to_string(kMaxLasers));
  }
  if (plan.first == kNever || plan.period <= Duration::zero() || !std::isfinite(rotor_rate_radps) ||
      !(pattern.maximum_range_m > pattern.minimum_range_m)) {
    throw std::invalid_argument(
        "spinning lidar: needs a firing plan, a finite rotor rate and a range window");
  }
  slice_ = std::make_unique<Slice>(parameters.threads);
  Slice& slice = *slice_;
  slice.laser_count = pattern.lasers.size();
  slice.near_m = static_cast<float>(parameters.housing_radius_m);
  slice.far_m =
      static_cast<float>(pattern.maximum_range_m + kNoiseReach_sigma * parameters.range_sigma_m);
  for (std::size_t i = 0; i < slice.laser_count; ++i) {
    const LaserGeometry& laser = pattern.lasers[i];
    slice.lasers[i].cos_elevation = static_cast<float>(std::cos(laser.elevation_rad));
    slice.lasers[i].sin_elevation = static_cast<float>(std::sin(laser.elevation_rad));
    slice.lasers[i].offset_m = static_cast<float>(laser.vertical_offset_m);
    slice.lasers[i].delay_s = static_cast<float>(to_seconds(laser.time_offset));
  }
  const auto used = std::span(slice.by_elevation).first(slice.laser_count);
  std::iota(used.begin(), used.end(), std::uint8_t{0});
  std::ranges::sort(used, {}, [&](std::uint8_t i) { return pattern.lasers[i].elevation_rad; });
}

SpinningLidar::~SpinningLidar() = default;

void SpinningLidar::set_rotor_rate(SimTime time, double rate_radps) {
  azimuth_at_change_rad_ = rotor_azimuth_rad(time);
  rate_changed_ = time;
  rotor_rate_radps_ = rate_radps;
}

double SpinningLidar::rotor_azimuth_rad(SimTime time) const {
  const double azimuth = std::fmod(
      azimuth_at_change_rad_ + rotor_rate_radps_ * to_seconds(time - rate_changed_), kTurn);
  return azimuth < 0.0 ? azimuth + kTurn : azimuth;
}

void SpinningLidar::prepare(const Scene& scene, SimTime t0, SimTime t1,
                            const LinkMotion& mount_at_t0, const LinkMotion& mount_at_t1,
                            std::vector<LidarFiring>& firings) {
  Slice& slice = *slice_;
  slice.blocks.clear();
  firings.clear();
  const double length_s = to_seconds(t1 - t0);
  for (std::size_t i = 0; i < slice.laser_count; ++i) {
    LaserConstants& laser = slice.lasers[i];
    const double turn = rotor_rate_radps_ * to_seconds(pattern_.lasers[i].time_offset);
    laser.cos_turn = static_cast<float>(std::cos(turn));
    laser.sin_turn = static_cast<float>(std::sin(turn));
    laser.delay_share = static_cast<float>(laser.delay_s / length_s);
  }
  SimTime time = plan_.next_after(t0);
  if (time <= t1) {
    slice.first_number = static_cast<std::uint64_t>((time - plan_.first) / plan_.period);
  }
  const Eigen::Vector3d origin_W = scene.internals().origin_W;
  for (; time <= t1; time += plan_.period) {
    LidarFiring& firing = firings.emplace_back();
    firing.time = time;
    firing.rotor_azimuth_rad = rotor_azimuth_rad(time);
    firing.rotor_rate_radps = rotor_rate_radps_;

    if (slice.blocks.empty() || slice.blocks.back().count == kLanes) {
      slice.blocks.emplace_back().first = firings.size() - 1;
    }
    FiringBlock& block = slice.blocks.back();
    const std::size_t lane = block.count++;
    const LinkMotion mount = interpolate(t0, mount_at_t0, t1, mount_at_t1, time);
    const Eigen::Vector3d p = mount.X_WL.translation() - origin_W;
    const Eigen::Matrix3d R = mount.X_WL.linear();
    for (std::size_t i = 0; i < 9; ++i) {
      block.R[i][lane] = static_cast<float>(R.data()[i]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      block.p[i][lane] = static_cast<float>(p(row));
      block.v[i][lane] = static_cast<float>(mount.v_WL_W(row));
      block.w[i][lane] = static_cast<float>(mount.w_WL_W(row));
    }
    block.cos_azimuth[lane] = static_cast<float>(std::cos(firing.rotor_azimuth_rad));
    block.sin_azimuth[lane] = static_cast<float>(std::sin(firing.rotor_azimuth_rad));
    block.time[lane] = static_cast<float>(to_seconds(time - t0) / length_s);
  }
}

void SpinningLidar::cast(const Scene& scene, SimTime t0, SimTime t1, const LinkMotion& mount_at_t0,
                         const LinkMotion& mount_at_t1, std::vector<LidarFiring>& firings,
                         std::uint32_t mask) {
  prepare(scene, t0, t1, mount_at_t0, mount_at_t1, firings);
  slice_->workers.run(slice_->blocks.size(),
                      [&](std::size_t block) { cast_block(scene, block, firings, mask); });
  rays_ += firings.size() * slice_->laser_count;
}

void SpinningLidar::cast_block(const Scene& scene, std::size_t block_index,
                               std::vector<LidarFiring>& firings, std::uint32_t mask) const {
  const FlushDenormals flush;
  const Slice& slice = *slice_;
  const FiringBlock& block = slice.blocks[block_index];
  const Scene::Internals& in = scene.internals();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(32) std::array<int, kLanes> valid{};
  valid.fill(-1);
  const auto maximum = static_cast<float>(pattern_.maximum_range_m);
  const auto minimum = static_cast<float>(pattern_.minimum_range_m);
  const auto sigma = static_cast<float>(parameters_.range_sigma_m);
  const float echo_limit = maximum * maximum / kReferenceReflectance;

  RTCRayHit8 packet;
  for (std::size_t k = 0; k < slice.packets(block); ++k) {
    const LaneMap map = slice.lanes(block, k);
    slice.fill(block, map, mask, packet);
    rtcIntersect8(valid.data(), in.top.get(), &context, &packet);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t f = block.first + map.firing[lane];
      const std::size_t laser = map.laser[lane];
      LidarReturn& echo = firings[f].returns[laser];
      echo = {};
      if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
        continue;
      }
      const Scene::Internals::Shading& surface = in.shading[packet.hit.instID[0][lane]];
      const Eigen::Vector3f normal =
          surface.R_WM *
          Eigen::Vector3f(packet.hit.Ng_x[lane], packet.hit.Ng_y[lane], packet.hit.Ng_z[lane]);
      const float along = normal.x() * packet.ray.dir_x[lane] +
                          normal.y() * packet.ray.dir_y[lane] + normal.z() * packet.ray.dir_z[lane];
      const float apparent =
          surface.reflectance * std::abs(along) / std::sqrt(normal.squaredNorm());
      const float range = packet.ray.tfar[lane];
      if (!(range * range <= echo_limit * apparent)) {
        continue;
      }
      float measured = range;
      if (sigma > 0.0F) {
        measured += sigma * static_cast<float>(counter_gaussian(
                                noise_key_, (slice.first_number + f) * kMaxLasers + laser));
      }
      if (range >= minimum && measured >= minimum && measured <= maximum) {
        echo = {measured, apparent};
      }
    }
  }
}

struct RecordedRays::Packets {
  std::vector<RTCRayHit8> pristine;
  std::vector<RTCRayHit8> working;
};

RecordedRays::RecordedRays() : packets_(std::make_unique<Packets>()) {}
RecordedRays::~RecordedRays() = default;
RecordedRays::RecordedRays(RecordedRays&&) noexcept = default;
RecordedRays& RecordedRays::operator=(RecordedRays&&) noexcept = default;

std::size_t RecordedRays::size() const {
  return packets_->pristine.size() * kLanes;
}

void RecordedRays::reset() {
  packets_->working = packets_->pristine;
}

void RecordedRays::cast_bare(const Scene& scene) {
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(32) std::array<int, kLanes> valid{};
  valid.fill(-1);
  RTCScene top = scene.internals().top.get();
  for (RTCRayHit8& packet : packets_->working) {
    rtcIntersect8(valid.data(), top, &context, &packet);
  }
}

std::size_t RecordedRays::hits() const {
  std::size_t count = 0;
  for (const RTCRayHit8& packet : packets_->working) {
    count += static_cast<std::size_t>(std::ranges::count_if(
        packet.hit.geomID, [](unsigned id) { return id != RTC_INVALID_GEOMETRY_ID; }));
  }
  return count;
}

RecordedRays SpinningLidar::record(const Scene& scene, SimTime t0, SimTime t1,
                                   const LinkMotion& mount_at_t0, const LinkMotion& mount_at_t1) {
  std::vector<LidarFiring> firings;
  prepare(scene, t0, t1, mount_at_t0, mount_at_t1, firings);
  RecordedRays recorded;
  for (const FiringBlock& block : slice_->blocks) {
    for (std::size_t k = 0; k < slice_->packets(block); ++k) {
      RTCRayHit8& packet = recorded.packets_->pristine.emplace_back();
      slice_->fill(block, slice_->lanes(block, k), Scene::kSeeEverything, packet);
    }
  }
  recorded.reset();
  return recorded;
}

}  // namespace rigwire::sim
