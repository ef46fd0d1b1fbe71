// The Velodyne position packet: 512 bytes of UDP payload, default port 8308, little-endian. Three
// layouts share it (PositionLayout in model.h); what a model does not send stays zero.
//
//   offset 0         14 zero bytes (decoders check them)
//   offset 14 + 8 g  inertial: group g = 0..2: gyro, temperature, accelerometer x, accelerometer y,
//                    each u16 of which the low 12 bits count, two's complement
//   offset 0xBB      extended: unit status, see UnitStatus, up to 0xC5, and 0xCB to 0xCD
//   offset 198       timestamp u32, microseconds past the hour
//   offset 202       state of the pulse-per-second input
//   offset 206       the last $GPRMC or $GPGGA sentence with CR LF, zeros up to 512 (extended: the
//                    sentence has 128 bytes)
//
// Sources: HDL-32E user's manual 63-9113 Rev. H, "Position packet"; pulse state: VLP-16 user's
// manual 63-9243 Rev. D, section 9.4; extended: VLS-128 user's manual 63-9483 Rev. A, table 9-2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "protocols/result.h"

namespace rigwire::protocols::velodyne {

inline constexpr std::size_t kInertialGroups = 3;
inline constexpr std::size_t kInertialGroupSize = 2     // gyro
                                                  + 2   // temperature
                                                  + 2   // accelerometer x
                                                  + 2;  // accelerometer y
inline constexpr std::size_t kPositionHeadSize = 14;
inline constexpr std::size_t kPositionGapSize = 160;
inline constexpr std::size_t kNmeaSize = 306;
inline constexpr std::size_t kExtendedNmeaSize = 128;
inline constexpr std::size_t kPositionPacketSize = kPositionHeadSize                       //
                                                   + kInertialGroups * kInertialGroupSize  //
                                                   + kPositionGapSize                      //
                                                   + 4  // timestamp
                                                   + 1  // pulse state
                                                   + 3  // zero
                                                   + kNmeaSize;
static_assert(kPositionPacketSize == 512);

/// Scales of the inertial counts (manual, "Position packet").
inline constexpr double kGyroUnit_degps = 0.09766;
inline constexpr double kTemperatureUnit_c = 0.1453;
inline constexpr double kTemperatureOrigin_c = 25.0;
inline constexpr double kAccelerationUnit_g = 0.001221;

/// Counts of one inertial group, -2048 .. 2047.
struct InertialGroup {
  std::int16_t gyro = 0;
  std::int16_t temperature = 0;
  std::int16_t acceleration_x = 0;
  std::int16_t acceleration_y = 0;

  friend bool operator==(const InertialGroup&, const InertialGroup&) = default;
};

/// One group in SI units, about the group's own axes. Which axes of the sensor these are is shown
/// in a figure of the manual alone.
struct InertialReading {
  double rate_radps = 0.0;
  double temperature_c = kTemperatureOrigin_c;
  double acceleration_x_mps2 = 0.0;
  double acceleration_y_mps2 = 0.0;
};

/// Rounded to counts and clamped to 12 bits (200 deg/s, 2.5 g); NaN becomes 0.
[[nodiscard]] InertialGroup to_counts(const InertialReading& reading);
[[nodiscard]] InertialReading from_counts(const InertialGroup& group);

enum class ConverterCalibration : std::uint8_t {
  none = 0,
  power_on = 1,
  manual = 2,
  temperature_change = 3,
  periodic = 4,
};

/// What the extended layout reports of the unit: temperatures and the calibration of its
/// analogue-to-digital converters. All zero in the other layouts.
struct UnitStatus {
  std::uint8_t top_board_c = 0;                 ///< 0xBB, 0 .. 150 as all temperatures.
  std::uint8_t bottom_board_c = 0;              ///< 0xBC
  std::uint8_t at_calibration_c = 0;            ///< 0xBD
  std::int16_t change_since_calibration_c = 0;  ///< 0xBE, -150 .. 150
  std::uint32_t since_calibration_s = 0;        ///< 0xC0
  ConverterCalibration last_calibration = ConverterCalibration::none;  ///< 0xC4, why it ran.
  bool calibrating = false;                                            ///< 0xC5, bit 0.
  bool temperature_change_reached = false;                             ///< 0xC5, bit 1.
  bool period_reached = false;                                         ///< 0xC5, bit 2.
  bool thermal_shutdown = false;                                       ///< 0xCB
  std::uint8_t at_shutdown_c = 0;                                      ///< 0xCC
  std::uint8_t at_power_up_c = 0;                                      ///< 0xCD

  friend bool operator==(const UnitStatus&, const UnitStatus&) = default;
};

enum class PulseState : std::uint8_t { absent = 0, synchronizing = 1, locked = 2, error = 3 };

struct PositionPacket {
  std::array<InertialGroup, kInertialGroups> inertial{};
  UnitStatus status;
  std::uint32_t timestamp_us = 0;  ///< Past the hour.
  PulseState pulse_state = PulseState::absent;
  std::array<char, kNmeaSize> nmea{};  ///< Zero-padded.

  /// The sentence with its CR LF; empty when the sensor receives none.
  [[nodiscard]] std::string_view sentence() const;
  /// Precondition: at most kNmeaSize characters, no NUL (asserted).
  void set_sentence(std::string_view text);

  friend bool operator==(const PositionPacket&, const PositionPacket&) = default;
};

/// Inertial counts must be within 12 bits (asserted).
void encode(const PositionPacket& packet, std::span<std::uint8_t, kPositionPacketSize> bytes);

/// Reads one datagram. Fewer bytes than a packet are incomplete; more, a non-zero head, an unknown
/// pulse state, thermal state or reason of a calibration, or anything behind the end of the
/// sentence are malformed.
Decoded<PositionPacket> decode_position_packet(std::span<const std::uint8_t> bytes);

}  // namespace rigwire::protocols::velodyne
