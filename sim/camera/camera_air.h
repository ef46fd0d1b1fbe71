// The air between a camera and what it sees, held for one picture: the media of sim/weather, which
// the lidar uses too, for visible light and one way.
//
// A surface of luminance L behind the optical depth tau is seen as L T + A (1 - T), T = exp(-tau):
// H. Koschmieder 1924. A, the airlight, is that of air lit evenly from all round, by its media:
// fog, rain and snow white, dust in its own colour. Scattering more than once, and shadows in the
// air, are left out; so are single drops and flakes.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "sim/weather/air_fault.h"
#include "sim/weather/droplets.h"
#include "sim/weather/dust_field.h"
#include "sim/weather/scene_weather.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::sim {

class CameraAir {
 public:
  CameraAir() = default;  ///< Clear.
  /// At `time`. Rain, snow, fog and haze by their laws in sim/weather, haze at 550 nm; `dust` as
  /// it is at present, null for none.
  /// `faults` of the air, null for none.
  CameraAir(const WeatherParameters& parameters, SimTime time, const DustCloud* dust,
            const AirFaults* faults = nullptr);

  [[nodiscard]] bool clear() const { return even_pm_ == 0.0 && fog_pm_ == 0.0 && !dust_; }

  struct Depth {
    double even = 0.0;  ///< Optical depth of all media but dust.
    double dust = 0.0;
  };
  /// Along a unit vector.
  [[nodiscard]] Depth depth(const Eigen::Vector3d& start_W, const Eigen::Vector3d& direction_W,
                            double length_m) const;
  /// mm/h of rain.
  [[nodiscard]] double rain_mmph() const { return rain_mmph_; }

 private:
  double even_pm_ = 0.0;
  double fog_pm_ = 0.0;
  double rain_mmph_ = 0.0;
  FogParameters fog_;
  std::shared_ptr<const DustField> dust_;  ///< Null: none. Copies share it.
};

/// How wet ground is under rain of that rate, 0 .. 1: a film from some 2 mm/h on. There is no
/// memory of rain before.
[[nodiscard]] double wetness_of(double rain_mmph);

}  // namespace rigwire::sim
