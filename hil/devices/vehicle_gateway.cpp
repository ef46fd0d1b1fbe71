// The vehicle gateway of a rig: its bus, its node, what it knows of its machine, how long it waits
// for commands, and the machine's own sensors and odometry that it reports.
#include <fmt/format.h>

#include <array>
#include <memory>
#include <string>

#include "emulators/own_clock.h"
#include "emulators/vehicle_gateway/report.h"
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/rig_check.h"
#include "hil/world/ports.h"
#include "protocols/iso11783/functionalities.h"
#include "protocols/vehicle/engine_configuration.h"
#include "protocols/vehicle/identification.h"
#include "sim/odometry/odometry.h"
#include "sim/vehicle_sensors/vehicle_sensors.h"

namespace rigwire::hil {
namespace {

/// With what that machine has.
emulators::VehicleGatewaySettings settings_on(emulators::VehicleGatewaySettings settings,
                                              const sim::VehiclePort* port) {
  if (port != nullptr) {
    settings.engine = port->engine_data();
    const VehicleSample sample = port->vehicle_sample(kStart);
    for (std::size_t i = 0; i < kImplementEnds; ++i) {
      settings.has_hitch[i] = sample.hitch[i].present;
      settings.has_power_take_off[i] = sample.power_take_off[i].present;
    }
  }
  return settings;
}

class VehicleGatewayDevice final
    : public CanDeviceOf<emulators::VehicleGateway, emulators::VehicleBackend>,
      private FixListener {
 public:
  VehicleGatewayDevice(Site& site, const std::string& bus, const emulators::OwnClockSettings& clock,
                       const Faults& faults, const emulators::VehicleGatewaySettings& settings,
                       std::string position_from)
      : CanDeviceOf(site, bus, clock, faults,
                    settings_on(settings, site.world().machine().vehicle_port())),
        position_from_(std::move(position_from)) {}

  void connect(const Neighbours& neighbours) override {
    FixSource* source = position_from_.empty() ? nullptr : neighbours.fixes_of(position_from_);
    if (source != nullptr) {
      source->inform(*this);
    }
  }

 private:
  void observe_fix(const GnssSample& sample) override {
    GnssSample seen = sample;
    seen.time = clock().own_time(sample.time);
    emulated().observe_fix(seen);
  }

  std::string position_from_;
};

/// J1939 node between a field controller and a machine that drives.
struct VehicleGatewayConfiguration final : DeviceConfigurationOf<VehicleGatewayConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  std::vector<NodeFault<VehicleSample, emulators::SupplyFault, emulators::PaceFault,
                        emulators::RefusalFault>>
      faults;
  std::string position_from;  ///< Name of the satellite receiver wired to it; empty: none.
  emulators::VehicleGatewaySettings gateway;
  sim::VehicleSensorParameters sensor;
  sim::OdometryParameters odometry;

  /// What its emulator is made with.
  [[nodiscard]] emulators::VehicleGatewaySettings settings() const {
    emulators::VehicleGatewaySettings made = gateway;
    made.has_position = !position_from.empty();
    made.has_ground_radar = sensor.ground_radar.fitted;
    return made;
  }

  void visit(fields::Visitor& v) override {
    visit_node(v, bus, clock, faults);
    v.text("position_from", position_from,
           "The satellite receiver whose fixes it reports (VP, VDS, VP2); empty = none.");
    emulators::visit(v, gateway);
    v.section("sensor", sensor, "How well the machine's own sensors measure.");
    v.section("odometry", odometry, "Speed and curvature from wheels and steering.");
  }

  void validate() const override { emulators::validate(gateway); }

  void check(const std::string& at, RigCheck& check) const override {
    check.j1939_node(at, bus, gateway.source_address, gateway.serial);
    if (!position_from.empty()) {
      check.receiver(at + ".position_from", position_from, {});
    }
    if (!check.rig().drives) {
      check.report(at + ".type", "the machine has no drive train", "", "a machine that drives");
    }
  }

  void each_fault(const FaultEar& take) override { show_faults(faults, take); }
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override {
    return mixed_kinds(faults);
  }
  [[nodiscard]] std::vector<LiveKey> live_keys() const override {
    return hil::live_keys(emulators::VehicleGateway::live_settings());
  }

  [[nodiscard]] DevicePlan plan(const RigView& rig) const override {
    return j1939_plan(rig, bus, gateway.source_address, bus_share({})->frames_hz,
                      fmt::format("stops {} after the last guidance command",
                                  fields::print_duration(gateway.timeouts.guidance.count())));
  }

  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override {
    return asked<emulators::VehicleGateway>(bus_share_of(bus, name), settings());
  }

  [[nodiscard]] DeviceDescription describe() const override {
    DeviceDescription description;
    description.quantities = asked<emulators::VehicleGateway>(quantities_of, gateway);
    description.wire = "CAN 2.0B at 250 kbit/s, J1939: SocketCAN or slcan on a pty";
    description.document =
        "SAE J1939-21, -71 (2020 annex), -73, -81; ISO 11783-7 guidance and machine selected "
        "speed; "
        "layouts in docs/devices/vehicle-gateway.md";
    add_schedule(description, emulators::VehicleReport::schedule());
    const auto add = [&](auto... message) { add_message(description, message...); };
    namespace vehicle = protocols::vehicle;
    add(vehicle::kDm1Pgn, "DM1", "1 Hz", "active trouble codes; also on change");
    add(vehicle::kDm2Pgn, "DM2", "on request", "trouble codes that were active");
    for (const auto& entry : emulators::VehicleSatellites::schedule()) {
      add(entry.group.pgn, entry.group.name, "with position_from", "sent");
    }
    add(vehicle::kEngineConfigurationPgn, "EC1", "0.2 Hz", "engine configuration, by transport");
    add(vehicle::kVehicleIdentificationPgn, "VI", "on request", "VIN, by transport");
    add(protocols::iso11783::kFunctionalitiesPgn, "functionalities", "on request", "by transport");
    add(vehicle::LanguageCommand::kGroup.pgn, "LANG", "on request", "language of displays");
    add(vehicle::kSoftwareIdentificationPgn, "SOFT", "on request", "by transport");
    add(vehicle::kComponentIdentificationPgn, "CI", "on request", "by transport");
    add(vehicle::kEcuIdentificationPgn, "ECUID", "on request", "by transport");
    return description;
  }

  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override {
    auto device = std::make_unique<VehicleGatewayDevice>(
        site, bus, clock, node_faults<VehicleSample>(faults),
        with_supply_faults(settings(), faults), position_from);
    device->hear(emulators::VehicleGateway::live_settings(), &VehicleGatewayConfiguration::gateway);
    site.world().add(
        make_world_vehicle(device->enlist(site.executive()), site.world().machine(),
                           sim::VehicleSensors(sensor, odometry, site.seed(), site.name())));
    return device;
  }
};

}  // namespace

std::unique_ptr<DeviceConfiguration> fresh_vehicle_gateway() {
  return std::make_unique<VehicleGatewayConfiguration>();
}

}  // namespace rigwire::hil
