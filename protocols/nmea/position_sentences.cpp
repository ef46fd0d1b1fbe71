#include "protocols/nmea/position_sentences.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace rigwire::protocols::nmea {
namespace {

constexpr double kKnotsPerMps = 3600.0 / 1852.0;
constexpr double kKilometresPerHourPerKnot = 1.852;
constexpr int kSatellitesPerPage = 4;
constexpr int kMaximumPages = 5;
constexpr std::size_t kUsedSlots = 12;

Sentence begin(const Epoch& epoch, std::string_view type) {
  std::array<char, 8> address{};
  std::snprintf(address.data(), address.size(), "%.*s%.*s", static_cast<int>(epoch.talker.size()),
                epoch.talker.data(), static_cast<int>(type.size()), type.data());
  return Sentence(address.data());
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

/// Degrees, minutes with five decimals, hemisphere. Rounded as one integer, so that 59.999999
/// minutes become the next degree.
void put_angle(Sentence& sentence, double angle_deg, int degree_digits, const char* hemispheres) {
  const long long units = std::llround(std::abs(angle_deg) * 60.0 * 1e5);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%0*lld%02lld.%05lld", degree_digits, units / 6'000'000,
                units / 100'000 % 60, units % 100'000);
  sentence.field(text.data());
  sentence.field(std::string_view(hemispheres + (angle_deg < 0.0 ? 1 : 0), 1));
}

void put_position(Sentence& sentence, const Epoch& epoch) {
  if (epoch.fix_dimensions == 0) {
    sentence.empty().empty().empty().empty();
    return;
  }
  put_angle(sentence, epoch.latitude_deg, 2, "NS");
  put_angle(sentence, epoch.longitude_deg, 3, "EW");
}

void put_course(Sentence& sentence, const Epoch& epoch) {
  if (!epoch.course_deg) {
    sentence.empty();
    return;
  }
  const double rounded = std::round(*epoch.course_deg * 100.0) / 100.0;
  sentence.number("%.2f", rounded >= 360.0 ? 0.0 : rounded);
}

void put_mode(Sentence& sentence, const Epoch& epoch) {
  if (epoch.with_mode) {
    sentence.field(epoch.fix_dimensions == 0 ? "N" : epoch.differential ? "D" : "A");
  }
}

void put_dilution(Sentence& sentence, const std::optional<double>& dilution) {
  sentence.number("%.2f", std::min(dilution.value_or(99.99), 99.99));
}

std::string_view status(const Epoch& epoch) {
  return epoch.fix_dimensions == 0 ? "V" : "A";
}

/// -0.04 must not become "-0.0".
double tenths(double value) {
  return std::round(value * 10.0) / 10.0 + 0.0;
}

int listed_satellites(const Epoch& epoch) {
  return std::min(static_cast<int>(epoch.satellites.size()), kMaximumPages * kSatellitesPerPage);
}

}  // namespace

Sentence write_rmc(const Epoch& epoch) {
  Sentence sentence = begin(epoch, "RMC");
  put_time(sentence, epoch.time);
  sentence.field(status(epoch));
  put_position(sentence, epoch);
  if (epoch.fix_dimensions == 0) {
    sentence.empty().empty();
  } else {
    sentence.number("%.3f", epoch.ground_speed_mps * kKnotsPerMps);
    put_course(sentence, epoch);
  }
  if (epoch.date) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%02d%02d%02d", epoch.date->day, epoch.date->month,
                  epoch.date->year % 100);
    sentence.field(text.data());
  } else {
    sentence.empty();
  }
  sentence.empty().empty();
  put_mode(sentence, epoch);
  return sentence;
}

Sentence write_vtg(const Epoch& epoch) {
  Sentence sentence = begin(epoch, "VTG");
  if (epoch.fix_dimensions == 0) {
    for (int i = 0; i < 8; ++i) {
      sentence.empty();
    }
  } else {
    const double knots = epoch.ground_speed_mps * kKnotsPerMps;
    put_course(sentence, epoch);
    sentence.field("T").empty().field("M");
    sentence.number("%.3f", knots).field("N");
    sentence.number("%.3f", knots * kKilometresPerHourPerKnot).field("K");
  }
  put_mode(sentence, epoch);
  return sentence;
}

Sentence write_gga(const Epoch& epoch) {
  Sentence sentence = begin(epoch, "GGA");
  put_time(sentence, epoch.time);
  put_position(sentence, epoch);
  const bool fix = epoch.fix_dimensions != 0;
  sentence.number("%d", fix ? (epoch.differential ? 2 : 1) : 0);
  sentence.number("%02d", std::min(epoch.satellites_used, static_cast<int>(kUsedSlots)));
  put_dilution(sentence, epoch.horizontal_dilution);
  if (fix) {
    sentence.number("%.1f", tenths(epoch.altitude_m)).field("M");
    sentence.number("%.1f", tenths(epoch.separation_m)).field("M");
    sentence.empty().field("0000");
  } else {
    sentence.empty().empty().empty().empty().empty().empty();
  }
  return sentence;
}

Sentence write_gsa(const Epoch& epoch) {
  Sentence sentence = begin(epoch, "GSA");
  sentence.field("A");
  sentence.number("%d", epoch.fix_dimensions == 0 ? 1 : epoch.fix_dimensions);
  std::size_t slots = 0;
  for (const auto& satellite : epoch.satellites) {
    if (satellite.used && slots < kUsedSlots) {
      sentence.number("%02d", satellite.number);
      ++slots;
    }
  }
  for (; slots < kUsedSlots; ++slots) {
    sentence.empty();
  }
  put_dilution(sentence, epoch.position_dilution);
  put_dilution(sentence, epoch.horizontal_dilution);
  put_dilution(sentence, epoch.vertical_dilution);
  return sentence;
}

Sentence write_gll(const Epoch& epoch) {
  Sentence sentence = begin(epoch, "GLL");
  put_position(sentence, epoch);
  put_time(sentence, epoch.time);
  sentence.field(status(epoch));
  put_mode(sentence, epoch);
  return sentence;
}

Sentence write_zda(const Epoch& epoch) {
  Sentence sentence = begin(epoch, "ZDA");
  put_time(sentence, epoch.time);
  if (epoch.date) {
    sentence.number("%02d", epoch.date->day).number("%02d", epoch.date->month);
    sentence.number("%04d", epoch.date->year);
  } else {
    sentence.empty().empty().empty();
  }
  sentence.field("00").field("00");
  return sentence;
}

int gsv_pages(const Epoch& epoch) {
  return std::max(1, (listed_satellites(epoch) + kSatellitesPerPage - 1) / kSatellitesPerPage);
}

Sentence write_gsv(const Epoch& epoch, int page) {
  Sentence sentence = begin(epoch, "GSV");
  const int listed = listed_satellites(epoch);
  sentence.number("%d", gsv_pages(epoch)).number("%d", page).number("%02d", listed);
  const int first = (page - 1) * kSatellitesPerPage;
  const auto optional = [&](const char* format, const std::optional<int>& value) {
    value ? sentence.number(format, *value) : sentence.empty();
  };
  for (int i = first; i < std::min(first + kSatellitesPerPage, listed); ++i) {
    const auto& satellite = epoch.satellites[static_cast<std::size_t>(i)];
    sentence.number("%02d", satellite.number);
    optional("%02d", satellite.elevation_deg);
    optional("%03d", satellite.azimuth_deg);
    optional("%02d", satellite.cn0_dbhz);
  }
  return sentence;
}

Sentence write_txt(std::string_view talker, TextKind kind, std::string_view text) {
  Epoch epoch;
  epoch.talker = talker;
  Sentence sentence = begin(epoch, "TXT");
  sentence.field("01").field("01").number("%02d", static_cast<int>(kind)).field(text);
  return sentence;
}

}  // namespace rigwire::protocols::nmea
