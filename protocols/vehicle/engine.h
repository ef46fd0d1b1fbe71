// Engine: its state (EEC1, EEC2, EEC3) and the request to it (TSC1).
#pragma once

#include <cmath>

#include "protocols/can/frame.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// One count of 1/8 rpm; shared by all shaft speeds.
inline constexpr Scale kShaftSpeed{0.125 * kRevolutionPerMinute_radps, 0.0, "rad/s", kInRpm};
/// One count of 1 %, from -125 %.
inline constexpr Scale kTorqueShare{kPercent, -1.25, "1", kInPercent};
/// One count of 0.4 %.
inline constexpr Scale kShare{0.4 * kPercent, 0.0, "1", kInPercent};

/// Electronic Engine Controller 1. Torques are shares of the engine's reference torque.
struct Eec1 {
  static constexpr Group kGroup{"EEC1", 61444, 3, std::chrono::milliseconds{20}};

  std::uint8_t torque_mode = 0xF;  ///< 4 bits; what governs the torque.
  double demand_torque_share = kNotAvailable;
  double actual_torque_share = kNotAvailable;
  double speed_radps = kNotAvailable;
  std::uint8_t controlling_address = 0xFF;
  std::uint8_t starter_mode = 0xF;
  double engine_demand_torque_share = kNotAvailable;  ///< What its governors ask of it, in all.

  static constexpr auto parameters() {
    return std::array{
        code("engine torque mode", 899, {1, 1}, 4, &Eec1::torque_mode),
        number("driver's demand torque", 512, {2}, 8, kTorqueShare, &Eec1::demand_torque_share),
        number("actual torque", 513, {3}, 8, kTorqueShare, &Eec1::actual_torque_share),
        number("engine speed", 190, {4}, 16, kShaftSpeed, &Eec1::speed_radps),
        code("controlling address", 1483, {6}, 8, &Eec1::controlling_address),
        code("starter mode", 1675, {7, 1}, 4, &Eec1::starter_mode),
        number("engine demand torque", 2432, {8}, 8, kTorqueShare,
               &Eec1::engine_demand_torque_share),
    };
  }
};

/// Electronic Engine Controller 2.
struct Eec2 {
  static constexpr Group kGroup{"EEC2", 61443, 3, std::chrono::milliseconds{50}};

  double pedal_share = kNotAvailable;
  double load_share = kNotAvailable;  ///< Share of the max torque at the present speed.

  static constexpr auto parameters() {
    return std::array{
        number("accelerator pedal position", 91, {2}, 8, kShare, &Eec2::pedal_share),
        number("load at current speed", 92, {3}, 8, {kPercent, 0.0, "1", kInPercent},
               &Eec2::load_share),
    };
  }
};

/// Electronic Engine Controller 3.
struct Eec3 {
  static constexpr Group kGroup{"EEC3", 65247, 6, std::chrono::milliseconds{250}};

  double friction_torque_share = kNotAvailable;  ///< The engine's own, of the reference torque.
  double desired_speed_radps = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        number("nominal friction", 514, {1}, 8, kTorqueShare, &Eec3::friction_torque_share),
        number("desired operating speed", 515, {2}, 16, kShaftSpeed, &Eec3::desired_speed_radps),
    };
  }
};

/// What TSC1 asks of the engine.
enum class OverrideMode : std::uint8_t {
  disabled = 0,
  speed = 1,
  torque = 2,
  limit = 3,  ///< Speed and torque are upper limits for another node's demand.
};

/// Torque/Speed Control 1, addressed.
struct Tsc1 {
  static constexpr Group kGroup{"TSC1", 0, 3, std::chrono::milliseconds{10}};

  std::uint8_t override_mode = 0;       ///< OverrideMode.
  std::uint8_t speed_condition = 3;     ///< 2 bits: how tightly speed is governed.
  std::uint8_t priority = 3;            ///< 2 bits: 0 highest .. 3 lowest.
  double speed_radps = kNotAvailable;   ///< Requested, or limit.
  double torque_share = kNotAvailable;  ///< Requested, or limit.
  std::uint8_t counter = 0xF;           ///< 4 bits, 0 .. 7 in turn; ones: not used.
  std::uint8_t checksum = 0xF;          ///< 4 bits, torque_speed_checksum(); ones: not used.

  static constexpr auto parameters() {
    return std::array{
        code("override control mode", 695, {1, 1}, 2, &Tsc1::override_mode),
        code("requested speed condition", 696, {1, 3}, 2, &Tsc1::speed_condition),
        code("override mode priority", 897, {1, 5}, 2, &Tsc1::priority),
        number("requested speed", 898, {2}, 16, kShaftSpeed, &Tsc1::speed_radps),
        number("requested torque", 518, {4}, 8, kTorqueShare, &Tsc1::torque_share),
        code("message counter", 4206, {8, 1}, 4, &Tsc1::counter),
        code("message checksum", 4207, {8, 5}, 4, &Tsc1::checksum),
    };
  }
};

/// Whether a request has the numbers that its mode is about.
[[nodiscard]] inline bool is_complete(const Tsc1& request) {
  const bool speed = std::isfinite(request.speed_radps);
  const bool torque = std::isfinite(request.torque_share);
  switch (static_cast<OverrideMode>(request.override_mode)) {
    case OverrideMode::speed:
      return speed;
    case OverrideMode::torque:
      return torque;
    case OverrideMode::limit:
      return speed || torque;
    case OverrideMode::disabled:
      break;
  }
  return true;
}

/// What closes a TSC1: over the first seven bytes of its frame, its counter and the four bytes of
/// its identifier. Source: SAE J1939-71, SPN 4207, as Deutz, Parker and Enovation cite it.
[[nodiscard]] inline std::uint8_t torque_speed_checksum(const can::Frame& frame) {
  // The sum, folded to three bits.
  unsigned sum = frame.data[7] & 0xFU;
  for (std::size_t i = 0; i < 7; ++i) {
    sum += frame.data[i];
  }
  for (unsigned shift = 0; shift < 32; shift += 8) {
    sum += (frame.id >> shift) & 0xFFU;
  }
  return static_cast<std::uint8_t>((((sum >> 6U) & 3U) + (sum >> 3U) + sum) & 7U);
}

}  // namespace rigwire::protocols::vehicle
