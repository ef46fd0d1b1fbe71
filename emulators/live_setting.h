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

/// One key that can be changed while running. A device lists its rows as `live_settings()`, in the
/// order in which several changes are applied.
template <class Device, class Settings>
struct LiveSetting {
  std::string_view key;  ///< Key in the settings' visit(), "fov.start" within a group.
  std::string_view by;   ///< Name of the setting in the device's own protocol: "CFG-RATE".
  /// Applies the value of `wanted`, which is valid, at `now`. Returns why the device refuses it;
  /// empty if it is accepted.
  std::string_view (*tell)(Device& device, SimTime now, const Settings& wanted);
};

}  // namespace rigwire::emulators
