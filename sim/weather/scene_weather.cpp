#include "sim/weather/scene_weather.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/weather/air_echoes.h"

namespace rigwire::sim {
namespace {

// Where each medium's own random numbers begin.
constexpr std::uint64_t kRainCounter = 0x100;
constexpr std::uint64_t kSnowCounter = 0x200;
constexpr std::uint64_t kDustCounter = 0x300;
constexpr std::uint64_t kSoftCounter = 0x400;

AirState state_of(const WeatherFrame& frame) {
  const auto inverse = [](double visibility_m) {
    return visibility_m > 0.0 ? 1.0 / visibility_m : 0.0;
  };
  return {frame.rain_mmph,
          frame.snow_mmph,
          inverse(frame.fog_visibility_m),
          inverse(frame.haze_visibility_m),
          wind_from(frame.wind_mps, frame.wind_from_rad),
          frame.dryness};
}

WeatherParameters valid(const WeatherParameters& parameters) {
  validate(parameters);
  return parameters;
}

}  // namespace

AirState state_at(const std::vector<WeatherFrame>& course, Duration time) {
  if (course.empty()) {
    return {};
  }
  const auto after = std::ranges::upper_bound(course, time, {}, &WeatherFrame::at);
  if (after == course.begin()) {
    return state_of(course.front());
  }
  AirState a = state_of(*std::prev(after));
  if (after == course.end()) {
    return a;
  }
  const AirState b = state_of(*after);
  const Duration since = time - std::prev(after)->at;
  // Linear between two frames of the course.
  const double share = to_seconds(since) / to_seconds(after->at - std::prev(after)->at);
  const auto blend = [share](const auto& from, const auto& to) {
    return (1.0 - share) * from + share * to;
  };
  AirState state;
  state.rain_mmph = blend(a.rain_mmph, b.rain_mmph);
  state.snow_mmph = blend(a.snow_mmph, b.snow_mmph);
  state.inverse_fog_visibility_pm = blend(a.inverse_fog_visibility_pm, b.inverse_fog_visibility_pm);
  state.inverse_haze_visibility_pm =
      blend(a.inverse_haze_visibility_pm, b.inverse_haze_visibility_pm);
  state.wind_mps = (1.0 - share) * a.wind_mps + share * b.wind_mps;
  state.dryness = blend(a.dryness, b.dryness);
  return state;
}

SceneWeather::SceneWeather() : SceneWeather(WeatherParameters{}, 0) {}

SceneWeather::SceneWeather(const WeatherParameters& parameters, std::uint64_t seed,
                           std::shared_ptr<const AirFaults> faults)
    : parameters_(valid(parameters)),
      faults_(std::move(faults)),
      wind_(parameters.wind, seed),
      dust_(parameters.dust) {
  dusty_ = std::ranges::any_of(parameters.course,
                               [](const WeatherFrame& frame) { return frame.dryness > 0.0; });
  step(kStart, {});
  present_ = !airs_.back().clear();
}

SceneWeather::~SceneWeather() = default;

void SceneWeather::advance(SimTime time, std::span<const DustEmitter> emitters) {
  // A beam of this slice may lie on the instant before until_ at the earliest.
  while (airs_.size() > 1 && airs_[1].time <= until_) {
    spare_.push_back(std::move(airs_.front()));
    airs_.pop_front();
  }
  while (airs_.back().time + kGrid <= time) {
    step(airs_.back().time + kGrid, emitters);
  }
  until_ = time;
  present_ = std::ranges::any_of(airs_, [](const Air& air) { return !air.clear(); });
}

void SceneWeather::step(SimTime time, std::span<const DustEmitter> emitters) {
  if (time > kStart) {
    const AirState state = state_at(parameters_.course, time - kStart);
    const double step_s = to_seconds(kGrid);
    wind_.advance(step_s, state.wind_mps);
    if (dusty_) {
      // AP-42 13.2.2: emission grows with the silt content to the power 0.7, stated for 12 %.
      const double dustiness = state.dryness * std::pow(parameters_.dust.silt_share / 0.12, 0.7);
      dust_.advance(step_s, wind_.velocity_mps(), dustiness, emitters);
    }
  }
  if (spare_.empty()) {
    airs_.emplace_back();
  } else {
    airs_.push_back(std::move(spare_.back()));
    spare_.pop_back();
  }
  prepare(airs_.back(), time);
}

AirState SceneWeather::state(SimTime time) const {
  AirState state = state_at(parameters_.course, time - kStart);
  if (faults_ != nullptr) {
    faults_->lay_over(time, state);
  }
  return state;
}

void SceneWeather::prepare(Air& air, SimTime time) {
  const WeatherParameters& p = parameters_;
  const AirState state = this->state(time);
  air.time = time;
  air.even_pm = 0.0;
  air.rain = {};
  air.snow = {};
  if (state.rain_mmph > 0.0) {
    if (p.rain.model == RainModel::goodin) {
      air.even_pm += goodin_extinction_pm(state.rain_mmph);
    } else {
      const DropSpectrum drops = rain_spectrum(p.rain, state.rain_mmph);
      air.even_pm += spectrum_extinction_pm(drops, p.rain.extinction_efficiency);
      air.rain = {drops, drop_reflectance(p.rain.refractive_index), p.rain.nearest_echo_m};
    }
  }
  if (state.snow_mmph > 0.0) {
    const DropSpectrum flakes = snow_spectrum(p.snow, state.snow_mmph);
    air.even_pm += spectrum_extinction_pm(flakes, p.snow.extinction_efficiency);
    air.snow = {flakes, drop_reflectance(p.snow.refractive_index), p.snow.nearest_echo_m};
  }
  air.fog = fog_optics(p.fog, state.inverse_fog_visibility_pm);
  air.haze = haze_optics(p.haze, state.inverse_haze_visibility_pm);
  air.even_pm += air.haze.extinction_pm;
  air.wind_mps << wind_.velocity_mps(), 0.0;
  air.dust.fill(dust_.puffs(), p);
}

const SceneWeather::Air& SceneWeather::air_at(SimTime time) const {
  std::size_t i = airs_.size() - 1;
  while (i > 0 && airs_[i].time > time) {
    --i;
  }
  return airs_[i];
}

double SceneWeather::even_extinction_pm(SimTime time) const {
  const Air& air = air_at(time);
  return air.even_pm + air.fog.extinction_pm;
}

AirPath SceneWeather::along(const WeatherBeam& beam) const {
  AirPath path;
  const Air& air = air_at(beam.time);
  if (air.clear()) {
    return path;
  }
  const double climb = beam.direction_W.z();
  const double z_m = beam.start_W.z();
  const bool foggy = air.fog.extinction_pm > 0.0;
  // Optical depth: what is even by the way, fog by the way through its profile (fog_path_m).
  const auto depth_to = [&](double range_m) {
    return air.even_pm * range_m +
           (foggy ? air.fog.extinction_pm * fog_path_m(parameters_.fog, z_m, climb, range_m) : 0.0);
  };
  const double depth = depth_to(beam.far_m);
  // Beer and Lambert, there and back.
  path.transmission = std::exp(-2.0 * depth);
  if (!air.dust.empty()) {
    WeatherBeam carried = beam;
    carried.start_W -= to_seconds(beam.time - air.time) * air.wind_mps;
    air.dust.along(carried, beam.far_m > 0.0 ? depth / beam.far_m : 0.0, kDustCounter, path);
  }
  const auto dust_transmission = [&](double range_m) {
    if (air.dust.empty() || parameters_.dust.echo == DustEchoModel::optical_depth) {
      return 1.0;
    }
    return std::exp(-2.0 * air.dust.optical_depth(
                               beam.start_W - to_seconds(beam.time - air.time) * air.wind_mps,
                               beam.direction_W, range_m));
  };
  if (foggy || air.haze.backscatter_pmsr > 0.0) {
    const auto mean = [&](double range_m) {
      const double density = foggy ? fog_density(parameters_.fog, z_m + climb * range_m) : 0.0;
      return mean_clutter(beam, range_m,
                          density * air.fog.backscatter_pmsr + air.haze.backscatter_pmsr,
                          depth_to(range_m));
    };
    // Fog in a layer is densest at the lower end of the beam, and thinnest at the upper one.
    const FogParameters& fog = parameters_.fog;
    const bool even = !foggy || fog.scale_height_m <= 0.0;
    const double end_z_m = z_m + climb * beam.far_m;
    const double densest = foggy ? fog_density(fog, std::min(z_m, end_z_m)) : 0.0;
    const double thinnest = foggy ? fog_density(fog, std::max(z_m, end_z_m)) : 0.0;
    ClutterLimits limits{densest * air.fog.backscatter_pmsr + air.haze.backscatter_pmsr,
                         even || climb >= 0.0,
                         2.0 * (air.even_pm + thinnest * air.fog.extinction_pm)};
    if (!even && climb > 0.0 && z_m >= fog.base_height_m && air.haze.backscatter_pmsr == 0.0) {
      limits.fall_pm += climb / fog.scale_height_m;
    }
    draw_clutter(beam, kSoftCounter, limits, mean, [&](double range_m, double energy) {
      // Dust before it thins out what is above the limit, exactly as drops below.
      const double weakened = energy * dust_transmission(range_m);
      if (weakened >= beam.detection_energy) {
        const double taken = std::min(range_m / std::max(range_m, beam.focus_m), 1.0);
        add_echo(path, {range_m, weakened, taken * taken});
      }
    });
  }
  const auto seen = [&](double range_m, double energy) {
    // Echo of one drop or flake, weakened there and back.
    const double weakened =
        energy * std::exp(-2.0 * depth_to(range_m)) * dust_transmission(range_m);
    if (weakened >= beam.detection_energy) {
      add_echo(path, {range_m, weakened});
    }
  };
  air.rain.draw(beam, kRainCounter, seen);
  air.snow.draw(beam, kSnowCounter, seen);
  return path;
}

}  // namespace rigwire::sim
