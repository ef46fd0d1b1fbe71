// Settings of a device that can be changed at run time: the keys that its own configuration
// software changes over the wire. The same code in the device applies them.
//
// No message and no answer appear on the wire: the change acts as if its message had come by
// another port of the device, with the same consequences. What the device would keep without supply
// it keeps here, too.
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
