// Rain and snow as a laser beam sees them: many drops that weaken it, and now and then one that is
// near and large enough to return an echo.
//
// Drops follow an exponential spectrum N(D) = N0 exp(-Lambda D), number per volume and diameter:
//   rain  N0 = 8000 per m3 mm, Lambda = 4.1 R^-0.21 per mm       (J. S. Marshall, W. M. Palmer,
//         "The distribution of raindrops with size", J. Meteorology 5, 1948)
//   snow  N0 = 3800 R^-0.87 per m3 mm, Lambda = 2.55 R^-0.48 per mm, melted diameters   (K. L. S.
//         Gunn, J. S. Marshall, "The distribution with size of aggregate snowflakes", J.
//         Meteorology 15, 1958)
// with R in mm/h of water. The optics are those of V. Kilic et al., "Lidar Light Scattering
// Augmentation (LISA)", arXiv 2107.07004, 2021:
//   extinction  alpha = (pi / 4) integral over D > D0 of Q_ext D^2 N(D) dD, in closed form;
//   echo        rho_d exp(-2 tau) min((D / D_b)^2, 1) / r^2 of a drop at range r, where D_b = r
//               Theta is the beam's diameter and rho_d = |(n - 1) / (n + 1)|^2.
// LISA draws every drop in the beam's cone, thousands for each shot, to keep the brightest. Here
// only those are drawn that can be detected: drops are a Poisson process in range and diameter, and
// its part above a limit of energy has a closed form (an incomplete Maxwell integral), so that most
// shots cost one comparison. The distribution is LISA's, but that the number of drops in a cone is
// Poisson instead of fixed. Attenuation is applied by thinning, which is exact.
//
// Limits. Q_ext is one number (Mie: 2.06 at 0.05 mm, 2.00 at 1 mm). Flakes are wider than the drops
// that they melt to: transmissometers read 2.5e-3 R per metre (Warner and Gunn 1969), the spectrum
// with Q_ext = 2 gives 7e-4 R^0.57. A beam has no width at its exit, so that near the sensor the
// echoes are too bright.
#pragma once

#include <cstdint>

#include "sim/weather/weather.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::sim {

/// N(D) = intercept exp(-slope D) for D above `smallest_m`, in SI units.
struct DropSpectrum {
  double intercept_pm4 = 0.0;  ///< Per m3 and m of diameter; 0: no drops.
  double slope_pm = 1.0;
  double smallest_m = 5e-5;
};

[[nodiscard]] DropSpectrum rain_spectrum(const RainParameters& parameters, double rain_mmph);
[[nodiscard]] DropSpectrum snow_spectrum(const SnowParameters& parameters, double snow_mmph);

/// Returns the extinction of a spectrum, per metre.
[[nodiscard]] double spectrum_extinction_pm(const DropSpectrum& spectrum,
                                            double extinction_efficiency);

/// Goodin et al., "Predicting the influence of rain on lidar in ADAS", Electronics 8(1):89, 2019.
[[nodiscard]] double goodin_extinction_pm(double rain_mmph);

/// |(n - 1) / (n + 1)|^2.
[[nodiscard]] double drop_reflectance(double refractive_index);

/// The drops of one spectrum that a beam may see.
class DropEchoes {
 public:
  DropEchoes() = default;  ///< None.
  DropEchoes(const DropSpectrum& spectrum, double reflectance, double nearest_m)
      : spectrum_(spectrum), reflectance_(reflectance), nearest_m_(nearest_m) {}

  [[nodiscard]] bool none() const { return spectrum_.intercept_pm4 <= 0.0; }

  /// Returns the expected number of drops in the beam whose echo, not attenuated, has at least that
  /// energy.
  [[nodiscard]] double expected(const WeatherBeam& beam, double energy) const;

  /// Calls seen(range_m, energy) for every drop of this shot whose echo, not attenuated, is
  /// detected; of more than some thirty only the brighter ones. Numbers are drawn from the beam's
  /// key with counters from `counter` on.
  template <class Seen>
  void draw(const WeatherBeam& beam, std::uint64_t counter, const Seen& seen) const;

 private:
  /// The part of the cone in which the drops that matter lie.
  struct Cone {
    double nearest_m = 0.0;
    double knee_m = 0.0;  ///< Up to here every drop of the spectrum is bright enough.
    double farthest_m = 0.0;
    double fall_pm2 = 0.0;  ///< k: beyond, the number falls with exp(-k r^2).
    double to_knee = 0.0;   ///< Integral of r^2 up to the knee.
    double beyond = 0.0;    ///< Integral of r^2 exp(-k r^2) from there on.
    double knee_density = 0.0;
    double density = 0.0;  ///< Expected drops: knee_density to_knee + density beyond.

    [[nodiscard]] double drops() const { return knee_density * to_knee + density * beyond; }
  };
  struct Drop {
    double range_m;
    double energy;
  };

  [[nodiscard]] Cone cone(const WeatherBeam& beam, double energy) const;
  [[nodiscard]] Drop drop(const WeatherBeam& beam, const Cone& cone, double energy,
                          std::uint64_t counter) const;
  /// Returns how many drops this shot hits; lowers their number by raising `energy` when there are
  /// too many.
  [[nodiscard]] int count(const WeatherBeam& beam, std::uint64_t counter, Cone& cone,
                          double& energy) const;

  DropSpectrum spectrum_;
  double reflectance_ = 0.0;
  double nearest_m_ = 0.0;
};

template <class Seen>
void DropEchoes::draw(const WeatherBeam& beam, std::uint64_t counter, const Seen& seen) const {
  double energy = beam.detection_energy;
  Cone cone;
  const int drops = count(beam, counter, cone, energy);
  for (int i = 0; i < drops; ++i) {
    const Drop one = drop(beam, cone, energy, counter + 1 + 2 * static_cast<std::uint64_t>(i));
    seen(one.range_m, one.energy);
  }
}

}  // namespace rigwire::sim
