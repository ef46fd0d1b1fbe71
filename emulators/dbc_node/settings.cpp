#include "emulators/dbc_node/settings.h"

namespace rigwire::emulators {

std::uint8_t checksum(DbcChecksum method, std::span<const std::uint8_t> data, std::size_t at) {
  constexpr unsigned kPolynomial = 0x1D;
  unsigned value = method == DbcChecksum::crc8_j1850 ? 0xFFU : 0U;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (i == at) {
      continue;
    }
    switch (method) {
      case DbcChecksum::sum8:
        value += data[i];
        break;
      case DbcChecksum::xor8:
        value ^= data[i];
        break;
      case DbcChecksum::crc8_j1850:
        value ^= data[i];
        for (int bit = 0; bit < 8; ++bit) {
          value = (value << 1U) ^ ((value & 0x80U) != 0 ? kPolynomial : 0U);
        }
        value &= 0xFFU;
        break;
    }
  }
  return static_cast<std::uint8_t>(method == DbcChecksum::crc8_j1850 ? value ^ 0xFFU : value);
}

}  // namespace rigwire::emulators
