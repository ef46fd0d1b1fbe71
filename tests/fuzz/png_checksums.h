// Checksums of a PNG file (ISO/IEC 15948, 5.3 and annex D), for inputs that a fuzzer has changed:
// without, nothing behind the first changed byte would ever be read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rigwire::fuzz {

/// Corrects the checksums of the chunks that end within the bytes, behind the signature's 8.
inline void put_checksums_right(std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kLength = 4;
  constexpr std::size_t kType = 4;
  constexpr std::size_t kChecksum = 4;
  std::size_t at = kSignature;
  while (at + kLength + kType + kChecksum <= bytes.size()) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < kLength; ++i) {
      length = length << 8U | bytes[at + i];
    }
    if (length > bytes.size() - at - kLength - kType - kChecksum) {
      return;
    }
    // CRC-32 of type and data, reflected, polynomial 0x04C11DB7.
    const std::size_t end = at + kLength + kType + length;
    std::uint32_t crc = 0xFFFF'FFFF;
    for (std::size_t i = at + kLength; i < end; ++i) {
      crc ^= bytes[i];
      for (int bit = 0; bit < 8; ++bit) {
        crc = crc >> 1U ^ ((crc & 1U) != 0 ? 0xEDB8'8320U : 0U);
      }
    }
    crc = ~crc;
    for (std::size_t i = 0; i < kChecksum; ++i) {
      bytes[end + i] = static_cast<std::uint8_t>(crc >> (24 - 8 * i));
    }
    at = end + kChecksum;
  }
}

}  // namespace rigwire::fuzz
