#include "sim/lidar/depth_image_lidar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "fields/constants.h"
#include "sim/lidar/beam_air.h"
#include "sim/lidar/beam_hits.h"
#include "sim/lidar/counter_noise.h"
#include "sim/lidar/depth_image_set.h"
#include "sim/lidar/link_budget.h"
#include "sim/random.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

/// What parallax may turn a beam that leaves beside the spin axis.
constexpr double kHorizontalParallax_rad = 0.05;

double wrapped(double azimuth_rad) {
  const double turns = azimuth_rad / kTurn;
  return (turns - std::floor(turns)) * kTurn;
}

/// Whether lasers fire with the rotor at this azimuth, [0, 2 pi).
bool in_view(const LidarCommand& command, double azimuth_rad) {
  const double width = wrapped(command.view_end_rad - command.view_start_rad);
  return width == 0.0 || wrapped(azimuth_rad - command.view_start_rad) < width;
}

const LidarCommand& checked(const LidarCommand& command) {
  if (!std::isfinite(command.view_start_rad) || !std::isfinite(command.view_end_rad)) {
    throw std::invalid_argument("depth images: the view's ends are not finite numbers");
  }
  return command;
}

const SpinningLidarParameters& checked(const SpinningLidarParameters& receiver) {
  if (receiver.sub_rays > 1 || receiver.blooming_share != 0.0) {
    throw std::invalid_argument("depth images: found sub_rays " +
                                std::to_string(receiver.sub_rays) + " and blooming_share " +
                                std::to_string(receiver.blooming_share) +
                                ", allowed: 0 or 1, and 0, because a pixel has one surface");
  }
  return receiver;
}

/// Sets the hit of one shot; it has no width and no depth.
void set_hit(SubRayHits& hits, std::size_t lane, const SeenSurface& seen, float minimum_m,
             bool compensates_incidence) {
  const auto range_m = static_cast<float>(seen.range_m);
  const bool hit = range_m > 0.0F;
  const bool returns = hit && range_m >= minimum_m;
  // Energy rho f(theta) / r^2 (link_budget.h).
  const float apparent = apparent_reflectance(seen.reflectance, seen.retro_gain, seen.cosine);
  const float head_on = apparent_reflectance(seen.reflectance, seen.retro_gain, 1.0F);
  hits.range_m[lane] = hit ? range_m : SubRayHits::kNothing;
  hits.energy[lane] = returns ? apparent / (range_m * range_m) : 0.0F;
  hits.brightness[lane] = !returns ? 0.0F : (compensates_incidence ? head_on : apparent);
  hits.patch_m[lane] = 0.0F;
}

/// The stronger of the surface and of what the air returns before it.
void keep_strongest(const SubRayHits& hits, const AirEchoes& air, std::size_t lane,
                    EchoLanes& echo) {
  echo.range_m[lane] = hits.energy[lane] > 0.0F ? hits.range_m[lane] : 0.0F;
  echo.energy[lane] = hits.energy[lane];
  echo.brightness[lane] = hits.brightness[lane];
  for (std::size_t i = 0; i < air.count; ++i) {
    if (air.parts[i].energy > echo.energy[lane]) {
      echo.range_m[lane] = air.parts[i].range_m;
      echo.energy[lane] = air.parts[i].energy;
      echo.brightness[lane] = air.parts[i].brightness;
    }
  }
}

}  // namespace

/// A firing that is still to be looked up.
struct DepthImageLidar::Pending {
  std::size_t first_bank = 0;  ///< Index of its first bank among the firings.
  std::uint64_t number = 0;    ///< Counted from the plan's first.
  SimTime time{};
  RotorState rotor;

  [[nodiscard]] double azimuth_rad(const LaserGeometry& laser) const {
    return rotor.azimuth_rad + rotor.rate_radps * to_seconds(laser.time_offset) +
           laser.azimuth_offset_rad;
  }
};

struct DepthImageLidar::State {
  State(const DepthImageParameters& parameters, const LidarPattern& pattern, double far_m,
        int threads)
      : images(parameters, pattern, far_m, threads) {
    for (const LaserGeometry& laser : pattern.lasers) {
      least_turn_rad = std::min(least_turn_rad, laser.azimuth_offset_rad);
      greatest_turn_rad = std::max(greatest_turn_rad, laser.azimuth_offset_rad);
      longest_delay_s = std::max(longest_delay_s, to_seconds(laser.time_offset));
      if (laser.horizontal_offset_m != 0.0) {
        beside_rad = kHorizontalParallax_rad;
      }
    }
  }

  DepthImageSet images;
  std::vector<Pending> pending;

  std::optional<SimTime> rendered;
  int part = 0;                 ///< Part of the revolution that the images show.
  std::int64_t revolution = 0;  ///< Revolution that the images show.
  std::int64_t now_in_revolution = 0;
  double azimuth_before_rad = 0.0;

  /// Azimuths of beams relative to the rotor's.
  double least_turn_rad = 0.0;
  double greatest_turn_rad = 0.0;
  double beside_rad = 0.0;
  double longest_delay_s = 0.0;
};

DepthImageLidar::DepthImageLidar(const DepthImageParameters& parameters,
                                 const SpinningLidarParameters& receiver,
                                 const LidarPattern& pattern, const SamplePlan& plan,
                                 const LidarCommand& command, std::uint64_t seed,
                                 std::string_view name, const RotorParameters& rotor)
    : parameters_(parameters),
      pattern_(pattern),
      plan_(plan),
      command_(checked(command)),
      rotor_(command, rotor, seed, name),
      echo_model_(checked(receiver), pattern, seed, name),
      compensates_incidence_(receiver.compensates_incidence),
      air_key_(RandomStream(seed, std::string(name) + "/air").bits()) {
  if (plan.first == kNever || plan.period <= Duration::zero() ||
      !(pattern.maximum_range_m > pattern.minimum_range_m)) {
    throw std::invalid_argument("depth images: needs a firing plan and a range window");
  }
  state_ = std::make_unique<State>(parameters, pattern, echo_model_.reach_m(), receiver.threads);
}

DepthImageLidar::~DepthImageLidar() = default;

void DepthImageLidar::command(SimTime time, const LidarCommand& command) {
  rotor_.command(time, checked(command));
  command_ = command;
}

bool DepthImageLidar::outdated(const Pending& next) const {
  const State& state = *state_;
  const double width = kTurn / parameters_.images_per_revolution;
  return !state.rendered || next.time - *state.rendered >= kLongestAge ||
         state.now_in_revolution != state.revolution ||
         static_cast<int>(next.rotor.azimuth_rad / width) != state.part;
}

void DepthImageLidar::render(const Scene& scene, const LidarSlice& slice, const Pending& first) {
  State& state = *state_;
  const double width = kTurn / parameters_.images_per_revolution;
  state.part = static_cast<int>(first.rotor.azimuth_rad / width);
  state.revolution = state.now_in_revolution;
  state.rendered = first.time;
  const LinkMotionInterpolation mount_at(slice.t0, slice.mount_at_t0, slice.t1, slice.mount_at_t1);
  const DepthImageView view{.X_WS = mount_at(first.time).X_WL,
                            .time = scene.internals().slice_fraction(first.time),
                            .mask = slice.mask};
  // Azimuths beside the part: lasers' offsets, parallax, and the turn until the last laser fires.
  const double swept_rad = first.rotor.rate_radps * state.longest_delay_s;
  const double before_rad = state.least_turn_rad - state.beside_rad + std::min(swept_rad, 0.0);
  const double after_rad = state.greatest_turn_rad + state.beside_rad + std::max(swept_rad, 0.0);
  pixels_ += state.images.render(scene, view, width * state.part + before_rad,
                                 width + after_rad - before_rad);
}

void DepthImageLidar::cast(const Scene& scene, const LidarSlice& slice, const Weather* weather,
                           std::vector<LidarFiring>& firings, std::vector<LidarBankTruth>* truth) {
  State& state = *state_;
  firings.clear();
  state.pending.clear();
  const auto answer_pending = [&] {
    state.images.workers().run(state.pending.size(), [&](std::size_t i) {
      answer(scene, weather, state.pending[i], firings);
    });
    state.pending.clear();
  };
  if (truth != nullptr) {
    truth->clear();
  }
  for (SimTime time = plan_.next_after(slice.t0); time <= slice.t1; time += plan_.period) {
    const Pending next{.first_bank = firings.size(),
                       .number = static_cast<std::uint64_t>((time - plan_.first) / plan_.period),
                       .time = time,
                       .rotor = rotor_.at(time)};
    for (std::size_t bank = 0; bank < pattern_.banks(); ++bank) {
      LidarFiring& firing = firings.emplace_back();
      firing.time = time;
      firing.rotor_azimuth_rad = next.rotor.encoder_rad;
      firing.rotor_rate_radps = next.rotor.rate_radps;
      firing.first_laser = bank * kBankLasers;
    }
    // A jump of more than half a turn is the azimuth's wrap: another revolution.
    if (std::abs(next.rotor.azimuth_rad - state.azimuth_before_rad) > 0.5 * kTurn) {
      ++state.now_in_revolution;
    }
    state.azimuth_before_rad = next.rotor.azimuth_rad;
    const bool fires = command_.laser_on && in_view(command_, next.rotor.encoder_rad);
    if (truth != nullptr) {
      truth->resize(firings.size());
      if (fires) {
        answer_truly(scene, slice, next, *truth);
      }
    }
    if (fires) {
      if (outdated(next)) {
        answer_pending();
        render(scene, slice, next);
      }
      state.pending.push_back(next);
    }
  }
  answer_pending();
}

WeatherBeam DepthImageLidar::weather_beam(const Pending& pending, std::size_t laser) const {
  const BeamLine line =
      beam_line(pattern_.lasers[laser], pending.azimuth_rad(pattern_.lasers[laser]));
  const Eigen::Isometry3d& X_WS = state_->images.X_WS();
  // Divergence: geometric mean of both; pulse: half its length in space, c tau / 2.
  return {.start_W = X_WS * line.start_S,
          .direction_W = X_WS.linear() * line.direction_S,
          .near_m = echo_model_.air_minimum_range_m(),
          .far_m = echo_model_.reach_m(),
          .focus_m = echo_model_.air_focus_range_m(),
          .divergence_rad = std::sqrt(pattern_.beam.horizontal_divergence_rad *
                                      pattern_.beam.vertical_divergence_rad),
          .pulse_m = 0.5 * kSpeedOfLight_mps * to_seconds(pattern_.beam.pulse),
          .time = pending.time + pattern_.lasers[laser].time_offset,
          .draw_key = counter_bits(air_key_, pending.number * kMaxLasers + laser),
          .detection_energy = echo_model_.air_threshold()};
}

void DepthImageLidar::answer(const Scene& scene, const Weather* weather, const Pending& pending,
                             std::vector<LidarFiring>& firings) const {
  static constexpr std::array kWholeBeam{1.0F};
  const bool air = weather != nullptr && weather->present();
  const std::size_t count = pattern_.lasers.size();
  for (std::size_t first = 0; first < count; first += kLanes) {
    ShotNumbers shots{};
    SubRayHits hits;
    EchoLanes echo;
    const std::size_t lanes = std::min(kLanes, count - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t laser = first + lane;
      shots[lane] = pending.number * kMaxLasers + laser;
      const SeenSurface seen =
          state_->images.see(scene, laser, pending.azimuth_rad(pattern_.lasers[laser]));
      set_hit(hits, lane, seen, echo_model_.minimum_range_m(), compensates_incidence_);
      AirEchoes in_the_air;
      if (air) {
        in_the_air =
            pass_air(*weather, weather_beam(pending, laser), kWholeBeam, std::span(&hits, 1), lane);
      }
      keep_strongest(hits, in_the_air, lane, echo);
    }
    const EightReturns returns = echo_model_.report(echo, shots, EchoRank::strongest);
    LidarFiring& firing = firings[pending.first_bank + first / kBankLasers];
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      firing.strongest[(first + lane) % kBankLasers] = returns[lane];
    }
  }
}

void DepthImageLidar::answer_truly(const Scene& scene, const LidarSlice& slice,
                                   const Pending& pending,
                                   std::vector<LidarBankTruth>& truth) const {
  const LinkMotionInterpolation mount_at(slice.t0, slice.mount_at_t0, slice.t1, slice.mount_at_t1);
  for (std::size_t i = 0; i < pattern_.lasers.size(); ++i) {
    const LaserGeometry& laser = pattern_.lasers[i];
    const SimTime time = pending.time + laser.time_offset;
    const BeamLine line = beam_line(laser, pending.azimuth_rad(laser));
    // A firing's last lasers may be past the slice.
    const SimTime within = std::min(time, slice.t1);
    Eigen::Isometry3d X_WS = mount_at(within).X_WL;
    X_WS.translation() += to_seconds(time - within) * slice.mount_at_t1.v_WL_W;
    const Eigen::Vector3d direction_W = X_WS.linear() * line.direction_S;
    const auto hit = scene.cast(X_WS * line.start_S, direction_W, parameters_.near_plane_m,
                                pattern_.maximum_range_m, time, slice.mask);
    if (hit) {
      truth[pending.first_bank + i / kBankLasers][i % kBankLasers] = {
          .range_m = static_cast<float>(hit->range_m),
          .instance = hit->instance,
          .cosine_of_incidence = static_cast<float>(std::abs(hit->normal_W.dot(direction_W)))};
    }
  }
}

}  // namespace rigwire::sim
