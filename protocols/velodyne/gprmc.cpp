#include "protocols/velodyne/gprmc.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kKnot_mps = 1852.0 / 3600.0;

struct DegreesMinutes {
  int degrees = 0;
  int minutes = 0;
  int ten_thousandths = 0;
};

DegreesMinutes split(double angle_deg, double limit_deg) {
  const double size = std::min(std::abs(angle_deg), limit_deg);
  const auto units = std::llround(size * 60.0 * 1e4);
  DegreesMinutes result;
  result.degrees = static_cast<int>(units / 600000);
  result.minutes = static_cast<int>(units % 600000 / 10000);
  result.ten_thousandths = static_cast<int>(units % 10000);
  return result;
}

}  // namespace

GprmcText::GprmcText(const RecommendedMinimum& values) {
  append("$GPRMC,");
  append("%02d%02d%02d", values.hour, values.minute, values.second);
  if (values.time_form == NmeaTimeForm::tenths) {
    append(".%d", values.tenth);
  }
  append(",");
  if (values.valid) {
    const auto speed_tenths =
        std::min(9999L, std::max(0L, std::lround(values.speed_mps / kKnot_mps * 10.0)));
    const auto course_tenths = std::lround(values.course_deg * 10.0) % 3600;
    append("A,");
    append_position(values.latitude_deg, values.longitude_deg);
    append("%03ld.%ld,%03ld.%ld,", speed_tenths / 10, speed_tenths % 10, course_tenths / 10,
           course_tenths % 10);
  } else {
    append("V,,,,,,,");
  }
  append("%02d%02d%02d,%s", values.day, values.month, values.year % 100,
         values.valid ? "000.0,E,A" : ",,N");
  unsigned checksum = 0;
  for (const char character : view().substr(1)) {
    checksum ^= static_cast<unsigned char>(character);
  }
  append("*%02X\r\n", checksum);
}

void GprmcText::append(const char* format, ...) {
  const std::size_t room = text_.size() - size_;
  va_list arguments;
  va_start(arguments, format);
  const int wanted = std::vsnprintf(text_.data() + size_, room, format, arguments);
  va_end(arguments);
  size_ += std::min(static_cast<std::size_t>(std::max(wanted, 0)), room - 1);
}

void GprmcText::append_position(double latitude_deg, double longitude_deg) {
  const DegreesMinutes latitude = split(latitude_deg, 90.0);
  const DegreesMinutes longitude = split(longitude_deg, 180.0);
  append("%02d%02d.%04d,%c,", latitude.degrees, latitude.minutes, latitude.ten_thousandths,
         latitude_deg < 0.0 ? 'S' : 'N');
  append("%03d%02d.%04d,%c,", longitude.degrees, longitude.minutes, longitude.ten_thousandths,
         longitude_deg < 0.0 ? 'W' : 'E');
}

}  // namespace rigwire::protocols::velodyne
