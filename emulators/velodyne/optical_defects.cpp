#include "emulators/velodyne/optical_defects.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace rigwire::emulators {
namespace {

constexpr double kWhite = 0.9;

void remove(LidarFiring& bank, std::size_t i) {
  bank.strongest[i] = {};
  bank.last[i] = {};
  bank.second[i] = {};
}

void kill_lasers(const DeadLaserFault& fault, std::size_t lasers, LidarFiring& bank) {
  for (std::size_t i = 0; i < lasers; ++i) {
    const auto laser = static_cast<int>(bank.first_laser + i);
    if (laser >= fault.first && laser <= fault.last) {
      remove(bank, i);
    }
  }
}

void dim(LidarReturn& echo, double transmission, double reference_range_m) {
  // Light passes the dirt twice; an echo is found while rho T^2 R^2 >= 0.9 r^2 (link_budget.h).
  const double passed = transmission * transmission;
  const double range_m = echo.range_m;
  const double found = echo.reflectivity * passed * reference_range_m * reference_range_m;
  if (!(found >= kWhite * range_m * range_m) || range_m == 0.0) {
    echo = {};
    return;
  }
  const double reported = echo.reflectivity <= 1.0F ? echo.reflectivity * passed
                                                    : 1.0 + (echo.reflectivity - 1.0) * passed;
  echo.reflectivity = static_cast<float>(reported);
}

void dim_sector(const DirtyWindowFault& fault, const LidarPattern& pattern,
                double reference_range_m, std::size_t lasers, LidarFiring& bank) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const double width_deg = std::fmod(fault.to_deg - fault.from_deg + 720.0, 360.0);
  const bool all_round = width_deg == 0.0;
  for (std::size_t i = 0; i < lasers; ++i) {
    const LaserGeometry& laser = pattern.lasers[bank.first_laser + i];
    const double azimuth_rad = bank.rotor_azimuth_rad + laser.azimuth_offset_rad +
                               bank.rotor_rate_radps * to_seconds(laser.time_offset);
    const double after_start_deg =
        std::fmod(azimuth_rad * kDegrees - fault.from_deg + 1080.0, 360.0);
    if (all_round || after_start_deg < width_deg) {
      dim(bank.strongest[i], fault.transmission, reference_range_m);
      dim(bank.last[i], fault.transmission, reference_range_m);
      dim(bank.second[i], fault.transmission, reference_range_m);
    }
  }
}

}  // namespace

void apply_optical_defects(const VelodyneFaults& faults, const LidarPattern& pattern,
                           double reference_range_m, LidarFiring& bank) {
  const std::size_t lasers = std::min(kBankLasers, pattern.lasers.size() - bank.first_laser);
  faults.each(bank.time, [&](const VelodyneFault& fault) {
    if (const auto* dead = std::get_if<DeadLaserFault>(&fault.what)) {
      kill_lasers(*dead, lasers, bank);
    } else if (const auto* dirt = std::get_if<DirtyWindowFault>(&fault.what)) {
      dim_sector(*dirt, pattern, reference_range_m, lasers, bank);
    }
  });
}

}  // namespace rigwire::emulators
