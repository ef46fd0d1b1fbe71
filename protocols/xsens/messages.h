// The CAN messages of the Xsens MTi-600 series.
//
// Sources: Xsens MT CAN Protocol Documentation MT1604P (September 2019); the maker's xsens.dbc as
// the ROS driver for CAN carries it. Numbers are big-endian, signed ones two's complement, physical
// = raw * scale. Identifiers have 11 bits, or the same numbers as 29-bit identifiers. There is no
// pattern for "not available": a value that is not valid is not sent, or the status word says so.
//
// The sample time is a number of ticks. The maker's current documents count ticks of 100 us, as its
// serial protocol does ("SampleTimeFine", 10 kHz); the older DBC says microseconds. Which of them a
// unit means is not in the frame: Reading::values has the ticks.
//
// The DBC gives quaternions the scale 2^-15; the driver and the description of the format 1/32767,
// which alone can carry 1. The difference is at most one count.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "protocols/can/frame.h"
#include "protocols/can/message.h"
#include "protocols/result.h"

namespace rigwire::protocols::xsens {

enum class MessageId : std::uint8_t {
  error = 0x01,
  warning = 0x02,
  sample_time = 0x05,
  group_counter = 0x06,
  utc = 0x07,
  status_word = 0x11,
  quaternion = 0x21,
  euler_angles = 0x22,
  velocity_increment = 0x31,  ///< "Delta v": three mantissas and an exponent.
  rate_of_turn = 0x32,
  orientation_increment = 0x33,  ///< "Delta q".
  acceleration = 0x34,
  free_acceleration = 0x35,
  magnetic_field = 0x41,
  temperature = 0x51,
  pressure = 0x52,
  rate_of_turn_fast = 0x61,  ///< "High rate".
  acceleration_fast = 0x62,
  latitude_longitude = 0x71,
  altitude = 0x72,
  position_x = 0x73,
  position_y = 0x74,
  position_z = 0x75,
  velocity = 0x76,
  receiver_status = 0x79,
  receiver_dilution = 0x7A,
};

using can::Message;

inline constexpr std::size_t kMaximumSignals = 7;
/// Physical values in the order of the message's signals.
using Values = std::array<double, kMaximumSignals>;

/// All messages, by identifier.
[[nodiscard]] std::span<const Message> messages();
/// Null when no message has that identifier.
[[nodiscard]] const Message* find(std::uint32_t id);
[[nodiscard]] const Message& message(MessageId id);

/// Encodes one value per signal of the message, in their order. Values beyond what a signal carries
/// are saturated.
[[nodiscard]] can::Frame encode(MessageId id, std::span<const double> values, bool extended);

struct Reading {
  const Message* message = nullptr;
  Values values{};  ///< One value per signal of the message.
};
/// Malformed unless the frame is a data frame of a known identifier with at least the message's
/// length (the driver takes longer ones, too).
[[nodiscard]] Decoded<Reading> decode(const can::Frame& frame);

/// The exponent with which `greatest`, a magnitude in m/s, still fits: value = mantissa *
/// 2^-exponent. 17 (the DBC's fixed scale, up to 0.25 m/s) where possible.
[[nodiscard]] unsigned increment_exponent(double greatest_mps);

/// Error codes of MessageId::error.
inline constexpr double kOutputBufferOverflow = 1;

/// Bits of the status word.
struct StatusBit {
  static constexpr std::uint32_t kSelfTest = 1U << 0U;
  static constexpr std::uint32_t kFilterValid = 1U << 1U;
  static constexpr std::uint32_t kFix = 1U << 2U;
  static constexpr std::uint32_t kClipAccelerationX = 1U << 8U;  ///< y, z: the next bits.
  static constexpr std::uint32_t kClipRateX = 1U << 11U;
  static constexpr std::uint32_t kClipFieldX = 1U << 14U;
  static constexpr std::uint32_t kClipping = 1U << 19U;  ///< Any of the nine above.
};

/// The table with the unit's settings; `tick_s` is what the sample time counts.
[[nodiscard]] std::vector<can::OwnedMessage> layouts(bool extended, double tick_s);

}  // namespace rigwire::protocols::xsens
