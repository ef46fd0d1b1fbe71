// Xsens MTi-600: bus, mount, messages with their rates, and sensor.
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "emulators/own_clock.h"
#include "emulators/xsens/mti_600.h"
#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/mounting.h"
#include "hil/devices/rig_check.h"
#include "hil/world/shapes.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {
namespace {

using XsensMtiDevice = CanDeviceOf<emulators::Mti600, emulators::ImuBackend>;

/// Xsens MTi-600 on a CAN bus.
struct XsensMtiConfiguration final : DeviceConfigurationOf<XsensMtiConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  std::vector<NodeFault<ImuSample, emulators::SupplyFault, emulators::PaceFault>> faults;
  MountConfiguration mount;
  emulators::MtiSettings mti;
  sim::ImuParameters sensor;
  sim::MagnetometerConfiguration magnetometer;

  void visit(fields::Visitor& v) override {
    visit_node(v, bus, clock, faults);
    emulators::visit(v, mti);
    v.section("mount", mount, "Where on the machine the sensor sits, and how it is turned.");
    v.section("sensor", sensor, "How well it measures.");
    v.section("magnetometer", magnetometer, "The Earth's field as it reads it.");
  }

  void validate() const override { emulators::validate(mti); }

  void check(const std::string& at, RigCheck& check) const override {
    check.link(at + ".mount.link", mount.link);
    check.bus(at, bus);
    // Its identifiers are fixed: a second unit on the bus would send the same ones.
    check.claim(at + ".bus", fmt::format("{} mti {}", bus, mti.extended), bus);
  }

  void each_fault(const FaultEar& take) override { show_faults(faults, take); }
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override {
    return mixed_kinds(faults);
  }

  [[nodiscard]] DevicePlan plan(const RigView& rig) const override {
    return {can_wire(rig, bus, mti.extended ? "29-bit" : "11-bit"),
            fmt::format("{:.0f} frames/s", bus_share({})->frames_hz), "", "nothing is received"};
  }

  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override {
    return asked<emulators::Mti600>(bus_share_of(bus, name), mti, some_calendar());
  }

  [[nodiscard]] DeviceDescription describe() const override {
    DeviceDescription description;
    description.quantities = asked<emulators::Mti600>(quantities_of, mti, some_calendar());
    description.wire = "CAN 2.0A or B: SocketCAN or slcan on a pty";
    description.document = "Xsens MT CAN Protocol Documentation MT1604P; the maker's xsens.dbc";
    for (const emulators::MtiOutput& mti_output : mti.outputs) {
      const auto& message = protocols::xsens::message(mti_output.id);
      description.messages.push_back(
          {fmt::format("{:03X} {}", static_cast<unsigned>(message.id), message.name),
           mti_output.divider == 0
               ? "off"
               : fmt::format("{} Hz", emulators::kMtiSamplesPerSecond / mti_output.divider),
           fmt::format("{} bytes", message.length)});
    }
    return description;
  }

  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override {
    auto device =
        std::make_unique<XsensMtiDevice>(site, bus, clock, node_faults<ImuSample>(faults),
                                         with_supply_faults(mti, faults), site.calendar());
    mount_inertial_unit(site, device->enlist(site.executive()), mount, sensor, magnetometer);
    return device;
  }
};

}  // namespace

std::unique_ptr<DeviceConfiguration> fresh_xsens() {
  return std::make_unique<XsensMtiConfiguration>();
}

}  // namespace rigwire::hil
