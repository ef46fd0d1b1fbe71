// The epoch in the words of the NMEA writers.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "emulators/ublox/solution.h"
#include "emulators/ublox/wire_units.h"

namespace rigwire::emulators {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::int64_t kHundredth_ns = 10'000'000;

double ground_speed_mps(const UbloxSolution& s) {
  return std::hypot(s.velocity_ned_mps.x, s.velocity_ned_mps.y);
}

}  // namespace

protocols::nmea::Epoch nmea_epoch(const UbloxSolution& s, std::string_view talker, bool with_mode,
                                  std::vector<protocols::nmea::SatelliteInView>& list) {
  protocols::nmea::Epoch epoch;
  epoch.talker = talker;
  epoch.with_mode = with_mode;
  if (s.time_known) {
    epoch.time = protocols::nmea::TimeOfDay{s.utc.hour, s.utc.minute, s.utc.second,
                                            static_cast<int>(s.utc.nanosecond / kHundredth_ns)};
  }
  if (s.date_known) {
    epoch.date = protocols::nmea::Date{s.utc.year, s.utc.month, s.utc.day};
  }
  epoch.fix_dimensions = s.fix_ok ? s.dimensions : 0;
  epoch.differential = s.differential;
  epoch.latitude_deg = s.latitude_deg;
  epoch.longitude_deg = s.longitude_deg;
  epoch.altitude_m = s.ellipsoid_height_m - s.geoid_separation_m;
  epoch.separation_m = s.geoid_separation_m;
  epoch.ground_speed_mps = ground_speed_mps(s);
  if (!s.heading_frozen) {
    epoch.course_deg = s.heading_deg;
  }
  epoch.satellites_used = s.satellites_used;
  const auto known = [](double dilution) {
    return std::isnan(dilution) ? std::nullopt : std::optional(dilution);
  };
  epoch.position_dilution = known(s.position_dilution);
  epoch.horizontal_dilution = known(s.horizontal_dilution);
  epoch.vertical_dilution = known(s.vertical_dilution);
  list.clear();
  for (const auto& view : s.satellites) {
    protocols::nmea::SatelliteInView satellite;
    satellite.number = view.number;
    if (s.orbits_known) {
      satellite.elevation_deg = to_field<int>(view.elevation_rad, kDegree);
      satellite.azimuth_deg = to_field<int>(view.azimuth_rad, kDegree) % 360;
    }
    if (view.tracked) {
      satellite.cn0_dbhz = to_field<int>(std::clamp(view.cn0_dbhz, 0.0, 99.0), 1.0);
    }
    if (satellite.elevation_deg || satellite.cn0_dbhz) {
      satellite.used = view.used;
      list.push_back(satellite);
    }
  }
  epoch.satellites = list;
  return epoch;
}

}  // namespace rigwire::emulators
