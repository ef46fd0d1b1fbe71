#include "protocols/velodyne/gprmc.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kKnot_mps = 1852.0 / 3600.0;

struct DegreesMinutes {
  int degrees = 0;
  int minutes = 0;
  int ten_thousandths = 0;
};

/// Rounded once, on the whole angle, so that 60.0000 minutes cannot appear.
DegreesMinutes split(double angle_deg) {
  const auto units = std::llround(std::abs(angle_deg) * 60.0 * 1e4);
  DegreesMinutes result;
  result.degrees = static_cast<int>(units / 600000);
  result.minutes = static_cast<int>(units % 600000 / 10000);
  result.ten_thousandths = static_cast<int>(units % 10000);
  return result;
}

}  // namespace

GprmcText::GprmcText(const RecommendedMinimum& values) {
  int length = std::snprintf(text_.data(), text_.size(), "$GPRMC,%02d%02d%02d,", values.hour,
                             values.minute, values.second);
  auto append = [&](const char* format, auto... arguments) {
    const auto used = static_cast<std::size_t>(length);
    length += std::snprintf(text_.data() + used, text_.size() - used, format, arguments...);
  };
  if (values.valid) {
    const DegreesMinutes latitude = split(std::clamp(values.latitude_deg, -90.0, 90.0));
    const DegreesMinutes longitude = split(std::clamp(values.longitude_deg, -180.0, 180.0));
    const auto speed_tenths =
        std::min(9999L, std::max(0L, std::lround(values.speed_mps / kKnot_mps * 10.0)));
    const auto course_tenths = std::lround(values.course_deg * 10.0) % 3600;
    append("A,%02d%02d.%04d,%c,%03d%02d.%04d,%c,%03ld.%ld,%03ld.%ld,", latitude.degrees,
           latitude.minutes, latitude.ten_thousandths, values.latitude_deg < 0.0 ? 'S' : 'N',
           longitude.degrees, longitude.minutes, longitude.ten_thousandths,
           values.longitude_deg < 0.0 ? 'W' : 'E', speed_tenths / 10, speed_tenths % 10,
           course_tenths / 10, course_tenths % 10);
  } else {
    append("%s", "V,,,,,,,");
  }
  append("%02d%02d%02d,,,%c", values.day, values.month, values.year % 100,
         values.valid ? 'A' : 'N');
  std::uint8_t checksum = 0;
  for (int i = 1; i < length; ++i) {
    checksum = static_cast<std::uint8_t>(
        checksum ^ static_cast<std::uint8_t>(text_[static_cast<std::size_t>(i)]));
  }
  append("*%02X\r\n", static_cast<unsigned>(checksum));
  size_ = static_cast<std::size_t>(length);
}

}  // namespace rigwire::protocols::velodyne
