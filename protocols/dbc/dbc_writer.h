// The DBC file of a bus: what Vector's tools, SavvyCAN, cantools, canmatrix and their like read.
//
// Format: Vector DBC File Format Documentation 1.0.5; attributes of J1939 buses as Vector's own
// database templates use them (VFrameFormat, ProtocolType, SPN, NmStationAddress). Only printable
// ASCII is written; names are C identifiers of at most 32 characters, made unique with the sender's
// name or a number where they are not. Identifiers of 29 bits carry bit 31, as the format has it.
// Messages that have an identifier which another one before them has are left out: such a file
// would be refused.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "protocols/can/message.h"

namespace rigwire::protocols::dbc {

/// Units and signs in which physical values are written.
enum class Units : std::uint8_t {
  si,        ///< Units of this library: SI, but deg, deg/s and ms of some devices.
  document,  ///< Units of the messages' own document: rpm, %, kPa, km/h, deg for SAE J1939.
};

/// A bus with everything that is said on it.
struct Bus {
  std::string_view name;
  std::uint32_t bit_rate_bps = 250'000;
  std::span<const can::OwnedMessage> messages;
};

inline constexpr std::size_t kLongestName = 32;

/// The whole file; lines end with a line feed. Precondition: no message has a defect
/// (can::defect).
[[nodiscard]] std::string write(const Bus& bus, Units units = Units::si);

}  // namespace rigwire::protocols::dbc
