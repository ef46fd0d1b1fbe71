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
// Signs and axes are those of the device's settings; axes.h holds them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "protocols/can/frame.h"
#include "protocols/can/message_layout.h"
#include "protocols/j1939/field.h"
#include "protocols/result.h"

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

/// How far a value can be trusted (SPN 3325 and its kin).
enum class FigureOfMerit : std::uint8_t {
  functional = 0,
  degraded = 1,
  error = 2,
  not_available = 3
};

/// One measured value and its merit. When encoding, NaN becomes the error value with merit `error`,
/// else "not available"; when decoding, everything that is no measurement becomes NaN.
struct Measurement {
  double value = 0.0;
  FigureOfMerit merit = FigureOfMerit::functional;
};

struct Slope {
  Measurement pitch_deg;
  Measurement roll_deg;
  std::uint8_t pitch_compensation = 0;  ///< 2 bits: 0 off, 1 on, 3 not available.
  std::uint8_t roll_compensation = 0;
  double latency_ms = 0.0;  ///< From the measurement to the message, 0.5 ms per count.
};

struct AngularRate {
  Measurement pitch_dps;
  Measurement roll_dps;
  Measurement yaw_dps;
  double latency_ms = 0.0;
};

struct Acceleration {
  Measurement lateral_mps2;
  Measurement longitudinal_mps2;
  Measurement vertical_mps2;
  double latency_ms = 0.0;  ///< The 300RI always sends 0 here.
};

struct MagneticField {
  double x_gauss = 0.0;  ///< NaN is "not available".
  double y_gauss = 0.0;
  double z_gauss = 0.0;
};

struct Slope1 {
  Measurement pitch_deg;
  Measurement roll_deg;
  Measurement pitch_rate_dps;
  std::uint8_t compensation = 0;  ///< 2 bits, of both angles.
  double latency_ms = 0.0;
};

struct FineRate {
  Measurement pitch_dps;
  Measurement roll_dps;
  Measurement yaw_dps;
};

/// The field tables, shared by encoder and decoder.
inline constexpr double kSlopeScale_deg = 1.0 / 32768.0;
inline constexpr double kRateScale_dps = 1.0 / 128.0;
inline constexpr double kAccelerationScale_mps2 = 0.01;
inline constexpr double kSlopeLimit_deg = 250.0;
inline constexpr double kRateLimit_dps = 250.0;  ///< The firmware clamps here, not at 251.99.
inline constexpr double kAccelerationLower_mps2 = -320.0;
inline constexpr double kAccelerationUpper_mps2 = 322.55;

inline constexpr std::array<j1939::Field, 2> kSlopeFields{{
    {"pitch", 3318, 0, 24, kSlopeScale_deg, -250.0, -kSlopeLimit_deg, kSlopeLimit_deg, "deg"},
    {"roll", 3319, 24, 24, kSlopeScale_deg, -250.0, -kSlopeLimit_deg, kSlopeLimit_deg, "deg"},
}};
inline constexpr std::array<j1939::Field, 3> kRateFields{{
    {"pitch rate", 3322, 0, 16, kRateScale_dps, -250.0, -kRateLimit_dps, kRateLimit_dps, "deg/s"},
    {"roll rate", 3323, 16, 16, kRateScale_dps, -250.0, -kRateLimit_dps, kRateLimit_dps, "deg/s"},
    {"yaw rate", 3324, 32, 16, kRateScale_dps, -250.0, -kRateLimit_dps, kRateLimit_dps, "deg/s"},
}};
inline constexpr std::array<j1939::Field, 3> kAccelerationFields{{
    {"lateral acceleration", 1809, 0, 16, kAccelerationScale_mps2, -320.0, kAccelerationLower_mps2,
     kAccelerationUpper_mps2, "m/s2"},
    {"longitudinal acceleration", 1810, 16, 16, kAccelerationScale_mps2, -320.0,
     kAccelerationLower_mps2, kAccelerationUpper_mps2, "m/s2"},
    {"vertical acceleration", 1811, 32, 16, kAccelerationScale_mps2, -320.0,
     kAccelerationLower_mps2, kAccelerationUpper_mps2, "m/s2"},
}};
inline constexpr double kMagneticScale_gauss = 0.00025;
inline constexpr std::array<j1939::Field, 3> kMagneticFields{{
    {"magnetic field x", 0, 0, 16, kMagneticScale_gauss, -8.0, -8.0, 8.0, "G"},
    {"magnetic field y", 0, 16, 16, kMagneticScale_gauss, -8.0, -8.0, 8.0, "G"},
    {"magnetic field z", 0, 32, 16, kMagneticScale_gauss, -8.0, -8.0, 8.0, "G"},
}};
inline constexpr double kSlope1Scale_deg = 0.002;
inline constexpr double kSlope1Limit_deg = 64.0;  ///< And deg/s. The firmware clamps here.
inline constexpr std::array<j1939::Field, 3> kSlope1Fields{{
    {"pitch", 0, 0, 16, kSlope1Scale_deg, -64.0, -kSlope1Limit_deg, kSlope1Limit_deg, "deg"},
    {"roll", 0, 16, 16, kSlope1Scale_deg, -64.0, -kSlope1Limit_deg, kSlope1Limit_deg, "deg"},
    {"pitch rate", 0, 32, 16, kSlope1Scale_deg, -64.0, -kSlope1Limit_deg, kSlope1Limit_deg,
     "deg/s"},
}};
inline constexpr double kFineRateScale_dps = 1.0 / 1024.0;
inline constexpr std::array<j1939::Field, 3> kFineRateFields{{
    {"pitch rate", 0, 0, 19, kFineRateScale_dps, -250.0, -kRateLimit_dps, kRateLimit_dps, "deg/s"},
    {"roll rate", 0, 19, 19, kFineRateScale_dps, -250.0, -kRateLimit_dps, kRateLimit_dps, "deg/s"},
    {"yaw rate", 0, 38, 19, kFineRateScale_dps, -250.0, -kRateLimit_dps, kRateLimit_dps, "deg/s"},
}};
inline constexpr j1939::Field kLatencyField{"latency", 0, 56, 8, 0.5, 0.0, 0.0, 125.0, "ms"};

/// `priority` as set in the device (335RI).
[[nodiscard]] can::Frame encode(const Slope& slope, std::uint8_t source,
                                std::uint8_t priority = kSlopePriority);
[[nodiscard]] can::Frame encode(const AngularRate& rate, std::uint8_t source,
                                std::uint8_t priority = kAngularRatePriority);
[[nodiscard]] can::Frame encode(const Acceleration& acceleration, std::uint8_t source,
                                std::uint8_t priority = kAccelerationPriority);
[[nodiscard]] can::Frame encode(const MagneticField& field, std::uint8_t source);
[[nodiscard]] can::Frame encode(const Slope1& slope, std::uint8_t source,
                                std::uint8_t priority = kSlopePriority);
[[nodiscard]] can::Frame encode(const FineRate& rate, std::uint8_t source,
                                std::uint8_t priority = kAngularRatePriority,
                                std::uint32_t pgn = kFineRatePgn);

/// Malformed unless the frame is a 29-bit data frame of that group with eight bytes.
[[nodiscard]] Decoded<Slope> decode_slope(const can::Frame& frame);
[[nodiscard]] Decoded<AngularRate> decode_angular_rate(const can::Frame& frame);
[[nodiscard]] Decoded<Acceleration> decode_acceleration(const can::Frame& frame);
[[nodiscard]] Decoded<MagneticField> decode_magnetic_field(const can::Frame& frame);
[[nodiscard]] Decoded<Slope1> decode_slope1(const can::Frame& frame);
[[nodiscard]] Decoded<FineRate> decode_fine_rate(const can::Frame& frame,
                                                 std::uint32_t pgn = kFineRatePgn);

/// All of the above as layouts, as a device with that source address sends them.
[[nodiscard]] std::vector<can::MessageLayout> layouts(std::uint8_t source);

}  // namespace rigwire::protocols::openimu
