// Motion out of a CSV: a line of names, then one for each instant, by its columns (docs/replay.md
// has the table). With `sim_s` the zero is the start of a run.
#pragma once

#include "hil/files/motion_contents.h"
#include "sim/local_frame.h"
#include "sim/machine.h"

namespace rigwire::hil {

/// Arguments and errors as read_motion() has them (hil/files/motion_file.h).
void read_csv_motion(const MotionSettings& settings, MotionContents& contents,
                     const sim::Machine& model, const sim::LocalFrame& frame);

}  // namespace rigwire::hil
