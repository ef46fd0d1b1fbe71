// What can be set at a running rig's devices: keys of their configuration, as in the rig's file, of
// those that a device can be told while it runs (hil/devices/live_settings.h).
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
  /// `configuration` is what the device was made of. The device must outlive this.
  void add(const std::string& name, const DeviceConfiguration& configuration, Device& device);

  /// Of the devices that can be told something, in the order in which they were added.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Of that device; empty where there is none.
  [[nodiscard]] std::vector<LiveKey> keys(const std::string& name) const;

  /// Of one of keys(): what the device was made of or has been set since, as a rig's file has it.
  /// What a client has changed on its wire is not known here.
  [[nodiscard]] std::string value(const std::string& name, std::string_view key) const;

  /// What became of a request.
  struct Outcome {
    struct Told {
      std::string key;
      std::string value;  ///< As it was written.
    };
    std::vector<Told> told;          ///< They hold.
    std::optional<Problem> refused;  ///< This key; what follows it in keys() was not told.
    bool by_device = false;          ///< By the device, as it is now.
  };
  /// Tells device `name` the keys of that map. They are checked as those of a rig's file are,
  /// beside what the device was made of and what has been set since; what is wrong there refuses
  /// all of them. Then the device is told one after the other, until it refuses one.
  /// Precondition: the device is one of names().
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
