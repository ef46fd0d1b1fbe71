#include "hil/devices/ublox.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "emulators/device.h"
#include "emulators/ublox/receiver.h"
#include "emulators/usb/cdc_acm.h"
#include "fields/visitor.h"
#include "hil/devices/device.h"
#include "hil/devices/mounting.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/site.h"
#include "hil/executive/station.h"
#include "hil/wires/line_ports.h"
#include "hil/wires/outlets.h"
#include "hil/wires/usb_serial_stream.h"

namespace rigwire::hil {

using fields::Choice;

namespace {

constexpr std::array<Choice<SerialWire>, 2> kSerialWires{
    {{SerialWire::pty, "pty", "A pseudo-terminal under `path`."},
     {SerialWire::usb, "usb",
      "A device on the rig's USB server; the client's kernel makes a tty."}}};

class UbloxDevice final : public Device,
                          private FixSource,
                          private CorrectionSource,
                          private CorrectionListener {
 public:
  UbloxDevice(const UbloxConfiguration& configuration, Site& site)
      : check_baud_(configuration.check_baud),
        corrections_from_(configuration.corrections_from),
        line_(open_line(configuration, site)),
        outlet_(*line_, own_statistics()),
        second_(*this),
        receiver_(settings(configuration, site), site.calendar(), outlet_, second_),
        backend_(receiver_),
        station_(receiver_, backend_) {
    offer(antenna_faults(site.executive(), station_, bands_of(configuration.sensor),
                         those_of<sim::GnssFault>(configuration.faults)));
    offer(make_fault_port(those_of<emulators::UbloxFault>(configuration.faults),
                          acted_by<emulators::UbloxFault>(receiver_)));
    offer(make_fault_port(those_of<emulators::SupplyFault>(configuration.faults), supply_acts()));
  }

  [[nodiscard]] StationIndex enlist(Executive& executive) {
    const StationIndex index = executive.add(station_);
    executive.add(outlet_);
    outlet_.on_client([this, &executive](const drivers::LineClient& client) {
      receiver_.set_client(executive.arrive(),
                           {client.present, seen_baud(check_baud_, client.baud)});
    });
    outlet_.start([this, &executive](std::span<const std::uint8_t> bytes) {
      receiver_.receive(client_arrived(executive), bytes);
    });
    return index;
  }

  void connect(const Neighbours& neighbours) override {
    if (CorrectionSource* source =
            corrections_from_.empty() ? nullptr : neighbours.corrections_of(corrections_from_)) {
      source->inform(*this);
    }
  }

  [[nodiscard]] FixSource* fixes() override { return this; }
  [[nodiscard]] CorrectionSource* corrections() override { return this; }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return line_->status(); }
  [[nodiscard]] std::uint64_t frames() const override { return receiver_.messages_sent(); }
  [[nodiscard]] std::uint64_t dropped() const override {
    return statistics().dropped + receiver_.counters().messages_lost;
  }
  [[nodiscard]] const emulators::Device& emulator() const override { return receiver_; }
  [[nodiscard]] std::optional<ClientRequest> last_request() const override {
    return ublox_request(receiver_.last_request());
  }
  [[nodiscard]] std::string tell(SimTime now, const DeviceConfiguration& wanted,
                                 std::string_view key) override {
    return hil::tell(emulators::UbloxReceiver::live_settings(), key, receiver_, now,
                     static_cast<const UbloxConfiguration&>(wanted).receiver);
  }

 private:
  std::unique_ptr<drivers::ByteStream> open_line(const UbloxConfiguration& configuration,
                                                 Site& site) {
    if (configuration.wire == SerialWire::pty) {
      return open_serial_ports(site.io(), configuration.path, configuration.ports,
                               configuration.receiver.baud);
    }
    UsbBus& bus = site.usb();
    auto stream = std::make_unique<UsbSerialStream>(
        site.io(), bus, emulators::ublox_usb(configuration.receiver.profile->generation),
        site.name());
    plug_ = {&bus, stream->socket()};
    offer(begin_plug_faults(those_of<PlugFault>(configuration.faults), bus, plug_.socket));
    for (const auto& fault : those_of<emulators::SupplyFault>(configuration.faults)) {
      bus.begin(plug_.socket, fault);
    }
    return stream;
  }

  /// On USB a receiver without supply is not seen either.
  FaultActs<emulators::SupplyFault> supply_acts() {
    return {[this](const emulators::SupplyFault& fault) {
              receiver_.supply().begin(fault);
              if (plug_.bus != nullptr) {
                plug_.bus->begin(plug_.socket, fault);
              }
            },
            [this](std::uint32_t id, SimTime now) {
              return (plug_.bus == nullptr || plug_.bus->end_outage(plug_.socket, id, now)) &&
                     receiver_.supply().end(id, now);
            }};
  }

  static emulators::UbloxSettings settings(const UbloxConfiguration& configuration,
                                           const Site& site) {
    emulators::UbloxSettings settings = configuration.receiver;
    settings.faults = those_of<emulators::UbloxFault>(configuration.faults);
    settings.supply_faults = those_of<emulators::SupplyFault>(configuration.faults);
    settings.noise_seed = site.device_seed();
    settings.uses_corrections = configuration.sensor.corrections.kind == sim::CorrectionKind::rtk;
    return settings;
  }

  void inform(FixListener& listener) override { backend_.listeners.push_back(&listener); }
  void inform(CorrectionListener& listener) override { second_.listeners.push_back(&listener); }
  void hear_corrections(SimTime now, std::span<const std::uint8_t> bytes,
                        std::uint32_t baud) override {
    receiver_.receive_second(now, bytes, baud);
  }

  /// The second UART's line, to the devices that are wired to it.
  struct Second final : emulators::ByteOutput {
    explicit Second(UbloxDevice& of) : device(of) {}
    void send(SimTime due, std::span<const std::uint8_t> bytes) override {
      for (CorrectionListener* listener : listeners) {
        listener->hear_corrections(due, bytes, device.receiver_.second_baud());
      }
    }
    UbloxDevice& device;
    std::vector<CorrectionListener*> listeners;
  };

  /// The receiver's backend, with the listeners to its fixes.
  struct Backend final : emulators::GnssBackend {
    explicit Backend(emulators::UbloxReceiver& of) : receiver(of) {}
    [[nodiscard]] const Command& command() const override { return receiver.command(); }
    void update(const GnssSample& sample) override {
      const bool supplied = receiver.supply().on();
      receiver.update(sample);
      for (std::size_t i = 0; supplied && i < listeners.size(); ++i) {
        listeners[i]->observe_fix(sample);
      }
    }
    emulators::UbloxReceiver& receiver;
    std::vector<FixListener*> listeners;
  };

  /// On USB; else of no bus.
  struct Plug {
    UsbBus* bus = nullptr;
    UsbBus::Socket socket{};
  };

  BaudCheck check_baud_;
  std::string corrections_from_;
  Plug plug_;
  std::unique_ptr<drivers::ByteStream> line_;
  StreamOutlet outlet_;
  Second second_;
  emulators::UbloxReceiver receiver_;
  Backend backend_;
  StationOf<emulators::GnssBackend> station_;
};

}  // namespace

UbloxConfiguration::UbloxConfiguration(const emulators::UbloxProfile& profile) {
  receiver.profile = &profile;
  receiver.baud = profile.baud;
  sensor.sky.maximum_channels = profile.channels;
  sensor.raw_measurements = true;  // RXM-RAW, RXM-SFRBX, RXM-RAWX, when a client asks for them
  if (profile.generation < 8) {
    sensor.systems.sbas = true;
  } else if (profile.generation == 8) {
    // Fitted to the accuracies that receivers of these generations report in recordings
    // (docs/accuracy/README.md); those of a NEO-7P are the sensor's own.
    sensor.ranges.broadcast_share = 0.4;
    sensor.ranges.multipath_sigma_m = 0.35;
    sensor.systems = {.gps = true, .glonass = true, .sbas = true, .qzss = true};
  } else if (profile.generation > 8) {
    sensor.systems = {
        .gps = true, .glonass = true, .galileo = true, .beidou = true, .sbas = true, .qzss = true};
    sensor.second_signals = true;
    sensor.ranges.broadcast_share = 0.4;
    sensor.ranges.multipath_sigma_m = 0.3;
    receiver.transmit_buffer_bytes = 16'384;  // raw measurements, and all frames of a half minute
    sensor.corrections.kind = sim::CorrectionKind::rtk;
  }
}

void UbloxConfiguration::visit(fields::Visitor& v) {
  v.choice("wire", wire, kSerialWires, "What carries the bytes.");
  v.only_if(wire == SerialWire::pty, "wire", "wire: pty", [this](fields::Visitor& w) {
    w.text("path", path, "Symbolic link to the pty; what a client opens.");
    w.integer("ports", ports, kPorts, kSerialPortsText);
    w.choice("check_baud", check_baud, kBaudChecks, "When a client receives garbage.");
  });
  emulators::visit(v, receiver);
  if (receiver.profile->carrier_solution) {
    v.text("corrections_from", corrections_from,
           "Name of the base station, another ZED-F9P or a gnss-base, whose line its second UART "
           "receives; empty = none.");
  }
  v.section("mount", mount, "Where on the machine the antenna sits.");
  v.section("sensor", sensor, "How well it knows where it is.");
  v.list("faults", faults, "What goes wrong with the device, and when.");
}

void UbloxConfiguration::validate() const {
  emulators::validate(receiver);
  sim::validate(sensor);
  check_corrections(sensor.corrections.kind, receiver.profile->carrier_solution,
                    receiver.profile->name);
}

void UbloxConfiguration::check(const std::string& at, RigCheck& check) const {
  if (wire == SerialWire::pty) {
    check.port_paths(at, path, ports);
    for (std::size_t i = 0; i < faults.size(); ++i) {
      if (std::holds_alternative<UnpluggedFault>(faults[i].what)) {
        check.report(fmt::format("{}.faults.{}.type", at, i), "there is no plug", "unplugged",
                     "with wire: usb");
      }
    }
  } else {
    check.usb();
  }
  check_bands(faults, bands_of(sensor), at, check);
  check.link(at + ".mount.link", mount.link);
  if (!corrections_from.empty()) {
    check.base_station(at + ".corrections_from", corrections_from, at.substr(at.rfind('.') + 1));
  }
}

void UbloxConfiguration::each_fault(const FaultEar& take) {
  show_faults(faults, take);
}

std::vector<fields::Named> UbloxConfiguration::fault_kinds() const {
  return wire == SerialWire::usb
             ? hil::fault_kinds<PlugFault, sim::GnssFault, emulators::UbloxFault,
                                emulators::SupplyFault>()
             : hil::fault_kinds<sim::GnssFault, emulators::UbloxFault, emulators::SupplyFault>();
}

std::vector<LiveKey> UbloxConfiguration::live_keys() const {
  std::vector<LiveKey> keys = hil::live_keys(emulators::UbloxReceiver::live_settings());
  if (!receiver.profile->carrier_solution) {
    std::erase_if(keys, [](const LiveKey& key) { return key.key.starts_with("uart2"); });
  }
  return keys;
}

DevicePlan UbloxConfiguration::plan(const RigView& rig) const {
  double bytes = 0.0;
  const double rate_hz = 1.0 / to_seconds(receiver.measurement_period);
  for (const auto& names : {receiver.nmea_sentences, receiver.ubx_messages}) {
    for (const std::string& name : names) {
      const std::size_t index = emulators::message_index(*receiver.profile, name);
      if (index < receiver.profile->messages.size()) {
        bytes += static_cast<double>(receiver.profile->messages[index].greatest_bytes) * rate_hz;
      }
    }
  }
  constexpr double kBitsPerByte = 10.0;  // 8N1
  const std::string line =
      wire == SerialWire::pty ? "pty " + port_list(path, ports) : usb_wire(rig);
  return {fmt::format("{} at {} baud", line, receiver.baud), epochs_text(rate_hz),
          fmt::format("<= {:.0f} B/s", bytes),
          fmt::format("{:.0f} % of the line", 100.0 * bytes * kBitsPerByte / receiver.baud)};
}

std::optional<BusShare> UbloxConfiguration::bus_share(std::string_view /*name*/) const {
  return std::nullopt;
}

DeviceDescription UbloxConfiguration::describe() const {
  emulators::NullByteOutput output;
  DeviceDescription description;
  description.quantities =
      quantities_of(emulators::UbloxReceiver(receiver, some_calendar(), output));
  description.wire = "serial line on a pty, 8N1; or USB (CDC-ACM) by USB/IP";
  switch (receiver.profile->generation) {
    case 7:
      description.document =
          "u-blox M8 receiver description UBX-13003221 R28, with what recordings of a NEO-7P show "
          "of protocol 14";
      break;
    case 8:
      description.document = "u-blox M8 receiver description UBX-13003221 R28";
      break;
    default:
      description.document = "u-blox ZED-F9P interface description, HPG 1.13 to 1.51";
      break;
  }
  for (const emulators::UbloxMessage& message : receiver.profile->messages) {
    if (!message.name.empty() && message.greatest_bytes > 0) {
      description.messages.push_back(
          {(message.sentence ? "NMEA "
            : message.rtcm   ? ""
                             : "UBX ") +
               std::string(message.name),
           message.periodic ? "each epoch" : "when polled",
           fmt::format("class {:#04x} id {:#04x}, at most {} bytes", message.id.message_class,
                       message.id.message_id, message.greatest_bytes)});
    }
  }
  return description;
}

std::unique_ptr<Device> UbloxConfiguration::make(Site& site) const {
  auto device = std::make_unique<UbloxDevice>(*this, site);
  mount_antenna(site, device->enlist(site.executive()), mount, sensor,
                those_of<sim::GnssFault>(faults));
  return device;
}

}  // namespace rigwire::hil
