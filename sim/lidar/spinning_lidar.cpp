#include "sim/lidar/spinning_lidar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "fields/constants.h"
#include "sim/lidar/beam_caster.h"
#include "sim/lidar/clear_echo.h"
#include "sim/lidar/firing_block.h"
#include "sim/lidar/worker_pool.h"
#include "sim/random.h"
#include "sim/scene/scene_internals.h"
#include "sim/weather/weather.h"

namespace rigwire::sim {
namespace {

void check(const LidarPattern& pattern, const SamplePlan& plan) {
  if (pattern.lasers.empty() || pattern.lasers.size() > kMaxLasers) {
    throw std::invalid_argument("spinning lidar: the pattern has " +
                                std::to_string(pattern.lasers.size()) + " lasers, allowed: 1 to " +
                                std::to_string(kMaxLasers));
  }
  if (plan.first == kNever || plan.period <= Duration::zero() ||
      !(pattern.maximum_range_m > pattern.minimum_range_m)) {
    throw std::invalid_argument("spinning lidar: needs a firing plan and a range window");
  }
}

/// Whether ClearEcho does all that is asked for, but for the width of beams.
bool is_plain(const SpinningLidarParameters& p) {
  return p.blooming_share == 0.0 && p.range_noise != RangeNoise::signal &&
         !p.compensates_incidence && p.drop_rate == 0.0 && p.drop_at_zero == 0.0;
}

SpinningLidarParameters with_rays(SpinningLidarParameters parameters, int sub_rays) {
  parameters.sub_rays = sub_rays;
  return parameters;
}

double checked_view_width(const LidarCommand& command) {
  if (!std::isfinite(command.view_start_rad) || !std::isfinite(command.view_end_rad)) {
    throw std::invalid_argument("spinning lidar: the view's ends are not finite numbers");
  }
  return within_turn(command.view_end_rad - command.view_start_rad);
}

/// No returns in this bank, or none but those that the caster will write to all its lasers.
void begin_bank(LidarFiring& bank, bool to_be_written_whole) {
  if (!to_be_written_whole) {
    bank.strongest.fill({});
  }
  // Both are empty unless echoes were separated: firings are reused, and this avoids writing half a
  // kilobyte each time.
  if (bank.several) {
    bank.last.fill({});
    bank.second.fill({});
    bank.several = false;
  }
}

}  // namespace

/// What a cast works with, kept so that it does not allocate.
struct SpinningLidar::Slice {
  Slice(const SpinningLidarParameters& parameters, const LidarPattern& pattern, std::uint64_t seed,
        std::string_view name)
      : head(pattern),
        single(with_rays(parameters, rays_per_beam(parameters, false)), pattern, seed, name),
        several(with_rays(parameters, rays_per_beam(parameters, true)), pattern, seed, name),
        clear_echo(parameters, pattern, single.echo_model(), head,
                   RandomStream(seed, std::string(name) + "/range").bits()),
        workers(parameters.threads) {}

  HeadLanes head;
  BeamCaster single;   ///< Casts for the strongest echo alone.
  BeamCaster several;  ///< Casts for several echoes.
  ClearEcho clear_echo;
  WorkerPool workers;
  std::vector<FiringBlock> blocks;  ///< The first block_count of them are of this slice.
  std::size_t block_count = 0;
  std::uint64_t first_number = 0;  ///< Number of the first firing, counted from the plan's first.
  RayLimits limits;

  [[nodiscard]] FiringBlock& new_block() {
    if (block_count == blocks.size()) {
      blocks.emplace_back();
    }
    return blocks[block_count++];
  }
  [[nodiscard]] std::span<const FiringBlock> used_blocks() const {
    return std::span(blocks).first(block_count);
  }
};

SpinningLidar::SpinningLidar(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                             const SamplePlan& plan, const LidarCommand& command,
                             std::uint64_t seed, std::string_view name,
                             const RotorParameters& rotor)
    : parameters_(parameters),
      pattern_(pattern),
      plan_(plan),
      command_(command),
      view_width_rad_(checked_view_width(command)),
      rotor_(command, rotor, seed, name) {
  validate(parameters);
  check(pattern, plan);
  slice_ = std::make_unique<Slice>(parameters, pattern, seed, name);
  slice_->limits.near_m = static_cast<float>(parameters.housing_radius_m);
  slice_->limits.far_m = static_cast<float>(slice_->single.echo_model().reach_m());
}

SpinningLidar::~SpinningLidar() = default;

void SpinningLidar::command(SimTime time, const LidarCommand& command) {
  view_width_rad_ = checked_view_width(command);
  rotor_.command(time, command);
  command_ = command;
}

bool SpinningLidar::fires_at(double azimuth_rad) const {
  return command_.laser_on &&
         (view_width_rad_ == 0.0 ||
          within_turn(azimuth_rad - command_.view_start_rad) < view_width_rad_);
}

void SpinningLidar::prepare(const Scene& scene, const LidarSlice& stretch, Rotor& rotor,
                            std::vector<LidarFiring>& firings) const {
  Slice& slice = *slice_;
  const SimTime t0 = stretch.t0;
  const SimTime t1 = stretch.t1;
  const double length_s = to_seconds(t1 - t0);
  slice.limits.mask = stretch.mask;
  slice.limits.slices_per_s = static_cast<float>(1.0 / length_s);
  slice.block_count = 0;
  // The plan's firings later than t0, up to and with t1.
  const SimTime first = plan_.next_after(t0);
  const auto count = first <= t1 ? static_cast<std::size_t>((t1 - first) / plan_.period) + 1 : 0;
  if (count > 0) {
    slice.first_number = static_cast<std::uint64_t>((first - plan_.first) / plan_.period);
  }
  const std::size_t banks = pattern_.banks();
  const bool last_bank_is_full = pattern_.lasers.size() % kBankLasers == 0;
  firings.resize(count * banks);

  // Embree's coordinates begin at the scene's local origin.
  const Eigen::Vector3d origin_W = scene.internals().origin_W;
  LinkMotion start = stretch.mount_at_t0;
  LinkMotion end = stretch.mount_at_t1;
  start.X_WL.translation() -= origin_W;
  end.X_WL.translation() -= origin_W;
  const LinkMotionInterpolation mount_at(t0, start, t1, end);
  std::array<FiringInstant, kLanes> waiting;
  std::size_t waiting_count = 0;
  const auto close_block = [&] {
    if (waiting_count > 0) {
      fill_block(std::span(waiting).first(waiting_count), mount_at, t0, length_s,
                 slice.new_block());
      waiting_count = 0;
    }
  };
  for (std::size_t i = 0; i < count; ++i) {
    const FiringInstant firing{
        .number = static_cast<std::uint32_t>(i),
        .time = first + static_cast<std::int64_t>(i) * plan_.period,
        .rotor = rotor.at(first + static_cast<std::int64_t>(i) * plan_.period)};
    const bool fires = fires_at(firing.rotor.encoder_rad);
    for (std::size_t b = 0; b < banks; ++b) {
      LidarFiring& bank = firings[i * banks + b];
      bank.time = firing.time;
      bank.rotor_azimuth_rad = firing.rotor.encoder_rad;
      bank.rotor_rate_radps = firing.rotor.rate_radps;
      bank.first_laser = b * kBankLasers;
      begin_bank(bank, fires && (b + 1 < banks || last_bank_is_full));
    }
    if (!fires || (waiting_count > 0 && firing.time - waiting[0].time > kLongestBlock)) {
      close_block();
    }
    if (fires) {
      waiting[waiting_count++] = firing;
      if (waiting_count == kLanes) {
        close_block();
      }
    }
  }
  close_block();
}

void SpinningLidar::cast(const Scene& scene, const LidarSlice& slice, const Weather* weather,
                         std::vector<LidarFiring>& firings, std::vector<LidarBankTruth>* truth) {
  prepare(scene, slice, rotor_, firings);
  std::span<LidarBankTruth> true_shots;
  if (truth != nullptr) {
    truth->assign(firings.size(), {});
    true_shots = *truth;
  }
  const bool clear = weather == nullptr || !weather->present();
  const BeamCaster& beams = command_.several_echoes ? slice_->several : slice_->single;
  const bool quick = clear && beams.rays_per_beam() == 1 && is_plain(parameters_);
  const std::span<const FiringBlock> blocks = slice_->used_blocks();
  slice_->workers.run(blocks.size(), [&](std::size_t i) {
    const FiringBlock& block = blocks[i];
    const BlockCast cast{.scene = scene,
                         .slice = slice,
                         .weather = weather,
                         .block = block,
                         .packets = slice_->head.packets(block.count),
                         .limits = slice_->limits,
                         .first_number = slice_->first_number,
                         .banks = pattern_.banks(),
                         .firings = firings,
                         .truth = true_shots,
                         .several = command_.several_echoes};
    if (quick) {
      slice_->clear_echo.cast(cast);
    } else {
      beams.cast(cast);
    }
  });
  for (const FiringBlock& block : blocks) {
    rays_ += block.count * pattern_.lasers.size() * beams.rays_per_beam();
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
  const Scene::Internals& in = scene.internals();
  for (RTCRayHit8& packet : packets_->working) {
    in.intersect(valid.data(), context, packet);
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
  Rotor rotor = rotor_;
  prepare(scene, slice, rotor, firings);
  RecordedRays recorded;
  for (const FiringBlock& block : slice_->used_blocks()) {
    for (const RingPacket& plan : slice_->head.packets(block.count)) {
      fill_packet(block, plan, slice_->limits, recorded.packets_->pristine.emplace_back());
    }
  }
  recorded.reset();
  return recorded;
}

}  // namespace rigwire::sim
