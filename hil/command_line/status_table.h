// What a rig does, and what a run came to, as tables for people.
#pragma once

#include <string>
#include <vector>

#include "hil/executive/truth_source.h"
#include "hil/record/report.h"
#include "hil/rig/rig_status.h"

namespace rigwire::hil {

/// Where the table is shown.
struct TableLook {
  bool colour = false;      ///< ANSI: red for drops, yellow for what is out of order.
  std::size_t columns = 0;  ///< No line is wider; 0: as wide as it gets.
  std::size_t lines = 0;    ///< Not more; the last one says how many are missing. 0: any number.

  friend bool operator==(const TableLook&, const TableLook&) = default;
};

/// A RigStatus; lines without their ends. Rates are those between `before` and `now` (per simulated
/// second); one is out of order when it is more than 10 % off its nominal value. A narrow window
/// leaves out lateness, then bytes, then nominal rates, and cuts what clients asked and wires.
/// Nothing in it but the colours can steer a terminal.
[[nodiscard]] std::vector<std::string> draw_status_table(const RigStatus& before,
                                                         const RigStatus& now,
                                                         const std::vector<StateQuantity>& machine,
                                                         const TableLook& look);

/// Returns the report's figures as lines without line ends: the run as a whole (time, slips of the
/// clock, a fault that ended it), a row for each device (frames, bytes, drops, worst lateness, the
/// client's last request), and each fault of the rig's file that acted, with its window. Nothing in
/// it but the colours can steer a terminal.
[[nodiscard]] std::vector<std::string> draw_summary(const RunReport& report, bool colour);

}  // namespace rigwire::hil
