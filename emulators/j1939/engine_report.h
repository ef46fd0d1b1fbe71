// What every engine says of itself on a J1939 bus, whatever it drives: friction and desired speed
// (EEC3), fluids (EFL/P1, ET1, DD1), battery (VEP1), fuel (LFE1, LFC1), hours (HOURS), and its
// configuration (EC1), which it sends by itself. What depends on who asks it for what (EEC1, EEC2)
// is its device's.
//
// Layouts and sources: protocols/vehicle/engine.h, condition.h, engine_configuration.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "emulators/j1939/j1939_node.h"
#include "protocols/can/frame.h"
#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/engine_configuration.h"
#include "sim/samples/engine_sample.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

class EngineReport {
 public:
  /// `hours`: how long the engine has run in its life when the run begins.
  EngineReport(const EngineData& engine, Duration hours);

  /// Adds up the engine's hours and revolutions since the sample before.
  void take(SimTime time, const EngineSample& sample);

  /// Returns the frame of group `pgn`, if it is one of these. Without a sample everything but the
  /// hours is not available.
  [[nodiscard]] std::optional<protocols::can::Frame> frame(std::uint32_t pgn, std::uint8_t source,
                                                           const EngineSample* sample) const;

  /// Returns the torque of the cylinders as a share of the reference torque (SPN 513); not
  /// available for an engine without one.
  [[nodiscard]] double torque_share(const EngineSample& sample) const;
  /// Returns the torque of the cylinders as a share of the maximum at this speed (SPN 92).
  [[nodiscard]] static double load_share(const EngineSample& sample);

  /// Sends EC1 where it is due in tick `tick` of 10 ms, or was while another message of that length
  /// was on its way. Call once for every tick in which the node may send.
  void send_due(J1939Node& node, SimTime now, std::uint64_t tick);
  /// Sends EC1; `unknown` for an engine without a reference torque.
  [[nodiscard]] J1939Answer send_configuration(J1939Node& node, SimTime now,
                                               std::uint8_t destination) const;

 private:
  [[nodiscard]] std::optional<
      std::array<std::uint8_t, protocols::vehicle::kEngineConfigurationBytes>>
  configuration() const;
  [[nodiscard]] double share(double torque_nm) const;

  EngineData engine_;
  double running_s_;
  double turns_ = 0.0;
  std::optional<SimTime> taken_;
  bool configuration_due_ = false;
};

/// Checks whether a torque/speed request (TSC1) counts, by the counter and the checksum at its end.
///
/// Source: SAE J1939-71, SPN 4206 and 4207. The counter increments from message to message of one
/// node; an unchanged one marks the same message again. All bits set in both: the sender does not
/// use them.
class TorqueSpeedCheck {
 public:
  /// `required`: requests that do not use counter and checksum do not count.
  explicit TorqueSpeedCheck(bool required) : required_(required) { counters_.fill(kNone); }

  /// Looks at the next request of the node `source`: the frame, and what it holds.
  [[nodiscard]] bool passes(const protocols::can::Frame& frame,
                            const protocols::vehicle::Tsc1& request, std::uint8_t source);

 private:
  static constexpr std::uint8_t kNone = 0xFF;

  bool required_;
  std::array<std::uint8_t, 256> counters_{};  ///< Last of each node.
};

}  // namespace rigwire::emulators
