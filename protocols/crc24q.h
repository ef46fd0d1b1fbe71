// CRC-24Q, which RTCM 3 and satellite based augmentation put at the end of their messages:
// generator 0x1864CFB, most significant bit first, start 0. Zero bits before a message change
// nothing.
#pragma once

#include <cstdint>
#include <span>

namespace rigwire::protocols {

[[nodiscard]] constexpr std::uint32_t crc24q(std::span<const std::uint8_t> bytes) {
  constexpr std::uint32_t kGenerator = 0x186'4CFB;
  constexpr std::uint32_t kCarry = 0x100'0000;
  std::uint32_t remainder = 0;
  for (const std::uint8_t byte : bytes) {
    remainder ^= std::uint32_t{byte} << 16U;
    for (int bit = 0; bit < 8; ++bit) {
      remainder <<= 1U;
      remainder ^= (remainder & kCarry) != 0 ? kGenerator : 0U;
    }
  }
  return remainder;
}

}  // namespace rigwire::protocols
