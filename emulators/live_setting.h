// What can be told to a device while it runs: keys of its settings that its own configuration
// software changes over the wire, told by the same way in the device.
//
// The message that would bring it is not on the wire, and so is no answer: it is as if it had come
// by another port of the device. What follows from it is what would follow there, and what the
// device keeps when its supply goes is what it would keep.
#pragma once

#include <string_view>

#include "sim/samples/time.h"

namespace rigwire::emulators {

/// One key. A device lists its rows as `live_settings()`, in the order in which they are told when
/// several are.
template <class Device, class Settings>
struct LiveSetting {
  std::string_view key;  ///< As the settings' visit() has it, "fov.start" within a group.
  std::string_view by;   ///< How the device's own software tells it: "CFG-RATE".
  /// At `now`, as `wanted` has it, which is valid. Why the device does not take it; empty: it has.
  std::string_view (*tell)(Device& device, SimTime now, const Settings& wanted);
};

}  // namespace rigwire::emulators
