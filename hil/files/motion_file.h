// The motion of a machine, out of a file, for a machine that is moved by it
// (sim/replay/replayed_machine.h).
//
// Formats: MCAP (hil/files/motion_mcap.h) and CSV (hil/files/motion_csv.h).
//
// Zero. A recording's is the start of its run (`sim_s`), any other file's its first instant. An
// instant t of the file is played at t - zero - start + offset.
#pragma once

#include <string>

#include "fields/visitor.h"
#include "sim/local_frame.h"
#include "sim/machine.h"
#include "sim/replay/replayed_machine.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

struct MotionSettings {
  std::string file;    ///< Empty: the machine moves itself.
  std::string frame;   ///< What the file calls the first link; empty: as the machine does.
  Duration start{0};   ///< Where the piece begins, from the file's zero.
  Duration offset{0};  ///< From the run's start to the piece's.
  /// Standard deviation of the window that smooths recorded poses; 0: not smoothed.
  Duration smoothing{0};
};
void visit(fields::Visitor& v, MotionSettings& p);

/// `model` is the machine at rest whose links, ports and fields are looked for. Throws
/// drivers::EndpointError where the file cannot be read, std::invalid_argument naming file, line or
/// topic and what is wrong there.
[[nodiscard]] sim::MachineRecord read_motion(const MotionSettings& settings, sim::Machine& model,
                                             const sim::LocalFrame& frame);

}  // namespace rigwire::hil
