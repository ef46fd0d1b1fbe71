// One device of the rig with everything between its emulator and its client: endpoint, outlets,
// statistics. One class per device type; CONTRIBUTING.md walks through adding one.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hil/devices/device_types.h"
#include "hil/devices/fix_listener.h"
#include "hil/devices/rig_status.h"
#include "hil/executive/executive.h"
#include "hil/wires/rig_can.h"
#include "hil/wires/usb_bus.h"
#include "hil/wires/wire_statistics.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

class DeviceLine {
 public:
  virtual ~DeviceLine() = default;
  DeviceLine(const DeviceLine&) = delete;
  DeviceLine& operator=(const DeviceLine&) = delete;

  /// Adds station and outlets to the executive and starts the endpoint. Once.
  virtual DeviceIndex enlist(Executive& executive) = 0;

  [[nodiscard]] virtual drivers::EndpointStatus endpoint() const = 0;
  /// Messages on the wire so far.
  [[nodiscard]] virtual std::uint64_t frames() const { return statistics_.units; }
  /// Units lost before and at the endpoint.
  [[nodiscard]] virtual std::uint64_t dropped() const { return statistics_.dropped; }
  [[nodiscard]] virtual const emulators::Device& device() const = 0;

  [[nodiscard]] virtual const WireStatistics& statistics() const { return statistics_; }
  [[nodiscard]] DeviceStatus status(const std::string& name, SimTime now) const;

 protected:
  DeviceLine() = default;
  [[nodiscard]] WireStatistics& own_statistics() { return statistics_; }
  /// To be called when a client has sent something; brings the devices up to the present.
  SimTime client_arrived(Executive& executive);

 private:
  WireStatistics statistics_;
};

/// What every line needs to be made.
struct LineContext {
  boost::asio::io_context& io;
  const Calendar& calendar;
  std::uint64_t device_seed = 0;  ///< Of what is random in the device itself.
  std::string name;               ///< Of the device in the rig.
  std::function<UsbBus&()> usb;   ///< The rig's; opened by the first who asks.
};

class LidarLine : public DeviceLine, public FixListener {
 public:
  /// For the firing pattern that the caster needs.
  [[nodiscard]] virtual const emulators::LidarBackend& backend() const = 0;
  /// Adds the station that hears how the lidar moves, when the device reports it. Once, after
  /// enlist().
  virtual std::optional<DeviceIndex> enlist_motion(Executive& executive) = 0;
};

class GnssLine : public DeviceLine {
 public:
  /// `listener` hears of every fix from now on. Must outlive the line.
  virtual void inform(FixListener& listener) = 0;
};
/// Opens its endpoint and throws drivers::EndpointError when that fails.
[[nodiscard]] std::unique_ptr<GnssLine> make_line(const UbloxConfiguration& configuration,
                                                  const LineContext& context);
/// `bus` must outlive the line.
[[nodiscard]] std::unique_ptr<DeviceLine> make_line(const OpenImuDeviceConfiguration& configuration,
                                                    CanLine& bus);
[[nodiscard]] std::unique_ptr<DeviceLine> make_line(
    const VehicleGatewayConfiguration& configuration, CanLine& bus);
[[nodiscard]] std::unique_ptr<DeviceLine> make_line(const XsensMtiConfiguration& configuration,
                                                    const LineContext& context, CanLine& bus);
[[nodiscard]] std::unique_ptr<DeviceLine> make_line(const EncoderDeviceConfiguration& configuration,
                                                    CanLine& bus);
[[nodiscard]] std::unique_ptr<DeviceLine> make_line(const IsoValvesConfiguration& configuration,
                                                    CanLine& bus);

}  // namespace rigwire::hil
