#include "hil/devices/vehicle_gateway.h"

#include <fmt/format.h>

#include <array>

#include "emulators/vehicle_gateway/report.h"
#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/rig_check.h"
#include "hil/world/ports.h"
#include "protocols/iso11783/functionalities.h"
#include "protocols/vehicle/engine_configuration.h"
#include "protocols/vehicle/identification.h"

namespace rigwire::hil {
namespace {

/// What its emulator is made with.
emulators::VehicleGatewaySettings settings_of(const VehicleGatewayConfiguration& p) {
  emulators::VehicleGatewaySettings settings = p.gateway;
  settings.has_position = !p.position_from.empty();
  settings.has_ground_radar = p.sensor.ground_radar.fitted;
  return settings;
}

/// The same on that machine.
emulators::VehicleGatewaySettings settings_on(const VehicleGatewayConfiguration& p,
                                              const sim::VehiclePort* port) {
  emulators::VehicleGatewaySettings settings = settings_of(p);
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
  VehicleGatewayDevice(Site& site, const VehicleGatewayConfiguration& configuration)
      : CanDeviceOf(site, configuration.bus, configuration.clock,
                    settings_on(configuration, site.world().machine().vehicle_port())),
        position_from_(configuration.position_from) {}

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

}  // namespace

void VehicleGatewayConfiguration::visit(fields::Visitor& v) {
  visit_node(v, bus, clock);
  v.text("position_from", position_from,
         "The satellite receiver whose fixes it reports (VP, VDS, VP2); empty = none.");
  emulators::visit(v, gateway);
  v.section("sensor", sensor, "How well the machine's own sensors measure.");
  v.section("odometry", odometry, "Speed and curvature from wheels and steering.");
}

void VehicleGatewayConfiguration::validate() const {
  emulators::validate(gateway);
}

void VehicleGatewayConfiguration::check(const std::string& at, RigCheck& check) const {
  check.j1939_node(at, bus, gateway.source_address, gateway.serial);
  if (!position_from.empty()) {
    check.receiver(at + ".position_from", position_from, {});
  }
  if (!check.rig().drives) {
    check.report(at + ".type", "the machine has no drive train", "", "a machine that drives");
  }
}

std::vector<FaultWindow> VehicleGatewayConfiguration::fault_windows(
    std::string_view /*name*/) const {
  return {};
}

DevicePlan VehicleGatewayConfiguration::plan(const RigView& rig) const {
  return j1939_plan(rig, bus, gateway.source_address, bus_share({})->frames_hz,
                    fmt::format("stops {} after the last guidance command",
                                fields::print_duration(gateway.timeouts.guidance.count())));
}

std::optional<BusShare> VehicleGatewayConfiguration::bus_share(std::string_view name) const {
  return asked<emulators::VehicleGateway>(bus_share_of(bus, name), settings_of(*this));
}

DeviceDescription VehicleGatewayConfiguration::describe() const {
  DeviceDescription description;
  description.quantities = asked<emulators::VehicleGateway>(quantities_of, gateway);
  description.wire = "CAN 2.0B at 250 kbit/s, J1939: SocketCAN or slcan on a pty";
  description.document =
      "SAE J1939-21, -71 (2020 annex), -73, -81; ISO 11783-7 guidance and machine selected speed; "
      "layouts in docs/devices/vehicle-gateway.md";
  for (const auto& entry : emulators::VehicleReport::schedule()) {
    const auto& group = entry.group;
    description.messages.push_back(
        {fmt::format("{} {:04X} {}", group.pgn, group.pgn, group.name),
         group.period.count() == 0
             ? "on request"
             : fmt::format("{:g} Hz", 1e3 / static_cast<double>(group.period.count())),
         "sent"});
  }
  const auto add = [&](std::uint32_t pgn, std::string_view name, const char* rate,
                       const char* content) {
    description.messages.push_back({fmt::format("{} {:04X} {}", pgn, pgn, name), rate, content});
  };
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

std::unique_ptr<Device> VehicleGatewayConfiguration::make(Site& site) const {
  auto device = std::make_unique<VehicleGatewayDevice>(site, *this);
  site.world().add(
      make_world_vehicle(device->enlist(site.executive()), site.world().machine(),
                         sim::VehicleSensors(sensor, odometry, site.seed(), site.name())));
  return device;
}

}  // namespace rigwire::hil
