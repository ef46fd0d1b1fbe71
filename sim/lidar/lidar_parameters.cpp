#include "sim/lidar/lidar_parameters.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

struct Bound {
  const char* name;
  double value;
  double least;
  double most;
  const char* allowed;
};

}  // namespace

void validate(const SpinningLidarParameters& p) {
  const auto refuse = [](const char* name, const std::string& found, const char* allowed) {
    throw std::invalid_argument("spinning lidar: " + std::string(name) + " is " + found +
                                ", allowed: " + allowed);
  };
  const std::array bounds{Bound{"range_sigma_m", p.range_sigma_m, 0.0, 1.0, "0 to 1"},
                          Bound{"housing_radius_m", p.housing_radius_m, 0.0, 1.0, "0 to 1"},
                          Bound{"range_resolution_m", p.range_resolution_m, 0.0, 1.0, "0 to 1"},
                          Bound{"laser_bias_sigma_m", p.laser_bias_sigma_m, 0.0, 1.0, "0 to 1"},
                          Bound{"reference_range_m", p.reference_range_m, 0.0, 1000.0, "0 to 1000"},
                          Bound{"echo_separation_m", p.echo_separation_m, 0.0, 100.0, "0 to 100"},
                          Bound{"drop_rate", p.drop_rate, 0.0, 1.0, "0 to 1"},
                          Bound{"drop_limit", p.drop_limit, 0.0, 2.0, "0 to 2"},
                          Bound{"drop_at_zero", p.drop_at_zero, 0.0, 1.0, "0 to 1"},
                          Bound{"blooming_share", p.blooming_share, 0.0, 0.1, "0 to 0.1"},
                          Bound{"blooming_angle_rad", p.blooming_angle_rad, 0.0, 0.1, "0 to 0.1"}};
  for (const Bound& bound : bounds) {
    if (!(bound.value >= bound.least && bound.value <= bound.most)) {
      refuse(bound.name, std::to_string(bound.value), bound.allowed);
    }
  }
  if (p.threads < 1 || p.threads > 64) {
    refuse("threads", std::to_string(p.threads), "1 to 64");
  }
  constexpr std::array kSubRays{1, 5, 19, 1000};
  if (std::ranges::find(kSubRays, p.sub_rays) == kSubRays.end()) {
    refuse("sub_rays", std::to_string(p.sub_rays), "1, 5, 19 or 1000");
  }
  if (p.range_noise != RangeNoise::constant && p.range_noise != RangeNoise::signal) {
    refuse("range_noise", std::to_string(static_cast<int>(p.range_noise)), "constant or signal");
  }
}

}  // namespace rigwire::sim
