// The client's place on an emulated CAN bus: its controller as the bus sees it, and what that
// controller tells the client.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "protocols/can/controller_report.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Hears what happens to the client's controller. Calls come from CanBusModel's advance(),
/// receive(), set_client() and restart_outside(), with times that never decrease.
class CanOutside {
 public:
  virtual ~CanOutside() = default;
  /// The oldest unsettled frame of CanBusModel::receive() was complete on the bus at `now`, or,
  /// with `sent` false, never will be: one-shot and failed, bus-off, queue full, nobody there.
  virtual void confirm(SimTime now, bool sent) = 0;
  /// An error that the controller saw, a change of its state, or both.
  virtual void report(SimTime now, const protocols::can::ControllerReport& report) = 0;
};

/// How the client has set its controller.
struct OutsideController {
  bool present = true;             ///< False: nobody there, nobody who acknowledges.
  std::uint32_t bit_rate_bps = 0;  ///< 10 000 .. 1 000 000; 0: the bus's.
  bool listen_only = false;        ///< Sends nothing, acknowledges nothing.
  bool one_shot = false;           ///< Tries every frame once only.
  /// From bus-off to the beginning of the recovery; nullopt: only by restart_outside(), or when the
  /// client closes and opens.
  std::optional<Duration> restart_after = std::chrono::milliseconds{100};

  friend bool operator==(const OutsideController&, const OutsideController&) = default;
};

}  // namespace rigwire::emulators
