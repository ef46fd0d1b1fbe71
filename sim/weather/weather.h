// Media in the air that a laser beam passes through: they weaken the echo of the surface behind
// them, and return echoes of their own.
//
// Energies are in the unit of the link budget that the lidar uses (sim/lidar): a surface of diffuse
// reflectance rho at incidence angle theta and range r returns rho f(theta) T / r^2, where T
// is the two-way transmission; an echo is seen when that is at least 0.9 / R_max^2. A thin layer of
// scatterers with back-scatter beta (per metre and steradian) and depth d is then a surface of
// rho f(theta) = pi beta d, since a white Lambertian surface sends 1 / pi per steradian back.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/samples/time.h"

namespace rigwire::sim {

/// Limit of detection of a lidar that just sees a surface of reflectance 0.9 at that range, at
/// normal incidence (Goodin et al. 2019).
[[nodiscard]] constexpr double detection_energy(double maximum_range_m) {
  return 0.9 / (maximum_range_m * maximum_range_m);
}

/// One beam, from its exit to the surface that it hits or to its maximum range.
struct WeatherBeam {
  Eigen::Vector3d start_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction_W = Eigen::Vector3d::UnitX();  ///< Unit.
  double near_m = 0.0;  ///< Echoes nearer than this are not looked for.
  double far_m = 0.0;   ///< Where the surface is.
  /// Focus of a receiver whose lens is focused far away: nearer than this, it images the light as a
  /// disc wider than its detector, which takes the share (range / focus)^2. 0: it takes all.
  double focus_m = 0.0;
  double divergence_rad = 0.0;  ///< Full angle of the beam, for the volume that it fills.
  double pulse_m = 0.75;  ///< Half the pulse's length in space, c / 2 times its half-power width:
                          ///< resolution in range.
  SimTime time{};
  std::uint64_t draw_key = 0;  ///< With the counter's values 0, 1, … gives this beam's own random
                               ///< numbers (sim/lidar/counter_noise.h).
  double detection_energy =
      sim::detection_energy(100.0);  ///< Fainter echoes are not reported; above 0.
};

/// An echo from the air.
struct AirEcho {
  double range_m = 0.0;
  double energy = 0.0;  ///< Attenuation included.
  /// Share of its light that the receiver took, included in `energy`. Receivers make up for it in
  /// the reflectivity that they report.
  double share_taken = 1.0;
};

inline constexpr std::size_t kMaxAirEchoes = 4;

struct AirPath {
  double transmission = 1.0;                    ///< Two ways, from the sensor to far_m and back.
  std::array<AirEcho, kMaxAirEchoes> echoes{};  ///< The strongest ones, in order of range.
  std::size_t echo_count = 0;
};

/// Casting is const and may run on many threads.
class Weather {
 public:
  virtual ~Weather() = default;
  [[nodiscard]] virtual AirPath along(const WeatherBeam& beam) const = 0;
  /// False: nothing in the air at present, along() need not be asked.
  [[nodiscard]] virtual bool present() const = 0;

 protected:
  Weather() = default;
  Weather(const Weather&) = default;
  Weather& operator=(const Weather&) = default;
};

}  // namespace rigwire::sim
