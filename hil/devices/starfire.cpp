#include "hil/devices/starfire.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "emulators/device.h"
#include "emulators/starfire/node.h"
#include "emulators/starfire/receiver.h"
#include "emulators/ublox/line_quality.h"
#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/device.h"
#include "hil/devices/mounting.h"
#include "hil/devices/rig_check.h"
#include "hil/executive/station.h"
#include "hil/wires/line_ports.h"
#include "hil/wires/outlets.h"

namespace rigwire::hil {
namespace {

/// Both sides of the receiver as one device: they share the antenna's samples, each taking the
/// epochs of its own plan. Both plans are multiples of GPS time, one period a multiple of the
/// other.
class BothSides final : public emulators::Device, public emulators::GnssBackend {
 public:
  template <class Side>
  void add(Side& side) {
    sides_.push_back({&side, &side, &side.supply()});
  }

  void advance(SimTime now) override {
    for (const Side& side : sides_) {
      side.device->advance(now);
    }
  }
  [[nodiscard]] SimTime next_event() const override {
    SimTime next = kNever;
    for (const Side& side : sides_) {
      next = std::min(next, side.device->next_event());
    }
    return next;
  }
  [[nodiscard]] SamplePlan sample_plan() const override {
    SamplePlan both;
    for (const Side& side : sides_) {
      const SamplePlan plan = side.device->sample_plan();
      if (plan.first != kNever && (both.first == kNever || plan.period < both.period)) {
        both.period = plan.period;
      }
      both.first = std::min(both.first, plan.first);
    }
    return both;
  }
  [[nodiscard]] emulators::ReceiveCounters received() const override {
    emulators::ReceiveCounters sum;
    for (const Side& side : sides_) {
      const emulators::ReceiveCounters one = side.device->received();
      sum.bytes += one.bytes;
      sum.accepted += one.accepted;
      sum.ignored += one.ignored;
      sum.malformed += one.malformed;
    }
    return sum;
  }
  [[nodiscard]] double nominal_rate_hz() const override {
    double sum = 0.0;
    for (const Side& side : sides_) {
      sum += side.device->nominal_rate_hz();
    }
    return sum;
  }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override {
    return sides_.front().device->quantities();
  }
  void update(const GnssSample& sample) override {
    for (std::size_t i = 0; sides_.front().supply->on() && i < listeners.size(); ++i) {
      listeners[i]->observe_fix(sample);
    }
    for (const Side& side : sides_) {
      const SamplePlan plan = side.device->sample_plan();
      if (plan.first <= sample.time && (sample.time - plan.first) % plan.period == Duration{0}) {
        side.backend->update(sample);
      }
    }
  }

  // The supply is one, of which each side keeps a book.
  void begin(const emulators::SupplyFault& fault) {
    for (const Side& side : sides_) {
      side.supply->begin(fault);
    }
  }
  bool end(std::uint32_t id, SimTime now) {
    bool ended = false;
    for (const Side& side : sides_) {
      ended = side.supply->end(id, now);
    }
    return ended;
  }

  std::vector<FixListener*> listeners;  ///< Receive every fix.

 private:
  struct Side {
    emulators::Device* device;
    emulators::GnssBackend* backend;
    emulators::Supply* supply;
  };
  std::vector<Side> sides_;
};

class StarFireDevice final : public Device, private FixSource {
 public:
  /// `bus` is null without a node.
  StarFireDevice(const StarFireConfiguration& configuration, Site& site, RigCan* bus)
      : check_baud_(configuration.check_baud), bus_(bus) {
    const emulators::StarFireSettings settings =
        with_supply_faults(configuration.receiver, configuration.faults);
    if (!configuration.path.empty()) {
      line_ = open_serial_ports(site.io(), configuration.path, configuration.ports,
                                configuration.receiver.baud);
      outlet_.emplace(*line_, own_statistics());
      quality_.emplace(*outlet_, site.device_seed());
      quality_->set_device_baud(configuration.receiver.baud);
      receiver_.emplace(settings, site.calendar(), *quality_);
      sides_.add(*receiver_);
    }
    if (bus != nullptr) {
      exit_ = &bus->add_node(own_statistics());
      node_.emplace(settings, site.calendar(), *exit_);
      bus->attach(*exit_, *node_);
      sides_.add(*node_);
    }
    offer(antenna_faults(site.executive(), station_, bands_of(configuration.sensor),
                         those_of<sim::GnssFault>(configuration.faults)));
    offer(make_fault_port(settings.supply.faults, acted_by<emulators::SupplyFault>(sides_)));
  }

  [[nodiscard]] StationIndex enlist(Executive& executive) {
    const StationIndex index = executive.add(station_);
    if (line_ != nullptr) {
      executive.add(*outlet_);
      outlet_->on_client([this, &executive](const drivers::LineClient& client) {
        executive.arrive();
        quality_->set_client_baud(seen_baud(check_baud_, client.baud));
      });
      outlet_->start([this, &executive](std::span<const std::uint8_t> bytes) {
        receiver_->receive(client_arrived(executive), bytes);
      });
    }
    return index;
  }

  [[nodiscard]] FixSource* fixes() override { return this; }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override {
    return line_ != nullptr ? line_->status() : bus_->endpoint();
  }
  [[nodiscard]] std::uint64_t frames() const override {
    return (receiver_ ? receiver_->messages_sent() : 0) + on_bus().sent;
  }
  [[nodiscard]] std::uint64_t dropped() const override {
    return statistics().dropped + on_bus().overflowed;
  }
  [[nodiscard]] const emulators::Device& emulator() const override { return sides_; }
  /// Returns the last request on the bus: its serial line receives nothing.
  [[nodiscard]] std::optional<ClientRequest> last_request() const override {
    return exit_ == nullptr ? std::nullopt : client_request(bus_->bus().last_request(*exit_));
  }

 private:
  void inform(FixListener& listener) override { sides_.listeners.push_back(&listener); }
  [[nodiscard]] emulators::CanNodeCounters on_bus() const {
    return exit_ == nullptr ? emulators::CanNodeCounters{} : bus_->bus().counters(*exit_);
  }

  BaudCheck check_baud_;
  RigCan* bus_;
  std::unique_ptr<drivers::ByteStream> line_;  ///< With what follows: only with a serial line.
  std::optional<StreamOutlet> outlet_;
  std::optional<emulators::UbloxLineQuality> quality_;
  std::optional<emulators::StarFireReceiver> receiver_;
  emulators::FrameOutput* exit_ = nullptr;  ///< With the node: only on a bus.
  std::optional<emulators::StarFireNode> node_;
  BothSides sides_;
  StationOf<emulators::GnssBackend> station_{sides_, sides_};
};

}  // namespace

StarFireConfiguration::StarFireConfiguration() {
  sensor.systems.glonass = true;
  sensor.systems.sbas = true;
  sensor.corrections.kind = sim::CorrectionKind::service;
}

void StarFireConfiguration::visit(fields::Visitor& v) {
  v.text("path", path, "Symbolic link to the pty; what a client opens; empty = no serial line.");
  v.only_if(!path.empty(), "path", "a path: there is no serial line", [this](fields::Visitor& w) {
    w.integer("ports", ports, kPorts, kSerialPortsText);
    w.choice("check_baud", check_baud, kBaudChecks, "When a client receives garbage.");
  });
  v.text("bus", bus, "Name of the rig's bus that the device is on; empty = on none.");
  emulators::visit(v, receiver);
  v.section("mount", mount, "Where on the machine the antenna sits.");
  v.section("sensor", sensor, "How well it knows where it is.");
  v.list("faults", faults, "What goes wrong with the device, and when.");
}

void StarFireConfiguration::validate() const {
  if (path.empty() && bus.empty()) {
    throw std::invalid_argument("neither `path` nor `bus` is given, at least one is needed");
  }
  emulators::validate(receiver);
  sim::validate(sensor);
  check_corrections(sensor.corrections.kind, false, "StarFire 3000");
}

void StarFireConfiguration::check(const std::string& at, RigCheck& check) const {
  if (!path.empty()) {
    check.port_paths(at, path, ports);
  }
  if (!bus.empty()) {
    check.j1939_node(at, bus, receiver.source_address, receiver.serial);
  }
  check_bands(faults, bands_of(sensor), at, check);
  check.link(at + ".mount.link", mount.link);
}

void StarFireConfiguration::each_fault(const FaultEar& take) {
  show_faults(faults, take);
}

std::vector<fields::Named> StarFireConfiguration::fault_kinds() const {
  return mixed_kinds(faults);
}

DevicePlan StarFireConfiguration::plan(const RigView& /*rig*/) const {
  std::string wires = path.empty()
                          ? std::string()
                          : fmt::format("pty {} at {} baud", port_list(path, ports), receiver.baud);
  std::string frames;
  if (const auto share = bus_share({})) {
    wires += fmt::format("{}CAN bus {}, address 0x{:02X}", wires.empty() ? "" : "; ", bus,
                         receiver.source_address);
    frames = fmt::format("{:.1f} frames/s", share->frames_hz);
  }
  return {wires, epochs_text(1.0 / to_seconds(receiver.sentence_period)), frames,
          fmt::format("{} sentence{}", receiver.sentences.size(),
                      receiver.sentences.size() == 1 ? "" : "s")};
}

std::optional<BusShare> StarFireConfiguration::bus_share(std::string_view name) const {
  if (bus.empty()) {
    return std::nullopt;
  }
  return asked<emulators::StarFireNode>(bus_share_of(bus, name), receiver, some_calendar());
}

DeviceDescription StarFireConfiguration::describe() const {
  emulators::NullByteOutput output;
  DeviceDescription description;
  description.quantities =
      quantities_of(emulators::StarFireReceiver(receiver, some_calendar(), output));
  description.wire = "serial line on a pty, 8N1; CAN 2.0B at 250 kbit/s, J1939; either or both";
  description.document =
      "Operator's manual OMPFP11008 (serial output); SAE J1939-71, -81; NMEA 0183; what is not "
      "documented is marked in the page";
  description.messages = {
      {"GGA GSA RMC VTG ZDA", "1, 5 or 10 Hz", "NMEA sentences on the serial line"},
      {"65267 FEF3 vehicle position", "5 Hz", "latitude, longitude"},
      {"65256 FEE8 vehicle direction and speed", "5 Hz", "course, speed, pitch, altitude"},
      {"64502 FBF6 vehicle position 2", "0.2 Hz", "satellites, dilutions"}};
  return description;
}

std::unique_ptr<Device> StarFireConfiguration::make(Site& site) const {
  auto device =
      std::make_unique<StarFireDevice>(*this, site, bus.empty() ? nullptr : &site.bus(bus));
  mount_antenna(site, device->enlist(site.executive()), mount, sensor,
                those_of<sim::GnssFault>(faults));
  return device;
}

}  // namespace rigwire::hil
