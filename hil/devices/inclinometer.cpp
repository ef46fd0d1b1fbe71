// A CANopen inclinometer: bus, mount, what it is at delivery and the sensor in it.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "emulators/canopen/inclinometer.h"
#include "emulators/own_clock.h"
#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/mounting.h"
#include "hil/devices/rig_check.h"
#include "hil/files/settings_file.h"
#include "hil/world/shapes.h"
#include "protocols/canopen/inclinometer.h"
#include "sim/imu/imu_sensor.h"

namespace rigwire::hil {
namespace {

using InclinometerDevice = CanDeviceOf<emulators::Inclinometer, emulators::ImuBackend>;

/// Two-axis inclinometer (CANopen, CiA 410) on a link of the machine.
struct InclinometerConfiguration final : DeviceConfigurationOf<InclinometerConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  std::vector<
      NodeFault<ImuSample, emulators::SupplyFault, emulators::PaceFault, emulators::RefusalFault>>
      faults;
  MountConfiguration mount;
  emulators::InclinometerSettings inclinometer;
  std::string settings_file;  ///< What "save" writes; empty: kept for the run.
  sim::ImuParameters sensor;  ///< Its accelerometer; the gyroscope is not used.

  void visit(fields::Visitor& v) override {
    visit_node(v, bus, clock, faults);
    emulators::visit(v, inclinometer);
    v.file("settings_file", settings_file, fields::FileKind::memory,
           "What a client saved, for the next run; empty: as long as the run.");
    v.section("mount", mount,
              "Where on the machine it sits: x forward, y left, z up where it is level.");
    v.section("sensor", sensor, "How well it measures the force; its gyroscope is not used.");
  }

  void validate() const override { emulators::validate(inclinometer); }

  void check(const std::string& at, RigCheck& check) const override {
    check.link(at + ".mount.link", mount.link);
    check.canopen_node(at, bus, inclinometer.node.node_id);
  }

  void each_fault(const FaultEar& take) override { show_faults(faults, take); }
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override {
    return mixed_kinds(faults);
  }
  [[nodiscard]] std::vector<LiveKey> live_keys() const override {
    return hil::live_keys(emulators::Inclinometer::live_settings());
  }

  [[nodiscard]] DevicePlan plan(const RigView& rig) const override {
    const bool synchronous =
        inclinometer.transmission_type <= protocols::canopen::kGreatestSynchronous;
    return {can_wire(rig, bus, fmt::format("node {}", inclinometer.node.node_id)),
            fmt::format("{:.0f} frames/s", bus_share({})->frames_hz), "",
            fmt::format("counts of {:g} deg{}", 1e-3 * inclinometer.resolution_mdeg,
                        synchronous ? ", sent after SYNC" : "")};
  }

  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override {
    return asked_with_memory<emulators::Inclinometer>(bus_share_of(bus, name), inclinometer);
  }

  [[nodiscard]] DeviceDescription describe() const override {
    DeviceDescription description;
    description.quantities =
        asked_with_memory<emulators::Inclinometer>(quantities_of, inclinometer);
    description.wire = "CAN 2.0A, CANopen: SocketCAN or slcan on a pty";
    description.document = "CiA 301 V4.2.0, CiA 410 V1.2, ifm JN2100 and JN2101 device manuals";
    for (const auto& layout : protocols::canopen::inclinometer_layouts(
             inclinometer.node.node_id, inclinometer.resolution_mdeg)) {
      description.messages.push_back(
          {fmt::format("{:03X} {}", layout.id, layout.name), "by its parameters", layout.text});
    }
    description.messages.push_back(
        {"SDO", "on request",
         fmt::format("{} entries of the object dictionary",
                     protocols::canopen::inclinometer_objects().size())});
    return description;
  }

  [[nodiscard]] std::optional<std::string> electronic_data_sheet() const override {
    return asked_with_memory<emulators::Inclinometer>(
        [](const emulators::Inclinometer& node) { return node.node().electronic_data_sheet(); },
        inclinometer);
  }

  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override {
    emulators::InclinometerSettings on_bus = inclinometer;
    on_bus.node.bit_rate_bps = site.bus(bus).bus().settings().bit_rate_bps;
    auto device = std::make_unique<InclinometerDevice>(
        site, bus, clock, node_faults<ImuSample>(faults), with_supply_faults(on_bus, faults),
        open_settings(settings_file));
    device->hear(emulators::Inclinometer::live_settings(),
                 &InclinometerConfiguration::inclinometer);
    mount_inertial_unit(site, device->enlist(site.executive()), mount, sensor, {});
    return device;
  }
};

}  // namespace

std::unique_ptr<DeviceConfiguration> fresh_inclinometer() {
  return std::make_unique<InclinometerConfiguration>();
}

}  // namespace rigwire::hil
