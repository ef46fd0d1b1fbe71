#include "protocols/velodyne/gpgga.h"

#include <algorithm>

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kHighest_m = 99999.9;
constexpr double kLargestSeparation_m = 999.9;
constexpr double kLargestDilution = 99.9;

double limited(double value, double limit) {
  return std::clamp(value, -limit, limit);
}

}  // namespace

GpggaText::GpggaText(const FixData& values) {
  text_.append("$GPGGA,");
  text_.append_time(values.hour, values.minute, values.second, values.tenth, values.time_form);
  const int satellites = std::clamp(values.satellites, 0, 99);
  if (values.valid) {
    text_.append_position(values.latitude_deg, values.longitude_deg);
    text_.append("%d,%02d,%.1f,%.1f,M,%.1f,M,,", std::clamp(values.quality, 1, 8), satellites,
                 std::clamp(values.horizontal_dilution, 0.0, kLargestDilution),
                 limited(values.altitude_m, kHighest_m),
                 limited(values.geoid_separation_m, kLargestSeparation_m));
  } else {
    text_.append(",,,,0,%02d,,,M,,M,,", satellites);
  }
  text_.finish();
}

}  // namespace rigwire::protocols::velodyne
