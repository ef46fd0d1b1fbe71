// The page at "/" of the sensor's web interface: for somebody who wants to look and to try, with
// the settings as forms. The words are ours; only the requests that the forms send are the
// sensor's.
#pragma once

#include <string>

#include "emulators/velodyne/velodyne_control.h"

namespace rigwire::emulators {

[[nodiscard]] std::string control_page(SimTime now, const VelodyneControl& control);

}  // namespace rigwire::emulators
