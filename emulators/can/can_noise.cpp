#include "emulators/can/can_noise.h"

#include <algorithm>
#include <cmath>

namespace rigwire::emulators {
namespace {

/// The first bit of the attempt that begins at `instant` or later; far ones are cut.
unsigned bit_from(const CanBitClock& clock, SimTime instant) {
  if (instant <= clock.now()) {
    return 0;
  }
  const Duration span = instant - clock.now();
  const auto bit = static_cast<unsigned>(clock.bits_in(span));
  return clock.after(bit) < instant ? bit + 1 : bit;
}

}  // namespace

CanNoise::CanNoise(const CanBusFaults& faults) {
  std::uint64_t seed = faults.seed;
  for (const CanFault& fault : faults.list) {
    if (std::holds_alternative<BitErrorsFault>(fault.what) ||
        std::holds_alternative<DisturbanceFault>(fault.what) ||
        std::holds_alternative<ShortCircuitFault>(fault.what)) {
      sources_.push_back({fault, RandomBits(RandomBits(seed).bits())});
      draw_gap(sources_.back());
    }
    ++seed;
  }
}

/// Geometric distribution of the good bits between two errors.
void CanNoise::draw_gap(Source& source) {
  if (const auto* errors = std::get_if<BitErrorsFault>(&source.fault.what)) {
    const double gap =
        std::floor(std::log(1.0 - source.random.uniform()) / std::log1p(-errors->probability));
    source.good_bits_left = static_cast<std::uint64_t>(std::min(gap, 1e18));
  }
}

CanLineState CanNoise::attempt(const CanBitClock& clock, unsigned bits) {
  CanLineState line;
  for (Source& source : sources_) {
    const SimTime begin = source.fault.when.begin();
    const SimTime end = source.fault.when.end();
    if (end <= clock.now() || begin >= clock.after(bits)) {
      continue;
    }
    const unsigned first = bit_from(clock, begin);
    const unsigned behind = bit_from(clock, end);
    unsigned inverted = CanLineState::kNoBit;
    if (std::holds_alternative<BitErrorsFault>(source.fault.what)) {
      if (first > 0) {
        // Begins within this attempt: errors are of those after it.
      } else if (source.good_bits_left >= bits) {
        source.good_bits_left -= bits;
      } else {
        // The error falls into this attempt; the next gap is drawn for those after it.
        inverted = static_cast<unsigned>(source.good_bits_left);
        draw_gap(source);
      }
    } else if (const auto* disturbance = std::get_if<DisturbanceFault>(&source.fault.what)) {
      const unsigned last = std::min(behind, bits);
      if (disturbance->bit >= 0) {
        const auto bit = static_cast<unsigned>(disturbance->bit);
        inverted = bit >= first && bit < last ? bit : inverted;
      } else if (first < last) {
        inverted = first + source.random.below(last - first);
      }
    } else {
      line.short_begin = std::min(line.short_begin, first);
      line.short_end =
          line.short_end == CanLineState::kNoBit ? behind : std::max(line.short_end, behind);
    }
    line.inverted_bit = std::min(line.inverted_bit, inverted);
  }
  return line;
}

}  // namespace rigwire::emulators
