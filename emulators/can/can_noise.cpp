#include "emulators/can/can_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Geometric distribution of the good bits between two errors.
std::uint64_t draw_gap(const BitErrorsFault& errors, RandomBits& random) {
  const double gap =
      std::floor(std::log(1.0 - random.uniform()) / std::log1p(-errors.bit_error_rate));
  return static_cast<std::uint64_t>(std::min(gap, 1e18));
}

/// The stretch in which it holds that `now` lies in, or the next one before `horizon`; begins at
/// kNever without one. Of several that lie in one frame the first counts.
std::pair<SimTime, SimTime> stretch(const FaultPeriod& when, SimTime now, SimTime horizon) {
  SimTime begin = now;
  if (when.holds(now)) {
    begin = when.began(now);
  } else {
    do {
      begin = when.next_edge(begin);
    } while (begin < horizon && !when.holds(begin));
    begin = begin < horizon ? begin : kNever;
  }
  return {begin, begin == kNever ? kNever : when.next_edge(begin)};
}

}  // namespace

void CanNoise::add_newest() {
  std::erase_if(sources_, [this](const Source& source) { return !book_.has(source.id); });
  const auto& [id, fault] = book_.list().back();
  if (is_of_wire(fault)) {
    const State state{RandomBits(RandomBits(seed_ + id - 1).bits()), std::nullopt};
    sources_.push_back({id, state, state});
  }
}

unsigned CanNoise::first_bit_error(const BitErrorsFault& errors, State& state, unsigned bits) {
  if (!state.good_bits_left) {
    state.good_bits_left = draw_gap(errors, state.random);
  }
  if (*state.good_bits_left >= bits) {
    *state.good_bits_left -= bits;
    return CanLineState::kNoBit;
  }
  // The error falls into this attempt; the next gap is drawn for those after it.
  const auto bit = static_cast<unsigned>(*state.good_bits_left);
  state.good_bits_left = draw_gap(errors, state.random);
  return bit;
}

CanLineState CanNoise::attempt(const CanBitClock& clock, unsigned bits) {
  CanLineState line;
  for (Source& source : sources_) {
    source.before_attempt = source.state;
    const CanFault& fault = book_.find(source.id);
    const auto [begin, end] = stretch(fault.when, clock.now(), clock.after(bits));
    if (end <= clock.now() || begin >= std::min(end, clock.after(bits))) {
      continue;
    }
    const unsigned first = bit_from(clock, begin);
    const unsigned behind = bit_from(clock, end);
    unsigned inverted = CanLineState::kNoBit;
    if (const auto* errors = std::get_if<BitErrorsFault>(&fault.what)) {
      // Where it begins within this attempt, errors are of those after it.
      inverted = first == 0 ? first_bit_error(*errors, source.state, bits) : inverted;
    } else if (const auto* disturbance = std::get_if<DisturbanceFault>(&fault.what)) {
      const unsigned last = std::min(behind, bits);
      if (disturbance->bit >= 0) {
        const auto bit = static_cast<unsigned>(disturbance->bit);
        inverted = bit >= first && bit < last ? bit : inverted;
      } else if (first < last) {
        inverted = first + source.state.random.below(last - first);
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

CanLineState CanNoise::attempt_again(const CanBitClock& clock, unsigned bits) {
  for (Source& source : sources_) {
    source.state = source.before_attempt;
  }
  return attempt(clock, bits);
}

}  // namespace rigwire::emulators
