#include "protocols/gs_usb/requests.h"

namespace rigwire::protocols::gs_usb {

bool permitted(const BitTiming& timing, const BitTimingLimits& limits) {
  const std::uint64_t segment_1 =
      std::uint64_t{timing.propagation_segment} + timing.phase_segment_1;
  return segment_1 >= limits.segment_1_min && segment_1 <= limits.segment_1_max &&
         timing.phase_segment_2 >= limits.segment_2_min &&
         timing.phase_segment_2 <= limits.segment_2_max &&
         timing.jump_width <= limits.jump_width_max && timing.prescaler >= limits.prescaler_min &&
         timing.prescaler <= limits.prescaler_max;
}

std::optional<std::uint32_t> bit_rate_bps(const BitTiming& timing, std::uint32_t clock_hz) {
  constexpr std::uint64_t kSynchronisation = 1;
  const std::uint64_t quanta = kSynchronisation + timing.propagation_segment +
                               timing.phase_segment_1 + timing.phase_segment_2;
  if (quanta == kSynchronisation || timing.prescaler == 0) {
    return std::nullopt;
  }
  // Both factors stay below 2^34 and 2^32: beyond the clock the product needs no exact value.
  if (quanta > clock_hz || timing.prescaler > clock_hz) {
    return std::nullopt;
  }
  const std::uint64_t clocks_per_bit = quanta * timing.prescaler;
  const std::uint64_t rate = (clock_hz + clocks_per_bit / 2) / clocks_per_bit;
  if (rate == 0) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(rate);
}

}  // namespace rigwire::protocols::gs_usb
