// A Velodyne lidar of a rig: its two UDP ports, its web interface, its mount, its behaviour and its
// accuracy. One structure for all models; each has the keys that have a meaning for its model.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/velodyne/velodyne_settings.h"
#include "hil/configuration/fault_window.h"
#include "hil/devices/device_configuration.h"
#include "hil/world/lidar.h"
#include "hil/world/shapes.h"

namespace rigwire::hil {

/// The sensor's web interface.
struct LidarWebConfiguration {
  std::string address = "127.0.0.1";  ///< Address that it listens at.
  std::uint16_t port = 0;             ///< 0: no web interface.
  bool silent_refusals = false;       ///< Refused requests are answered with success, too.
};

enum class SourcePorts {
  /// The model's port, unless it is taken or a client on this machine needs it: then `any`.
  automatic,
  any,  ///< The system chooses.
  /// The model's port: the destination's, or 443 for the HDL models. An error if it is taken.
  model,
};

struct VelodyneConfiguration final : DeviceConfigurationOf<VelodyneConfiguration> {
  bool allow_remote = false;   ///< Needed for addresses outside this machine.
  std::string source_address;  ///< Source address of the packets; empty: the system chooses.
  SourcePorts source_ports = SourcePorts::automatic;
  LidarWebConfiguration web;
  std::string time_source{kAutomaticTimeSource};  ///< One of the words below, or a device's name.
  std::string calibration_file;                   ///< HDL-64E; empty: the nominal unit.
  MountConfiguration mount;           ///< Frame S: x forward, y left, z up, on the spin axis.
  emulators::VelodyneSettings lidar;  ///< Except what settings_of() fills in from the others.
  LidarSensorConfiguration sensor;
  std::vector<MixedFault<emulators::VelodyneFault, emulators::SupplyFault>> faults;

  static constexpr std::string_view kAutomaticTimeSource = "auto";
  static constexpr std::string_view kIdealTimeSource = "ideal";
  static constexpr std::string_view kPulseTimeSource = "pulse";
  static constexpr std::string_view kNoTimeSource = "none";

  /// `model` is one of protocols/velodyne's.
  explicit VelodyneConfiguration(std::string_view model = "HDL-32E");

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  void each_fault(const FaultEar& take) override;
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override;
  [[nodiscard]] std::vector<LiveKey> live_keys() const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
};

/// Returns the emulator's settings: with the faults, the source of its time and the calibration
/// read from its file. Throws std::runtime_error for a file that cannot be used.
[[nodiscard]] emulators::VelodyneSettings settings_of(const VelodyneConfiguration& configuration);

/// Returns its model table.
[[nodiscard]] const protocols::velodyne::Model& model_of(
    const VelodyneConfiguration& configuration);

}  // namespace rigwire::hil
