// The civil navigation message (CNAV) of L2C: messages of 300 bits, one every 12 s, and the order
// in which a satellite sends them here. Types 10 and 11 (orbit), 30 (clock, ionosphere, group
// delays), 31 (clock, reduced almanac of four satellites), 32 (clock, earth orientation), 33
// (clock, UTC).
//
// Source: IS-GPS-200 sections 30.3.2 (structure), 30.3.3 (figures 30-1 to 30-6, tables 30-I to
// 30-VIII: content), 30.3.4 (broadcast intervals), 30.3.5 (CRC-24Q over the 276 bits before it).
// Figures of orbit and clock are those of the legacy message, in the finer steps of this one: the
// axis and the node's rate, which are differences from constants here, are off by half a step at
// most. Values that the legacy message does not have are 0: rates of axis and mean motion,
// predicted accuracy, earth orientation (here UT1 is UTC and the poles are fixed). L5 is not sent:
// its health is bad, its delays are not available.
//
// The order is chosen; the intervals stay within table 30-XII (48 s for orbit and clock, 288 s for
// ionosphere and UTC, 20 and 30 min for almanac and earth orientation). The convolutional code is
// not here: receivers hand messages on decoded.
#pragma once

#include <array>
#include <cstdint>

#include "protocols/gps/broadcast.h"

namespace rigwire::protocols::gps {

inline constexpr std::int32_t kCnavSeconds = 12;
/// 300 bits, the bit sent first highest in the first word; 20 zeros.
using CnavMessage = std::array<std::uint32_t, 10>;

/// When a message begins: GPS week, not rolled over, and second, a multiple of 12.
struct CnavTime {
  std::int32_t week = 0;
  std::uint32_t second = 0;  ///< Second of the week.
};

/// Returns the type of the message that begins at that second of the week.
[[nodiscard]] std::uint8_t cnav_type_at(std::uint32_t second);

/// Preconditions: prn 1..32, of which `broadcast` has an ephemeris; one of the types above.
[[nodiscard]] CnavMessage cnav_message(std::uint8_t type, const Broadcast& broadcast,
                                       std::uint8_t prn, const CnavTime& time);

}  // namespace rigwire::protocols::gps
