#include "emulators/j1939/position_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigwire::emulators {
namespace {

constexpr double kSlowest_mps = 0.1;

}  // namespace

void PositionReport::take(const GnssSample& sample) {
  const bool fix = sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d;
  const double bearing_before_rad = direction.bearing_rad;
  *this = {};
  quality.satellites =
      static_cast<double>(std::ranges::count(sample.satellites, true, &SatelliteView::tracked));
  if (!fix) {
    return;
  }
  position = {sample.latitude_deg, sample.longitude_deg};
  const Vector3& v = sample.velocity_ned_mps;
  const double speed_mps = std::hypot(v.x, v.y);
  direction.speed_mps = speed_mps;
  direction.altitude_m = sample.ellipsoid_height_m - sample.geoid_separation_m;
  direction.bearing_rad = bearing_before_rad;
  if (speed_mps >= kSlowest_mps) {
    const double course_rad = std::atan2(v.y, v.x);
    direction.bearing_rad = course_rad < 0.0 ? course_rad + 2.0 * std::numbers::pi : course_rad;
  }
  quality.horizontal_dilution = sample.horizontal_dilution;
  quality.vertical_dilution = sample.vertical_dilution;
  quality.position_dilution = sample.position_dilution;
  quality.time_dilution = sample.time_dilution;
}

}  // namespace rigwire::emulators
