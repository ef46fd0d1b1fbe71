// What the program believes, one JSON object per line; docs/field-program.md lists the keys. The
// figures are those of the wires: nothing here knows the truth.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "dig_cycle/cycle.h"
#include "field/gnss_wire.h"

namespace rigwire::dig_cycle {

struct LogEntry {
  double uptime_s = 0.0;                         ///< Monotonic, since the program's start.
  std::optional<std::uint32_t> time_of_hour_us;  ///< Of the newest lidar packet.
  std::string_view state;                        ///< "waiting", "working", "holding".
  std::string_view phase;
  std::uint64_t cycles = 0;
  Belief belief;
  CycleOutput output;
  PerJoint spool{};
  field::GnssFixBelief gnss;
  std::optional<double> nearest_range_m;
  std::optional<double> ground_z_m;
};

/// One line without its end.
[[nodiscard]] std::string to_json(const LogEntry& entry);

}  // namespace rigwire::dig_cycle
