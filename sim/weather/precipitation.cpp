#include "sim/weather/precipitation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/lidar/counter_noise.h"

namespace rigwire::sim {
namespace {

constexpr double kPerMillimetre = 1e3;
/// Expected drops of one shot above which the faint ones are left out.
constexpr double kManyDrops = 32.0;
constexpr double kBrighter = 2.0;

double cubed(double x) {
  return x * x * x;
}

/// Integral of r^2 exp(-k r^2) from 0 to r.
double maxwell_integral(double k, double r_m) {
  const double x = k * r_m * r_m;
  if (x < 1e-3) {  // the closed form loses its digits
    return cubed(r_m) * (1.0 / 3.0 - x / 5.0 + x * x / 14.0);
  }
  const double root = std::sqrt(k);
  return (0.5 * std::sqrt(std::numbers::pi) * std::erf(root * r_m) / root - r_m * std::exp(-x)) /
         (2.0 * k);
}

}  // namespace

DropSpectrum rain_spectrum(const RainParameters& parameters, double rain_mmph) {
  if (rain_mmph <= 0.0) {
    return {};
  }
  // Marshall and Palmer 1948.
  return {8000.0 * kPerMillimetre, 4.1 * std::pow(rain_mmph, -0.21) * kPerMillimetre,
          parameters.smallest_drop_m};
}

DropSpectrum snow_spectrum(const SnowParameters& parameters, double snow_mmph) {
  if (snow_mmph <= 0.0) {
    return {};
  }
  // Gunn and Marshall 1958.
  return {parameters.intercept * std::pow(snow_mmph, -0.87) * kPerMillimetre,
          2.55 * std::pow(snow_mmph, -0.48) * kPerMillimetre, parameters.smallest_flake_m};
}

double spectrum_extinction_pm(const DropSpectrum& spectrum, double extinction_efficiency) {
  // Integral of D^2 N(D) above D0: N0 exp(-x) (2 + 2 x + x^2) / Lambda^3, x = Lambda D0.
  const double x = spectrum.slope_pm * spectrum.smallest_m;
  const double second_moment =
      spectrum.intercept_pm4 * std::exp(-x) * (2.0 + 2.0 * x + x * x) / cubed(spectrum.slope_pm);
  return 0.25 * std::numbers::pi * extinction_efficiency * second_moment;
}

double goodin_extinction_pm(double rain_mmph) {
  // Goodin et al. 2019: 0.01 R^0.6.
  return rain_mmph > 0.0 ? 0.01 * std::pow(rain_mmph, 0.6) : 0.0;
}

double drop_reflectance(double refractive_index) {
  // Fresnel at normal incidence.
  const double amplitude = (refractive_index - 1.0) / (refractive_index + 1.0);
  return amplitude * amplitude;
}

DropEchoes::Cone DropEchoes::cone(const WeatherBeam& beam, double energy) const {
  Cone cone;
  cone.nearest_m = std::max(beam.near_m, nearest_m_);
  // Even a drop as wide as the beam is too faint beyond sqrt(rho_d / energy).
  cone.farthest_m = std::min(beam.far_m, std::sqrt(reflectance_ / energy));
  if (cone.farthest_m <= cone.nearest_m || beam.divergence_rad <= 0.0) {
    return cone;
  }
  // The smallest drop bright enough at range r is a r^2 wide.
  const double a_pm = beam.divergence_rad * std::sqrt(energy / reflectance_);
  cone.fall_pm2 = spectrum_.slope_pm * a_pm;
  cone.knee_m = std::clamp(std::sqrt(spectrum_.smallest_m / a_pm), cone.nearest_m, cone.farthest_m);
  // Up to the knee every drop is bright enough: volume; beyond it the share exp(-Lambda a r^2).
  cone.to_knee = (cubed(cone.knee_m) - cubed(cone.nearest_m)) / 3.0;
  cone.beyond = maxwell_integral(cone.fall_pm2, cone.farthest_m) -
                maxwell_integral(cone.fall_pm2, cone.knee_m);
  const double cross_section = 0.25 * std::numbers::pi * beam.divergence_rad * beam.divergence_rad;
  cone.density = cross_section * spectrum_.intercept_pm4 / spectrum_.slope_pm;
  cone.knee_density = cone.density * std::exp(-spectrum_.slope_pm * spectrum_.smallest_m);
  return cone;
}

double DropEchoes::expected(const WeatherBeam& beam, double energy) const {
  return none() ? 0.0 : cone(beam, energy).drops();
}

int DropEchoes::count(const WeatherBeam& beam, std::uint64_t counter, Cone& cone,
                      double& energy) const {
  if (none()) {
    return 0;
  }
  const double u = counter_uniform(beam.draw_key, counter);
  // All of the cone, from its tip to where nothing is left, holds no more than sqrt(pi) / 4 k^-3/2.
  const double k = spectrum_.slope_pm * beam.divergence_rad * std::sqrt(energy / reflectance_);
  const double most = 0.25 * std::numbers::pi * beam.divergence_rad * beam.divergence_rad *
                      spectrum_.intercept_pm4 / spectrum_.slope_pm * 0.4432 / (k * std::sqrt(k));
  if (u < 1.0 - most) {
    return 0;
  }
  cone = this->cone(beam, energy);
  while (cone.drops() > kManyDrops) {
    energy *= kBrighter;
    cone = this->cone(beam, energy);
  }
  const double expected = cone.drops();
  // Poisson's distribution inverted term by term.
  double probability = std::exp(-expected);
  int drops = 0;
  for (double sum = probability; u > sum && probability > 1e-18; sum += probability) {
    ++drops;
    probability *= expected / drops;
  }
  return drops;
}

DropEchoes::Drop DropEchoes::drop(const WeatherBeam& beam, const Cone& cone, double energy,
                                  std::uint64_t counter) const {
  double share = counter_uniform(beam.draw_key, counter) * cone.drops();
  double range_m = 0.0;
  // Range by inverting the cumulative number: a cube root before the knee, bisection beyond it.
  if (share < cone.knee_density * cone.to_knee) {
    range_m = std::cbrt(cubed(cone.nearest_m) + 3.0 * share / cone.knee_density);
  } else {
    share = (share - cone.knee_density * cone.to_knee) / cone.density +
            maxwell_integral(cone.fall_pm2, cone.knee_m);
    double low_m = cone.knee_m;
    double high_m = cone.farthest_m;
    for (int i = 0; i < 40; ++i) {
      const double middle_m = 0.5 * (low_m + high_m);
      (maxwell_integral(cone.fall_pm2, middle_m) < share ? low_m : high_m) = middle_m;
    }
    range_m = 0.5 * (low_m + high_m);
  }
  const double beam_m = range_m * beam.divergence_rad;
  const double bright_m = beam_m * range_m * std::sqrt(energy / reflectance_);
  // Beyond a diameter the rest of the spectrum is exponential again.
  const double diameter_m =
      std::max(bright_m, spectrum_.smallest_m) -
      std::log(counter_uniform(beam.draw_key, counter + 1)) / spectrum_.slope_pm;
  // LISA: rho_d min((D / D_b)^2, 1) / r^2.
  const double filled = std::min(diameter_m * diameter_m / (beam_m * beam_m), 1.0);
  return {range_m, reflectance_ * filled / (range_m * range_m)};
}

}  // namespace rigwire::sim
