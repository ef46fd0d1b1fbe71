#include "protocols/openimu/axes.h"

namespace rigwire::protocols::openimu {

std::optional<AxisMap> orientation_axes(std::uint16_t word) {
  if (word > 0x1FF) {
    return std::nullopt;
  }
  AxisMap map;
  for (unsigned i = 0; i < 3; ++i) {
    const unsigned code = word >> (3 * i);
    const unsigned choice = (code >> 1U) & 3U;
    if (choice == 3) {
      return std::nullopt;
    }
    map[i] = {static_cast<std::uint8_t>((i + choice) % 3), (code & 1U) != 0 ? -1.0 : 1.0};
  }
  if (map[0].axis == map[1].axis || map[1].axis == map[2].axis || map[0].axis == map[2].axis) {
    return std::nullopt;
  }
  // Right-handed: an even permutation with an even number of minus signs, or both odd.
  const bool even = map[1].axis == (map[0].axis + 1) % 3;
  const double signs = map[0].sign * map[1].sign * map[2].sign;
  if ((even ? 1.0 : -1.0) * signs < 0.0) {
    return std::nullopt;
  }
  return map;
}

}  // namespace rigwire::protocols::openimu
