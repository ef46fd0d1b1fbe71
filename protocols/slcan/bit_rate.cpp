#include "protocols/slcan/bit_rate.h"

#include <algorithm>
#include <cassert>

namespace rigwire::protocols::slcan {

std::optional<unsigned> rate_code(std::uint32_t bit_rate_bps) {
  const auto* found = std::find(kBitRates_bps.begin(), kBitRates_bps.end(), bit_rate_bps);
  return found == kBitRates_bps.end()
             ? std::nullopt
             : std::optional(static_cast<unsigned>(found - kBitRates_bps.begin()));
}

std::uint32_t rate_of_code(unsigned code, std::uint32_t bus_bit_rate_bps) {
  assert(code <= kPythonCanCode);
  if (code == kPythonCanCode) {
    return kPythonCanRate_bps;
  }
  if (code == kDisputedCode && bus_bit_rate_bps == kPythonCanDisputedRate_bps) {
    return kPythonCanDisputedRate_bps;
  }
  return kBitRates_bps[code];
}

std::optional<std::uint32_t> rate_of_registers(std::uint16_t registers) {
  constexpr std::uint32_t kClock_Hz = 16'000'000;
  const std::uint32_t timing_0 = registers >> 8U;
  const std::uint32_t timing_1 = registers & 0xFFU;
  // A time quantum is two clocks times the prescaler.
  const std::uint32_t clocks_per_quantum = 2 * ((timing_0 & 0x3FU) + 1);
  const std::uint32_t quanta_per_bit = 1 /* synchronisation */ +
                                       ((timing_1 & 0xFU) + 1) /* segment 1 */ +
                                       (((timing_1 >> 4U) & 7U) + 1) /* segment 2 */;
  const std::uint32_t clocks_per_bit = clocks_per_quantum * quanta_per_bit;
  const std::uint32_t rate_bps = (kClock_Hz + clocks_per_bit / 2) / clocks_per_bit;
  if (rate_bps > 1'000'000) {
    return std::nullopt;
  }
  return rate_bps;
}

bool rates_agree(std::uint32_t first_bps, std::uint32_t second_bps) {
  const std::uint32_t greater = std::max(first_bps, second_bps);
  return greater - std::min(first_bps, second_bps) <= greater / 200;
}

}  // namespace rigwire::protocols::slcan
