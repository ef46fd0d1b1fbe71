// The types of devices that there are. A new one is a class in this folder and a row of the list in
// device_types.cpp.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "fields/box.h"
#include "fields/rules.h"
#include "hil/devices/device_configuration.h"

namespace rigwire::hil {

struct DeviceType {
  fields::Named named;  ///< As the key `type` writes it.
  std::unique_ptr<DeviceConfiguration> (*fresh)();
};

/// In the order in which `rigwire list devices` shows them.
[[nodiscard]] std::span<const DeviceType> device_types();

/// A device of the rig: its type and the settings of that type.
class ConfiguredDevice {
 public:
  /// Of the first type.
  ConfiguredDevice();
  explicit ConfiguredDevice(const DeviceType& type);

  [[nodiscard]] std::string_view type() const { return type_->named.name; }
  [[nodiscard]] std::string_view type_text() const { return type_->named.text; }
  [[nodiscard]] std::size_t type_index() const;
  /// Of that row of device_types(), with its defaults; what is there is kept when it is of the
  /// type.
  void choose(std::size_t index);

  [[nodiscard]] DeviceConfiguration& settings() { return *settings_; }
  [[nodiscard]] const DeviceConfiguration& settings() const { return *settings_; }

 private:
  const DeviceType* type_;
  fields::Box<DeviceConfiguration> settings_;
};

void visit(fields::Visitor& v, ConfiguredDevice& p);

/// The settings, when they are of the class `Settings`; else null.
template <class Settings>
[[nodiscard]] const Settings* settings_as(const ConfiguredDevice& device) {
  return dynamic_cast<const Settings*>(&device.settings());
}

}  // namespace rigwire::hil
