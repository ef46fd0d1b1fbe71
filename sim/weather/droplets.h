// Fog and haze: the droplets are too many and too small to be treated one by one; they weaken a
// beam evenly and return an echo that begins at the sensor.
//
// Optical constants:
//   fog   alpha = ln(20) / MOR, beta = 0.046 / MOR   (R. H. Rasshofer, M. Spies, H. Spies,
//         "Influences of weather phenomena on automotive laser radar systems", Adv. Radio Sci. 9,
//         2011; MOR the distance at which 5 % of the light is left)
//   haze  alpha = (3.912 / V) (wavelength / 550 nm)^-q, q = 1.6 for V > 50 km, 1.3 for V > 6 km,
//         0.585 (V / km)^(1/3) below   (P. W. Kruse et al., Elements of Infrared Technology, 1962),
//         beta = alpha / lidar ratio
// Fog may have an upper end: full density up to a base height, falling with a scale height above.
//
// The echo of a layer at range r, middle of the pulse, is on average, as M. Hahner et al., "Fog
// simulation on real LiDAR point clouds for 3D object detection in adverse weather", ICCV 2021,
// have it,
//   E(r) = pi beta integral of cos^2(pi u / 2 L) exp(-2 tau(s)) xi(s) / s^2 du, s = r - u, |u| < L,
// with L half the pulse's length in space and xi the share of the light that the receiver takes.
// Hahner's xi is 1 from 1 m on, for a sensor with a common axis. Velodyne's lenses are focused far
// away, and nearby the image of the lit spot is wider than the detector: xi = min((s / f)^2, 1)
// with f the width of the lens over the detector's angle (the geometrical compression of K.
// Stelmaszczyk et al., "Analytical function for lidar geometrical compression form-factor
// calculations", Applied Optics 44, 2005, for axes that coincide). Nearby xi / s^2 is constant, so
// that fog echoes no louder from 1 m than from f, and the integral is L exp(-2 tau(r)) / max(r,
// f)^2; error below 3 % for extinctions up to 0.3 per metre.
//
// Light scattered by very many droplets is speckle: the energy of each resolution cell of length L
// has a negative exponential distribution about E(r), independently of the other cells and of other
// shots (J. W. Goodman, "Statistical optics", 1985, 2.9). A receiver detects the cells above its
// limit T, exp(-T / E(r)) / L of them per metre: a Poisson process in range, of which most shots
// cost one comparison (precipitation.h draws drops the same way). An echo at r has the energy T
// plus an exponential one of mean E(r). Within L before a surface there is none: it is part of that
// surface's echo.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "sim/lidar/counter_noise.h"
#include "sim/weather/weather.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::sim {

/// Extinction per metre and back-scatter per metre and steradian.
struct DropletOptics {
  double extinction_pm = 0.0;
  double backscatter_pmsr = 0.0;
};

/// From 1 / visibility, so that 0 is: none.
[[nodiscard]] DropletOptics fog_optics(const FogParameters& parameters, double inverse_mor_pm);
[[nodiscard]] DropletOptics haze_optics(const HazeParameters& parameters,
                                        double inverse_visibility_pm);

/// Metres of full fog that hold as much as a path of that length from height z0_m on, whose height
/// changes by `climb` per metre.
[[nodiscard]] double fog_path_m(const FogParameters& parameters, double z0_m, double climb,
                                double length_m);
/// Density at a height against that below the base.
[[nodiscard]] double fog_density(const FogParameters& parameters, double z_m);

/// How fog and haze may echo along a beam.
struct ClutterLimits {
  double backscatter_pmsr = 0.0;  ///< At most, anywhere along the beam.
  bool falls = true;              ///< The mean energy falls with range all the way.
  /// It falls with exp(-fall r) or faster; where it does not fall all the way, what the
  /// back-scatter above would send does.
  double fall_pm = 0.0;
};

/// Calls seen(range_m, energy) for each echo of this shot that is detected, at most kMostClutter.
/// `mean(range_m)` is E(r) above. Numbers are drawn from the beam's key with counters from
/// `counter` on.
template <class Mean, class Seen>
void draw_clutter(const WeatherBeam& beam, std::uint64_t counter, const ClutterLimits& limits,
                  const Mean& mean, const Seen& seen);

/// E(r) for that back-scatter and optical depth, one way, up to the range.
[[nodiscard]] inline double mean_clutter(const WeatherBeam& beam, double range_m,
                                         double backscatter_pmsr, double optical_depth) {
  const double far_m = std::max(range_m, beam.focus_m);
  return std::numbers::pi * backscatter_pmsr * beam.pulse_m * std::exp(-2.0 * optical_depth) /
         (far_m * far_m);
}

inline constexpr int kMostClutter = 16;

/// Expected number of draw_clutter()'s echoes, summed step by step along the beam.
class ClutterCount {
 public:
  static constexpr std::size_t kSteps = 24;

  [[nodiscard]] double range_m(std::size_t node) const {
    const double share = static_cast<double>(node) / kSteps;
    return near_m_ + (far_m_ - near_m_) * share * share;  // denser where there is more
  }
  /// Returns the range below which that share of them lies.
  [[nodiscard]] double quantile_m(double share) const;

  template <class Mean>
  ClutterCount(const WeatherBeam& beam, double near_m, double far_m, const Mean& mean)
      : near_m_(near_m), far_m_(far_m) {
    const auto per_m = [&](double range_m) {
      return std::exp(-beam.detection_energy / mean(range_m)) / beam.pulse_m;
    };
    double before = per_m(near_m);
    for (std::size_t i = 1; i <= kSteps; ++i) {
      const double here = per_m(range_m(i));
      up_to_[i] = up_to_[i - 1] + 0.5 * (before + here) * (range_m(i) - range_m(i - 1));
      before = here;
    }
  }
  [[nodiscard]] double expected() const { return up_to_.back(); }

 private:
  double near_m_;
  double far_m_;
  std::array<double, kSteps + 1> up_to_{};
};

/// Poisson's distribution inverted: the number below which `u` of it lies, at most kMostClutter.
[[nodiscard]] int poisson_quantile(double u, double expected);

template <class Mean, class Seen>
void draw_clutter(const WeatherBeam& beam, std::uint64_t counter, const ClutterLimits& limits,
                  const Mean& mean, const Seen& seen) {
  // A cell above the limit with a probability of exp(-18) is left out.
  constexpr double kRare = 18.0;
  const double limit = beam.detection_energy;
  const double near_m = beam.near_m;
  const double strength = std::numbers::pi * limits.backscatter_pmsr * beam.pulse_m;
  double far_m = std::min(beam.far_m - beam.pulse_m, std::sqrt(kRare * strength / limit));
  const double nearest_m = std::max(near_m, beam.focus_m);
  if (far_m <= near_m || kRare * strength < limit * nearest_m * nearest_m) {
    return;
  }
  const double u = counter_uniform(beam.draw_key, counter);
  // No cell is seen more often than the nearest one: exp(-k) of them, k = T / E. Where E falls with
  // exp(-a r), the integral of exp(-k exp(a r)) is at most that of exp(-k (1 + a r)), exp(-k) /
  // (k a).
  const double k =
      limits.falls ? limit / mean(near_m)
                   : limit * nearest_m * nearest_m / strength * std::exp(limits.fall_pm * near_m);
  const double span_m = std::min(far_m - near_m, 1.0 / (k * limits.fall_pm));
  if (u < 1.0 - std::exp(-k) * span_m / beam.pulse_m) {
    return;
  }
  for (int i = 0; limits.falls && i < 8; ++i) {
    const double middle_m = 0.5 * (near_m + far_m);
    if (limit <= kRare * mean(middle_m)) {
      break;
    }
    far_m = middle_m;
  }
  const ClutterCount count(beam, near_m, far_m, mean);
  const int echoes = poisson_quantile(u, count.expected());
  for (int i = 0; i < echoes; ++i) {
    const std::uint64_t own = counter + 1 + 2 * static_cast<std::uint64_t>(i);
    const double range_m = count.quantile_m(counter_uniform(beam.draw_key, own));
    seen(range_m, limit - mean(range_m) * std::log(counter_uniform(beam.draw_key, own + 1)));
  }
}

}  // namespace rigwire::sim
