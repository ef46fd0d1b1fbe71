// Fields of messages that are strings of bits, most significant first, in the order of the
// standards' tables. A message is described once, by a function that walks its fields; BitReader
// and BitWriter are what it walks with.
//
//   template <class Bits>
//   void walk(Bits& bits, AntennaPosition& p) {
//     bits.whole(12, p.station);
//     bits.scaled(38, Sign::twos, 1e-4, p.position_m[0]);
//   }
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace rigwire::protocols {

/// Magnitude: a sign bit, and then the absolute value.
enum class Sign : std::uint8_t { none, twos, magnitude };

/// The nearest count of `step` that `bits` hold; NaN gives 0.
[[nodiscard]] inline std::int64_t nearest_count(double value, double step, unsigned bits,
                                                Sign sign) {
  const double greatest = std::ldexp(1.0, static_cast<int>(bits) - (sign == Sign::none ? 0 : 1));
  const double least = sign == Sign::twos        ? -greatest
                       : sign == Sign::magnitude ? 1.0 - greatest
                                                 : 0.0;
  const double count = std::round(value / step);
  return std::isnan(count) ? 0
                           : static_cast<std::int64_t>(std::clamp(count, least, greatest - 1.0));
}

/// Reads what is there. Beyond the end every bit is 0, and short_of() says so.
class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::integral Integer>
  void whole(unsigned bits, Integer& value) {
    value = static_cast<Integer>(take(bits));
  }
  void flag(bool& value) { value = take(1) != 0; }
  void spare(unsigned bits) { take(bits); }
  /// A signed count.
  void count(unsigned bits, std::int64_t& value) { value = extended(bits); }
  void scaled(unsigned bits, Sign sign, double step, double& value) {
    if (sign == Sign::magnitude) {
      const bool negative = take(1) != 0;
      const double size = static_cast<double>(take(bits - 1));
      value = step * (negative ? -size : size);
      return;
    }
    value = step * (sign == Sign::twos ? static_cast<double>(extended(bits))
                                       : static_cast<double>(take(bits)));
  }

  [[nodiscard]] bool short_of() const { return at_ > bytes_.size() * 8; }
  [[nodiscard]] std::size_t bytes() const { return (at_ + 7) / 8; }

 private:
  std::uint64_t take(unsigned bits) {
    assert(bits <= 64);
    std::uint64_t value = 0;
    for (unsigned i = 0; i < bits; ++i, ++at_) {
      const bool set = at_ / 8 < bytes_.size() && (bytes_[at_ / 8] >> (7U - at_ % 8) & 1U) != 0;
      value = value << 1U | (set ? 1U : 0U);
    }
    return value;
  }
  std::int64_t extended(unsigned bits) {
    const unsigned unused = 64 - bits;
    return static_cast<std::int64_t>(take(bits) << unused) >> unused;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

/// Writes up to so many bytes; what is left of the last one is zeros.
template <std::size_t kCapacity>
class BitWriter {
 public:
  /// Higher bits of the value than there are are left out.
  template <std::integral Integer>
  void whole(unsigned bits, Integer value) {
    put(bits, static_cast<std::uint64_t>(value));
  }
  void flag(bool value) { put(1, value ? 1 : 0); }
  void spare(unsigned bits) { put(bits, 0); }
  void count(unsigned bits, std::int64_t value) { put(bits, static_cast<std::uint64_t>(value)); }
  /// The nearest that the field holds.
  void scaled(unsigned bits, Sign sign, double step, double value) {
    const std::int64_t count = nearest_count(value, step, bits, sign);
    if (sign == Sign::magnitude) {
      put(1, count < 0 ? 1 : 0);
      put(bits - 1, static_cast<std::uint64_t>(count < 0 ? -count : count));
      return;
    }
    put(bits, static_cast<std::uint64_t>(count));
  }

  [[nodiscard]] std::span<const std::uint8_t> bytes() const {
    return std::span(bytes_).first((at_ + 7) / 8);
  }

 private:
  void put(unsigned bits, std::uint64_t value) {
    assert(at_ + bits <= kCapacity * 8);
    for (unsigned i = bits; i-- > 0; ++at_) {
      if (i < 64 && (value >> i & 1U) != 0) {  // Spare fields may be longer than a number.
        bytes_[at_ / 8] = static_cast<std::uint8_t>(bytes_[at_ / 8] | 1U << (7U - at_ % 8));
      }
    }
  }

  std::array<std::uint8_t, kCapacity> bytes_{};
  std::size_t at_ = 0;
};

}  // namespace rigwire::protocols
