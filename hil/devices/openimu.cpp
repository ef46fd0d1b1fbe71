// ACEINNA OpenIMU: bus, mount, device and sensor.
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "emulators/openimu/openimu335ri.h"
#include "emulators/own_clock.h"
#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/mounting.h"
#include "hil/devices/rig_check.h"
#include "hil/files/settings_file.h"
#include "hil/world/shapes.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {
namespace {

using OpenImuDevice = CanDeviceOf<emulators::OpenImu, emulators::ImuBackend>;

/// ACEINNA OpenIMU335RI on a J1939 bus, or OpenIMU300RI: the same with older firmware and a
/// magnetometer.
struct OpenImuDeviceConfiguration final : DeviceConfigurationOf<OpenImuDeviceConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  std::vector<
      NodeFault<ImuSample, emulators::SupplyFault, emulators::PaceFault, emulators::RefusalFault>>
      faults;
  MountConfiguration mount;
  emulators::OpenImuSettings imu;
  std::string settings_file;  ///< What "save" writes; empty: kept for the run.
  sim::ImuParameters sensor;
  sim::MagnetometerConfiguration magnetometer;  ///< OpenIMU300RI.

  explicit OpenImuDeviceConfiguration(
      emulators::OpenImuVariant variant = emulators::OpenImuVariant::openimu335ri) {
    imu.variant = variant;
  }

  void visit(fields::Visitor& v) override {
    visit_node(v, bus, clock, faults);
    emulators::visit(v, imu);
    v.file("settings_file", settings_file, fields::FileKind::memory,
           "What a client saved, for the next run; empty: as long as the run.");
    v.section("mount", mount, "Where on the machine the sensor sits, and how it is turned.");
    v.section("sensor", sensor, "How well it measures.");
    if (imu.variant == emulators::OpenImuVariant::openimu300ri) {
      v.section("magnetometer", magnetometer, "The Earth's field as it reads it.");
    }
  }

  void validate() const override { emulators::validate(imu); }

  void check(const std::string& at, RigCheck& check) const override {
    check.link(at + ".mount.link", mount.link);
    check.j1939_node(at, bus, imu.source_address, imu.serial);
  }

  void each_fault(const FaultEar& take) override { show_faults(faults, take); }
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override {
    return mixed_kinds(faults);
  }
  [[nodiscard]] std::vector<LiveKey> live_keys() const override {
    return hil::live_keys(emulators::OpenImu::live_settings());
  }

  [[nodiscard]] DevicePlan plan(const RigView& rig) const override {
    const unsigned divider = imu.configuration.rate_divider;
    const std::string with =
        divider == 0 ? "silent" : fmt::format("each message at {:.0f} Hz", 100.0 / divider);
    return j1939_plan(rig, bus, imu.source_address, bus_share({})->frames_hz, with);
  }

  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override {
    return asked<emulators::OpenImu>(bus_share_of(bus, name), imu);
  }

  [[nodiscard]] DeviceDescription describe() const override {
    DeviceDescription description;
    description.quantities = asked<emulators::OpenImu>(quantities_of, imu);
    description.wire = "CAN 2.0B at 250 kbit/s, J1939: SocketCAN or slcan on a pty";
    description.document =
        "SAE J1939-21, -81; ACEINNA openIMU300RI and openIMU335RI firmware and J1939 documentation";
    description.page = "docs/devices/openimu335ri.md";
    description.messages = {
        {"61481 F029 slope sensor information 2", "100 Hz", "pitch, roll, merit, latency"},
        {"61482 F02A angular rate information", "100 Hz", "pitch, roll, yaw rate, merit, latency"},
        {"61485 F02D acceleration sensor", "100 Hz", "lateral, longitudinal, vertical, merit"}};
    if (imu.variant == emulators::OpenImuVariant::openimu300ri) {
      description.messages.push_back({"65386 FF6A magnetic field", "off", "x, y, z"});
    } else {
      description.messages.push_back(
          {"61459 F013 slope sensor information", "off", "16-bit angles"});
      description.messages.push_back({"65387 FF6B fine angular rate", "off", "19-bit rates"});
      description.messages.push_back(
          {"65226 FECA DM1", "while a trouble is active", "trouble code"});
    }
    description.messages.insert(description.messages.end(),
                                {{"60928 EE00 address claimed", "at start, on request", "NAME"},
                                 {"65242 FEDA software version", "on request", "5 bytes"},
                                 {"64965 FDC5 ECU identification", "on request", "NAME"},
                                 {"FF50 .. FF5E, FFF0 .. FFF2 settings", "received",
                                  "rate, messages, filters, orientation, save, groups"}});
    return description;
  }

  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override {
    auto device = std::make_unique<OpenImuDevice>(site, bus, clock, node_faults<ImuSample>(faults),
                                                  with_supply_faults(imu, faults),
                                                  open_settings(settings_file));
    device->hear(emulators::OpenImu::live_settings(), &OpenImuDeviceConfiguration::imu);
    mount_inertial_unit(site, device->enlist(site.executive()), mount, sensor, magnetometer);
    return device;
  }
};

}  // namespace

std::unique_ptr<DeviceConfiguration> fresh_openimu(emulators::OpenImuVariant variant) {
  return std::make_unique<OpenImuDeviceConfiguration>(variant);
}

}  // namespace rigwire::hil
