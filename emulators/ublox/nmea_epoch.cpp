#include "emulators/ublox/nmea_epoch.h"

#include <algorithm>
#include <cmath>

#include "emulators/ublox/wire_units.h"
#include "fields/constants.h"
#include "protocols/nmea/satellite_numbers.h"

namespace rigwire::emulators {
namespace {

namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

constexpr std::int64_t kHundredth_ns = 10'000'000;

// CFG-NMEA filter.
constexpr unsigned kInvalidTime = 2;
constexpr unsigned kInvalidDate = 3;
constexpr unsigned kGpsOnly = 4;
constexpr unsigned kFrozenCourse = 5;

bool has(std::uint8_t bits, unsigned bit) {
  return (bits >> bit & 1U) != 0;
}

unsigned enabled_systems(const UbloxConfiguration& configuration) {
  unsigned systems = 0;
  for (const auto system : {GnssSystem::gps, GnssSystem::sbas, GnssSystem::galileo,
                            GnssSystem::beidou, GnssSystem::qzss, GnssSystem::glonass}) {
    if (configuration.enabled(system)) {
      systems |= nmea::system_bit(static_cast<nmea::System>(system));
    }
  }
  return systems;
}

/// By CFG-NMEA mainTalkerId; 0 = by the systems.
std::string_view talker_of(std::uint8_t wanted, unsigned systems, nmea::Version version) {
  constexpr std::array<std::string_view, 7> kTalkers{"", "GP", "GL", "GN", "GA", "GB", "GQ"};
  return wanted == 0 || wanted >= kTalkers.size() ? nmea::main_talker(systems, version)
                                                  : kTalkers[wanted];
}

/// CFG-NMEA gnssToFilter.
bool filtered(std::uint32_t systems, GnssSystem system) {
  constexpr std::array<int, 7> kBits{0, 1, 2, 6, -1, 4, 5};
  const int bit = kBits[static_cast<std::size_t>(system)];
  return bit >= 0 && (systems >> bit & 1U) != 0;
}

int locked_seconds(const UbloxSolution& s, const SatelliteView& view) {
  if (s.sample == nullptr || !view.tracked) {
    return 0;
  }
  const auto& all = s.sample->measurements;
  const auto found = std::ranges::find_if(all, [&](const GnssMeasurement& m) {
    return m.system == view.system && m.number == view.number;
  });
  return found == all.end() ? 64 : static_cast<int>(std::min(to_seconds(found->locked), 64.0));
}

nmea::ErrorStatistics statistics_of(const UbloxSolution& s) {
  const auto& covariance = s.position_covariance_ned_m2;
  nmea::ErrorStatistics errors;
  errors.latitude_m = std::sqrt(std::max(0.0, covariance[0]));
  errors.longitude_m = std::sqrt(std::max(0.0, covariance[3]));
  errors.altitude_m = std::sqrt(std::max(0.0, covariance[5]));
  const bool diluted = s.horizontal_dilution > 0.0;
  errors.range_m = diluted ? s.horizontal_accuracy_m / s.horizontal_dilution : 0.0;
  return errors;
}

std::optional<nmea::SatelliteInView> in_view(const UbloxSolution& s, const SatelliteView& view,
                                             nmea::Version version, nmea::Numbering numbering) {
  if (view.system == GnssSystem::imes) {
    return std::nullopt;
  }
  const auto system = static_cast<nmea::System>(view.system);
  const auto number = nmea::satellite_number(system, view.number, version, numbering);
  if (!number) {
    return std::nullopt;
  }
  nmea::SatelliteInView satellite;
  satellite.number = *number;
  satellite.system = system;
  satellite.signal = view.tracked ? nmea::first_signal(system) : std::uint8_t{0};
  satellite.single_number = nmea::single_satellite_number(system, view.number);
  satellite.ephemeris = s.orbits_known;
  satellite.locked_s = locked_seconds(s, view);
  if (s.orbits_known) {
    satellite.elevation_deg = to_field<int>(view.elevation_rad, kDegree);
    satellite.azimuth_deg = to_field<int>(view.azimuth_rad, kDegree) % 360;
  }
  if (view.tracked) {
    satellite.cn0_dbhz = to_field<int>(std::clamp(view.cn0_dbhz, 0.0, 99.0), 1.0);
  }
  satellite.used = view.used;
  if (view.used) {
    satellite.residual_m = view.residual_m;
  }
  return satellite;
}

}  // namespace

nmea::Epoch nmea_epoch(const UbloxSolution& s, const UbloxConfiguration& configuration,
                       std::vector<nmea::SatelliteInView>& list) {
  const auto& settings = configuration.nmea();
  nmea::Epoch epoch;
  epoch.version = static_cast<nmea::Version>(settings.version);
  epoch.precision = (settings.flags & ubx::kNmeaHighPrecision) != 0 ? nmea::Precision::high
                    : (settings.flags & ubx::kNmeaCompatible) != 0  ? nmea::Precision::compatible
                                                                    : nmea::Precision::normal;
  const unsigned systems = enabled_systems(configuration);
  constexpr int kSeveralSystems = 8;  // first generation whose sentences distinguish systems
  epoch.systems = configuration.profile().generation >= kSeveralSystems ? systems : 0;
  epoch.talker = talker_of(settings.main_talker, systems, epoch.version);
  epoch.gsv_main_talker = settings.gsv_talker == 1;
  epoch.maximum_satellites = settings.maximum_satellites;
  if (s.time_known || has(settings.filter, kInvalidTime)) {
    epoch.time = nmea::TimeOfDay{s.utc.hour, s.utc.minute, s.utc.second,
                                 static_cast<int>(s.utc.nanosecond / kHundredth_ns)};
  }
  if (s.date_known || has(settings.filter, kInvalidDate)) {
    epoch.date = nmea::Date{s.utc.year, s.utc.month, s.utc.day};
  }
  epoch.fix_dimensions = s.fix_ok ? s.dimensions : 0;
  epoch.differential = s.differential;
  epoch.differential_age_s = s.differential_age_s;
  epoch.station = s.base ? s.base->station : 0;
  if (configuration.profile().carrier_solution) {
    epoch.carrier = static_cast<nmea::CarrierFix>(s.carrier);
  }
  epoch.latitude_deg = s.latitude_deg;
  epoch.longitude_deg = s.longitude_deg;
  epoch.altitude_m = s.ellipsoid_height_m - s.geoid_separation_m;
  epoch.separation_m = s.geoid_separation_m;
  epoch.ground_speed_mps = std::hypot(s.velocity_ned_mps.x, s.velocity_ned_mps.y);
  epoch.down_velocity_mps = s.velocity_ned_mps.z;
  if (!s.heading_frozen || has(settings.filter, kFrozenCourse)) {
    epoch.course_deg = s.heading_deg;
  }
  epoch.satellites_used = s.satellites_used;
  const auto known = [](double dilution) {
    return std::isnan(dilution) ? std::nullopt : std::optional(dilution);
  };
  epoch.position_dilution = known(s.position_dilution);
  epoch.horizontal_dilution = known(s.horizontal_dilution);
  epoch.vertical_dilution = known(s.vertical_dilution);
  epoch.time_dilution = known(s.time_dilution);
  epoch.horizontal_accuracy_m = s.horizontal_accuracy_m;
  epoch.vertical_accuracy_m = s.vertical_accuracy_m;
  if (s.fix_ok) {
    epoch.errors = statistics_of(s);
  }
  list.clear();
  for (const auto& view : s.satellites) {
    if ((has(settings.filter, kGpsOnly) && view.system != GnssSystem::gps) ||
        filtered(settings.systems_to_filter, view.system)) {
      continue;
    }
    const auto satellite =
        in_view(s, view, epoch.version, static_cast<nmea::Numbering>(settings.satellite_numbering));
    if (satellite && (satellite->elevation_deg || satellite->cn0_dbhz)) {
      list.push_back(*satellite);
    }
  }
  epoch.satellites = list;
  return epoch;
}

nmea::PubxTime pubx_time(const UbloxSolution& s) {
  constexpr std::int64_t kWeek_hundredths = 60'480'000;
  nmea::PubxTime time;
  const std::int64_t of_week_ns =
      std::int64_t{s.time_of_week_ms} * 1'000'000 + s.time_of_week_rest_ns + kHundredth_ns / 2;
  std::int64_t hundredths = of_week_ns / kHundredth_ns - std::int64_t{s.leap_seconds} * 100;
  time.week = s.week;
  if (hundredths < 0) {
    hundredths += kWeek_hundredths;
    time.week -= s.date_known ? 1 : 0;
  }
  time.time_of_week_hundredths = hundredths % kWeek_hundredths;
  time.leap_seconds = s.leap_seconds;
  time.leap_seconds_received = s.leap_known;
  time.clock_bias_ns = s.clock_bias_s * 1e9;
  time.clock_drift_nsps = s.clock_drift * 1e9;
  constexpr int kTick_ns = 21;  // 48 MHz
  time.pulse_granularity_ns = kTick_ns;
  return time;
}

}  // namespace rigwire::emulators
