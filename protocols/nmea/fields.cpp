#include "protocols/nmea/fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace rigwire::protocols::nmea {
namespace {

int minute_decimals(Precision precision) {
  return precision == Precision::high ? 7 : precision == Precision::compatible ? 4 : 5;
}

/// Rounded as one integer, so that 59.999999 minutes become the next degree, and the hemisphere is
/// that of what is printed.
void put_angle(Sentence& sentence, double angle_deg, int degree_digits, int decimals,
               std::string_view hemispheres) {
  long long unit = 1;
  for (int i = 0; i < decimals; ++i) {
    unit *= 10;
  }
  const long long rounded = std::llround(angle_deg * 60.0 * static_cast<double>(unit));
  const long long size = std::abs(rounded);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%0*lld%02lld.%0*lld", degree_digits, size / unit / 60,
                size / unit % 60, decimals, size % unit);
  sentence.field(text.data());
  sentence.field(hemispheres.substr(rounded < 0 ? 1 : 0, 1));
}

}  // namespace

Sentence begin_sentence(std::string_view talker, std::string_view type) {
  std::array<char, 8> address{};
  std::snprintf(address.data(), address.size(), "%.*s%.*s", static_cast<int>(talker.size()),
                talker.data(), static_cast<int>(type.size()), type.data());
  return Sentence(address.data());
}

bool has_fix(const Epoch& epoch) {
  return epoch.fix_dimensions != 0;
}

bool has_identifiers(const Epoch& epoch) {
  return epoch.version >= Version::v410;
}

std::string_view position_mode(const Epoch& epoch, bool with_carrier) {
  if (!has_fix(epoch)) {
    return "N";
  }
  if (epoch.dead_reckoning) {
    return "E";
  }
  if (epoch.carrier != CarrierFix::none) {
    const bool told = with_carrier && epoch.version >= Version::v40;
    return !told ? "D" : epoch.carrier == CarrierFix::fixed ? "R" : "F";
  }
  return epoch.differential ? "D" : "A";
}

int quality(const Epoch& epoch) {
  if (!has_fix(epoch)) {
    return 0;
  }
  if (epoch.dead_reckoning) {
    return epoch.version == Version::v21 ? 1 : 6;
  }
  if (epoch.carrier != CarrierFix::none && epoch.version >= Version::v40) {
    return epoch.carrier == CarrierFix::fixed ? 4 : 5;
  }
  return epoch.differential || epoch.carrier != CarrierFix::none ? 2 : 1;
}

void put_time(Sentence& sentence, const std::optional<TimeOfDay>& time) {
  if (!time) {
    sentence.empty();
    return;
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%02d%02d%02d.%02d", time->hour, time->minute,
                time->second, time->hundredths);
  sentence.field(text.data());
}

void put_date(Sentence& sentence, const std::optional<Date>& date) {
  if (!date) {
    sentence.empty();
    return;
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%02d%02d%02d", date->day, date->month, date->year % 100);
  sentence.field(text.data());
}

void put_coordinates(Sentence& sentence, const Epoch& epoch) {
  const int decimals = minute_decimals(epoch.precision);
  put_angle(sentence, epoch.latitude_deg, 2, decimals, "NS");
  put_angle(sentence, epoch.longitude_deg, 3, decimals, "EW");
}

void put_position(Sentence& sentence, const Epoch& epoch) {
  if (has_fix(epoch)) {
    put_coordinates(sentence, epoch);
  } else {
    sentence.empty().empty().empty().empty();
  }
}

void put_altitude(Sentence& sentence, const Epoch& epoch) {
  sentence.number(epoch.precision == Precision::high ? "%.3f" : "%.1f", epoch.altitude_m);
}

void put_course(Sentence& sentence, double course_deg) {
  const double rounded = std::round(course_deg * 100.0) / 100.0;
  sentence.number("%.2f", rounded >= 360.0 ? 0.0 : rounded);
}

void put_dilution(Sentence& sentence, const std::optional<double>& dilution) {
  sentence.number("%.2f", std::min(dilution.value_or(99.99), 99.99));
}

void put_deviation(Sentence& sentence, double value) {
  sentence.number(value >= 9.95     ? "%.0f"
                  : value >= 0.995  ? "%.1f"
                  : value >= 0.0995 ? "%.2f"
                                    : "%.3f",
                  value);
}

void put_corrections(Sentence& sentence, const Epoch& epoch) {
  const bool corrected = has_fix(epoch) && !epoch.dead_reckoning &&
                         (epoch.differential || epoch.carrier != CarrierFix::none);
  if (!corrected) {
    sentence.empty().empty();
    return;
  }
  epoch.differential_age_s ? sentence.number("%.1f", *epoch.differential_age_s) : sentence.empty();
  sentence.number("%04d", epoch.station);
}

}  // namespace rigwire::protocols::nmea
