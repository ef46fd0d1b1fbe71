#include "sim/weather/droplets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigwire::sim {
namespace {

constexpr double kGreatestExtinction_pm = 1.0;
constexpr double kShortestPulse_m = 0.15;
constexpr double kLongestPulse_m = 3.0;
constexpr int kFineSteps = 192;
constexpr int kCoarseSteps = 24;
constexpr int kMiddleSteps = 96;
constexpr double kRangeStep_m = 0.1;
constexpr double kGoldenSection = 0.6180339887498949;

/// Node coordinates, in which the table is smooth.
double extinction_place(double extinction_pm, std::size_t nodes) {
  return std::sqrt(std::clamp(extinction_pm / kGreatestExtinction_pm, 0.0, 1.0)) *
         static_cast<double>(nodes - 1);
}
double pulse_place(double pulse_m, std::size_t nodes) {
  const double clamped_m = std::clamp(pulse_m, kShortestPulse_m, kLongestPulse_m);
  return std::log(clamped_m / kShortestPulse_m) / std::log(kLongestPulse_m / kShortestPulse_m) *
         static_cast<double>(nodes - 1);
}

}  // namespace

DropletOptics fog_optics(const FogParameters& parameters, double inverse_mor_pm) {
  // Rasshofer et al. 2011: alpha = ln 20 / MOR, beta in proportion to 1 / MOR.
  return {std::log(20.0) * inverse_mor_pm, parameters.backscatter * inverse_mor_pm};
}

DropletOptics haze_optics(const HazeParameters& parameters, double inverse_visibility_pm) {
  if (inverse_visibility_pm <= 0.0) {
    return {};
  }
  const double visibility_km = 1e-3 / inverse_visibility_pm;
  // Kruse et al. 1962: alpha = (3.912 / V) (wavelength / 550 nm)^-q.
  const double exponent =
      visibility_km > 50.0 ? 1.6 : (visibility_km > 6.0 ? 1.3 : 0.585 * std::cbrt(visibility_km));
  const double extinction_pm =
      3.912 * inverse_visibility_pm * std::pow(parameters.wavelength_m / 550e-9, -exponent);
  return {extinction_pm, extinction_pm / parameters.lidar_ratio_sr};
}

double fog_density(const FogParameters& parameters, double z_m) {
  if (parameters.scale_height_m <= 0.0 || z_m <= parameters.base_height_m) {
    return 1.0;
  }
  return std::exp(-(z_m - parameters.base_height_m) / parameters.scale_height_m);
}

double fog_path_m(const FogParameters& parameters, double z0_m, double climb, double length_m) {
  if (parameters.scale_height_m <= 0.0) {
    return length_m;
  }
  const double low_m = std::min(z0_m, z0_m + climb * length_m) - parameters.base_height_m;
  const double high_m = std::max(z0_m, z0_m + climb * length_m) - parameters.base_height_m;
  const double slope = std::abs(climb);
  if (high_m <= 0.0) {
    return length_m;
  }
  const double scale_m = parameters.scale_height_m;
  // Full below the base; above it the integral of exp(-z / H): (1 - exp(-f)) / f of the rest.
  const double below_m = low_m < 0.0 ? std::min(-low_m / slope, length_m) : 0.0;
  const double above_m = length_m - below_m;
  const double start = std::exp(-std::max(low_m, 0.0) / scale_m);
  const double fall = slope * above_m / scale_m;
  return below_m + start * above_m * (fall > 1e-9 ? -std::expm1(-fall) / fall : 1.0);
}

SoftEchoTable::SoftEchoTable(double overlap_start_m, double overlap_end_m)
    : overlap_start_m_(overlap_start_m), overlap_end_m_(overlap_end_m) {
  nodes_.reserve(kExtinctions * kPulses);
  for (std::size_t i = 0; i < kExtinctions; ++i) {
    const double share = static_cast<double>(i) / (kExtinctions - 1);
    for (std::size_t j = 0; j < kPulses; ++j) {
      const double pulse_m = kShortestPulse_m * std::pow(kLongestPulse_m / kShortestPulse_m,
                                                         static_cast<double>(j) / (kPulses - 1));
      const SoftEcho peak = search(kGreatestExtinction_pm * share * share, pulse_m, 0.0, 1e9);
      nodes_.push_back({peak.range_m, std::log(peak.energy)});
    }
  }
}

double SoftEchoTable::energy_at(double range_m, double extinction_pm, double pulse_m, double far_m,
                                int steps) const {
  // The pulse and its slope vanish at both ends, which makes equal steps exact to high order.
  const double step_m = 2.0 * pulse_m / steps;
  const double thinner = std::exp(-2.0 * extinction_pm * step_m);
  double s_m = range_m - pulse_m;
  double transmission = std::exp(-2.0 * extinction_pm * s_m);
  // cos^2 by turning a pair of numbers.
  const double cos_step = std::cos(2.0 * std::numbers::pi / steps);
  const double sin_step = std::sin(2.0 * std::numbers::pi / steps);
  double cos_phase = -1.0;
  double sin_phase = 0.0;
  double sum = 0.0;
  for (int i = 1; i < steps; ++i) {
    s_m += step_m;
    transmission *= thinner;
    const double turned = cos_phase * cos_step - sin_phase * sin_step;
    sin_phase = sin_phase * cos_step + cos_phase * sin_step;
    cos_phase = turned;
    if (s_m > far_m) {
      break;
    }
    if (s_m > overlap_start_m_) {
      const double overlap =
          std::min((s_m - overlap_start_m_) / (overlap_end_m_ - overlap_start_m_), 1.0);
      // Hahner et al. 2021: cos^2(pi u / 2 L) exp(-2 alpha s) xi(s) / s^2.
      sum += 0.5 * (1.0 + cos_phase) * transmission * overlap / (s_m * s_m);
    }
  }
  return std::numbers::pi * sum * step_m;
}

SoftEcho SoftEchoTable::search(double extinction_pm, double pulse_m, double near_m,
                               double far_m) const {
  const auto energy = [&](double range_m) {
    return energy_at(range_m, extinction_pm, pulse_m, far_m, kFineSteps);
  };
  const double first_m = std::max(near_m, overlap_start_m_ - pulse_m);
  const double last_m = std::max(first_m, std::min(far_m, overlap_end_m_ + pulse_m));
  double best_m = first_m;
  double best = energy(first_m);
  for (double range_m = first_m + kRangeStep_m; range_m <= last_m; range_m += kRangeStep_m) {
    if (const double here = energy(range_m); here > best) {
      best = here;
      best_m = range_m;
    }
  }
  // Golden section about the best of the coarse steps.
  double low_m = std::max(first_m, best_m - kRangeStep_m);
  double high_m = std::min(last_m, best_m + kRangeStep_m);
  for (int i = 0; i < 14; ++i) {
    const double left_m = high_m - kGoldenSection * (high_m - low_m);
    const double right_m = low_m + kGoldenSection * (high_m - low_m);
    if (energy(left_m) > energy(right_m)) {
      high_m = right_m;
    } else {
      low_m = left_m;
    }
  }
  const double range_m = 0.5 * (low_m + high_m);
  return {range_m, energy(range_m)};
}

SoftEcho SoftEchoTable::look_up(double extinction_pm, double pulse_m) const {
  const double x = extinction_place(extinction_pm, kExtinctions);
  const double y = pulse_place(pulse_m, kPulses);
  const auto i = std::min(static_cast<std::size_t>(x), kExtinctions - 2);
  const auto j = std::min(static_cast<std::size_t>(y), kPulses - 2);
  // Bilinear in range and in the energy's logarithm.
  const double u = x - static_cast<double>(i);
  const double v = y - static_cast<double>(j);
  const auto blend = [&](double Node::*member) {
    return (1.0 - u) * ((1.0 - v) * node(i, j).*member + v * node(i, j + 1).*member) +
           u * ((1.0 - v) * node(i + 1, j).*member + v * node(i + 1, j + 1).*member);
  };
  return {blend(&Node::range_m), std::exp(blend(&Node::log_energy))};
}

SoftEcho SoftEchoTable::strongest(double extinction_pm, double pulse_m, double near_m,
                                  double far_m) const {
  const SoftEcho peak = look_up(extinction_pm, pulse_m);
  if (far_m < std::max(peak.range_m, near_m) + pulse_m) {
    return search(extinction_pm, pulse_m, near_m, far_m);  // the surface cuts the pulse short
  }
  if (near_m <= peak.range_m) {
    return peak;
  }
  const bool clear_of_overlap = near_m - pulse_m > overlap_end_m_ + 0.2 * pulse_m;
  return {near_m, energy_at(near_m, extinction_pm, pulse_m, far_m,
                            clear_of_overlap ? kCoarseSteps : kMiddleSteps)};
}

}  // namespace rigwire::sim
