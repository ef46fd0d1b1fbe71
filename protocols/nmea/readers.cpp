#include "protocols/nmea/readers.h"

#include <charconv>
#include <cmath>

namespace rigwire::protocols::nmea {
namespace {

constexpr double kMpsPerKnot = 1852.0 / 3600.0;

std::optional<double> to_number(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, std::chars_format::fixed);
  if (text.empty() || error != std::errc{} || stop != end || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

/// Exactly these digits, no sign.
std::optional<int> to_digits(std::string_view text) {
  int value = 0;
  if (text.empty() || text.size() > 6) {
    return std::nullopt;
  }
  for (const char c : text) {
    if (c < '0' || c > '9') {
      return std::nullopt;
    }
    value = value * 10 + (c - '0');
  }
  return value;
}

std::optional<TimeOfDay> to_time(std::string_view text) {
  if (text.size() < 6) {
    return std::nullopt;
  }
  const auto whole = to_digits(text.substr(0, 6));
  std::optional<int> hundredths = 0;
  if (text.size() > 6) {
    const auto fraction = text.substr(7);
    hundredths = to_digits(fraction.substr(0, 2));
    if (text[6] != '.' || !to_digits(fraction)) {
      return std::nullopt;
    }
    if (fraction.size() == 1) {
      hundredths = *hundredths * 10;
    }
  }
  if (!whole || !hundredths) {
    return std::nullopt;
  }
  const TimeOfDay time{*whole / 10'000, *whole / 100 % 100, *whole % 100, *hundredths};
  if (time.hour > 23 || time.minute > 59 || time.second > 60) {
    return std::nullopt;
  }
  return time;
}

std::optional<Date> to_date(std::string_view text) {
  const auto digits = to_digits(text);
  if (text.size() != 6 || !digits) {
    return std::nullopt;
  }
  const int two_digit_year = *digits % 100;  // RMC: 80..99 are of the last century
  const Date date{two_digit_year + (two_digit_year < 80 ? 2000 : 1900), *digits / 100 % 100,
                  *digits / 10'000};
  if (date.month < 1 || date.month > 12 || date.day < 1 || date.day > 31) {
    return std::nullopt;
  }
  return date;
}

std::optional<double> to_angle(std::string_view text, std::string_view hemisphere,
                               std::size_t degree_digits, std::string_view hemispheres) {
  if (text.size() < degree_digits + 2 || hemisphere.size() != 1) {
    return std::nullopt;
  }
  const auto degrees = to_digits(text.substr(0, degree_digits));
  const auto minutes = to_number(text.substr(degree_digits));
  const auto sign = hemispheres.find(hemisphere[0]);
  const int limit = degree_digits == 2 ? 90 : 180;
  if (!degrees || !minutes || sign == std::string_view::npos || *minutes < 0.0 ||
      *minutes >= 60.0 || std::signbit(*minutes)) {
    return std::nullopt;
  }
  const double angle = *degrees + *minutes / 60.0;
  if (angle > limit) {
    return std::nullopt;
  }
  return sign == 0 ? angle : -angle;
}

/// Empty is fine; strange is not.
bool absent_or(const std::optional<double>& value, std::string_view text) {
  return text.empty() || value.has_value();
}

std::optional<double> to_dilution(std::string_view text) {
  const auto value = to_number(text);
  return value && *value < 99.99 ? value : std::nullopt;
}

/// A hexadecimal digit.
std::optional<int> to_identifier(std::string_view text) {
  int value = 0;
  const char* const end = text.data() + text.size();
  if (text.size() != 1 || std::from_chars(text.data(), end, value, 16).ptr != end) {
    return std::nullopt;
  }
  return value;
}

/// Digits within limits, or nothing; false when strange.
bool take_digits(std::string_view text, int least, int most, std::optional<int>& value) {
  value = to_digits(text);
  return text.empty() || (value && *value >= least && *value <= most);
}

}  // namespace

Decoded<Rmc> read_rmc(const SentenceView& sentence) {
  if (sentence.type() != "RMC") {
    return Malformed{"another NMEA sentence", 1};
  }
  if (sentence.field_count < 11) {
    return Malformed{"RMC has at least 11 fields", 1};
  }
  Rmc rmc;
  rmc.time = to_time(sentence.field(0));
  rmc.date = to_date(sentence.field(8));
  if ((!rmc.time && !sentence.field(0).empty()) || (!rmc.date && !sentence.field(8).empty())) {
    return Malformed{"RMC time or date", 1};
  }
  if (sentence.field(1) == "V") {
    return {rmc, 1};
  }
  const auto latitude = to_angle(sentence.field(2), sentence.field(3), 2, "NS");
  const auto longitude = to_angle(sentence.field(4), sentence.field(5), 3, "EW");
  const auto knots = to_number(sentence.field(6));
  rmc.course_deg = to_number(sentence.field(7));
  const bool course_ok = sentence.field(7).empty() ||
                         (rmc.course_deg && *rmc.course_deg >= 0.0 && *rmc.course_deg <= 360.0);
  if (sentence.field(1) != "A" || !rmc.time || !latitude || !longitude || !knots || *knots < 0.0 ||
      !course_ok) {
    return Malformed{"RMC status, position, speed or course", 1};
  }
  rmc.valid = true;
  rmc.latitude_deg = *latitude;
  rmc.longitude_deg = *longitude;
  rmc.ground_speed_mps = *knots * kMpsPerKnot;
  return {rmc, 1};
}

Decoded<Gga> read_gga(const SentenceView& sentence) {
  if (sentence.type() != "GGA") {
    return Malformed{"another NMEA sentence", 1};
  }
  if (sentence.field_count != 14) {
    return Malformed{"GGA has 14 fields", 1};
  }
  Gga gga;
  gga.time = to_time(sentence.field(0));
  const auto quality = to_digits(sentence.field(5));
  if ((!gga.time && !sentence.field(0).empty()) || !quality || *quality > 8) {
    return Malformed{"GGA time or quality", 1};
  }
  gga.quality = *quality;
  const auto used = to_digits(sentence.field(6));
  const auto dilution = to_number(sentence.field(7));
  if (dilution && *dilution < 99.99) {
    gga.horizontal_dilution = dilution;
  }
  gga.satellites_used = used.value_or(0);
  if (gga.quality == 0) {
    return {gga, 1};
  }
  const auto latitude = to_angle(sentence.field(1), sentence.field(2), 2, "NS");
  const auto longitude = to_angle(sentence.field(3), sentence.field(4), 3, "EW");
  const auto altitude = to_number(sentence.field(8));
  const auto separation = to_number(sentence.field(10));
  if (!gga.time || !latitude || !longitude || !altitude || sentence.field(9) != "M" ||
      !separation || sentence.field(11) != "M" || !used) {
    return Malformed{"GGA position or altitude", 1};
  }
  gga.latitude_deg = *latitude;
  gga.longitude_deg = *longitude;
  gga.altitude_m = *altitude;
  gga.separation_m = *separation;
  return {gga, 1};
}

Decoded<Gll> read_gll(const SentenceView& sentence) {
  if (sentence.type() != "GLL") {
    return Malformed{"another NMEA sentence", 1};
  }
  Gll gll;
  gll.time = to_time(sentence.field(4));
  if (sentence.field_count < 6 || (!gll.time && !sentence.field(4).empty())) {
    return Malformed{"GLL fields or time", 1};
  }
  if (sentence.field(5) == "V") {
    return {gll, 1};
  }
  const auto latitude = to_angle(sentence.field(0), sentence.field(1), 2, "NS");
  const auto longitude = to_angle(sentence.field(2), sentence.field(3), 3, "EW");
  if (sentence.field(5) != "A" || !gll.time || !latitude || !longitude) {
    return Malformed{"GLL status or position", 1};
  }
  gll.valid = true;
  gll.latitude_deg = *latitude;
  gll.longitude_deg = *longitude;
  return {gll, 1};
}

Decoded<Vtg> read_vtg(const SentenceView& sentence) {
  if (sentence.type() != "VTG") {
    return Malformed{"another NMEA sentence", 1};
  }
  Vtg vtg;
  vtg.course_deg = to_number(sentence.field(0));
  const auto speed_kmph = to_number(sentence.field(6));
  if (sentence.field_count < 8 || !absent_or(vtg.course_deg, sentence.field(0)) ||
      !absent_or(speed_kmph, sentence.field(6)) || speed_kmph.value_or(0.0) < 0.0 ||
      vtg.course_deg.value_or(0.0) < 0.0 || vtg.course_deg.value_or(0.0) > 360.0 ||
      (speed_kmph && sentence.field(7) != "K")) {
    return Malformed{"VTG fields, course or speed", 1};
  }
  if (speed_kmph) {
    vtg.ground_speed_mps = *speed_kmph / 3.6;
  }
  return {vtg, 1};
}

Decoded<Zda> read_zda(const SentenceView& sentence) {
  if (sentence.type() != "ZDA") {
    return Malformed{"another NMEA sentence", 1};
  }
  Zda zda;
  zda.time = to_time(sentence.field(0));
  std::optional<int> day;
  std::optional<int> month;
  std::optional<int> year;
  if (sentence.field_count < 6 || (!zda.time && !sentence.field(0).empty()) ||
      !take_digits(sentence.field(1), 1, 31, day) ||
      !take_digits(sentence.field(2), 1, 12, month) ||
      !take_digits(sentence.field(3), 1980, 9999, year) || day.has_value() != month.has_value() ||
      day.has_value() != year.has_value()) {
    return Malformed{"ZDA fields, time or date", 1};
  }
  if (day) {
    zda.date = Date{*year, *month, *day};
  }
  return {zda, 1};
}

Decoded<Gsa> read_gsa(const SentenceView& sentence) {
  constexpr std::size_t kFirst = 2;
  constexpr std::size_t kDilutions = kFirst + 12;
  if (sentence.type() != "GSA") {
    return Malformed{"another NMEA sentence", 1};
  }
  Gsa gsa;
  const auto mode = to_digits(sentence.field(1));
  if (sentence.field_count < kDilutions + 3 || !mode || *mode < 1 || *mode > 3) {
    return Malformed{"GSA fields or mode", 1};
  }
  gsa.mode = *mode;
  for (std::size_t i = 0; i < gsa.used.size(); ++i) {
    std::optional<int> number;
    if (!take_digits(sentence.field(kFirst + i), 1, 999, number)) {
      return Malformed{"GSA satellite", 1};
    }
    if (number) {
      gsa.used[gsa.used_count++] = *number;
    }
  }
  gsa.position_dilution = to_dilution(sentence.field(kDilutions));
  gsa.horizontal_dilution = to_dilution(sentence.field(kDilutions + 1));
  gsa.vertical_dilution = to_dilution(sentence.field(kDilutions + 2));
  gsa.system = to_identifier(sentence.field(kDilutions + 3));
  return {gsa, 1};
}

Decoded<Gsv> read_gsv(const SentenceView& sentence) {
  constexpr std::size_t kFirst = 3;
  constexpr std::size_t kEach = 4;
  if (sentence.type() != "GSV") {
    return Malformed{"another NMEA sentence", 1};
  }
  std::optional<int> pages;
  std::optional<int> page;
  std::optional<int> in_view;
  if (sentence.field_count < kFirst || !take_digits(sentence.field(0), 1, 99, pages) ||
      !take_digits(sentence.field(1), 1, 99, page) ||
      !take_digits(sentence.field(2), 0, 999, in_view) || !pages || !page || !in_view ||
      *page > *pages) {
    return Malformed{"GSV pages or satellites in view", 1};
  }
  Gsv gsv;
  gsv.pages = *pages;
  gsv.page = *page;
  gsv.in_view = *in_view;
  const std::size_t rest = sentence.field_count - kFirst;
  gsv.satellite_count = rest / kEach;
  if (gsv.satellite_count > gsv.satellites.size() || rest % kEach > 1) {
    return Malformed{"GSV number of fields", 1};
  }
  for (std::size_t i = 0; i < gsv.satellite_count; ++i) {
    const std::size_t at = kFirst + i * kEach;
    auto& satellite = gsv.satellites[i];
    std::optional<int> number;
    if (!take_digits(sentence.field(at), 1, 999, number) ||
        !take_digits(sentence.field(at + 1), 0, 90, satellite.elevation_deg) ||
        !take_digits(sentence.field(at + 2), 0, 360, satellite.azimuth_deg) ||
        !take_digits(sentence.field(at + 3), 0, 99, satellite.cn0_dbhz)) {
      return Malformed{"GSV satellite", 1};
    }
    satellite.number = number.value_or(0);
  }
  if (rest % kEach == 1) {
    gsv.signal = to_identifier(sentence.field(sentence.field_count - 1));
  }
  return {gsv, 1};
}

Decoded<Gst> read_gst(const SentenceView& sentence) {
  if (sentence.type() != "GST") {
    return Malformed{"another NMEA sentence", 1};
  }
  Gst gst;
  gst.time = to_time(sentence.field(0));
  gst.range_m = to_number(sentence.field(1));
  gst.latitude_m = to_number(sentence.field(5));
  gst.longitude_m = to_number(sentence.field(6));
  gst.altitude_m = to_number(sentence.field(7));
  if (sentence.field_count != 8 || (!gst.time && !sentence.field(0).empty()) ||
      !absent_or(gst.range_m, sentence.field(1)) || !absent_or(gst.latitude_m, sentence.field(5)) ||
      !absent_or(gst.longitude_m, sentence.field(6)) ||
      !absent_or(gst.altitude_m, sentence.field(7))) {
    return Malformed{"GST fields or numbers", 1};
  }
  return {gst, 1};
}

}  // namespace rigwire::protocols::nmea
