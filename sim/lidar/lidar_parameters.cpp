#include "sim/lidar/lidar_parameters.h"

#include <stdexcept>
#include <string>

namespace rigwire::sim {

void validate(const SpinningLidarParameters& parameters) {
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("spinning lidar: " + what);
  };
  if (!(parameters.range_sigma_m >= 0.0 && parameters.range_sigma_m <= 1.0)) {
    refuse("range_sigma_m is " + std::to_string(parameters.range_sigma_m) + ", allowed: 0 to 1");
  }
  if (!(parameters.housing_radius_m >= 0.0 && parameters.housing_radius_m <= 1.0)) {
    refuse("housing_radius_m is " + std::to_string(parameters.housing_radius_m) +
           ", allowed: 0 to 1");
  }
  if (parameters.threads < 1 || parameters.threads > 64) {
    refuse("threads is " + std::to_string(parameters.threads) + ", allowed: 1 to 64");
  }
}

}  // namespace rigwire::sim
