// What a device may know of its rig: before a run as values, and while it is made the running parts
// that it takes its place in. Devices know nothing else of the rig, and nothing of each other but
// what device.h's Neighbours say.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hil/executive/executive.h"
#include "hil/wires/can_bus_configuration.h"
#include "hil/wires/modbus_line_configuration.h"
#include "hil/wires/rig_can.h"
#include "hil/wires/rig_modbus.h"
#include "hil/wires/usb_bus.h"
#include "hil/wires/usb_configuration.h"
#include "hil/world/shapes.h"
#include "hil/world/simulated_world.h"
#include "sim/gnss/antenna_book.h"
#include "sim/gnss/constellation.h"
#include "sim/local_frame.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

class CameraSurroundings;

/// The rig as it is configured. Refers to its configuration.
struct RigView {
  const std::map<std::string, BusConfiguration>& buses;
  const std::map<std::string, ModbusLineConfiguration>& modbus;
  const UsbConfiguration& usb;
  std::vector<std::string> links;  ///< Links of the machine.
  /// Actuators of the machine's valve block; empty: it has none.
  std::vector<std::string> actuators;
  bool drives = false;                 ///< The machine has a drive train.
  bool has_power_unit = false;         ///< The machine has an engine that drives pumps.
  std::vector<std::string> receivers;  ///< Names of the satellite receivers.
  /// Names of the devices that send corrections over a line.
  std::vector<std::string> base_stations;
};

/// What a client of the rig's USB devices attaches to.
[[nodiscard]] std::string usb_wire(const RigView& rig);

/// Where a device is made.
class Site {
 public:
  virtual ~Site() = default;

  /// Returns the name of the device in the rig.
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Returns the seed of every random stream of the rig; the streams are distinguished by name.
  [[nodiscard]] virtual std::uint64_t seed() const = 0;
  /// Returns the seed of the device's own random stream "<name>/<stream>".
  [[nodiscard]] virtual std::uint64_t stream_seed(std::string_view stream) const = 0;
  [[nodiscard]] std::uint64_t device_seed() const { return stream_seed("line"); }
  [[nodiscard]] virtual const Calendar& calendar() const = 0;
  [[nodiscard]] virtual boost::asio::io_context& io() = 0;
  [[nodiscard]] virtual Executive& executive() = 0;

  /// The CAN bus or Modbus line of that name; what joins it must live to its last advance().
  [[nodiscard]] virtual RigCan& bus(const std::string& bus) = 0;
  [[nodiscard]] virtual RigModbus& modbus(const std::string& line) = 0;
  /// Opens the server when the first device asks for it.
  [[nodiscard]] virtual UsbBus& usb() = 0;

  [[nodiscard]] virtual SimulatedWorld& world() = 0;
  /// Light and air of the rig's cameras.
  [[nodiscard]] virtual const std::shared_ptr<CameraSurroundings>& surroundings() const = 0;
  [[nodiscard]] virtual const std::shared_ptr<const sim::Constellation>& satellites() const = 0;
  /// Returns the antennas of the rig's receivers and base stations.
  [[nodiscard]] virtual const std::shared_ptr<sim::AntennaBook>& antennas() const = 0;
  [[nodiscard]] virtual const sim::LocalFrame& frame() const = 0;
  /// Throws std::invalid_argument when the machine has no such link.
  [[nodiscard]] virtual SensorMount mount(const MountConfiguration& mount) const = 0;
  [[nodiscard]] virtual std::size_t link(const std::string& link) const = 0;
};

}  // namespace rigwire::hil
