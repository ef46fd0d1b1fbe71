// What `rigwire describe` says of each device type: its messages, and the document it follows. The
// units, ranges and resolutions come from the emulator itself (Device::quantities()), the keys from
// the visit functions.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/device.h"

namespace rigwire::hil {

struct DeviceMessage {
  std::string name;
  std::string rate;
  std::string content;
};

/// A quantity with its texts owned, as the device it was asked of is gone.
struct DescribedQuantity {
  std::string name;
  std::string unit;
  double lower = 0.0;
  double upper = 0.0;
  double resolution = 0.0;
};

struct DeviceDescription {
  std::string type;
  std::string text;
  std::string wire;
  std::string document;  ///< Title, revision, sections.
  std::string page;      ///< In docs/.
  std::vector<DeviceMessage> messages;
  std::vector<DescribedQuantity> quantities;  ///< With default settings.
  std::string keys;                           ///< Reference of the configuration keys.
};

/// All device types in the order of DeviceSettings.
[[nodiscard]] std::vector<DeviceDescription> device_catalogue();

}  // namespace rigwire::hil
