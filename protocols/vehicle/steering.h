// Steering: its state (VDC2, ESC1, guidance machine info) and the request to it (guidance system
// command).
//
// Angles are left positive on the wire and here. Curvature is right positive on the wire (Danfoss
// PVED-CL protocol, GuidanceSystemCommand: negative drives left) and left positive here.
#pragma once

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// One count of 1/4 per km, from -8032 per km.
inline constexpr Scale kCurvature{0.25e-3, -8.032, "1/m", kPerKilometre};

/// Vehicle Dynamic Stability Control 2: the steering wheel, and motion where it is measured.
struct Vdc2 {
  static constexpr Group kGroup{"VDC2", 61449, 6, std::chrono::milliseconds{10}};

  double steering_wheel_rad = kNotAvailable;
  std::uint8_t turn_counter = 0x3F;  ///< 6 bits; turns + 32.
  double yaw_rate_radps = kNotAvailable;
  double lateral_acceleration_mps2 = kNotAvailable;
  double longitudinal_acceleration_mps2 = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        number("steering wheel angle", 1807, {1}, 16, {1.0 / 1024.0, -31.374, "rad"},
               &Vdc2::steering_wheel_rad),
        code("steering wheel turns", 1811, {3, 1}, 6, &Vdc2::turn_counter),
        number("yaw rate", 1808, {4}, 16, {1.0 / 8192.0, -3.92, "rad/s"}, &Vdc2::yaw_rate_radps),
        number("lateral acceleration", 1809, {6}, 16, {1.0 / 2048.0, -15.687, "m/s2"},
               &Vdc2::lateral_acceleration_mps2),
        number("longitudinal acceleration", 1810, {8}, 8, {0.1, -12.5, "m/s2"},
               &Vdc2::longitudinal_acceleration_mps2),
    };
  }
};

/// Steering Angle Sensor Information. The checksum's rule is in none of the available documents: it
/// is sent as not available.
struct Sas {
  static constexpr Group kGroup{"SAS", 61469, 6, std::chrono::milliseconds{10}};

  double steering_wheel_rad = kNotAvailable;
  std::uint8_t range_counter = 0x3F;  ///< 6 bits; ranges + 32.
  Switch active = Switch::not_available;
  Switch calibrated = Switch::not_available;
  std::uint8_t counter = 0xF;   ///< 4 bits; 0 .. 15.
  std::uint8_t checksum = 0xF;  ///< 4 bits.

  static constexpr auto parameters() {
    return std::array{
        number("steering wheel angle", 3683, {1}, 16, {1.0 / 1024.0, -31.374, "rad"},
               &Sas::steering_wheel_rad),
        code("range counter", 3684, {3, 1}, 6, &Sas::range_counter),
        state("sensor active", 3687, {7, 1}, &Sas::active),
        state("sensor calibrated", 3688, {7, 3}, &Sas::calibrated),
        code("message counter", 3689, {8, 1}, 4, &Sas::counter),
        code("message checksum", 3690, {8, 5}, 4, &Sas::checksum),
    };
  }
};

/// Places of an axle, front to rear in the high four bits; the low four (left to right) are ones,
/// as an axle has no side. Source: general knowledge of J1939-71.
inline constexpr std::uint8_t kFrontAxle = 0x0F;
inline constexpr std::uint8_t kRearAxle = 0x1F;

/// Electronic Steering Control 1, one message for each steered axle.
struct Esc1 {
  static constexpr Group kGroup{"ESC1", 61451, 6, std::chrono::milliseconds{20}};

  double steer_rad = kNotAvailable;
  std::uint8_t location = 0xFF;  ///< kFrontAxle, kRearAxle.

  static constexpr auto parameters() {
    return std::array{
        number("inner wheel angle", 2927, {1}, 16,
               {kDegree_rad / 256.0, -125.0 * kDegree_rad, "rad", kInDegree}, &Esc1::steer_rad),
        code("axle location", 2928, {3}, 8, &Esc1::location),
    };
  }
};

/// Why steering left a command or limits it; ISO 11783-7 exit/reason codes and limit states that
/// this project sends.
enum class ExitReason : std::uint8_t {
  none = 0,
  released = 2,  ///< By the commander.
  command_timeout = 5,
  out_of_range = 6,
  function_fault = 9,
  gear = 22,  ///< Gear or parking brake do not allow it.
  other_error = 62,
  not_available = 63,
};
enum class LimitStatus : std::uint8_t {
  not_limited = 0,
  operator_limited = 1,
  limited_high = 2,
  limited_low = 3,
  not_recoverable = 6,
  not_available = 7,
};

/// ISO 11783-7 guidance machine info: what the machine says about its steering.
struct GuidanceMachineInfo {
  static constexpr Group kGroup{"GMS", 44032, 3, std::chrono::milliseconds{100}};

  double curvature_1pm = kNotAvailable;  ///< Estimated, left positive.
  Switch lockout = Switch::not_available;
  Switch ready = Switch::not_available;
  Switch input_position_correct = Switch::not_available;
  Switch reset_required = Switch::not_available;
  std::uint8_t limit_status = 7;    ///< LimitStatus; 3 bits.
  std::uint8_t exit_reason = 0x3F;  ///< ExitReason; 6 bits.
  Switch engage_switch = Switch::not_available;

  static constexpr auto parameters() {
    return std::array{
        mirrored(number("estimated curvature", 5238, {1}, 16, kCurvature,
                        &GuidanceMachineInfo::curvature_1pm)),
        state("mechanical lock-out", 5243, {3, 1}, &GuidanceMachineInfo::lockout),
        state("steering system ready", 5242, {3, 3}, &GuidanceMachineInfo::ready),
        state("input position", 5241, {3, 5}, &GuidanceMachineInfo::input_position_correct),
        state("reset request", 5240, {3, 7}, &GuidanceMachineInfo::reset_required),
        code("limit status", 5726, {4, 6}, 3, &GuidanceMachineInfo::limit_status),
        code("exit/reason code", 5725, {5, 1}, 6, &GuidanceMachineInfo::exit_reason),
        state("remote engage switch", 9726, {5, 7}, &GuidanceMachineInfo::engage_switch),
    };
  }
};

/// ISO 11783-7 guidance system command.
struct GuidanceCommand {
  static constexpr Group kGroup{"GSC", 44288, 3, std::chrono::milliseconds{100}};

  double curvature_1pm = kNotAvailable;     ///< Left positive.
  Switch intended = Switch::not_available;  ///< On: steer; off: do not steer.

  static constexpr auto parameters() {
    return std::array{
        mirrored(number("curvature command", 5237, {1}, 16, kCurvature,
                        &GuidanceCommand::curvature_1pm)),
        state("curvature command status", 5239, {3, 1}, &GuidanceCommand::intended),
    };
  }
};

}  // namespace rigwire::protocols::vehicle
