// Values that several navigation messages (class 0x01) share.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.17 "UBX-NAV".
#pragma once

#include <cstdint>

namespace rigwire::protocols::ubx {

/// gpsFix / fixType.
inline constexpr std::uint8_t kFixNone = 0;
inline constexpr std::uint8_t kFixDeadReckoning = 1;
inline constexpr std::uint8_t kFix2d = 2;
inline constexpr std::uint8_t kFix3d = 3;
inline constexpr std::uint8_t kFixGnssAndDeadReckoning = 4;
inline constexpr std::uint8_t kFixTimeOnly = 5;
/// A dilution that is not known, in hundredths.
inline constexpr std::uint16_t kNoDilution = 9999;

}  // namespace rigwire::protocols::ubx
