// Telling whoever started a run that every wire is open.
#pragma once

#include <string>

namespace rigwire::hil {

/// Whether a descriptor is there to be written. Asked before anything is opened, which could get
/// its number.
[[nodiscard]] bool can_be_written(int descriptor);

/// Writes `line` and its end to the descriptor and closes it; a reader that has gone is no fault of
/// the run. Precondition: can_be_written(descriptor).
void tell_ready(int descriptor, const std::string& line);

/// Tells a service manager, where the environment names one (sd_notify(3), NOTIFY_SOCKET).
void notify_service_manager();

}  // namespace rigwire::hil
