#include "sim/lidar/spinning_lidar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "sim/lidar/firing_block.h"
#include "sim/lidar/worker_pool.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

/// Reflectance of the target that the maximum range is stated for.
constexpr float kReferenceReflectance = 0.9F;
/// Beyond the maximum range a hit may still come into it by its noise.
constexpr double kNoiseReach_sigma = 6.0;

/// Normals in the world and reflectances of what the packet has hit; where nothing was hit, a
/// reflectance that lets no echo through.
void shade(const Scene::Internals& scene, const RTCRayHit8& packet, std::array<Lanes, 3>& normal,
           Lanes& reflectance) {
  const unsigned instance = packet.hit.instID[0][0];
  const bool one_surface =
      instance != RTC_INVALID_GEOMETRY_ID &&
      std::ranges::all_of(packet.hit.instID[0], [&](unsigned other) { return other == instance; });
  if (one_surface) {
    const Scene::Internals::Shading& surface = scene.shading[instance];
    const LanesIn x(packet.hit.Ng_x);
    const LanesIn y(packet.hit.Ng_y);
    const LanesIn z(packet.hit.Ng_z);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      normal[i] = surface.R_WM(row, 0) * x + surface.R_WM(row, 1) * y + surface.R_WM(row, 2) * z;
    }
    reflectance.setConstant(surface.reflectance);
    return;
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<Eigen::Index>(lane);
    if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
      normal[0](i) = normal[1](i) = normal[2](i) = 1.0F;
      reflectance(i) = 0.0F;
      continue;
    }
    const Scene::Internals::Shading& surface = scene.shading[packet.hit.instID[0][lane]];
    const Eigen::Vector3f n_W =
        surface.R_WM *
        Eigen::Vector3f(packet.hit.Ng_x[lane], packet.hit.Ng_y[lane], packet.hit.Ng_z[lane]);
    normal[0](i) = n_W.x();
    normal[1](i) = n_W.y();
    normal[2](i) = n_W.z();
    reflectance(i) = surface.reflectance;
  }
}

}  // namespace

struct SpinningLidar::Slice {
  explicit Slice(int threads) : workers(threads) {}

  std::array<LaserLanes, kMaxLasers> lasers{};
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
  const RayLimits limits{near_m, far_m, mask};
  if (block.count == kLanes) {
    fill_rays(block.lanes, lasers[map.laser[0]], limits, packet);
  } else {
    FiringLanes firing;
    LaserLanes laser;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      firing.copy_lane(block.lanes, map.firing[lane], lane);
      laser.copy_lane(lasers[map.laser[lane]], lane, lane);
    }
    fill_rays(firing, laser, limits, packet);
  }
}

SpinningLidar::SpinningLidar(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                             const SamplePlan& plan, const LidarCommand& command,
                             std::uint64_t seed, std::string_view name)
    : parameters_(parameters),
      pattern_(pattern),
      plan_(plan),
      command_(command),
      rotor_(command),
      noise_key_(RandomStream(seed, std::string(name) + "/range").bits()) {
  validate(parameters);
  if (pattern.lasers.empty() || pattern.lasers.size() > kMaxLasers) {
    throw std::invalid_argument("spinning lidar: the pattern has " +
                                std::to_string(pattern.lasers.size()) + " lasers, allowed: 1 to " +
                                std::to_string(kMaxLasers));
  }
  if (plan.first == kNever || plan.period <= Duration::zero() ||
      !(pattern.maximum_range_m > pattern.minimum_range_m)) {
    throw std::invalid_argument("spinning lidar: needs a firing plan and a range window");
  }
  slice_ = std::make_unique<Slice>(parameters.threads);
  Slice& slice = *slice_;
  slice.laser_count = pattern.lasers.size();
  slice.near_m = static_cast<float>(parameters.housing_radius_m);
  slice.far_m =
      static_cast<float>(pattern.maximum_range_m + kNoiseReach_sigma * parameters.range_sigma_m);
  for (std::size_t i = 0; i < slice.laser_count; ++i) {
    const LaserGeometry& laser = pattern.lasers[i];
    LaserLanes& lanes = slice.lasers[i];
    lanes.cos_elevation().setConstant(static_cast<float>(std::cos(laser.elevation_rad)));
    lanes.sin_elevation().setConstant(static_cast<float>(std::sin(laser.elevation_rad)));
    lanes.offset_m().setConstant(static_cast<float>(laser.vertical_offset_m));
    lanes.delay_s().setConstant(static_cast<float>(to_seconds(laser.time_offset)));
  }
  const auto used = std::span(slice.by_elevation).first(slice.laser_count);
  std::iota(used.begin(), used.end(), std::uint8_t{0});
  std::ranges::sort(used, {}, [&](std::uint8_t i) { return pattern.lasers[i].elevation_rad; });
}

SpinningLidar::~SpinningLidar() = default;

void SpinningLidar::command(SimTime time, const LidarCommand& command) {
  rotor_.command(time, command);
  command_ = command;
}

void SpinningLidar::prepare(const Scene& scene, const LidarSlice& stretch,
                            std::vector<LidarFiring>& firings) {
  Slice& slice = *slice_;
  const auto [t0, t1, mount_at_t0, mount_at_t1, mask] = stretch;
  const double rotor_rate_radps = rotor_.at(t0).rate_radps;
  slice.blocks.clear();
  firings.clear();
  const double length_s = to_seconds(t1 - t0);
  for (std::size_t i = 0; i < slice.laser_count; ++i) {
    LaserLanes& laser = slice.lasers[i];
    const double delay_s = to_seconds(pattern_.lasers[i].time_offset);
    laser.cos_turn().setConstant(static_cast<float>(std::cos(rotor_rate_radps * delay_s)));
    laser.sin_turn().setConstant(static_cast<float>(std::sin(rotor_rate_radps * delay_s)));
    laser.delay_share().setConstant(static_cast<float>(delay_s / length_s));
  }
  SimTime time = plan_.next_after(t0);
  if (time <= t1) {
    slice.first_number = static_cast<std::uint64_t>((time - plan_.first) / plan_.period);
  }
  const Eigen::Vector3d origin_W = scene.internals().origin_W;
  const LinkMotionInterpolation mount_at(t0, mount_at_t0, t1, mount_at_t1);
  for (; time <= t1; time += plan_.period) {
    LidarFiring& firing = firings.emplace_back();
    firing.time = time;
    const RotorState rotor = rotor_.at(time);
    firing.rotor_azimuth_rad = rotor.azimuth_rad;
    firing.rotor_rate_radps = rotor.rate_radps;

    if (slice.blocks.empty() || slice.blocks.back().count == kLanes) {
      slice.blocks.emplace_back().first = firings.size() - 1;
    }
    FiringBlock& block = slice.blocks.back();
    const auto lane = static_cast<Eigen::Index>(block.count++);
    FiringLanes& lanes = block.lanes;
    const LinkMotion mount = mount_at(time);
    const Eigen::Vector3d p = mount.X_WL.translation() - origin_W;
    const Eigen::Matrix3d R = mount.X_WL.linear();
    for (std::size_t i = 0; i < 9; ++i) {
      lanes.R(i)(lane) = static_cast<float>(R.data()[i]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      lanes.p(i)(lane) = static_cast<float>(p(row));
      lanes.v(i)(lane) = static_cast<float>(mount.v_WL_W(row));
      lanes.w(i)(lane) = static_cast<float>(mount.w_WL_W(row));
    }
    lanes.cos_azimuth()(lane) = static_cast<float>(std::cos(firing.rotor_azimuth_rad));
    lanes.sin_azimuth()(lane) = static_cast<float>(std::sin(firing.rotor_azimuth_rad));
    lanes.time()(lane) = static_cast<float>(to_seconds(time - t0) / length_s);
  }
}

void SpinningLidar::cast(const Scene& scene, const LidarSlice& slice, const Weather* /*weather*/,
                         std::vector<LidarFiring>& firings,
                         std::vector<LidarBankTruth>* /*truth*/) {
  prepare(scene, slice, firings);
  slice_->workers.run(slice_->blocks.size(),
                      [&](std::size_t block) { cast_block(scene, block, firings, slice.mask); });
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
    std::array<Lanes, 3> normal;
    Lanes reflectance;
    shade(in, packet, normal, reflectance);
    const LanesIn range(packet.ray.tfar);
    const Lanes along = normal[0] * LanesIn{packet.ray.dir_x} +
                        normal[1] * LanesIn{packet.ray.dir_y} +
                        normal[2] * LanesIn{packet.ray.dir_z};
    const Lanes length = (normal[0].square() + normal[1].square() + normal[2].square()).sqrt();
    const Lanes apparent = reflectance * along.abs() / length;
    const Lanes excess = echo_limit * apparent - range.square();
    Lanes noise = Lanes::Zero();
    if (sigma > 0.0F) {
      std::array<std::uint64_t, kLanes> shots{};
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        shots[lane] =
            (slice.first_number + block.first + map.firing[lane]) * kMaxLasers + map.laser[lane];
      }
      noise = sigma * gaussian_lanes(noise_key_, shots);
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const auto i = static_cast<Eigen::Index>(lane);
      const std::size_t f = block.first + map.firing[lane];
      const std::size_t laser = map.laser[lane];
      LidarReturn& echo = firings[f].strongest[laser];
      if (!(excess(i) >= 0.0F) || range(i) < minimum) {
        continue;  // nothing, too faint, or within the minimum range
      }
      const float measured = range(i) + noise(i);
      if (measured >= minimum && measured <= maximum) {
        echo = {measured, apparent(i)};
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

RecordedRays SpinningLidar::record(const Scene& scene, const LidarSlice& slice) {
  std::vector<LidarFiring> firings;
  prepare(scene, slice, firings);
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
