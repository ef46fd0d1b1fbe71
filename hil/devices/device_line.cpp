#include "hil/devices/device_line.h"

#include <vector>

#include "drivers/pty.h"
#include "emulators/iso_valve/iso_valves.h"
#include "emulators/ublox/receiver.h"
#include "emulators/usb/ublox_usb.h"
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "hil/devices/bus_node_line.h"
#include "hil/executive/station.h"
#include "hil/wires/outlets.h"
#include "hil/wires/usb_serial_stream.h"

namespace rigwire::hil {
namespace {

class SerialGnssLine final : public GnssLine {
 public:
  SerialGnssLine(const UbloxConfiguration& configuration, const LineContext& context)
      : check_baud_(configuration.check_baud),
        line_(open_line(configuration, context)),
        outlet_(*line_, own_statistics()),
        receiver_(settings(configuration, context), context.calendar, outlet_),
        backend_(receiver_),
        station_(receiver_, backend_) {}

  DeviceIndex enlist(Executive& executive) override {
    const DeviceIndex index = executive.add(station_);
    executive.add(outlet_);
    line_->on_client([this, &executive](const drivers::LineClient& client) {
      receiver_.set_client(executive.arrive(),
                           {client.present, seen_baud(check_baud_, client.baud)});
    });
    line_->start([this, &executive](std::span<const std::uint8_t> bytes) {
      receiver_.receive(client_arrived(executive), bytes);
    });
    return index;
  }

  void inform(FixListener& listener) override { backend_.listeners.push_back(&listener); }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return line_->status(); }
  [[nodiscard]] std::uint64_t frames() const override { return receiver_.messages_sent(); }
  [[nodiscard]] std::uint64_t dropped() const override {
    return statistics().dropped + receiver_.counters().messages_lost;
  }
  [[nodiscard]] const emulators::Device& device() const override { return receiver_; }

 private:
  static std::unique_ptr<drivers::ByteStream> open_line(const UbloxConfiguration& configuration,
                                                        const LineContext& context) {
    if (configuration.wire == SerialWire::pty) {
      return std::make_unique<drivers::Pty>(context.io, configuration.path,
                                            configuration.receiver.baud);
    }
    UsbBus& bus = context.usb();
    auto stream = std::make_unique<UsbSerialStream>(
        context.io, bus, emulators::ublox_usb(configuration.receiver.profile->generation),
        context.name);
    for (const UnplugConfiguration& unplug : configuration.unplugged) {
      bus.schedule_unplug(stream->socket(), kStart + unplug.at, kStart + unplug.at + unplug.length);
    }
    return stream;
  }

  static emulators::UbloxSettings settings(const UbloxConfiguration& configuration,
                                           const LineContext& context) {
    emulators::UbloxSettings settings = configuration.receiver;
    settings.faults = ublox_faults(configuration.faults);
    settings.noise_seed = context.device_seed;
    return settings;
  }

  /// The receiver's backend, with those who hear of its fixes.
  struct Backend final : emulators::GnssBackend {
    explicit Backend(emulators::UbloxReceiver& of) : receiver(of) {}
    void update(const GnssSample& sample) override {
      receiver.update(sample);
      for (FixListener* listener : listeners) {
        listener->observe_fix(sample);
      }
    }
    emulators::UbloxReceiver& receiver;
    std::vector<FixListener*> listeners;
  };

  BaudCheck check_baud_;
  std::unique_ptr<drivers::ByteStream> line_;
  StreamOutlet outlet_;
  emulators::UbloxReceiver receiver_;
  Backend backend_;
  GnssStation station_;
};

using BusValveLine = BusNodeLine<emulators::IsoValves, ValveStation>;

class BusVehicleLine final : public BusNodeLine<emulators::VehicleGateway, VehicleStation>,
                             public FixListener {
 public:
  using BusNodeLine::BusNodeLine;
  void observe_fix(const GnssSample& sample) override { emulator().observe_fix(sample); }
};

}  // namespace

SimTime DeviceLine::client_arrived(Executive& executive) {
  const SimTime now = executive.arrive();
  statistics_.last_client_activity = now;
  return now;
}

DeviceStatus DeviceLine::status(const std::string& name, SimTime now) const {
  const drivers::EndpointStatus wire = endpoint();
  const WireStatistics& known = statistics();
  DeviceStatus status;
  status.name = name;
  status.wire = wire.address;
  status.client_present = wire.client_present;
  status.frames = frames();
  status.bytes = known.bytes;
  status.dropped = dropped();
  status.nominal_rate_hz = device().nominal_rate_hz();
  status.lateness_p50 = known.lateness.percentile(0.5);
  status.lateness_p99 = known.lateness.percentile(0.99);
  status.lateness_max = known.lateness.max();
  if (known.last_client_activity) {
    status.since_client_activity = now - *known.last_client_activity;
  }
  return status;
}

std::unique_ptr<GnssLine> make_line(const UbloxConfiguration& configuration,
                                    const LineContext& context) {
  return std::make_unique<SerialGnssLine>(configuration, context);
}

std::unique_ptr<DeviceLine> make_line(const VehicleGatewayConfiguration& configuration,
                                      CanLine& bus) {
  return std::make_unique<BusVehicleLine>(bus, settings_of(configuration));
}

std::unique_ptr<DeviceLine> make_line(const IsoValvesConfiguration& configuration, CanLine& bus) {
  return std::make_unique<BusValveLine>(bus, configuration.valves);
}

}  // namespace rigwire::hil
