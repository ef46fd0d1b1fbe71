#include "protocols/nmea/field_names.h"

#include <algorithm>
#include <array>

namespace rigwire::protocols::nmea {
namespace {

struct Row {
  std::string_view type;
  std::string_view names;  ///< In order, parted by commas.
};

constexpr std::array<Row, 9> kRows{{
    {"GGA",
     "time,latitude,north or south,longitude,east or west,quality,satellites used,horizontal "
     "dilution,altitude,its unit,geoid separation,its unit,age of corrections,station"},
    {"GLL", "latitude,north or south,longitude,east or west,time,status,mode"},
    {"GNS",
     "time,latitude,north or south,longitude,east or west,mode,satellites used,horizontal "
     "dilution,altitude,geoid separation,age of corrections,station,status"},
    {"GSA",
     "selection,dimensions,satellite 1,satellite 2,satellite 3,satellite 4,satellite 5,satellite "
     "6,satellite 7,satellite 8,satellite 9,satellite 10,satellite 11,satellite 12,position "
     "dilution,horizontal dilution,vertical dilution,system"},
    {"GST",
     "time,deviation of ranges,major axis,minor axis,orientation,deviation of latitude,deviation "
     "of longitude,deviation of altitude"},
    {"GSV", "sentences,sentence,satellites in view"},
    {"RMC",
     "time,status,latitude,north or south,longitude,east or west,speed,course,date,magnetic "
     "variation,east or west,mode,navigational status"},
    {"VTG",
     "true course,its reference,magnetic course,its reference,speed in knots,its unit,speed in "
     "km/h,its unit,mode"},
    {"ZDA", "time,day,month,year,hours of the zone,minutes of the zone"},
}};

/// GSV behind its head: groups of four, then from version 4.10 on one more.
constexpr std::size_t kViewHead = 3;
constexpr std::array<std::string_view, 4> kViewed{"satellite", "elevation", "azimuth", "C/N0"};

std::string_view part(std::string_view names, std::size_t index) {
  for (; index != 0; --index) {
    const std::size_t comma = names.find(',');
    if (comma == std::string_view::npos) {
      return {};
    }
    names.remove_prefix(comma + 1);
  }
  return names.substr(0, names.find(','));
}

}  // namespace

std::string_view field_name(std::string_view type, std::size_t index, std::size_t count) {
  const auto* const row = std::ranges::find(kRows, type, &Row::type);
  if (row == kRows.end()) {
    return {};
  }
  if (type != "GSV" || index < kViewHead) {
    return part(row->names, index);
  }
  const std::size_t behind = index - kViewHead;
  const bool last = index + 1 == count && behind % kViewed.size() == 0;
  return last ? "signal" : kViewed[behind % kViewed.size()];
}

}  // namespace rigwire::protocols::nmea
