#include <charconv>
#include <cmath>

#include "protocols/nmea/position_sentences.h"

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

}  // namespace rigwire::protocols::nmea
