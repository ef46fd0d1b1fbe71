#include "sim/gnss/constellation.h"

#include <cmath>
#include <numbers>

namespace rigwire::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSemiMajorAxis_m = 26'559.7e3;
constexpr double kInclination = 55.0 * kDegree;
constexpr double kGravity_m3ps2 = 3.986005e14;
// 18 h 36 m 14.4 s of right ascension.
constexpr double kGreenwichAtEpoch = (18.0 + 36.0 / 60.0 + 14.4 / 3600.0) * 15.0 * kDegree;
// 1993-07-01 00:00:00 UTC in GPS time: week 703, Thursday, GPS 9 s ahead of UTC.
constexpr std::int64_t kEpochWeek = 703;
constexpr std::int64_t kEpochOfWeek_ns = (4LL * 86'400 + 9) * 1'000'000'000;
constexpr std::int64_t kWeek_ns = 604'800LL * 1'000'000'000;

constexpr std::array kNode_deg{272.847, 332.847, 32.847, 92.847, 152.847, 212.847};
constexpr std::array<double, kGpsSlots> kArgumentOfLatitude_deg{
    268.126, 161.786, 11.676,  41.806,   // A
    80.956,  173.336, 309.976, 204.376,  // B
    111.876, 11.796,  339.666, 241.556,  // C
    135.226, 265.446, 35.156,  167.356,  // D
    197.046, 302.596, 66.066,  333.686,  // E
    238.886, 345.226, 105.206, 135.346,  // F
};

double seconds_since_epoch(const GpsTime& time) {
  return static_cast<double>((time.week - kEpochWeek) * kWeek_ns + time.time_of_week_ns -
                             kEpochOfWeek_ns) *
         1e-9;
}

}  // namespace

Eigen::Vector3d gps_satellite_ecef(std::size_t slot, const GpsTime& time) {
  static const double kMeanMotion =
      std::sqrt(kGravity_m3ps2 / (kSemiMajorAxis_m * kSemiMajorAxis_m * kSemiMajorAxis_m));
  const double t = seconds_since_epoch(time);
  const double argument =
      kArgumentOfLatitude_deg[slot] * kDegree + std::fmod(kMeanMotion * t, 2.0 * std::numbers::pi);
  const double node = kNode_deg[slot / 4] * kDegree - kGreenwichAtEpoch -
                      std::fmod(kEarthRate_radps * t, 2.0 * std::numbers::pi);
  const double x = kSemiMajorAxis_m * std::cos(argument);
  const double y = kSemiMajorAxis_m * std::sin(argument);
  const double y_equator = y * std::cos(kInclination);
  return {x * std::cos(node) - y_equator * std::sin(node),
          x * std::sin(node) + y_equator * std::cos(node), y * std::sin(kInclination)};
}

std::array<Eigen::Vector3d, kGpsSlots> gps_constellation_ecef(const GpsTime& time) {
  std::array<Eigen::Vector3d, kGpsSlots> positions;
  for (std::size_t slot = 0; slot < kGpsSlots; ++slot) {
    positions[slot] = gps_satellite_ecef(slot, time);
  }
  return positions;
}

}  // namespace rigwire::sim
