#include "protocols/nmea/writers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "protocols/nmea/satellite_numbers.h"

namespace rigwire::protocols::nmea {
namespace {

constexpr double kKnotsPerMps = 3600.0 / 1852.0;
constexpr double kKilometresPerHourPerKnot = 1.852;

// Fields that several sentences share.

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
  Digits text;
  text.put(degree_digits, size / unit / 60).put(2, size / unit % 60);
  sentence.field(text.point().put(decimals, size % unit).text());
  sentence.field(hemispheres.substr(rounded < 0 ? 1 : 0, 1));
}

Sentence begin_sentence(std::string_view talker, std::string_view type) {
  std::array<char, 8> address{};
  const std::string_view first = talker.substr(0, address.size() / 2);
  const std::string_view second = type.substr(0, address.size() / 2);
  std::ranges::copy(second, std::ranges::copy(first, address.begin()).out);
  return Sentence({address.data(), first.size() + second.size()});
}

bool has_fix(const Epoch& epoch) {
  return epoch.fix_dimensions != 0;
}

/// Version 4.10 or later: system, signal and navigational status are printed.
bool has_identifiers(const Epoch& epoch) {
  return epoch.version >= Version::v410;
}

/// Returns the letter of the position mode. `with_carrier`: RMC and GNS distinguish float and
/// fixed.
std::string_view position_mode(const Epoch& epoch, bool with_carrier) {
  if (!has_fix(epoch)) {
    return "N";
  }
  if (epoch.carrier != CarrierFix::none) {
    const bool told = with_carrier && epoch.version >= Version::v40;
    return !told ? "D" : epoch.carrier == CarrierFix::fixed ? "R" : "F";
  }
  return epoch.differential ? "D" : "A";
}

/// GGA quality.
int quality(const Epoch& epoch) {
  if (!has_fix(epoch)) {
    return 0;
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
  Digits text;
  text.put(2, time->hour).put(2, time->minute).put(2, time->second);
  sentence.field(text.point().put(2, time->hundredths).text());
}

void put_date(Sentence& sentence, const std::optional<Date>& date) {
  if (!date) {
    sentence.empty();
    return;
  }
  sentence.field(Digits().put(2, date->day).put(2, date->month).put(2, date->year % 100).text());
}

/// Two fields: latitude and hemisphere, then longitude and hemisphere, however there is a fix.
/// Error at most half a unit of the last decimal.
void put_coordinates(Sentence& sentence, const Epoch& epoch) {
  const int decimals = minute_decimals(epoch.precision);
  put_angle(sentence, epoch.latitude_deg, 2, decimals, "NS");
  put_angle(sentence, epoch.longitude_deg, 3, decimals, "EW");
}

/// Writes the four position fields, empty without fix.
void put_position(Sentence& sentence, const Epoch& epoch) {
  if (has_fix(epoch)) {
    put_coordinates(sentence, epoch);
  } else {
    sentence.empty().empty().empty().empty();
  }
}

void put_altitude(Sentence& sentence, const Epoch& epoch) {
  sentence.decimal(epoch.precision == Precision::high ? 3 : 1, epoch.altitude_m);
}

/// Two decimals; 360.00 becomes 0.00.
void put_course(Sentence& sentence, double course_deg) {
  const double rounded = std::round(course_deg * 100.0) / 100.0;
  sentence.decimal(2, rounded >= 360.0 ? 0.0 : rounded);
}

/// Two decimals, 99.99 at most and when unknown.
void put_dilution(Sentence& sentence, const std::optional<double>& dilution) {
  sentence.decimal(2, std::min(dilution.value_or(99.99), 99.99));
}

/// About two significant digits: 148, 12, 1.2, 0.12, 0.012.
void put_deviation(Sentence& sentence, double value) {
  sentence.decimal(value >= 9.95 ? 0 : value >= 0.995 ? 1 : value >= 0.0995 ? 2 : 3, value);
}

/// Age and station of corrections; empty without them.
void put_corrections(Sentence& sentence, const Epoch& epoch) {
  const bool corrected =
      has_fix(epoch) && (epoch.differential || epoch.carrier != CarrierFix::none);
  if (!corrected) {
    sentence.empty().empty();
    return;
  }
  epoch.differential_age_s ? sentence.decimal(1, *epoch.differential_age_s) : sentence.empty();
  sentence.number(4, epoch.station);
}

// Position.

constexpr int kMostUsedInGga = 12;
constexpr int kMostUsedInGns = 99;

std::string_view status(const Epoch& epoch) {
  return has_fix(epoch) ? "A" : "V";
}

/// Writes the position mode of RMC, GLL or VTG; only RMC has `with_carrier`.
void put_mode(Sentence& sentence, const Epoch& epoch, bool with_carrier) {
  if (epoch.version != Version::v21) {
    sentence.field(position_mode(epoch, with_carrier));
  }
}

/// "Equipment is not providing navigational status information".
void put_navigational_status(Sentence& sentence, const Epoch& epoch) {
  if (has_identifiers(epoch)) {
    sentence.field("V");
  }
}

void put_optional_course(Sentence& sentence, const Epoch& epoch) {
  if (epoch.course_deg) {
    put_course(sentence, *epoch.course_deg);
  } else {
    sentence.empty();
  }
}

// Satellites.

constexpr int kSatellitesPerPage = 4;
constexpr int kMostPages = 5;
constexpr int kMostPagesFrom40 = 9;
constexpr int kUsedSlots = 12;
constexpr int kSignals = 16;

/// Satellites that share a talker and, from 4.10 on, a signal.
struct Set {
  std::optional<System> group;  ///< Empty: all satellites, with the main talker.
  std::optional<int> signal;    ///< Empty: whatever the signal.
};

bool belongs(const Epoch& epoch, const SatelliteInView& satellite, const Set& set) {
  return (!set.group || satellite_group(satellite.system, epoch.version) == *set.group) &&
         (!set.signal || satellite.signal == *set.signal);
}

bool group_is_on(const Epoch& epoch, System group) {
  for (const System system : {System::gps, System::sbas, System::galileo, System::beidou,
                              System::qzss, System::glonass}) {
    if ((epoch.systems & system_bit(system)) != 0 &&
        satellite_group(system, epoch.version) == group) {
      return true;
    }
  }
  return false;
}

/// Group of the n-th GSA, n from 1; empty when there is but one for all.
std::optional<System> nth_group(const Epoch& epoch, int n) {
  for (const System group : kSatelliteGroups) {
    if (group_is_on(epoch, group) && --n == 0) {
      return group;
    }
  }
  return std::nullopt;
}

/// Version 4.10: system of the group, or of the satellites when there is but one for all.
int identifier(const Epoch& epoch, const std::optional<System>& group) {
  if (group) {
    return system_identifier(*group);
  }
  return epoch.talker == "GL" ? 2 : epoch.talker == "GA" ? 3 : epoch.talker == "GB" ? 4 : 1;
}

int satellites_in(const Epoch& epoch, const Set& set) {
  int count = 0;
  for (const auto& satellite : epoch.satellites) {
    count += belongs(epoch, satellite, set) ? 1 : 0;
  }
  const int pages = epoch.version >= Version::v40 ? kMostPagesFrom40 : kMostPages;
  const int limit = epoch.maximum_satellites > 0 ? epoch.maximum_satellites : count;
  return std::min({count, limit, pages * kSatellitesPerPage});
}

int pages_of(const Epoch& epoch, const Set& set) {
  return std::max(1, (satellites_in(epoch, set) + kSatellitesPerPage - 1) / kSatellitesPerPage);
}

/// Calls visit(set) for each set that is printed, in order, until it returns true.
template <class Visit>
bool visit_group(const Epoch& epoch, const std::optional<System>& group, Visit&& visit) {
  if (!has_identifiers(epoch)) {
    return visit(Set{group, std::nullopt});
  }
  // Signals that satellites of the group have, a bit each.
  std::uint32_t present = 0;
  for (const SatelliteInView& satellite : epoch.satellites) {
    if (satellite.signal < kSignals && belongs(epoch, satellite, {group, std::nullopt})) {
      present |= 1U << satellite.signal;
    }
  }
  for (int i = 1; i <= kSignals; ++i) {  // the unknown signal, 0, last
    if ((present >> (i % kSignals) & 1U) != 0 && visit(Set{group, i % kSignals})) {
      return true;
    }
  }
  return present == 0 && visit(Set{group, 0});
}

template <class Visit>
void visit_sets(const Epoch& epoch, Visit&& visit) {
  if (epoch.systems == 0) {
    visit_group(epoch, std::nullopt, visit);
    return;
  }
  for (const System group : kSatelliteGroups) {
    if (group_is_on(epoch, group) && visit_group(epoch, group, visit)) {
      return;
    }
  }
}

std::string_view gsv_talker(const Epoch& epoch, const Set& set) {
  return !set.group || epoch.gsv_main_talker ? epoch.talker : group_talker(*set.group);
}

void put_number(Sentence& sentence, int number) {
  number > 0 ? sentence.number(2, number) : sentence.empty();
}

void put_optional(Sentence& sentence, int digits, const std::optional<int>& value) {
  value ? sentence.number(digits, *value) : sentence.empty();
}

Sentence gsv_page(const Epoch& epoch, const Set& set, int page) {
  Sentence sentence = begin_sentence(gsv_talker(epoch, set), "GSV");
  const int listed = satellites_in(epoch, set);
  sentence.number(1, pages_of(epoch, set)).number(1, page).number(2, listed);
  const int first = (page - 1) * kSatellitesPerPage;
  const int last = std::min(first + kSatellitesPerPage, listed);
  int at = 0;
  for (const auto& satellite : epoch.satellites) {
    if (!belongs(epoch, satellite, set)) {
      continue;
    }
    if (at >= first && at < last) {
      put_number(sentence, satellite.number);
      put_optional(sentence, 2, satellite.elevation_deg);
      put_optional(sentence, 3, satellite.azimuth_deg);
      put_optional(sentence, 2, satellite.cn0_dbhz);
    }
    ++at;
  }
  if (has_identifiers(epoch)) {
    sentence.hexadecimal(set.signal.value_or(0));
  }
  return sentence;
}

/// Calls put(satellite) for the used satellites of a group, 12 at most, and fills up with empty
/// fields. A satellite with several signals counts once.
template <class Put>
void put_used(Sentence& sentence, const Epoch& epoch, const std::optional<System>& group,
              Put&& put) {
  int slots = 0;
  const SatelliteInView* before = nullptr;
  for (const auto& satellite : epoch.satellites) {
    const bool again = before != nullptr && before->system == satellite.system &&
                       before->number == satellite.number;
    if (satellite.used && !again && slots < kUsedSlots &&
        belongs(epoch, satellite, {group, std::nullopt})) {
      put(satellite);
      ++slots;
      before = &satellite;
    }
  }
  for (; slots < kUsedSlots; ++slots) {
    sentence.empty();
  }
}

// PUBX.

constexpr int kLongestLock_s = 64;

std::string_view navigation_state(const Epoch& epoch) {
  if (!has_fix(epoch)) {
    return "NF";
  }
  const bool corrected = epoch.differential || epoch.carrier != CarrierFix::none;
  return epoch.fix_dimensions == 3 ? (corrected ? "D3" : "G3") : (corrected ? "D2" : "G2");
}

}  // namespace

Sentence write_rmc(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "RMC");
  put_time(sentence, epoch.time);
  sentence.field(status(epoch));
  put_position(sentence, epoch);
  if (has_fix(epoch)) {
    sentence.decimal(3, epoch.ground_speed_mps * kKnotsPerMps);
    put_optional_course(sentence, epoch);
  } else {
    sentence.empty().empty();
  }
  put_date(sentence, epoch.date);
  sentence.empty().empty();
  put_mode(sentence, epoch, true);
  put_navigational_status(sentence, epoch);
  return sentence;
}

Sentence write_vtg(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "VTG");
  if (has_fix(epoch)) {
    const double knots = epoch.ground_speed_mps * kKnotsPerMps;
    put_optional_course(sentence, epoch);
    sentence.field("T").empty().field("M");
    sentence.decimal(3, knots).field("N");
    sentence.decimal(3, knots * kKilometresPerHourPerKnot).field("K");
  } else {
    for (int i = 0; i < 8; ++i) {
      sentence.empty();
    }
  }
  put_mode(sentence, epoch, false);
  return sentence;
}

Sentence write_gga(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "GGA");
  put_time(sentence, epoch.time);
  put_position(sentence, epoch);
  sentence.number(1, quality(epoch));
  sentence.number(2, std::min(epoch.satellites_used, kMostUsedInGga));
  put_dilution(sentence, epoch.horizontal_dilution);
  if (has_fix(epoch)) {
    put_altitude(sentence, epoch);
    sentence.field("M").decimal(1, epoch.separation_m).field("M");
  } else {
    sentence.empty().empty().empty().empty();
  }
  put_corrections(sentence, epoch);
  return sentence;
}

Sentence write_gns(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "GNS");
  put_time(sentence, epoch.time);
  put_position(sentence, epoch);
  std::array<char, 4> modes{};
  const std::size_t told = has_identifiers(epoch) ? 4 : 2;
  constexpr std::array kOrder{System::gps, System::glonass, System::galileo, System::beidou};
  const unsigned systems = epoch.systems != 0     ? epoch.systems
                           : epoch.talker == "GL" ? system_bit(System::glonass)
                                                  : system_bit(System::gps);
  for (std::size_t i = 0; i < told; ++i) {
    const bool on = (systems & system_bit(kOrder[i])) != 0;
    modes[i] = on ? position_mode(epoch, true)[0] : 'N';
  }
  sentence.field({modes.data(), told});
  sentence.number(2, std::min(epoch.satellites_used, kMostUsedInGns));
  put_dilution(sentence, epoch.horizontal_dilution);
  if (has_fix(epoch)) {
    put_altitude(sentence, epoch);
    sentence.decimal(1, epoch.separation_m);
  } else {
    sentence.empty().empty();
  }
  put_corrections(sentence, epoch);
  put_navigational_status(sentence, epoch);
  return sentence;
}

Sentence write_gll(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "GLL");
  put_position(sentence, epoch);
  put_time(sentence, epoch.time);
  sentence.field(status(epoch));
  put_mode(sentence, epoch, false);
  return sentence;
}

Sentence write_zda(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "ZDA");
  put_time(sentence, epoch.time);
  if (epoch.date) {
    sentence.number(2, epoch.date->day).number(2, epoch.date->month);
    sentence.number(4, epoch.date->year);
  } else {
    sentence.empty().empty().empty();
  }
  sentence.field("00").field("00");
  return sentence;
}

Sentence write_dtm(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "DTM");
  sentence.field("W84").empty();
  sentence.field("0.0").field("N").field("0.0").field("E").field("0.0").field("W84");
  return sentence;
}

Sentence write_txt(std::string_view talker, TextKind kind, std::string_view text) {
  Sentence sentence = begin_sentence(talker, "TXT");
  sentence.field("01").field("01").number(2, static_cast<int>(kind)).field(text);
  return sentence;
}

int gsa_sentences(const Epoch& epoch) {
  int count = 0;
  for (const System group : kSatelliteGroups) {
    count += group_is_on(epoch, group) ? 1 : 0;
  }
  return std::max(1, count);
}

Sentence write_gsa(const Epoch& epoch, int n) {
  Sentence sentence = begin_sentence(epoch.talker, "GSA");
  const auto group = nth_group(epoch, n);
  sentence.field("A");
  sentence.number(1, has_fix(epoch) ? epoch.fix_dimensions : 1);
  put_used(sentence, epoch, group, [&](const auto& s) { put_number(sentence, s.number); });
  put_dilution(sentence, epoch.position_dilution);
  put_dilution(sentence, epoch.horizontal_dilution);
  put_dilution(sentence, epoch.vertical_dilution);
  if (has_identifiers(epoch)) {
    sentence.hexadecimal(identifier(epoch, group));
  }
  return sentence;
}

int grs_sentences(const Epoch& epoch) {
  return gsa_sentences(epoch);
}

Sentence write_grs(const Epoch& epoch, int n) {
  Sentence sentence = begin_sentence(epoch.talker, "GRS");
  const auto group = nth_group(epoch, n);
  put_time(sentence, epoch.time);
  sentence.field("1");
  put_used(sentence, epoch, group, [&](const auto& s) {
    s.residual_m ? sentence.decimal(1, *s.residual_m) : sentence.empty();
  });
  if (has_identifiers(epoch)) {
    sentence.hexadecimal(identifier(epoch, group));
    sentence.hexadecimal(static_cast<int>(first_signal(group.value_or(System::gps))));
  }
  return sentence;
}

int gsv_pages(const Epoch& epoch) {
  int pages = 0;
  visit_sets(epoch, [&](const Set& set) {
    pages += pages_of(epoch, set);
    return false;
  });
  return pages;
}

Sentence write_gsv(const Epoch& epoch, int page) {
  std::optional<Sentence> found;
  visit_sets(epoch, [&](const Set& set) {
    const int pages = pages_of(epoch, set);
    if (page > pages) {
      page -= pages;
      return false;
    }
    found = gsv_page(epoch, set, page);
    return true;
  });
  return found ? *found : gsv_page(epoch, {}, page);
}

Sentence write_gst(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "GST");
  put_time(sentence, epoch.time);
  if (!epoch.errors) {
    for (int i = 0; i < 7; ++i) {
      sentence.empty();
    }
    return sentence;
  }
  put_deviation(sentence, epoch.errors->range_m);
  sentence.empty().empty().empty();  // the ellipse
  put_deviation(sentence, epoch.errors->latitude_m);
  put_deviation(sentence, epoch.errors->longitude_m);
  put_deviation(sentence, epoch.errors->altitude_m);
  return sentence;
}

Sentence write_gbs(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "GBS");
  put_time(sentence, epoch.time);
  if (epoch.errors && has_fix(epoch)) {
    sentence.decimal(1, epoch.errors->latitude_m).decimal(1, epoch.errors->longitude_m);
    sentence.decimal(1, epoch.errors->altitude_m);
  } else {
    sentence.empty().empty().empty();
  }
  sentence.empty().empty().empty().empty();
  if (has_identifiers(epoch)) {
    sentence.empty().empty();
  }
  return sentence;
}

Sentence write_pubx_position(const Epoch& epoch) {
  Sentence sentence("PUBX");
  sentence.field("00");
  put_time(sentence, epoch.time);
  const bool fix = has_fix(epoch);
  Epoch shown;
  shown.precision = epoch.precision;
  if (fix) {
    shown = epoch;
  }
  put_coordinates(sentence, shown);
  sentence.decimal(3, shown.altitude_m + shown.separation_m);
  sentence.field(navigation_state(epoch));
  put_deviation(sentence, epoch.horizontal_accuracy_m);
  put_deviation(sentence, epoch.vertical_accuracy_m);
  sentence.decimal(3, shown.ground_speed_mps * kKnotsPerMps * kKilometresPerHourPerKnot);
  put_course(sentence, shown.course_deg.value_or(0.0));
  sentence.decimal(3, shown.down_velocity_mps);
  fix&& epoch.differential_age_s ? sentence.decimal(1, *epoch.differential_age_s)
                                 : sentence.empty();
  put_dilution(sentence, epoch.horizontal_dilution);
  put_dilution(sentence, epoch.vertical_dilution);
  put_dilution(sentence, epoch.time_dilution);
  sentence.number(1, epoch.satellites_used).field("0").field("0");
  return sentence;
}

Sentence write_pubx_satellites(const Epoch& epoch) {
  Sentence sentence("PUBX");
  sentence.field("03");
  const auto listed = epoch.satellites.first(
      std::min(epoch.satellites.size(), static_cast<std::size_t>(kMostPubxSatellites)));
  sentence.number(2, static_cast<int>(listed.size()));
  for (const auto& satellite : listed) {
    sentence.number(1, satellite.single_number);
    sentence.field(satellite.used ? "U" : satellite.ephemeris ? "e" : "-");
    put_optional(sentence, 3, satellite.azimuth_deg);
    put_optional(sentence, 2, satellite.elevation_deg);
    put_optional(sentence, 2, satellite.cn0_dbhz);
    sentence.number(3, std::clamp(satellite.locked_s, 0, kLongestLock_s));
  }
  return sentence;
}

Sentence write_pubx_time(const Epoch& epoch, const PubxTime& time) {
  Sentence sentence("PUBX");
  sentence.field("04");
  put_time(sentence, epoch.time);
  put_date(sentence, epoch.date);
  sentence.field(Digits()
                     .put(1, time.time_of_week_hundredths / 100)
                     .point()
                     .put(2, time.time_of_week_hundredths % 100)
                     .text());
  sentence.number(1, time.week);
  Digits leap;
  leap.put(1, time.leap_seconds);
  sentence.field(time.leap_seconds_received ? leap.text() : leap.letter('D').text());
  sentence.decimal(0, time.clock_bias_ns).decimal(3, time.clock_drift_nsps);
  sentence.number(2, time.pulse_granularity_ns);
  return sentence;
}

}  // namespace rigwire::protocols::nmea
