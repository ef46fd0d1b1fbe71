#include "bench/weather_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace rigwire::bench {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLargestDrop_mm = 15.0;

/// Sum of f over the middles of equal parts, times their width.
template <class Function>
double integral(double from, double to, int parts, const Function& f) {
  const double width = (to - from) / parts;
  double sum = 0.0;
  for (int i = 0; i < parts; ++i) {
    sum += f(from + (i + 0.5) * width);
  }
  return sum * width;
}

double marshall_palmer_pm3mm(double rain_mmph, double diameter_mm) {
  return 8000.0 * std::exp(-4.1 * std::pow(rain_mmph, -0.21) * diameter_mm);
}

double dust_pm(const sim::WeatherParameters& parameters, std::span<const sim::DustPuff> puffs,
               const Eigen::Vector3d& point_W) {
  double sum = 0.0;
  for (const sim::DustPuff& puff : puffs) {
    const double above =
        0.5 *
        (1.0 + std::erf((puff.centre_W.z() - puff.ground_z_m) / std::sqrt(2.0 * puff.variance_m2)));
    sum += puff.mass_kg / above / std::pow(2.0 * kPi * puff.variance_m2, 1.5) *
           std::exp(-(point_W - puff.centre_W).squaredNorm() / (2.0 * puff.variance_m2));
  }
  return parameters.dust.mass_extinction_m2pkg * sum;
}

double even_pm(const sim::WeatherParameters& parameters) {
  const sim::WeatherFrame& air = parameters.course.front();
  double sum = 0.0;
  if (air.rain_mmph > 0.0) {
    sum += parameters.rain.model == sim::RainModel::goodin
               ? 0.01 * std::pow(air.rain_mmph, 0.6)
               : integrated_rain_extinction_pm(air.rain_mmph, parameters.rain);
  }
  return sum;
}

double reference_fog_density(const sim::FogParameters& fog, double z_m) {
  const double above_m = z_m - fog.base_height_m;
  return fog.scale_height_m > 0.0 && above_m > 0.0 ? std::exp(-above_m / fog.scale_height_m) : 1.0;
}

/// Light returned per metre of the beam, as an echogram to be averaged by the pulse.
struct Echogram {
  double step_m;
  std::vector<double> dust;

  [[nodiscard]] double averaged(const std::vector<double>& light, std::size_t at,
                                double pulse_m) const {
    const auto half = static_cast<std::ptrdiff_t>(pulse_m / step_m);
    double sum = 0.0;
    for (std::ptrdiff_t j = -half; j <= half; ++j) {
      const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(at) + j;
      if (i >= 0 && i < static_cast<std::ptrdiff_t>(light.size())) {
        const double cosine = std::cos(0.5 * kPi * static_cast<double>(j) * step_m / pulse_m);
        sum += cosine * cosine * light[static_cast<std::size_t>(i)];
      }
    }
    return sum * step_m;
  }
};

}  // namespace

double integrated_rain_extinction_pm(double rain_mmph, const sim::RainParameters& rain) {
  return 1e-6 * kPi / 4.0 *
         integral(1e3 * rain.smallest_drop_m, kLargestDrop_mm, 20000, [&](double d_mm) {
           return rain.extinction_efficiency * d_mm * d_mm * marshall_palmer_pm3mm(rain_mmph, d_mm);
         });
}

double expected_drop_echoes(double rain_mmph, double extinction_pm, const sim::RainParameters& rain,
                            const sim::WeatherBeam& beam) {
  const double amplitude = (rain.refractive_index - 1.0) / (rain.refractive_index + 1.0);
  return integral(
      std::max(rain.nearest_echo_m, beam.near_m), std::min(beam.far_m, 20.0), 1000,
      [&](double r_m) {
        const double beam_m = r_m * beam.divergence_rad;
        const double filled =
            amplitude * amplitude * std::exp(-2.0 * extinction_pm * r_m) / (r_m * r_m);
        if (filled < beam.detection_energy) {
          return 0.0;
        }
        const double least_mm = std::max(1e3 * beam_m * std::sqrt(beam.detection_energy / filled),
                                         1e3 * rain.smallest_drop_m);
        return 0.25 * kPi * beam_m * beam_m *
               integral(least_mm, least_mm + kLargestDrop_mm, 1500,
                        [&](double d_mm) { return marshall_palmer_pm3mm(rain_mmph, d_mm); });
      });
}

ExpectedClutter expected_clutter(double visibility_m, const sim::FogParameters& fog,
                                 const sim::WeatherBeam& beam) {
  const double alpha_pm = std::log(20.0) / visibility_m;
  const auto mean_energy = [&](double r_m) {
    return kPi * fog.backscatter / visibility_m *
           integral(-beam.pulse_m, beam.pulse_m, 60, [&](double u_m) {
             const double s_m = r_m - u_m;
             const double cosine = std::cos(0.5 * kPi * u_m / beam.pulse_m);
             const double taken =
                 beam.focus_m > s_m ? s_m * s_m / (beam.focus_m * beam.focus_m) : 1;
             return cosine * cosine * std::exp(-2.0 * alpha_pm * s_m) * taken / (s_m * s_m);
           });
  };
  const auto above_limit_pm = [&](double r_m) {
    return std::exp(-beam.detection_energy / mean_energy(r_m)) / beam.pulse_m;
  };
  const double far_m = std::min(beam.far_m - beam.pulse_m, 60.0);
  const double echoes = integral(beam.near_m, far_m, 3000, above_limit_pm);
  return {echoes, integral(beam.near_m, far_m, 3000, [&](double r_m) {
                    return r_m * above_limit_pm(r_m);
                  }) / echoes};
}

MarchedBeam march_beam(const sim::WeatherParameters& parameters,
                       std::span<const sim::DustPuff> puffs, const sim::WeatherBeam& beam,
                       double step_m) {
  const sim::WeatherFrame& air = parameters.course.front();
  const double rain_pm = even_pm(parameters);
  const double fog_per_m = air.fog_visibility_m > 0.0 ? 1.0 / air.fog_visibility_m : 0.0;
  const auto steps = static_cast<std::size_t>(std::ceil(beam.far_m / step_m));
  Echogram echogram{beam.far_m / static_cast<double>(steps), {}};
  double tau = 0.0;
  for (std::size_t i = 0; i < steps; ++i) {
    const double s_m = (static_cast<double>(i) + 0.5) * echogram.step_m;
    const Eigen::Vector3d point_W = beam.start_W + s_m * beam.direction_W;
    const double density = reference_fog_density(parameters.fog, point_W.z());
    const double dust = puffs.empty() ? 0.0 : dust_pm(parameters, puffs, point_W);
    const double half =
        0.5 * echogram.step_m * (rain_pm + std::log(20.0) * fog_per_m * density + dust);
    tau += half;
    const double overlap = std::clamp((s_m - parameters.overlap_start_m) /
                                          (parameters.overlap_end_m - parameters.overlap_start_m),
                                      0.0, 1.0);
    const double light = kPi * std::exp(-2.0 * tau) * overlap / (s_m * s_m);
    echogram.dust.push_back(light * dust / parameters.dust.lidar_ratio_sr);
    tau += half;
  }
  MarchedBeam marched;
  marched.transmission = std::exp(-2.0 * tau);
  bool ended = puffs.empty();
  for (std::size_t i = 0; i < steps; ++i) {
    const double s_m = (static_cast<double>(i) + 0.5) * echogram.step_m;
    if (s_m < beam.near_m) {
      continue;
    }
    if (!ended) {
      const double energy = echogram.averaged(echogram.dust, i, beam.pulse_m);
      if (energy >= beam.detection_energy) {
        if (!marched.dust_echo) {
          marched.dust = {s_m, energy};
          marched.dust_echo = true;
        }
        marched.dust.energy = std::max(marched.dust.energy, energy);
      } else {
        ended = marched.dust_echo;
      }
    }
  }
  return marched;
}

}  // namespace rigwire::bench
