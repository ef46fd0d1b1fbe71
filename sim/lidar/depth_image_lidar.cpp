#include "sim/lidar/depth_image_lidar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include "sim/lidar/counter_noise.h"
#include "sim/lidar/depth_image_set.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/random.h"
#include "sim/scene/scene_internals.h"
#include "sim/weather/weather.h"

namespace rigwire::sim {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
/// Reflectance of the target that the maximum range is stated for.
constexpr float kReferenceReflectance = 0.9F;
/// Beyond the maximum range a hit may still come into it by its noise.
constexpr double kNoiseReach_sigma = 6.0;
/// What parallax may turn a beam that leaves beside the spin axis.
constexpr double kHorizontalParallax_rad = 0.05;
constexpr double kHalfLightSpeed_mpns = 0.5 * 0.299792458;

double wrapped(double azimuth_rad) {
  const double turns = azimuth_rad / kTurn;
  return (turns - std::floor(turns)) * kTurn;
}

/// Whether lasers fire with the rotor at this azimuth, [0, 2 pi).
bool in_view(const LidarCommand& command, double azimuth_rad) {
  const double width = wrapped(command.view_end_rad - command.view_start_rad);
  return width == 0.0 || wrapped(azimuth_rad - command.view_start_rad) < width;
}

double far_plane_m(const DepthImageParameters& parameters, const LidarPattern& pattern) {
  return pattern.maximum_range_m + kNoiseReach_sigma * parameters.range_sigma_m;
}

/// What comes back from a surface or from the air before it.
struct Echo {
  float range_m = 0.0F;
  float apparent = 0.0F;  ///< Reflectance of a diffuse target that returns as much from there.
};

/// The stronger of the surface seen through the air and of the air's own echoes.
Echo strongest(const Echo& surface, const AirPath& air) {
  const auto energy = [](const Echo& echo) {
    return echo.range_m > 0.0F ? echo.apparent / (echo.range_m * echo.range_m) : 0.0F;
  };
  Echo best{surface.range_m, surface.apparent * static_cast<float>(air.transmission)};
  for (std::size_t i = 0; i < air.echo_count; ++i) {
    const auto range_m = static_cast<float>(air.echoes[i].range_m);
    const Echo other{range_m, static_cast<float>(air.echoes[i].energy) * range_m * range_m};
    if (energy(other) > energy(best)) {
      best = other;
    }
  }
  return best;
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
  State(const DepthImageParameters& parameters, const LidarPattern& pattern)
      : images(parameters, pattern, far_plane_m(parameters, pattern)) {
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
  int part = 0;                 ///< Of the revolution, that the images are of.
  std::int64_t revolution = 0;  ///< That the images are of.
  std::int64_t now_in_revolution = 0;
  double azimuth_before_rad = 0.0;

  /// Azimuths of beams relative to the rotor's.
  double least_turn_rad = 0.0;
  double greatest_turn_rad = 0.0;
  double beside_rad = 0.0;
  double longest_delay_s = 0.0;
};

DepthImageLidar::DepthImageLidar(const DepthImageParameters& parameters,
                                 const LidarPattern& pattern, const SamplePlan& plan,
                                 const LidarCommand& command, std::uint64_t seed,
                                 std::string_view name)
    : parameters_(parameters),
      pattern_(pattern),
      plan_(plan),
      command_(command),
      rotor_(command),
      noise_key_(RandomStream(seed, std::string(name) + "/range").bits()),
      weather_key_(RandomStream(seed, std::string(name) + "/weather").bits()) {
  validate(parameters);
  if (plan.first == kNever || plan.period <= Duration::zero() ||
      !(pattern.maximum_range_m > pattern.minimum_range_m)) {
    throw std::invalid_argument("depth images: needs a firing plan and a range window");
  }
  state_ = std::make_unique<State>(parameters, pattern);
}

DepthImageLidar::~DepthImageLidar() = default;

void DepthImageLidar::command(SimTime time, const LidarCommand& command) {
  rotor_.command(time, command);
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
      firing.rotor_azimuth_rad = next.rotor.azimuth_rad;
      firing.rotor_rate_radps = next.rotor.rate_radps;
      firing.first_laser = bank * kBankLasers;
    }
    if (std::abs(next.rotor.azimuth_rad - state.azimuth_before_rad) > 0.5 * kTurn) {
      ++state.now_in_revolution;
    }
    state.azimuth_before_rad = next.rotor.azimuth_rad;
    const bool fires = command_.laser_on && in_view(command_, next.rotor.azimuth_rad);
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

void DepthImageLidar::answer(const Scene& scene, const Weather* weather, const Pending& pending,
                             std::vector<LidarFiring>& firings) const {
  const DepthImageSet& images = state_->images;
  const auto maximum = static_cast<float>(pattern_.maximum_range_m);
  const auto minimum = static_cast<float>(pattern_.minimum_range_m);
  const auto sigma = static_cast<float>(parameters_.range_sigma_m);
  const float echo_limit = maximum * maximum / kReferenceReflectance;
  const bool air = weather != nullptr && weather->present();
  Lanes noise = Lanes::Zero();
  for (std::size_t i = 0; i < pattern_.lasers.size(); ++i) {
    const LaserGeometry& laser = pattern_.lasers[i];
    const std::uint64_t shot = pending.number * kMaxLasers + i;
    if (sigma > 0.0F && i % kLanes == 0) {
      std::array<std::uint64_t, kLanes> shots{};
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        shots[lane] = shot + lane;
      }
      noise = sigma * gaussian_lanes(noise_key_, shots);
    }
    const double azimuth_rad = pending.azimuth_rad(laser);
    const SeenSurface seen = images.see(scene, i, azimuth_rad);
    Echo echo{static_cast<float>(seen.range_m), seen.reflectance * seen.cosine};
    if (air) {
      const BeamLine line = beam_line(laser, azimuth_rad);
      echo = strongest(
          echo,
          weather->along(
              {.start_W = images.X_WS() * line.start_S,
               .direction_W = images.X_WS().linear() * line.direction_S,
               .near_m = pattern_.minimum_range_m,
               .far_m = seen.range_m > 0.0 ? seen.range_m : pattern_.maximum_range_m,
               .divergence_rad = pattern_.beam.horizontal_divergence_rad,
               .pulse_m = kHalfLightSpeed_mpns * static_cast<double>(pattern_.beam.pulse.count()),
               .time = pending.time + laser.time_offset,
               .draw_key = counter_bits(weather_key_, shot)}));
    }
    if (!(echo_limit * echo.apparent >= echo.range_m * echo.range_m) || echo.range_m < minimum) {
      continue;  // nothing, too faint, or within the minimum range
    }
    const float measured = echo.range_m + noise(static_cast<Eigen::Index>(i % kLanes));
    if (measured >= minimum && measured <= maximum) {
      firings[pending.first_bank + i / kBankLasers].strongest[i % kBankLasers] = {
          measured, std::min(echo.apparent, 1.0F)};
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
