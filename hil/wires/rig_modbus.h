// One Modbus line of the rig at run time: the wire to the clients and the server in front of the
// devices' units.
//
// Units are added before the run, before or after start(). The line goes to the executive first,
// then its outlet. It owns endpoint, outlet and server; the units are the devices'.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <vector>

#include "drivers/endpoints.h"
#include "emulators/modbus/modbus_unit.h"
#include "hil/configuration/fault_port.h"
#include "hil/executive/event_source.h"
#include "hil/executive/executive.h"
#include "hil/wires/modbus_line_configuration.h"
#include "hil/wires/wire_statistics.h"

namespace rigwire::hil {

class RigModbus : public EventSource {
 public:
  /// `unit` must outlive the last call of advance() and of the io_context.
  virtual void add_unit(std::uint8_t number, emulators::ModbusUnit& unit) = 0;
  /// Adds line and outlet to the executive and starts the endpoint. Once.
  virtual void start(Executive& executive) = 0;

  /// Returns the port for the line's faults; `configured`: those that it was made with. It must
  /// outlive the port.
  [[nodiscard]] virtual std::unique_ptr<FaultPort> fault_port(
      const std::vector<emulators::ModbusFault>& configured) = 0;

  [[nodiscard]] virtual drivers::EndpointStatus endpoint() const = 0;
  /// Returns the statistics of all devices of the line together.
  [[nodiscard]] const WireStatistics& statistics() const { return statistics_; }

  [[nodiscard]] SimTime next_wakeup() const override { return next_event(); }

 protected:
  [[nodiscard]] WireStatistics& own_statistics() { return statistics_; }
  /// To be called when a client has sent something; brings the devices up to the present.
  SimTime client_arrived(Executive& executive) {
    const SimTime now = executive.arrive();
    statistics_.last_client_activity = now;
    return now;
  }

 private:
  WireStatistics statistics_;
};

/// Opens the endpoint. Throws drivers::EndpointError, std::invalid_argument. `seed` is of what is
/// random in the line: delays and faults.
[[nodiscard]] std::unique_ptr<RigModbus> make_rig_modbus(
    const ModbusLineConfiguration& configuration, boost::asio::io_context& io, std::uint64_t seed);

}  // namespace rigwire::hil
