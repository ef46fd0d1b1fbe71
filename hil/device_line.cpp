#include "hil/device_line.h"

#include <vector>

#include "drivers/pty.h"
#include "drivers/tcp_server.h"
#include "emulators/openimu/openimu335ri.h"
#include "emulators/ublox/receiver.h"
#include "emulators/usb/ublox_usb.h"
#include "emulators/valve_driver/valve_driver.h"
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "hil/outlet.h"
#include "hil/station.h"
#include "hil/usb_serial_stream.h"

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

  void inform(LidarLine& lidar) override { backend_.lidars.push_back(&lidar); }

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

  /// The receiver's backend, with the lidars that hear of its fixes.
  struct Backend final : emulators::GnssBackend {
    explicit Backend(emulators::UbloxReceiver& of) : receiver(of) {}
    void update(const GnssSample& sample) override {
      receiver.update(sample);
      for (LidarLine* lidar : lidars) {
        lidar->observe_fix(sample);
      }
    }
    emulators::UbloxReceiver& receiver;
    std::vector<LidarLine*> lidars;
  };

  BaudCheck check_baud_;
  std::unique_ptr<drivers::ByteStream> line_;
  StreamOutlet outlet_;
  emulators::UbloxReceiver receiver_;
  Backend backend_;
  GnssStation station_;
};

/// A device that is a node of a CAN bus.
template <class Emulator, class StationType>
class BusNodeLine final : public DeviceLine {
 public:
  template <class Settings>
  BusNodeLine(const Settings& settings, CanLine& bus)
      : bus_(bus),
        node_(bus.add_node(own_statistics())),
        emulator_(settings, node_),
        station_(emulator_, emulator_) {
    bus_.attach(node_, emulator_);
  }

  DeviceIndex enlist(Executive& executive) override { return executive.add(station_); }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return bus_.endpoint(); }
  [[nodiscard]] std::uint64_t dropped() const override {
    const emulators::CanNodeCounters counters = bus_.bus().counters(node_);
    return statistics().dropped + counters.overflowed + counters.abandoned;
  }
  [[nodiscard]] const emulators::Device& device() const override { return emulator_; }

 private:
  CanLine& bus_;
  emulators::FrameOutput& node_;
  Emulator emulator_;
  StationType station_;
};
using BusImuLine = BusNodeLine<emulators::OpenImu, ImuStation>;
using BusVehicleLine = BusNodeLine<emulators::VehicleGateway, VehicleStation>;

class TcpValveLine final : public DeviceLine {
 public:
  TcpValveLine(const ValveDriverConfiguration& configuration, const LineContext& context)
      : server_(context.io, server_settings(configuration)),
        outlet_(server_, own_statistics()),
        driver_(configuration.driver, outlet_),
        station_(driver_, driver_) {}

  DeviceIndex enlist(Executive& executive) override {
    const DeviceIndex index = executive.add(station_);
    executive.add(outlet_);
    server_.start({
        .connected =
            [this, &executive](emulators::ConnectionId connection) {
              driver_.connected(executive.arrive(), connection);
            },
        .received =
            [this, &executive](emulators::ConnectionId connection,
                               std::span<const std::uint8_t> bytes) {
              driver_.receive(client_arrived(executive), connection, bytes);
            },
        .disconnected =
            [this, &executive](emulators::ConnectionId connection) {
              driver_.disconnected(executive.arrive(), connection);
            },
    });
    return index;
  }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return server_.status(); }
  [[nodiscard]] const emulators::Device& device() const override { return driver_; }

 private:
  static drivers::TcpServerSettings server_settings(const ValveDriverConfiguration& configuration) {
    drivers::TcpServerSettings settings;
    settings.address = configuration.address;
    settings.port = configuration.port;
    settings.allow_remote = configuration.allow_remote;
    return settings;
  }

  drivers::TcpServer server_;
  ServerOutlet outlet_;
  emulators::ValveDriver driver_;
  ValveStation station_;
};

}  // namespace

SimTime DeviceLine::client_arrived(Executive& executive) {
  const SimTime now = executive.arrive();
  statistics_.last_client_activity = now;
  return now;
}

DeviceStatus DeviceLine::status(const std::string& name, SimTime now) const {
  const drivers::EndpointStatus wire = endpoint();
  DeviceStatus status;
  status.name = name;
  status.wire = wire.address;
  status.client_present = wire.client_present;
  status.frames = frames();
  status.bytes = statistics_.bytes;
  status.dropped = dropped();
  status.nominal_rate_hz = device().nominal_rate_hz();
  status.lateness_p50 = statistics_.lateness.percentile(0.5);
  status.lateness_p99 = statistics_.lateness.percentile(0.99);
  status.lateness_max = statistics_.lateness.max();
  if (statistics_.last_client_activity) {
    status.since_client_activity = now - *statistics_.last_client_activity;
  }
  return status;
}

std::unique_ptr<GnssLine> make_line(const UbloxConfiguration& configuration,
                                    const LineContext& context) {
  return std::make_unique<SerialGnssLine>(configuration, context);
}

std::unique_ptr<DeviceLine> make_line(const OpenImuDeviceConfiguration& configuration,
                                      CanLine& bus) {
  return std::make_unique<BusImuLine>(configuration.imu, bus);
}

std::unique_ptr<DeviceLine> make_line(const VehicleGatewayConfiguration& configuration,
                                      CanLine& bus) {
  return std::make_unique<BusVehicleLine>(configuration.gateway, bus);
}

std::unique_ptr<DeviceLine> make_line(const ValveDriverConfiguration& configuration,
                                      const LineContext& context) {
  return std::make_unique<TcpValveLine>(configuration, context);
}

}  // namespace rigwire::hil
