// The data messages of the ACEINNA OpenIMU300RI, MTLT305D and OpenIMU335RI on J1939: slope (SSI2),
// angular rate (ARI), acceleration (ACCS); of the 300RI also the magnetic field, of the 335RI the
// older slope message (SSI1) and the fine angular rate.
//
// Sources: Aceinna openIMU300-lib and openIMU335RI-lib (open firmware, J1939 message definitions);
// the annex of SAE J1939 (October 2020 extract) for positions and scales. docs/devices/
// openimu335ri.md has the worked bytes. All are 8 bytes, broadcast:
//
//   PGN          bytes 1..6 (little-endian)                byte 7                       byte 8
//   61481 SSI2   pitch u24, roll u24: deg/32768 - 250      compensation and merit x 2   latency
//   61482 ARI    pitch, roll, yaw rate u16: deg/s/128-250  merit x 3, 2 bits 0          latency
//   61485 ACCS   lateral, longitudinal, vertical u16:      merit x 3, repetition        latency or
//                0.01 m/s2 - 320                           rate code 2                  0
//   FF6A         x, y, z u16: 0.25 mG - 8 G                0                            0
//   61459 SSI1   pitch, roll, pitch rate u16: deg/500-64   merit x 3, compensation      latency
//   FF6B         pitch, roll, yaw rate, 19 bits each: deg/s/1024 - 250; merit x 3 from bit 57
//
// (The 335RI's fine acceleration is left out: firmware and description disagree on its group.)
//
// Signs and axes are those of the device's settings; axes.h holds them. Numbers are sent and read
// as those of protocols/vehicle: NaN is not available, an infinity an error.
#pragma once

#include <array>
#include <cstdint>

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::openimu {

inline constexpr std::uint32_t kSlopePgn = 61481;         ///< F029 Slope Sensor Information 2.
inline constexpr std::uint32_t kAngularRatePgn = 61482;   ///< F02A.
inline constexpr std::uint32_t kAccelerationPgn = 61485;  ///< F02D.

inline constexpr std::uint32_t kMagneticFieldPgn = 0xFF6A;
inline constexpr std::uint32_t kSlope1Pgn = 61459;     ///< F013 Slope Sensor Information.
inline constexpr std::uint32_t kFineRatePgn = 0xFF6B;  ///< At delivery; may be moved.

inline constexpr std::uint8_t kSlopePriority = 3;
inline constexpr std::uint8_t kAngularRatePriority = 3;
inline constexpr std::uint8_t kAccelerationPriority = 2;
inline constexpr std::uint8_t kMagneticFieldPriority = 6;

/// How far a value can be trusted (SPN 3325 and its kin), 2 bits.
struct FigureOfMerit {
  static constexpr std::uint8_t kFunctional = 0;
  static constexpr std::uint8_t kDegraded = 1;
  static constexpr std::uint8_t kError = 2;
  static constexpr std::uint8_t kNotAvailable = 3;
};
inline constexpr std::array<can::NamedValue, 4> kMeritValues{{
    {FigureOfMerit::kFunctional, "functional"},
    {FigureOfMerit::kDegraded, "degraded"},
    {FigureOfMerit::kError, "error"},
    {FigureOfMerit::kNotAvailable, "not available"},
}};

// One count, and the value of raw 0.
inline constexpr vehicle::Scale kSlopeAngle{1.0 / 32768.0, -250.0, "deg"};
inline constexpr vehicle::Scale kRate{1.0 / 128.0, -250.0, "deg/s"};
inline constexpr vehicle::Scale kForce{0.01, -320.0, "m/s2"};
inline constexpr vehicle::Scale kMagnetic{0.00025, -8.0, "G"};
inline constexpr vehicle::Scale kSlope1Angle{0.002, -64.0, "deg"};
inline constexpr vehicle::Scale kSlope1Rate{0.002, -64.0, "deg/s"};
inline constexpr vehicle::Scale kFineRate{1.0 / 1024.0, -250.0, "deg/s"};
inline constexpr vehicle::Scale kLatency{0.5, 0.0, "ms"};
// Where the firmware clamps, not where the scale ends.
inline constexpr can::Range kSlopeRange_deg{-250.0, 250.0};
inline constexpr can::Range kRateRange_dps{-250.0, 250.0};
inline constexpr can::Range kForceRange_mps2{-320.0, 322.55};
inline constexpr can::Range kSlope1Range_deg{-64.0, 64.0};  ///< And deg/s.
inline constexpr can::Range kMagneticRange_gauss{-8.0, 8.0};

/// A measurement within limits.
template <class Message>
[[nodiscard]] constexpr vehicle::Parameter<Message> measured(
    std::string_view name, std::uint32_t spn, vehicle::Position position, std::uint8_t width,
    const vehicle::Scale& scale, const can::Range& limits, double Message::*member) {
  auto row = vehicle::number(name, spn, position, width, scale, member);
  row.signal.lower = limits.lower;
  row.signal.upper = limits.upper;
  return row;
}
template <class Message>
[[nodiscard]] constexpr vehicle::Parameter<Message> merit(std::string_view name,
                                                          vehicle::Position position,
                                                          std::uint8_t Message::*member) {
  return vehicle::code(name, 0, position, 2, member, kMeritValues);
}

struct Slope {
  static constexpr vehicle::Group kGroup{"slope sensor 2", kSlopePgn, kSlopePriority, {}, 0};

  double pitch_deg = 0.0;
  double roll_deg = 0.0;
  std::uint8_t pitch_merit = FigureOfMerit::kFunctional;
  std::uint8_t roll_merit = FigureOfMerit::kFunctional;
  std::uint8_t pitch_compensation = 0;  ///< 2 bits: 0 off, 1 on, 3 not available.
  std::uint8_t roll_compensation = 0;
  double latency_ms = 0.0;  ///< From the measurement to the message, 0.5 ms per count.

  static constexpr auto parameters() {
    using M = Slope;
    return std::array{
        measured("pitch", 3318, {1}, 24, kSlopeAngle, kSlopeRange_deg, &M::pitch_deg),
        measured("roll", 3319, {4}, 24, kSlopeAngle, kSlopeRange_deg, &M::roll_deg),
        vehicle::code("pitch compensation", 0, {7, 1}, 2, &M::pitch_compensation),
        vehicle::code("roll compensation", 0, {7, 5}, 2, &M::roll_compensation),
        merit("pitch figure of merit", {7, 3}, &M::pitch_merit),
        merit("roll figure of merit", {7, 7}, &M::roll_merit),
        vehicle::number("latency", 0, {8}, 8, kLatency, &M::latency_ms),
    };
  }
};

struct AngularRate {
  static constexpr vehicle::Group kGroup{
      "angular rate", kAngularRatePgn, kAngularRatePriority, {}, 0};

  double pitch_dps = 0.0;
  double roll_dps = 0.0;
  double yaw_dps = 0.0;
  std::uint8_t pitch_merit = FigureOfMerit::kFunctional;
  std::uint8_t roll_merit = FigureOfMerit::kFunctional;
  std::uint8_t yaw_merit = FigureOfMerit::kFunctional;
  double latency_ms = 0.0;

  static constexpr auto parameters() {
    using M = AngularRate;
    return std::array{
        measured("pitch rate", 3322, {1}, 16, kRate, kRateRange_dps, &M::pitch_dps),
        measured("roll rate", 3323, {3}, 16, kRate, kRateRange_dps, &M::roll_dps),
        measured("yaw rate", 3324, {5}, 16, kRate, kRateRange_dps, &M::yaw_dps),
        merit("merit 1", {7, 1}, &M::pitch_merit),
        merit("merit 2", {7, 3}, &M::roll_merit),
        merit("merit 3", {7, 5}, &M::yaw_merit),
        vehicle::number("latency", 0, {8}, 8, kLatency, &M::latency_ms),
    };
  }
};

struct Acceleration {
  static constexpr vehicle::Group kGroup{
      "acceleration", kAccelerationPgn, kAccelerationPriority, {}, 0};

  double lateral_mps2 = 0.0;
  double longitudinal_mps2 = 0.0;
  double vertical_mps2 = 0.0;
  std::uint8_t lateral_merit = FigureOfMerit::kFunctional;
  std::uint8_t longitudinal_merit = FigureOfMerit::kFunctional;
  std::uint8_t vertical_merit = FigureOfMerit::kFunctional;
  std::uint8_t variable_repetition_rate = 2;  ///< The value that both firmwares send.
  double latency_ms = 0.0;                    ///< The 300RI always sends 0 here.

  static constexpr auto parameters() {
    using M = Acceleration;
    return std::array{
        measured("lateral acceleration", 1809, {1}, 16, kForce, kForceRange_mps2, &M::lateral_mps2),
        measured("longitudinal acceleration", 1810, {3}, 16, kForce, kForceRange_mps2,
                 &M::longitudinal_mps2),
        measured("vertical acceleration", 1811, {5}, 16, kForce, kForceRange_mps2,
                 &M::vertical_mps2),
        merit("merit 1", {7, 1}, &M::lateral_merit),
        merit("merit 2", {7, 3}, &M::longitudinal_merit),
        merit("merit 3", {7, 5}, &M::vertical_merit),
        vehicle::code("support variable repetition rate", 0, {7, 7}, 2,
                      &M::variable_repetition_rate),
        vehicle::number("latency", 0, {8}, 8, kLatency, &M::latency_ms),
    };
  }
};

struct MagneticField {
  static constexpr vehicle::Group kGroup{
      "magnetic field", kMagneticFieldPgn, kMagneticFieldPriority, {}, 0};

  double x_gauss = 0.0;
  double y_gauss = 0.0;
  double z_gauss = 0.0;

  static constexpr auto parameters() {
    using M = MagneticField;
    return std::array{
        measured("magnetic field x", 0, {1}, 16, kMagnetic, kMagneticRange_gauss, &M::x_gauss),
        measured("magnetic field y", 0, {3}, 16, kMagnetic, kMagneticRange_gauss, &M::y_gauss),
        measured("magnetic field z", 0, {5}, 16, kMagnetic, kMagneticRange_gauss, &M::z_gauss),
    };
  }
};

struct Slope1 {
  static constexpr vehicle::Group kGroup{"slope sensor 1", kSlope1Pgn, kSlopePriority, {}, 0};

  double pitch_deg = 0.0;
  double roll_deg = 0.0;
  double pitch_rate_dps = 0.0;
  std::uint8_t pitch_merit = FigureOfMerit::kFunctional;
  std::uint8_t roll_merit = FigureOfMerit::kFunctional;
  std::uint8_t pitch_rate_merit = FigureOfMerit::kFunctional;
  std::uint8_t compensation = 0;  ///< 2 bits, of both angles.
  double latency_ms = 0.0;

  static constexpr auto parameters() {
    using M = Slope1;
    return std::array{
        measured("pitch", 0, {1}, 16, kSlope1Angle, kSlope1Range_deg, &M::pitch_deg),
        measured("roll", 0, {3}, 16, kSlope1Angle, kSlope1Range_deg, &M::roll_deg),
        measured("pitch rate", 0, {5}, 16, kSlope1Rate, kSlope1Range_deg, &M::pitch_rate_dps),
        merit("merit 1", {7, 1}, &M::pitch_merit),
        merit("merit 2", {7, 3}, &M::roll_merit),
        merit("merit 3", {7, 5}, &M::pitch_rate_merit),
        vehicle::code("compensation", 0, {7, 7}, 2, &M::compensation),
        vehicle::number("latency", 0, {8}, 8, kLatency, &M::latency_ms),
    };
  }
};

struct FineRate {
  static constexpr vehicle::Group kGroup{
      "fine angular rate", kFineRatePgn, kAngularRatePriority, {}, 0};

  double pitch_dps = 0.0;
  double roll_dps = 0.0;
  double yaw_dps = 0.0;
  std::uint8_t pitch_merit = FigureOfMerit::kFunctional;
  std::uint8_t roll_merit = FigureOfMerit::kFunctional;
  std::uint8_t yaw_merit = FigureOfMerit::kFunctional;

  static constexpr auto parameters() {
    using M = FineRate;
    return std::array{
        measured("pitch rate", 0, {1}, 19, kFineRate, kRateRange_dps, &M::pitch_dps),
        measured("roll rate", 0, {3, 4}, 19, kFineRate, kRateRange_dps, &M::roll_dps),
        measured("yaw rate", 0, {5, 7}, 19, kFineRate, kRateRange_dps, &M::yaw_dps),
        merit("merit 1", {8, 2}, &M::pitch_merit),
        merit("merit 2", {8, 4}, &M::roll_merit),
        merit("merit 3", {8, 6}, &M::yaw_merit),
    };
  }
};

/// `priority` as set in the device, `pgn` where its group has been moved (335RI).
template <class Message>
[[nodiscard]] can::Frame encode(const Message& message, std::uint8_t source,
                                std::uint8_t priority = Message::kGroup.priority,
                                std::uint32_t pgn = Message::kGroup.pgn) {
  vehicle::Group group = Message::kGroup;
  group.priority = priority;
  group.pgn = pgn;
  return vehicle::encode(message, source, j1939::kGlobalAddress, group);
}
using vehicle::decode;

}  // namespace rigwire::protocols::openimu
