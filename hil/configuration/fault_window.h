// When a fault of a rig's file acts, whatever it does: for the status table, the summary and the
// report.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fields/visitor.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

struct FaultWindow {
  std::string where;  ///< Name of the device; "bus can", "modbus cab".
  std::string type;   ///< As in the rig's file: "jamming"; of a node on a bus with its name.
  SimTime begin{};    ///< It acts in [begin, end).
  SimTime end{};      ///< kNever: to the end of the run.

  [[nodiscard]] bool acts_at(SimTime now) const { return begin <= now && now < end; }

  friend bool operator==(const FaultWindow&, const FaultWindow&) = default;
};

/// The windows of a list of faults.
template <class Fault>
[[nodiscard]] std::vector<FaultWindow> fault_windows(const std::vector<Fault>& faults,
                                                     std::string_view where) {
  std::vector<FaultWindow> windows;
  for (const Fault& fault : faults) {
    windows.push_back({std::string(where), std::string(fields::chosen_name(fault.what)),
                       fault.when.begin(), fault.when.end()});
  }
  return windows;
}

}  // namespace rigwire::hil
