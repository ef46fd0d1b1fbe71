#include "hil/devices/dbc_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "emulators/dbc_node/dbc_node.h"
#include "hil/configuration/problems.h"
#include "hil/devices/can_device.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/valve_source.h"
#include "hil/world/ports.h"
#include "protocols/j1939/identifier.h"

namespace rigwire::hil {

using fields::IntegerRule;

namespace {

using emulators::DbcNode;

template <class Backend>
using DbcNodeDevice = CanDeviceOf<DbcNode<Backend>, Backend>;

class DbcValvesDevice final : public DbcNodeDevice<emulators::ValveBackend> {
 public:
  DbcValvesDevice(Site& site, const std::string& bus, const emulators::OwnClockSettings& clock,
                  const Faults& faults, const emulators::DbcNodeSettings& settings,
                  const std::vector<std::string>& sections)
      : CanDeviceOf(site, bus, clock, faults, settings),
        source_(emulator(), sections, valve_port(site.world().machine()).actuators()) {}
  [[nodiscard]] const ValveSource* valves() const override { return &source_; }

 private:
  ValveSource source_;
};

/// What senses for it, for the station.
struct Attach {
  Site& site;
  StationIndex station;

  void operator()(const AttachedToNothing&) const {}
  void operator()(const AttachedToJoint& p) const { mount_encoder(site, station, p); }
  void operator()(const AttachedToLink& p) const {
    mount_inertial_unit(site, station, p.mount, p.sensor, {});
  }
  void operator()(const AttachedToSky& p) const {
    mount_antenna(site, station, p.mount, p.sensor, {});
  }
  void operator()(const AttachedToValves& p) const {
    site.world().add(make_world_valves(station, site.world().machine(), p.sections));
  }
  void operator()(const AttachedToPowerUnit&) const {
    site.world().add(make_world_power_unit(station, site.world().machine()));
  }
  void operator()(const AttachedToVehicle& p) const {
    site.world().add(
        make_world_vehicle(station, site.world().machine(),
                           sim::VehicleSensors(p.sensor, p.odometry, site.seed(), site.name())));
  }
};

/// Whether the machine has it.
struct CheckAttached {
  const std::string& at;
  RigCheck& check;

  void operator()(const AttachedToNothing&) const {}
  void operator()(const AttachedToJoint& p) const { check_joint(p, at + ".attached", check); }
  void operator()(const AttachedToLink& p) const {
    check.link(at + ".attached.mount.link", p.mount.link);
  }
  void operator()(const AttachedToSky& p) const {
    check.link(at + ".attached.mount.link", p.mount.link);
  }
  void operator()(const AttachedToValves& p) const {
    check.valve_block(at + ".attached", p.sections);
  }
  void operator()(const AttachedToPowerUnit&) const {
    if (!check.rig().has_power_unit) {
      check.report(at + ".attached.type", "the machine has no engine that drives pumps", "",
                   "an excavator with pumps: engine");
    }
  }
  void operator()(const AttachedToVehicle&) const {
    if (!check.rig().drives) {
      check.report(at + ".attached.type", "the machine has no drive train", "",
                   "a machine that drives");
    }
  }
};

}  // namespace

void visit(fields::Visitor& v, AttachedToLink& p) {
  v.section("mount", p.mount, "Where on the machine the sensor sits, and how it is turned.");
  v.section("sensor", p.sensor, "How well it measures.");
}
void visit(fields::Visitor& v, AttachedToSky& p) {
  v.section("mount", p.mount, "Where on the machine the antenna sits.");
  v.section("sensor", p.sensor, "How well it measures.");
}
void visit(fields::Visitor& v, AttachedToValves& p) {
  v.texts("sections", p.sections, "Actuators of the machine, in the order of its outputs.");
  v.check(!p.sections.empty() && p.sections.size() <= kValveSections, "sections",
          "as many as a block has", std::to_string(p.sections.size()), "1 .. 8");
}
void visit(fields::Visitor& v, AttachedToVehicle& p) {
  v.section("sensor", p.sensor, "How well the machine's own sensors measure.");
  v.section("odometry", p.odometry, "Speed and curvature from wheels and steering.");
}

void DbcNodeConfiguration::visit(fields::Visitor& v) {
  visit_node(v, bus, clock, faults);
  v.required("file");
  v.file("file", file, fields::FileKind::dbc_node, "Its binding (docs/your-own-can-device.md).");
  v.integer("source_address", source_address, IntegerRule{0, kAddressOfBinding},
            "Preferred address of one that claims; 254 = as its binding says.");
  v.group(
      "attached", [this](fields::Visitor& w) { w.variant("type", attached, "To what."); },
      "What of the machine it measures and moves.");
  emulators::visit(v, supply);
}

void DbcNodeConfiguration::validate() const {
  if (file.empty()) {
    return;  // as it is described, without a rig
  }
  try {
    const DbcNodeDescription device = description();
    const std::string_view type = fields::chosen_name(attached);
    if (device.attachment != type && device.attachment != "nothing") {
      throw std::invalid_argument(fmt::format(
          "attached.type: the binding's quantities are of another, found {}, allowed {}", type,
          device.attachment));
    }
    if (source_address != kAddressOfBinding && !device.settings.claim) {
      throw std::invalid_argument(
          fmt::format("source_address: the binding claims no address, found {}, allowed {}",
                      source_address, kAddressOfBinding));
    }
    (void)asked<DbcNode<emulators::NothingBackend>>([](const auto&) { return 0; }, device.settings);
  } catch (const ConfigurationError& error) {
    throw std::invalid_argument(error.what());
  }
}

DbcNodeDescription DbcNodeConfiguration::description() const {
  DbcNodeDescription device = load_dbc_node(file);
  device.settings.supply = supply;
  device.settings.supply.faults = those_of<emulators::SupplyFault>(faults);
  device.settings.faults = those_of<emulators::DbcNodeFault>(faults);
  if (device.settings.claim && source_address != kAddressOfBinding) {
    device.settings.claim->source_address = source_address;
  }
  return device;
}

void DbcNodeConfiguration::check(const std::string& at, RigCheck& check) const {
  const DbcNodeDescription device = description();
  if (const auto& claim = device.settings.claim) {
    check.j1939_node(at, bus, claim->source_address, device.serial);
  } else if (check.bus(at, bus)) {
    for (const emulators::DbcSentMessage& sent : device.settings.sent) {
      const std::string id = fmt::format("{:0{}X}", sent.layout.id, sent.layout.extended ? 8 : 3);
      check.claim(at + ".file", fmt::format("{} identifier {}", bus, id), id);
    }
  }
  std::visit(CheckAttached{at, check}, attached);
}

void DbcNodeConfiguration::each_fault(const FaultEar& take) {
  show_faults(faults, take);
}

std::vector<fields::Named> DbcNodeConfiguration::fault_kinds() const {
  return mixed_kinds(faults);
}

DevicePlan DbcNodeConfiguration::plan(const RigView& rig) const {
  const DbcNodeDescription device = description();
  const auto& claim = device.settings.claim;
  return {can_wire(rig, bus,
                   claim ? fmt::format("address {}", claim->source_address)
                         : fmt::format("{} message{}", device.settings.sent.size(),
                                       device.settings.sent.size() == 1 ? "" : "s")),
          fmt::format("{:.0f} frames/s", bus_share({})->frames_hz), "",
          device.text.empty() ? file : device.text};
}

std::optional<BusShare> DbcNodeConfiguration::bus_share(std::string_view name) const {
  if (file.empty()) {
    return std::nullopt;
  }
  return asked<DbcNode<emulators::NothingBackend>>(bus_share_of(bus, name), description().settings);
}

DeviceDescription DbcNodeConfiguration::describe() const {
  DeviceDescription description;
  description.wire = "CAN 2.0A or B, SocketCAN or slcan on a pty";
  description.document = "Vector DBC File Format Documentation 1.0.5; the user's own files";
  description.page = "your-own-can-device.md";
  const auto add = [&](std::span<const emulators::NamedQuantity> quantities, const char* key) {
    for (const emulators::NamedQuantity& quantity : quantities) {
      const std::string_view unit = fields::detail::si_unit(quantity.dimension).symbol;
      description.messages.push_back({quantity.full_name(),
                                      fmt::format("{}, {}", key, unit.empty() ? "a number" : unit),
                                      std::string(quantity.text)});
    }
  };
  add(emulators::measured_quantities(), "quantity");
  add(emulators::moved_quantities(), "moves");
  return description;
}

std::unique_ptr<Device> DbcNodeConfiguration::make(Site& site) const {
  const emulators::DbcNodeSettings settings = description().settings;
  return std::visit(
      [&]<class Attached>(const Attached& to) -> std::unique_ptr<Device> {
        const auto attach = [&](auto device) -> std::unique_ptr<Device> {
          Attach{site, device->enlist(site.executive())}(to);
          return device;
        };
        if constexpr (std::is_same_v<Attached, AttachedToValves>) {
          return attach(std::make_unique<DbcValvesDevice>(
              site, bus, clock, node_faults<ValveSample>(faults), settings, to.sections));
        } else {
          return attach(std::make_unique<DbcNodeDevice<typename Attached::Backend>>(
              site, bus, clock, node_faults<typename Attached::Backend::Sample>(faults), settings));
        }
      },
      attached);
}

}  // namespace rigwire::hil
