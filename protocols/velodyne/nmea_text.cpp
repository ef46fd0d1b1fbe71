#include "protocols/velodyne/nmea_text.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>

namespace rigwire::protocols::velodyne {
namespace {

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

void NmeaText::append(const char* format, ...) {
  const std::size_t room = text_.size() - size_;
  va_list arguments;
  va_start(arguments, format);
  const int wanted = std::vsnprintf(text_.data() + size_, room, format, arguments);
  va_end(arguments);
  size_ += std::min(static_cast<std::size_t>(std::max(wanted, 0)), room - 1);
}

void NmeaText::append_time(int hour, int minute, int second, int tenth, NmeaTimeForm form) {
  append("%02d%02d%02d", hour, minute, second);
  if (form == NmeaTimeForm::tenths) {
    append(".%d", tenth);
  }
  append(",");
}

void NmeaText::append_position(double latitude_deg, double longitude_deg) {
  const DegreesMinutes latitude = split(latitude_deg, 90.0);
  const DegreesMinutes longitude = split(longitude_deg, 180.0);
  append("%02d%02d.%04d,%c,", latitude.degrees, latitude.minutes, latitude.ten_thousandths,
         latitude_deg < 0.0 ? 'S' : 'N');
  append("%03d%02d.%04d,%c,", longitude.degrees, longitude.minutes, longitude.ten_thousandths,
         longitude_deg < 0.0 ? 'W' : 'E');
}

void NmeaText::finish() {
  unsigned checksum = 0;
  for (const char character : view().substr(1)) {
    checksum ^= static_cast<unsigned char>(character);
  }
  append("*%02X\r\n", checksum);
}

}  // namespace rigwire::protocols::velodyne
