// When the vehicle gateway sends its active trouble codes: every second, and at once when they
// change, with at least a second between two changes reported at once (SAE J1939-73, 5.7.1.1).
// More than one code is broadcast in packets 50 ms apart (J1939-21, 5.10: 50..200 ms); a report on
// its way is finished before the next one begins.
#pragma once

#include <cstdint>
#include <optional>

#include "emulators/vehicle_gateway/control.h"
#include "protocols/can/frame.h"
#include "protocols/vehicle/diagnostics.h"

namespace rigwire::emulators {

class VehicleDiagnostics {
 public:
  static constexpr std::uint64_t kPeriodTicks = 100;  ///< Of 10 ms.
  static constexpr std::uint64_t kPhaseTicks = 50;
  static constexpr std::uint64_t kPacketTicks = 5;

  /// Somebody asked for the codes: they are sent in the next tick.
  void ask() { asked_ = true; }
  /// The frame to send in tick `tick`, if any. Call once for every tick in which messages may be
  /// sent.
  [[nodiscard]] std::optional<protocols::can::Frame> tick(std::uint64_t tick,
                                                          const VehicleControl& control,
                                                          std::uint8_t source);

 private:
  VehicleControl::Faults reported_;
  std::optional<std::uint64_t> last_change_;
  bool asked_ = false;
  protocols::vehicle::TroubleReport report_;
  std::size_t next_frame_ = 0;  ///< Of the report on its way.
  std::size_t frame_count_ = 0;
  std::uint64_t next_tick_ = 0;
};

}  // namespace rigwire::emulators
