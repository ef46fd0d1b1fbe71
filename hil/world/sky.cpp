#include "hil/world/sky.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/gps_broadcast.h"
#include "fields/check.h"
#include "fields/visitor.h"
#include "hil/configuration/outside_file.h"
#include "protocols/rinex/navigation.h"
#include "protocols/rinex/yuma.h"

namespace rigwire::hil {

namespace {

/// Systems that have nominal slots.
constexpr std::array<fields::Choice<GnssSystem>, 6> kSatelliteSystems{
    {{GnssSystem::gps, "gps", "24 slots, with broadcast orbits and clocks."},
     {GnssSystem::sbas, "sbas", "Standing satellites of EGNOS, WAAS, MSAS, GAGAN."},
     {GnssSystem::galileo, "galileo", "Walker 24/3/1."},
     {GnssSystem::beidou, "beidou", "Medium orbits, Walker 24/3/1."},
     {GnssSystem::qzss, "qzss", "Three inclined, one standing."},
     {GnssSystem::glonass, "glonass", "Walker 24/3/1."}}};

}  // namespace

void visit(fields::Visitor& v, SatellitesConfiguration& p) {
  v.file("file", p.file, fields::FileKind::satellites,
         "RINEX navigation file or YUMA almanac of GPS; empty = nominal slots.");
  v.only_if(p.file.empty(), "file", "no file, which holds GPS alone", [&p](fields::Visitor& keys) {
    keys.texts("systems", p.systems,
               "Systems in nominal slots: gps sbas galileo beidou qzss glonass.");
  });
}

std::vector<GnssSystem> systems_of(const SatellitesConfiguration& p) {
  std::vector<GnssSystem> systems;
  for (const std::string& name : p.systems) {
    const auto found = std::ranges::find(kSatelliteSystems, std::string_view(name),
                                         &fields::Choice<GnssSystem>::name);
    if (found == kSatelliteSystems.end()) {
      throw std::invalid_argument("systems has \"" + name +
                                  "\", allowed gps, sbas, galileo, beidou, qzss, glonass");
    }
    if (std::ranges::find(systems, found->value) != systems.end()) {
      throw std::invalid_argument("systems has \"" + name + "\" twice");
    }
    systems.push_back(found->value);
  }
  if (systems.empty()) {
    throw std::invalid_argument(
        "systems is empty, allowed gps, sbas, galileo, beidou, qzss, glonass");
  }
  return systems;
}

void validate(const SatellitesConfiguration& configuration) {
  fields::check(configuration);
  if (configuration.file.empty()) {
    (void)systems_of(configuration);
  }
}
namespace {

/// A coarse orbit as a broadcast set of its own reference time.
GpsEphemeris as_broadcast_set(const protocols::gps::Almanac& from) {
  GpsEphemeris to;
  to.prn = from.prn;
  to.week = from.week;
  to.issue_of_clock = 1;
  to.issue_of_ephemeris = 1;
  to.health = from.health == 0 ? std::uint8_t{0} : std::uint8_t{0x3F};
  to.clock_time_s = from.almanac_time_s;
  to.clock_bias_s = from.clock_bias_s;
  to.clock_drift = from.clock_drift;
  to.ephemeris_time_s = from.almanac_time_s;
  to.sqrt_semi_major_axis = from.sqrt_semi_major_axis;
  to.eccentricity = from.eccentricity;
  to.mean_anomaly_rad = from.mean_anomaly_rad;
  to.ascending_node_rad = from.ascending_node_rad;
  to.inclination_rad = from.inclination_rad;
  to.argument_of_perigee_rad = from.argument_of_perigee_rad;
  to.ascending_node_rate = from.ascending_node_rate;
  return to;
}

GpsUtcParameters utc_of(const Calendar& start) {
  GpsUtcParameters utc;
  utc.reference_week = start.gps(kStart).week;
  utc.leap_seconds = start.leap_seconds(kStart);
  utc.leap_week = utc.reference_week;
  utc.leap_seconds_future = utc.leap_seconds;
  return utc;
}

std::string content(const std::filesystem::path& file) {
  try {
    return read_outside_file(file, kSatellitesFile);
  } catch (const FileRefused& refused) {
    throw std::invalid_argument("satellite file " + file.string() + ": " + refused.rest());
  }
}

bool is_rinex(std::string_view text) {
  constexpr std::size_t kLabelColumn = 60;
  const std::string_view first = text.substr(0, text.find('\n'));
  return first.size() > kLabelColumn &&
         first.substr(kLabelColumn).starts_with("RINEX VERSION / TYPE");
}

}  // namespace

std::shared_ptr<const sim::Constellation> load_satellites(const std::filesystem::path& file,
                                                          const Calendar& start) {
  const std::string text = content(file);
  std::vector<GpsEphemeris> sets;
  KlobucharParameters ionosphere;
  GpsUtcParameters utc = utc_of(start);
  if (is_rinex(text)) {
    const auto navigation = protocols::rinex::read_navigation(text, file.string());
    for (const auto& record : navigation.records) {
      sets.push_back(emulators::to_sample(record.ephemeris));
    }
    if (navigation.has_ionosphere) {
      ionosphere = emulators::klobuchar_of(navigation.ionosphere_utc);
    }
    if (navigation.has_utc && navigation.has_leap_seconds) {
      utc = emulators::utc_of(navigation.ionosphere_utc);
    }
  } else {
    const auto yuma = protocols::rinex::read_yuma(text, file.string(), start.gps(kStart).week);
    for (const auto& almanac : yuma.almanacs) {
      sets.push_back(as_broadcast_set(almanac));
    }
  }
  try {
    return sim::make_gps_constellation(sets, ionosphere, utc);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("satellite file " + file.string() + ": " + error.what());
  }
}

std::shared_ptr<const sim::Constellation> make_satellites(
    const SatellitesConfiguration& configuration, const Calendar& start) {
  return configuration.file.empty() ? sim::make_nominal_constellation(systems_of(configuration))
                                    : load_satellites(configuration.file, start);
}

}  // namespace rigwire::hil
