#include "hil/device_line.h"

#include <vector>

#include "drivers/pty.h"
#include "emulators/iso_valve/iso_valves.h"
#include "emulators/openimu/openimu335ri.h"
#include "emulators/ublox/receiver.h"
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "hil/outlet.h"
#include "hil/station.h"

namespace rigwire::hil {
namespace {

class SerialGnssLine final : public GnssLine {
 public:
  SerialGnssLine(const UbloxConfiguration& configuration, const LineContext& context)
      : check_baud_(configuration.check_baud),
        pty_(context.io, configuration.path, configuration.receiver.baud),
        outlet_(pty_, own_statistics()),
        receiver_(settings(configuration, context), context.calendar, outlet_),
        backend_(receiver_),
        station_(receiver_, backend_) {}

  DeviceIndex enlist(Executive& executive) override {
    const DeviceIndex index = executive.add(station_);
    executive.add(outlet_);
    pty_.on_client([this, &executive](const drivers::LineClient& client) {
      receiver_.set_client(executive.arrive(),
                           {client.present, seen_baud(check_baud_, client.baud)});
    });
    pty_.start([this, &executive](std::span<const std::uint8_t> bytes) {
      receiver_.receive(client_arrived(executive), bytes);
    });
    return index;
  }

  void inform(LidarLine& lidar) override { backend_.lidars.push_back(&lidar); }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return pty_.status(); }
  [[nodiscard]] std::uint64_t frames() const override { return receiver_.messages_sent(); }
  [[nodiscard]] std::uint64_t dropped() const override {
    return statistics().dropped + receiver_.counters().messages_lost;
  }
  [[nodiscard]] const emulators::Device& device() const override { return receiver_; }

 private:
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
  drivers::Pty pty_;
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
    return statistics().dropped + bus_.bus().counters(node_).overflowed;
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
using BusValveLine = BusNodeLine<emulators::IsoValves, ValveStation>;

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

std::unique_ptr<DeviceLine> make_line(const OpenImuDeviceConfiguration& configuration,
                                      CanLine& bus) {
  return std::make_unique<BusImuLine>(configuration.imu, bus);
}

std::unique_ptr<DeviceLine> make_line(const VehicleGatewayConfiguration& configuration,
                                      CanLine& bus) {
  return std::make_unique<BusVehicleLine>(configuration.gateway, bus);
}

std::unique_ptr<DeviceLine> make_line(const IsoValvesConfiguration& configuration, CanLine& bus) {
  return std::make_unique<BusValveLine>(configuration.valves, bus);
}

}  // namespace rigwire::hil
