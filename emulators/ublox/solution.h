// What an emulated NEO-7P knows at one navigation epoch, and its form in every message that it
// prints: conversion from SI to wire units happens here, once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/ublox/profile.h"
#include "protocols/nmea/position_sentences.h"
#include "protocols/ubx/frame.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

struct UbloxSolution {
  bool time_known = false;            ///< Time of day.
  bool date_known = false;            ///< Date and week.
  bool orbits_known = false;          ///< Elevation and azimuth of satellites can be said.
  std::uint32_t time_of_week_ms = 0;  ///< Nearest; milliseconds since start while time is unknown.
  std::int32_t time_of_week_rest_ns = 0;  ///< Epoch less time_of_week_ms.
  std::int32_t week = 0;
  std::int32_t leap_seconds = 0;
  UtcTime utc;                   ///< Rounded to 1/100 s, so that 23:59:59.996 is the next day.
  std::int32_t utc_rest_ns = 0;  ///< Epoch less the full second in `utc`; may be negative.
  std::uint32_t since_start_ms = 0;
  std::uint32_t first_fix_ms = 0;  ///< 0 while there was none.

  int dimensions = 0;  ///< 0 without fix, 2, 3. Position is then the last one.
  bool has_position = false;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double ellipsoid_height_m = 0.0;
  double geoid_separation_m = 0.0;
  Vector3 velocity_ned_mps;
  double heading_deg = 0.0;  ///< Of motion, 0..360; the last one while frozen.
  double heading_accuracy_deg = 180.0;
  bool heading_frozen = true;
  double horizontal_accuracy_m = std::numeric_limits<double>::infinity();
  double vertical_accuracy_m = std::numeric_limits<double>::infinity();
  double speed_accuracy_mps = std::numeric_limits<double>::infinity();
  double time_accuracy_s = std::numeric_limits<double>::infinity();
  double clock_bias_s = 0.0;
  double clock_drift = 0.0;
  double horizontal_dilution = std::numeric_limits<double>::quiet_NaN();
  double vertical_dilution = std::numeric_limits<double>::quiet_NaN();
  double position_dilution = std::numeric_limits<double>::quiet_NaN();
  double time_dilution = std::numeric_limits<double>::quiet_NaN();
  std::vector<SatelliteView> satellites;
  int satellites_used = 0;
};

/// Room for the longest UBX frame of this file.
inline constexpr std::size_t kLongestSolutionFrame = 8 + 8 + 12 * 32;

/// Fills the time fields from the epoch.
void set_time(UbloxSolution& solution, const Calendar& calendar, SimTime epoch);

/// Writes the UBX frame of a message of class NAV, or MON-HW, and returns its size; 0 when there is
/// no such message here. Values beyond a field's range are clamped to it. Precondition: out.size()
/// >= kLongestSolutionFrame.
[[nodiscard]] std::size_t encode_solution(const UbloxSolution& solution,
                                          const UbloxProfile& profile, protocols::ubx::MessageId id,
                                          std::span<std::uint8_t> out);

/// The same epoch for the NMEA writers; `list` holds its satellites.
[[nodiscard]] protocols::nmea::Epoch nmea_epoch(
    const UbloxSolution& solution, std::string_view talker, bool with_mode,
    std::vector<protocols::nmea::SatelliteInView>& list);

}  // namespace rigwire::emulators
