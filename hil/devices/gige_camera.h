// A GigE Vision camera of a rig: its network address, its kind, its mount, its behaviour and its
// accuracy. One structure for all kinds.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/gige_camera/gige_camera_settings.h"
#include "hil/configuration/fault_window.h"
#include "hil/devices/device_configuration.h"
#include "hil/world/shapes.h"
#include "sim/camera/camera_kinds.h"

namespace rigwire::hil {

struct GigeCameraConfiguration final : DeviceConfigurationOf<GigeCameraConfiguration> {
  std::string address = "127.0.0.2";  ///< The camera's address; clients use its port 3956.
  bool allow_remote = false;          ///< Needed for addresses outside this machine.
  /// With allow_remote: the network whose clients are answered.
  std::string netmask = "255.0.0.0";
  std::string gateway = "0.0.0.0";  ///< With allow_remote: the gateway that the camera reports.
  std::string mac;                  ///< Empty: 02:52 and the address.
  std::string settings_file;        ///< What a client saved; empty: lasts as long as the run.
  MountConfiguration mount;         ///< Frame S: x forward along the optical axis.
  bool sees_own_link = false;       ///< Whether shapes of the mount's link can be seen.
  Duration processing = std::chrono::milliseconds(100);
  emulators::GigeCameraSettings camera;  ///< Except what settings_of() fills in from the others.
  sim::CameraKind sensor;
  std::vector<MixedFault<emulators::GigeCameraFault, emulators::SupplyFault>> faults;

  /// `kind` has the defaults; `model` is the name that the device reports.
  explicit GigeCameraConfiguration(sim::CameraKind kind = sim::CameraParameters(),
                                   std::string_view model = "AreaCamera");

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
  [[nodiscard]] bool is_camera() const override { return true; }
};

/// Returns the emulator's settings, completed with what its sensor can do and its network address.
/// Throws std::invalid_argument for malformed addresses, and for sensors that make no camera.
[[nodiscard]] emulators::GigeCameraSettings settings_of(
    const GigeCameraConfiguration& configuration);

/// Returns the sensor's settings at power-on. Throws as settings_of().
[[nodiscard]] CameraCommand power_on_command(const GigeCameraConfiguration& configuration);

}  // namespace rigwire::hil
