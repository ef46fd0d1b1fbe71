#include "sim/lidar/velodyne_heads.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/constants.h"

namespace rigwire::sim {
namespace {

constexpr double kRpm = 2.0 * std::numbers::pi / 60.0;

/// Spread of the five units' mean speeds, and how slowly one unit's changes.
constexpr double kWander_rpm = 0.45;
constexpr double kWanderCorrelation_s = 16.0;

// Measured in the only available HDL-32E scan with its surroundings; used for all models.
constexpr double kNoiseOnset = 3.0;  ///< link_budget.h, noise_growth().
constexpr double kReflectivitySigma = 0.045;
constexpr double kLaserReflectivitySigma = 0.10;

struct Figures {
  std::string_view model;
  double noise_mm;
  double bias_mm;
  double reference_range_m;
  double air_reference_range_m;  ///< Range of the data sheet,
  double air_minimum_range_m;    ///< and its nearest one.
  double air_focus_range_m;      ///< Width of the lens over the angle of a detector.
  double encoder_deg;
  double ripple_rpm;
};

constexpr std::array kFigures{
    Figures{"HDL-32E", 5.3, 7.9, 150.0, 100.0, 1.0, 8.0, 0.0030, 0.3},
    Figures{"VLP-16", 5.8, 7.1, 150.0, 100.0, 0.5, 11.6, 0.0053, 0.85},
    Figures{"Puck Hi-Res", 5.8, 7.1, 150.0, 100.0, 0.5, 11.6, 0.0053, 0.85},
    Figures{"VLP-32C", 4.8, 6.2, 300.0, 200.0, 1.0, 11.8, 0.0051, 0.7},
    Figures{"HDL-64E S2", 5.3, 7.9, 150.0, 120.0, 2.0, 11.8, 0.0030, 0.3},
    Figures{"HDL-64E S3", 5.3, 7.9, 150.0, 120.0, 2.0, 11.8, 0.0030, 0.3},
    Figures{"VLS-128", 10.0, 7.4, 660.0, 245.0, 1.0, 11.8, 0.0008, 0.6},
};

}  // namespace

SpinningHead velodyne_head(std::string_view model) {
  const auto* found = std::ranges::find(kFigures, model, &Figures::model);
  if (found == kFigures.end()) {
    throw std::invalid_argument("no figures are known of the lidar '" + std::string(model) + "'");
  }
  SpinningHead head;
  head.receiver.range_sigma_m = 1e-3 * found->noise_mm;
  head.receiver.range_noise = RangeNoise::jitter;
  head.receiver.noise_onset = kNoiseOnset;
  head.receiver.reflectivity_sigma = kReflectivitySigma;
  head.receiver.laser_reflectivity_sigma = kLaserReflectivitySigma;
  head.receiver.laser_bias_sigma_m = 1e-3 * found->bias_mm;
  head.receiver.reference_range_m = found->reference_range_m;
  head.receiver.air_reference_range_m = found->air_reference_range_m;
  head.receiver.air_minimum_range_m = found->air_minimum_range_m;
  head.receiver.air_focus_range_m = found->air_focus_range_m;
  head.rotor.wander_radps = kWander_rpm * kRpm;
  head.rotor.wander_correlation_s = kWanderCorrelation_s;
  head.rotor.ripple_radps = found->ripple_rpm * kRpm;
  head.rotor.encoder_noise_rad = found->encoder_deg * kDegree;
  return head;
}

}  // namespace rigwire::sim
