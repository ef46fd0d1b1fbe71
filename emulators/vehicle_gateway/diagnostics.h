// When the vehicle gateway sends its active trouble codes: every second, and at once when they
// change, with at least a second between two changes reported at once (SAE J1939-73, 5.7.1.1).
#pragma once

#include <cstdint>
#include <optional>

#include "emulators/vehicle_gateway/control.h"
#include "protocols/vehicle/diagnostics.h"

namespace rigwire::emulators {

class VehicleDiagnostics {
 public:
  static constexpr std::uint64_t kPeriodTicks = 100;  ///< Of 10 ms.
  static constexpr std::uint64_t kPhaseTicks = 50;

  /// Whether DM1 is to be sent in tick `tick`. Call once for every tick in which messages may be
  /// sent.
  [[nodiscard]] bool is_due(std::uint64_t tick, const VehicleControl& control);
  /// What was due could not be sent; it is due again in the next tick.
  void postpone() { postponed_ = true; }

  /// DM1 and DM2.
  [[nodiscard]] static protocols::vehicle::TroubleReport active(const VehicleControl& control);
  [[nodiscard]] static protocols::vehicle::TroubleReport previous(const VehicleControl& control);

 private:
  VehicleControl::Faults reported_;
  std::optional<std::uint64_t> last_change_;
  bool postponed_ = false;
};

}  // namespace rigwire::emulators
