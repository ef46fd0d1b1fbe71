// Compares the GPS time in a recorded file with the instants that the recorder wrote, so that files
// of several recorders, each with a clock of its own, are played in step.
//
//   file                             source of the time
//   log or capture of a receiver     RMC and ZDA that are valid, UBX NAV-PVT and NAV-TIMEUTC with a
//     (serial or UDP)                known date
//   capture of a Velodyne            the position packets' microseconds past the hour, with the
//                                    hour of the valid GPRMC in them
//   candump log, capture of CAN      its own stamps, where they count from 1970
//
// The time is UTC. The message was recorded a little later than the instant that it reports; of all
// in a file's first minute the one with the minimum delay counts. That delay remains as an error:
// of a receiver 20 to 200 ms from the epoch to the end of the message, less what the line's speed
// explains; of a lidar below a millisecond.
#pragma once

#include <cstdint>
#include <string_view>

#include "hil/files/replay_reader.h"

namespace rigwire::hil {

struct GpsAlignment {
  std::int64_t ahead_ns = 0;      ///< GPS time (UTC, ns since 1970) less the file's instant.
  std::int64_t first_utc_ns = 0;  ///< UTC of the file's first unit, ns since 1970.
  std::string_view by;            ///< Kind of message that gave `ahead_ns`.
  std::uint64_t told = 0;         ///< Number of units that gave a time.
};

/// Throws as open_replay_reader(), and std::invalid_argument when the file contains no time.
[[nodiscard]] GpsAlignment find_gps_alignment(const ReplaySourceSettings& settings);

}  // namespace rigwire::hil
