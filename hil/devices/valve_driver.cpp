#include "hil/devices/valve_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>

#include "fields/visitor.h"
#include "hil/configuration/problems.h"
#include "hil/devices/device.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/site.h"
#include "hil/devices/valve_source.h"
#include "hil/executive/station.h"
#include "hil/files/valve_map_file.h"
#include "hil/world/ports.h"

namespace rigwire::hil {

using fields::IntegerRule;

namespace {

ModbusLineConfiguration own_line(const ValveDriverConfiguration& configuration) {
  ModbusLineConfiguration line;
  line.address = configuration.address;
  line.port = configuration.port;
  line.allow_remote = configuration.allow_remote;
  line.response_delay.typical = configuration.processing_delay;
  line.faults = configuration.line_faults();
  return line;
}

class ValveDriverDevice final : public Device {
 public:
  /// `shared` is null when the driver has a TCP server of its own.
  ValveDriverDevice(const ValveDriverConfiguration& configuration, Site& site, RigModbus* shared)
      : own_(shared != nullptr
                 ? nullptr
                 : make_rig_modbus(own_line(configuration), site.io(), site.device_seed())),
        line_(shared != nullptr ? *shared : *own_),
        driver_(driver_settings(configuration)),
        source_(driver_, configuration.driver.amplifier.sections,
                valve_port(site.world().machine()).actuators()),
        station_(driver_, driver_) {
    line_.add_unit(configuration.unit, driver_.unit());
    auto acts = acted_by<emulators::ValveDefect>(driver_.defects());
    acts.name = valve_fault_names(configuration.driver.amplifier);
    offer(make_fault_port(those_of<emulators::ValveDefect>(configuration.faults), std::move(acts)));
    offer(make_fault_port(those_of<emulators::SupplyFault>(configuration.faults),
                          acted_by<emulators::SupplyFault>(driver_.supply())));
    if (own_ != nullptr) {
      offer(own_->fault_port(configuration.line_faults()));
    }
  }

  [[nodiscard]] StationIndex enlist(Executive& executive) {
    const StationIndex index = executive.add(station_);
    if (own_ != nullptr) {
      own_->start(executive);
    }
    return index;
  }

  [[nodiscard]] const ValveSource* valves() const override { return &source_; }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return line_.endpoint(); }
  /// Requests to this unit; the rest of the statistics is the line's.
  [[nodiscard]] std::uint64_t frames() const override {
    const emulators::ReceiveCounters requests = driver_.received();
    return requests.accepted + requests.ignored + requests.malformed;
  }
  [[nodiscard]] std::uint64_t dropped() const override { return line_.statistics().dropped; }
  [[nodiscard]] const WireStatistics& statistics() const override { return line_.statistics(); }
  [[nodiscard]] const emulators::Device& emulator() const override { return driver_; }
  [[nodiscard]] std::optional<ClientRequest> last_request() const override {
    return modbus_request(driver_.last_request());
  }

 private:
  std::unique_ptr<RigModbus> own_;
  RigModbus& line_;
  emulators::ValveDriver driver_;
  ValveSource source_;
  StationOf<emulators::ValveBackend> station_;
};

/// The wire of the line that it is on.
std::string modbus_wire(const RigView& rig, const ValveDriverConfiguration& device) {
  const auto line = rig.modbus.find(device.line);
  if (line == rig.modbus.end()) {
    return fmt::format("modbus tcp {}:{}", device.address, device.port);
  }
  const ModbusLineConfiguration& shared = line->second;
  return shared.wire == emulators::ModbusWire::rtu
             ? fmt::format("{}: modbus rtu {} {} bit/s", line->first, shared.path,
                           shared.line.timing.baud)
             : fmt::format("{}: modbus tcp {}:{}", line->first, shared.address, shared.port);
}

}  // namespace

emulators::ValveDriverSettings driver_settings(const ValveDriverConfiguration& configuration) {
  emulators::ValveDriverSettings settings = configuration.driver;
  settings.amplifier.defects = those_of<emulators::ValveDefect>(configuration.faults);
  settings.supply_faults = those_of<emulators::SupplyFault>(configuration.faults);
  if (!configuration.map.empty()) {
    settings.map = load_valve_map(configuration.map);
  }
  return settings;
}

void ValveDriverConfiguration::visit(fields::Visitor& v) {
  v.text("line", line, "One of the rig's Modbus lines; empty = its own TCP server.");
  v.integer("unit", unit, IntegerRule{1, 247}, "Number of the Modbus unit on its line.");
  v.only_if(line.empty(), "line", "no line, which has its own", [this](fields::Visitor& w) {
    w.text("address", address, "Address at which the server listens.");
    w.integer("port", port, IntegerRule{1, 65535}, "TCP; the standard port 502 needs privileges.");
    w.boolean("allow_remote", allow_remote, "Permits listening where other machines reach it.");
    w.duration("processing_delay", processing_delay, {0, 1'000'000'000},
               "Time from a request to its answer.");
  });
  v.file("map", map, fields::FileKind::valve_map,
         "Registers from a file (docs/your-own-valve.md); empty: Rigwire's own.");
  emulators::visit(v, driver);
  v.list("faults", faults,
         "What happens to coils, spools, sensors, supply, surroundings and its own line.");
}

void ValveDriverConfiguration::validate() const {
  try {
    emulators::validate(driver_settings(*this));
    for (const emulators::ModbusFault& fault : line_faults()) {
      emulators::validate(fault, emulators::ModbusWire::tcp);
    }
  } catch (const ConfigurationError& error) {
    throw std::invalid_argument(error.what());
  }
}

void ValveDriverConfiguration::check(const std::string& at, RigCheck& check) const {
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const bool of_line = std::visit(
        []<class What>(const What&) {
          return kIsAlternative<What, decltype(emulators::ModbusFault::what)>;
        },
        faults[i].what);
    if (of_line && !line.empty()) {
      check.report(fmt::format("{}.faults.{}.type", at, i), "the line is one of the rig's",
                   std::string(fields::chosen_name(faults[i].what)),
                   fmt::format("the same on \"modbus {}\"", line));
    }
  }
  if (line.empty()) {
    check.listener(at, address, port, allow_remote);
  } else if (check.modbus_line(at, line)) {
    check.claim(at + ".unit", fmt::format("{} unit {}", line, unit), std::to_string(unit));
  }
  check.valve_block(at, driver.amplifier.sections);
  if (!map.empty()) {
    check_against_map(at, check);
  }
}

/// Registers that begin with values of their own beat the device's keys.
void ValveDriverConfiguration::check_against_map(const std::string& at, RigCheck& check) const {
  const emulators::ValveDriver at_start(driver_settings(*this));
  const emulators::ValveAmplifierParameters& effective = at_start.amplifier().parameters();
  const emulators::ValveAmplifierParameters& configured = driver.amplifier.parameters;
  const std::string needed = "without `initial` in the map, or without this key";
  if (effective.watchdog != configured.watchdog) {
    check.without_effect(
        at + ".watchdog", at + ".map",
        "the map's register begins with " + fields::print_duration(effective.watchdog.count()),
        fields::print_duration(configured.watchdog.count()), needed);
  }
  if (effective.reaction != configured.reaction) {
    check.without_effect(at + ".reaction", at + ".map",
                         "the map's register begins with another one", "", needed);
  }
}

void visit(fields::Visitor& v, ValveDriverFault& p) {
  visit(v, p.when);
  visit(v, p.scope);
  v.required("type");
  v.variant("type", p.what, "Kind of the fault.");
  const bool of_line = std::visit(
      []<class What>(const What&) {
        return kIsAlternative<What, decltype(emulators::ModbusFault::what)>;
      },
      p.what);
  v.check(of_line || p.scope == emulators::ModbusFaultScope{}, "type",
          "which requests it concerns is of faults of the line",
          std::string(fields::chosen_name(p.what)), "without unit, table, first, last, share");
}

std::vector<emulators::ModbusFault> ValveDriverConfiguration::line_faults() const {
  std::vector<emulators::ModbusFault> all;
  for (const ValveDriverFault& fault : faults) {
    std::visit(
        [&]<class What>(const What& what) {
          if constexpr (kIsAlternative<What, decltype(emulators::ModbusFault::what)>) {
            all.push_back({fault.when, fault.scope, what});
          }
        },
        fault.what);
  }
  return all;
}

void ValveDriverConfiguration::each_fault(const FaultEar& take) {
  show_faults(faults, take, [this](const ValveDriverFault& fault) {
    return valve_fault_name(fault, driver.amplifier);
  });
}

std::vector<fields::Named> ValveDriverConfiguration::fault_kinds() const {
  auto kinds = hil::fault_kinds<emulators::ValveDefect, emulators::SupplyFault>();
  if (line.empty()) {
    std::ranges::move(emulators::modbus_fault_kinds(emulators::ModbusWire::tcp),
                      std::back_inserter(kinds));
  }
  return kinds;
}

DevicePlan ValveDriverConfiguration::plan(const RigView& rig) const {
  const emulators::ValveDriver driver_at_start(driver_settings(*this));
  const emulators::ValveMap& registers = driver_at_start.map();
  std::set<std::size_t> commanded;
  for (const emulators::ValveRegister& entry : registers.registers) {
    if (entry.writable && entry.signal <= emulators::ValveSignal::command_b) {
      for (std::size_t i = 0; i < entry.count; ++i) {
        commanded.insert(entry.section + i);
      }
    }
  }
  return {modbus_wire(rig, *this), "on request", "",
          fmt::format(
              "unit {}, registers of {}, {} sections commanded, watchdog {}", unit, registers.name,
              commanded.size(),
              fields::print_duration(driver_at_start.amplifier().parameters().watchdog.count()))};
}

std::optional<BusShare> ValveDriverConfiguration::bus_share(std::string_view /*name*/) const {
  return std::nullopt;
}

DeviceDescription ValveDriverConfiguration::describe() const {
  DeviceDescription description;
  description.quantities = quantities_of(emulators::ValveDriver(driver));
  description.wire = "Modbus TCP server, default 127.0.0.1:1502";
  description.document =
      "MODBUS Application Protocol Specification V1.1b3; Messaging on TCP/IP Implementation Guide "
      "V1.0b; register map in docs/devices/valve-driver.md";
  description.messages = {
      {"03 read holding registers", "on request", "set points, ramps, watchdog"},
      {"04 read input registers", "on request", "spools, pressures, swing encoder, faults"},
      {"06, 16, 22, 23 write registers", "on request", "control word, set points, parameters"},
      {"17, 43/14 identification", "on request", "vendor, product, revision"}};
  return description;
}

std::unique_ptr<Device> ValveDriverConfiguration::make(Site& site) const {
  auto device =
      std::make_unique<ValveDriverDevice>(*this, site, line.empty() ? nullptr : &site.modbus(line));
  site.world().add(make_world_valves(device->enlist(site.executive()), site.world().machine(),
                                     driver.amplifier.sections));
  return device;
}

}  // namespace rigwire::hil
