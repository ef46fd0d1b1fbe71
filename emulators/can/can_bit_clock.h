// Where a bus is in its bits, as exact simulated time.
//
// Positions are whole bits since the last synchronisation, never sums of rounded spans: an instant
// is rounded once, to the nearest nanosecond, whatever the bit rate and however long the bus has
// been busy.
#pragma once

#include <cstdint>

#include "sim/samples/time.h"

namespace rigwire::emulators {

class CanBitClock {
 public:
  explicit CanBitClock(std::uint32_t bit_rate_bps) : rate_(bit_rate_bps) {}

  /// The present position: begin of a frame, or the bit from which the bus is free.
  [[nodiscard]] SimTime now() const { return after(0); }
  /// The begin of the bit that many bits later. Precondition: bits < 2^33.
  [[nodiscard]] SimTime after(std::uint64_t bits) const { return anchor_ + span(bit_ + bits); }
  /// As a duration, to the nearest nanosecond. Precondition: bits < 2^34.
  [[nodiscard]] Duration span(std::uint64_t bits) const {
    return Duration{static_cast<std::int64_t>((bits * kSecond_ns + rate_ / 2) / rate_)};
  }
  /// Bits in a span, to the nearest; spans beyond a second count as one. Precondition: not
  /// negative.
  [[nodiscard]] std::uint64_t bits_in(Duration span) const {
    const auto ns = static_cast<std::uint64_t>(span.count());
    return ((ns < kSecond_ns ? ns : kSecond_ns) * rate_ + kSecond_ns / 2) / kSecond_ns;
  }

  void advance(std::uint64_t bits) {
    bit_ += bits;
    while (bit_ >= rate_) {
      bit_ -= rate_;
      anchor_ += Duration{static_cast<std::int64_t>(kSecond_ns)};
    }
  }
  /// A frame begins on an idle bus: everybody synchronises to its edge.
  void synchronise(SimTime instant) {
    anchor_ = instant;
    bit_ = 0;
  }
  [[nodiscard]] std::uint32_t bit_rate_bps() const { return static_cast<std::uint32_t>(rate_); }

 private:
  static constexpr std::uint64_t kSecond_ns = 1'000'000'000;
  std::uint64_t rate_;
  SimTime anchor_ = kStart;
  std::uint64_t bit_ = 0;  ///< Since anchor_, below rate_.
};

}  // namespace rigwire::emulators
