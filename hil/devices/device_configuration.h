// A device type before a run: its keys, whether they fit the rig, what it will send, its
// description. One class per type in this folder, listed in device_types.cpp; a class that leaves a
// function out does not compile. device.h has the device at run time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fields/rules.h"
#include "hil/configuration/fault_window.h"
#include "hil/devices/live_settings.h"
#include "protocols/can/message.h"

namespace rigwire::hil {

class Device;
class RigCheck;
class Site;
struct RigView;

/// What a device will do, in words for `run --dry-run`.
struct DevicePlan {
  std::string wire;   ///< What a client opens.
  std::string sends;  ///< "10 epochs/s".
  std::string bytes;  ///< "720 B/s"; empty where it depends on the client.
  std::string with;   ///< What else is worth knowing.
};

/// What a device does on a CAN bus by itself. Every member comes from the emulator.
struct BusShare {
  std::string bus;   ///< One of the rig's.
  double frames_hz;  ///< Rate as configured, and as if a master had started it.
  std::vector<protocols::can::OwnedMessage> messages;  ///< For the bus's DBC file.
};

struct DeviceMessage {
  std::string name;
  std::string rate;
  std::string content;
};

/// A quantity with copies of its texts, as its device is gone.
struct DescribedQuantity {
  std::string name;
  std::string unit;
  double lower = 0.0;
  double upper = 0.0;
  double resolution = 0.0;
};

/// What `rigwire describe` shows of a type beside its keys.
struct DeviceDescription {
  std::string wire;
  std::string document;  ///< Title, revision, sections.
  std::string page;      ///< In docs/; empty: the page of the type's name.
  std::vector<DeviceMessage> messages;
  std::vector<DescribedQuantity> quantities;
};

/// Returns a receiver's rate for DevicePlan::sends: "1 epoch/s", "10 epochs/s".
[[nodiscard]] std::string epochs_text(double rate_hz);

class DeviceConfiguration {
 public:
  virtual ~DeviceConfiguration() = default;

  /// Visits its keys. `type` is not among them.
  virtual void visit(fields::Visitor& v) = 0;
  /// Checks what joins several of its own members. Throws std::invalid_argument.
  virtual void validate() const = 0;
  /// Checks how it fits into the rig; `at` is "devices.gnss".
  virtual void check(const std::string& at, RigCheck& check) const = 0;
  /// Shows the faults among its keys.
  virtual void each_fault(const FaultEar& take) = 0;
  /// Returns the kinds of fault that it can have, also while it runs, as its ports report them
  /// (device.h). For what depends on the rig, such as a line of its own, the defaults count.
  [[nodiscard]] virtual std::vector<fields::Named> fault_kinds() const = 0;
  /// Returns those of its keys that can be changed while it runs (Device::tell), in the order in
  /// which they are applied.
  [[nodiscard]] virtual std::vector<LiveKey> live_keys() const { return {}; }
  /// The three below may throw std::invalid_argument for settings that make no device.
  [[nodiscard]] virtual DevicePlan plan(const RigView& rig) const = 0;
  /// nullopt: it is not on a CAN bus. `name` is the device's in its rig.
  [[nodiscard]] virtual std::optional<BusShare> bus_share(std::string_view name) const = 0;
  [[nodiscard]] virtual DeviceDescription describe() const = 0;
  /// Opens its wire and adds itself to the executive and the world: station, outlets, then further
  /// stations. Throws drivers::EndpointError (environment), std::invalid_argument or
  /// std::runtime_error (configuration).
  [[nodiscard]] virtual std::unique_ptr<Device> make(Site& site) const = 0;

  /// Returns the EDS file of a CANopen node (protocols/canopen/eds.h).
  [[nodiscard]] virtual std::optional<std::string> electronic_data_sheet() const {
    return std::nullopt;
  }
  /// Returns whether it is a satellite receiver, from which others can get time and position.
  [[nodiscard]] virtual bool is_receiver() const { return false; }
  /// Returns whether it makes pictures, which have ground truth (run --camera-truth).
  [[nodiscard]] virtual bool is_camera() const { return false; }

  /// Returns whether others can be wired to it for its corrections (CorrectionSource).
  [[nodiscard]] virtual bool is_base_station() const { return false; }

  [[nodiscard]] virtual std::unique_ptr<DeviceConfiguration> copy() const = 0;
};

// For fields::Part, which finds them by the type.
void visit(fields::Visitor& v, DeviceConfiguration& p);
/// Checks every member by its rule, then what joins them. Throws std::invalid_argument.
void validate(const DeviceConfiguration& p);

/// Base of the classes of this folder: implements copy().
template <class Type>
class DeviceConfigurationOf : public DeviceConfiguration {
 public:
  [[nodiscard]] std::unique_ptr<DeviceConfiguration> copy() const override {
    return std::make_unique<Type>(static_cast<const Type&>(*this));
  }
};

}  // namespace rigwire::hil
