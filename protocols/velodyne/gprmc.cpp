#include "protocols/velodyne/gprmc.h"

#include <algorithm>
#include <cmath>

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kKnot_mps = 1852.0 / 3600.0;

}  // namespace

GprmcText::GprmcText(const RecommendedMinimum& values) {
  text_.append("$GPRMC,");
  text_.append_time(values.hour, values.minute, values.second, values.tenth, values.time_form);
  if (values.valid) {
    const auto speed_tenths =
        std::min(9999L, std::max(0L, std::lround(values.speed_mps / kKnot_mps * 10.0)));
    const auto course_tenths = std::lround(values.course_deg * 10.0) % 3600;
    text_.append("A,");
    text_.append_position(values.latitude_deg, values.longitude_deg);
    text_.append("%03ld.%ld,%03ld.%ld,", speed_tenths / 10, speed_tenths % 10, course_tenths / 10,
                 course_tenths % 10);
  } else {
    text_.append("V,,,,,,,");
  }
  text_.append("%02d%02d%02d,%s", values.day, values.month, values.year % 100,
               values.valid ? "000.0,E,A" : ",,N");
  text_.finish();
}

}  // namespace rigwire::protocols::velodyne
