#include "hil/devices/engine_controller.h"

#include <fmt/format.h>

#include <utility>

#include "fields/visitor.h"
#include "hil/devices/can_device.h"
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
emulators::EngineControllerSettings settings_on(const EngineControllerConfiguration& p,
                                                const sim::PowerUnitPort* port) {
  emulators::EngineControllerSettings settings = p.engine;
  if (port != nullptr) {
    settings.engine = port->engine_data();
  }
  return settings;
}

}  // namespace

void EngineControllerConfiguration::visit(fields::Visitor& v) {
  visit_node(v, bus, clock);
  emulators::visit(v, engine);
}

void EngineControllerConfiguration::validate() const {
  emulators::validate(engine);
}

void EngineControllerConfiguration::check(const std::string& at, RigCheck& check) const {
  check.j1939_node(at, bus, engine.source_address, engine.serial);
  if (!check.rig().has_power_unit) {
    check.report(at + ".type", "the machine has no engine that drives pumps", "",
                 "an excavator with pumps: engine");
  }
}

std::vector<FaultWindow> EngineControllerConfiguration::fault_windows(
    std::string_view /*name*/) const {
  return {};
}

DevicePlan EngineControllerConfiguration::plan(const RigView& rig) const {
  return j1939_plan(rig, bus, engine.source_address, bus_share({})->frames_hz,
                    fmt::format("the dial's speed {} after the last TSC1",
                                fields::print_duration(engine.request_timeout.count())));
}

std::optional<BusShare> EngineControllerConfiguration::bus_share(std::string_view name) const {
  return asked<emulators::EngineController>(bus_share_of(bus, name), engine);
}

DeviceDescription EngineControllerConfiguration::describe() const {
  DeviceDescription description;
  description.quantities = asked<emulators::EngineController>(quantities_of, engine);
  description.wire = "CAN 2.0B at 250 kbit/s, J1939: SocketCAN or slcan on a pty";
  description.document =
      "SAE J1939-21, -71 (2020 annex), -73, -81; layouts in docs/devices/engine-controller.md";
  const auto add = [&](std::uint32_t pgn, std::string_view name, std::string rate,
                       const char* content) {
    description.messages.push_back(
        {fmt::format("{} {:04X} {}", pgn, pgn, name), std::move(rate), content});
  };
  for (const auto& [group, phase] : emulators::EngineController::schedule()) {
    add(group.pgn, group.name,
        group.period.count() == 0
            ? "on request"
            : fmt::format("{:g} Hz", 1e3 / static_cast<double>(group.period.count())),
        "sent");
  }
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

std::unique_ptr<Device> EngineControllerConfiguration::make(Site& site) const {
  auto device = std::make_unique<EngineControllerDevice>(
      site, bus, clock, settings_on(*this, site.world().machine().power_unit_port()));
  site.world().add(make_world_power_unit(device->enlist(site.executive()), site.world().machine()));
  return device;
}

}  // namespace rigwire::hil
