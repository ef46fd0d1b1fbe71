#include "sim/weather/dust_emitter.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kPound_kg = 0.45359237;
constexpr double kMile_m = 1609.344;
constexpr double kShortTon_kg = 2000.0 * kPound_kg;
constexpr double kLeastWake_m = 0.4;
constexpr double kMoisture_percent = 2.0;

}  // namespace

double road_dust_kgpm(double vehicle_kg) {
  // AP-42, 13.2.2, equation 1a: 4.9 (W / 3 short tons)^0.45 lb per mile at 12 % silt.
  return 4.9 * std::pow(std::max(vehicle_kg, 0.0) / (3.0 * kShortTon_kg), 0.45) * kPound_kg /
         kMile_m;
}

DustEmitter rolling_dust(double road_kgpm, const Eigen::Vector3d& contact_W, double width_m,
                         double load_share, double speed_mps) {
  DustEmitter emitter;
  emitter.position_W = contact_W;
  emitter.radius_m = std::max(kLeastWake_m, 0.5 * width_m);
  if (load_share > 0.0) {
    emitter.mass_rate_kgps = road_kgpm * load_share * std::abs(speed_mps);
  }
  return emitter;
}

double dropped_soil_dust_kgpm3(double drop_height_m) {
  // AP-42, table 11.9-2, dragline: 0.0046 d^1.1 / M^0.3 kg per m3.
  return 0.0046 * std::pow(std::max(drop_height_m, 0.0), 1.1) / std::pow(kMoisture_percent, 0.3);
}

}  // namespace rigwire::sim
