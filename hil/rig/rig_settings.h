// The settings of a running rig's devices: those keys of their configuration, as in the rig's file,
// that can be changed while a device runs (hil/devices/live_settings.h).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/configuration/document.h"
#include "hil/configuration/problems.h"
#include "hil/devices/device.h"
#include "hil/devices/device_configuration.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

class RigSettings {
 public:
  /// `configuration` is the one that the device was made with. The device must outlive this.
  void add(const std::string& name, const DeviceConfiguration& configuration, Device& device);

  /// Returns the names of the devices with settings, in the order in which they were added.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Returns the keys of that device that can be set; empty: none.
  [[nodiscard]] std::vector<LiveKey> keys(const std::string& name) const;

  /// Returns the value of one of keys() as a rig's file has it: the configured one or the last one
  /// set. Changes by a client on the device's wire are not included.
  [[nodiscard]] std::string value(const std::string& name, std::string_view key) const;

  /// Result of a request.
  struct Outcome {
    struct Told {
      std::string key;
      std::string value;  ///< Value as it was written.
    };
    std::vector<Told> told;  ///< Keys that were set.
    /// Problem with this key; the keys behind it in keys() were not set.
    std::optional<Problem> refused;
    bool by_device = false;  ///< True: refused by the device in its present state.
  };
  /// Sets the keys of that map at device `name`. Checks them like those of a rig's file, together
  /// with the device's configuration and what has been set since; an error refuses all of them.
  /// Then passes them to the device one after the other, until it refuses one. Precondition: the
  /// device is one of names().
  [[nodiscard]] Outcome tell(SimTime now, const std::string& name, const Value& keys);

 private:
  struct Entry {
    std::string name;
    std::unique_ptr<DeviceConfiguration> configuration;
    Device* device;
  };

  std::vector<Entry> entries_;
};

}  // namespace rigwire::hil
