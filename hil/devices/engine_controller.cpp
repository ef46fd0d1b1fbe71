// The controller of an engine with pumps in a rig: its bus and its node.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include "emulators/engine_controller/engine_controller.h"
#include "emulators/own_clock.h"
#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/rig_check.h"
#include "hil/world/ports.h"
#include "protocols/vehicle/diagnostics.h"
#include "protocols/vehicle/engine_configuration.h"
#include "protocols/vehicle/identification.h"

namespace rigwire::hil {
namespace {

using EngineControllerDevice =
    CanDeviceOf<emulators::EngineController, emulators::PowerUnitBackend>;

/// What its emulator is made with on that machine.
emulators::EngineControllerSettings settings_on(emulators::EngineControllerSettings settings,
                                                const sim::PowerUnitPort* port) {
  if (port != nullptr) {
    settings.engine = port->engine_data();
  }
  return settings;
}

/// J1939 node of an engine that drives hydraulic pumps.
struct EngineControllerConfiguration final : DeviceConfigurationOf<EngineControllerConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  std::vector<NodeFault<PowerUnitSample, emulators::SupplyFault, emulators::PaceFault,
                        emulators::RefusalFault>>
      faults;
  emulators::EngineControllerSettings engine;

  void visit(fields::Visitor& v) override {
    visit_node(v, bus, clock, faults);
    emulators::visit(v, engine);
  }

  void validate() const override { emulators::validate(engine); }

  void check(const std::string& at, RigCheck& check) const override {
    check.j1939_node(at, bus, engine.source_address, engine.serial);
    if (!check.rig().has_power_unit) {
      check.report(at + ".type", "the machine has no engine that drives pumps", "",
                   "an excavator with pumps: engine");
    }
  }

  void each_fault(const FaultEar& take) override { show_faults(faults, take); }
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override {
    return mixed_kinds(faults);
  }
  [[nodiscard]] std::vector<LiveKey> live_keys() const override {
    return hil::live_keys(emulators::EngineController::live_settings());
  }

  [[nodiscard]] DevicePlan plan(const RigView& rig) const override {
    return j1939_plan(rig, bus, engine.source_address, bus_share({})->frames_hz,
                      fmt::format("the dial's speed {} after the last TSC1",
                                  fields::print_duration(engine.request_timeout.count())));
  }

  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override {
    return asked<emulators::EngineController>(bus_share_of(bus, name), engine);
  }

  [[nodiscard]] DeviceDescription describe() const override {
    DeviceDescription description;
    description.quantities = asked<emulators::EngineController>(quantities_of, engine);
    description.wire = "CAN 2.0B at 250 kbit/s, J1939: SocketCAN or slcan on a pty";
    description.document =
        "SAE J1939-21, -71 (2020 annex), -73, -81; layouts in docs/devices/engine-controller.md";
    add_schedule(description, emulators::EngineController::schedule());
    const auto add = [&](auto... message) { add_message(description, message...); };
    namespace vehicle = protocols::vehicle;
    add(vehicle::kDm1Pgn, "DM1", "1 Hz", "active trouble codes; also on change");
    add(vehicle::kDm2Pgn, "DM2", "on request", "trouble codes that were active");
    add(vehicle::kEngineConfigurationPgn, "EC1", "0.2 Hz", "engine configuration, by transport");
    add(vehicle::kVehicleIdentificationPgn, "VI", "on request", "VIN, by transport");
    add(vehicle::kSoftwareIdentificationPgn, "SOFT", "on request", "by transport");
    add(vehicle::kComponentIdentificationPgn, "CI", "on request", "by transport");
    add(vehicle::kEcuIdentificationPgn, "ECUID", "on request", "by transport");
    add(vehicle::kDm3Pgn, "DM3", "received", "a request for it clears DM2");
    add(vehicle::kDm11Pgn, "DM11", "received", "a request for it clears DM1");
    add(vehicle::Tsc1::kGroup.pgn, "TSC1", "received", "speed, torque limit; counter and checksum");
    return description;
  }

  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override {
    auto device = std::make_unique<EngineControllerDevice>(
        site, bus, clock, node_faults<PowerUnitSample>(faults),
        with_supply_faults(settings_on(engine, site.world().machine().power_unit_port()), faults));
    device->hear(emulators::EngineController::live_settings(),
                 &EngineControllerConfiguration::engine);
    site.world().add(
        make_world_power_unit(device->enlist(site.executive()), site.world().machine()));
    return device;
  }
};

}  // namespace

std::unique_ptr<DeviceConfiguration> fresh_engine_controller() {
  return std::make_unique<EngineControllerConfiguration>();
}

}  // namespace rigwire::hil
