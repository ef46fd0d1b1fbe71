// Where a rig's USB devices are plugged in, whatever exports them, and what can happen to a plug
// and to the supply of the device behind it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "emulators/supply.h"
#include "emulators/usb/usb_device.h"
#include "fields/visitor.h"
#include "sim/samples/fault_book.h"

namespace rigwire::hil {

struct UnpluggedFault {
  static constexpr fields::Named kNamed{"unplugged", "The plug is out."};
};
inline void visit(fields::Visitor&, UnpluggedFault&) {}

struct PlugFault {
  FaultPeriod when;
  std::variant<UnpluggedFault> what;
};
inline void visit(fields::Visitor& v, PlugFault& p) {
  visit_fault(v, p);
}

class UsbBus {
 public:
  /// Number of a socket, never reused within a run.
  using Socket = std::uint16_t;
  virtual ~UsbBus() = default;

  /// Plugs `device` in from the start of the run; it must outlive every use of the bus. `name` is
  /// what a client sees in the list. The bus lets the device live (advance) from then on. Throws
  /// std::invalid_argument when the device's description is not valid.
  virtual Socket plug(emulators::UsbDevice& device, std::string_view name) = 0;
  /// Adds a fault of that plug. It begins no earlier than the bus was advanced to. Throws
  /// std::invalid_argument.
  virtual FaultBook<PlugFault>::Id begin(Socket socket, const PlugFault& fault) = 0;
  /// Ends a fault of that plug (FaultBook::end()).
  virtual bool end(Socket socket, FaultBook<PlugFault>::Id id, SimTime now) = 0;
  /// Adds or ends an outage of the device's supply: without supply the socket is empty.
  virtual FaultBook<emulators::SupplyFault>::Id begin(Socket socket,
                                                      const emulators::SupplyFault& fault) = 0;
  virtual bool end_outage(Socket socket, FaultBook<emulators::SupplyFault>::Id id, SimTime now) = 0;
  /// Returns whether a client has imported the device.
  [[nodiscard]] virtual bool imported(Socket socket) const = 0;
  /// Returns the address for a client: "usb 127.0.0.1:3240 1-1".
  [[nodiscard]] virtual std::string address(Socket socket) const = 0;
  /// Present simulated time.
  [[nodiscard]] virtual SimTime now() const = 0;
};

}  // namespace rigwire::hil
