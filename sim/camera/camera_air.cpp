#include "sim/camera/camera_air.h"

#include <cmath>
#include <utility>

#include "sim/weather/precipitation.h"

namespace rigwire::sim {

CameraAir::CameraAir(const WeatherParameters& parameters, SimTime time, const DustCloud* dust,
                     const AirFaults* faults)
    : fog_(parameters.fog) {
  validate(parameters);
  AirState state = state_at(parameters.course, time - kStart);
  if (faults != nullptr) {
    faults->lay_over(time, state);
  }
  rain_mmph_ = state.rain_mmph;
  // Rain and snow by the spectra of precipitation.h, whose drops are far above any wavelength here.
  if (parameters.rain.model == RainModel::goodin) {
    even_pm_ += goodin_extinction_pm(state.rain_mmph);
  } else if (state.rain_mmph > 0.0) {
    even_pm_ += spectrum_extinction_pm(rain_spectrum(parameters.rain, state.rain_mmph),
                                       parameters.rain.extinction_efficiency);
  }
  if (state.snow_mmph > 0.0) {
    even_pm_ += spectrum_extinction_pm(snow_spectrum(parameters.snow, state.snow_mmph),
                                       parameters.snow.extinction_efficiency);
  }
  HazeParameters visible = parameters.haze;
  visible.wavelength_m = 550e-9;
  even_pm_ += haze_optics(visible, state.inverse_haze_visibility_pm).extinction_pm;
  fog_pm_ = fog_optics(parameters.fog, state.inverse_fog_visibility_pm).extinction_pm;
  if (dust != nullptr && !dust->puffs().empty()) {
    auto field = std::make_shared<DustField>();
    field->fill(dust->puffs(), parameters);
    if (!field->empty()) {
      dust_ = std::move(field);
    }
  }
}

CameraAir::Depth CameraAir::depth(const Eigen::Vector3d& start_W,
                                  const Eigen::Vector3d& direction_W, double length_m) const {
  Depth depth;
  depth.even = even_pm_ * length_m;
  if (fog_pm_ > 0.0) {
    depth.even += fog_pm_ * fog_path_m(fog_, start_W.z(), direction_W.z(), length_m);
  }
  if (dust_) {
    depth.dust = dust_->optical_depth(start_W, direction_W, length_m);
  }
  return depth;
}

double wetness_of(double rain_mmph) {
  return rain_mmph > 0.0 ? 1.0 - std::exp(-0.5 * rain_mmph) : 0.0;
}

}  // namespace rigwire::sim
