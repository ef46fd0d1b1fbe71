// A number in a CAN message: where it sits, what one count means, what its sender may send, and
// which bit patterns are no number. One row serves encoder, decoder, DBC file and descriptions.
//
// Sources: Vector DBC File Format Documentation 1.0.5 (bit counting, value types, multiplexing);
// SAE J1939-71, 5.1.4 (reserved patterns); 10 bits, which only joysticks have: ISO 11783-6 by
// general knowledge.
//
// Bits are counted as a DBC file counts them: byte k has bits 8 k (least significant) .. 8 k + 7. A
// little-endian ("Intel") signal is identified by its least significant bit and grows upward; a
// big-endian ("Motorola") one by its most significant bit and grows downward within a byte, then
// into the upper end of the next byte. A 16-bit big-endian number in the bytes 0 and 1 begins at
// bit 7.
//
// Physical value = raw * scale + offset. The rounding error of put then get is at most half a
// count, and beyond 53 bits that of a double. A sender never sends beyond `lower` .. `upper`, and
// never wraps: a value that is too large becomes the maximum raw value that is a number.
//
// Reserved::j1939 excludes the highest raw values of each width from the numbers:
//
//   width          valid              indicator            error            not available
//   2 bit          0..1               -                    2                3
//   4 bit          0..0xD             -                    0xE              0xF
//   8 bit          0..0xFA            0xFB..0xFD           0xFE             0xFF
//   10 bit         0..1000            1001..1021           1022             1023
//   16, 24, 32     top byte <= 0xFA   top byte 0xFB..0xFD  top byte 0xFE    top byte 0xFF
//
// and other widths after the same pattern. Everything here takes any row and any payload.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::protocols::can {

enum class ByteOrder : std::uint8_t { little_endian, big_endian };

/// Raw values that are no number.
enum class Reserved : std::uint8_t { none, j1939 };

/// All that encoder and decoder need to know of a signal.
struct Coding {
  std::uint16_t bit = 0;    ///< Where it begins, as above.
  std::uint16_t width = 8;  ///< 1 .. 64.
  ByteOrder order = ByteOrder::little_endian;
  bool is_signed = false;  ///< Two's complement.
  bool is_float = false;   ///< IEEE 754, of 32 or 64 bits.
  Reserved reserved = Reserved::none;
  double scale = 1.0;   ///< Per count; negative where the wire has the other sign.
  double offset = 0.0;  ///< Physical value of raw 0.
  double lower = 0.0;   ///< Minimum physical value that is sent.
  double upper = 0.0;   ///< Maximum.
};

enum class Availability : std::uint8_t { valid, indicator, error, not_available };

/// A decoded signal; `value` is meaningful only when valid.
struct Reading {
  Availability availability = Availability::not_available;
  double value = 0.0;

  [[nodiscard]] bool valid() const { return availability == Availability::valid; }
  /// Returns the value that put() accepts: infinity for an error, NaN for every other reading
  /// without a number.
  [[nodiscard]] double number() const {
    if (valid()) {
      return value;
    }
    return availability == Availability::error ? std::numeric_limits<double>::infinity()
                                               : std::numeric_limits<double>::quiet_NaN();
  }
};

/// All ones.
[[nodiscard]] constexpr std::uint64_t greatest_raw(unsigned width) {
  return width >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1U;
}

// The reserved patterns of J1939, by width: of 2 .. 64 bits, others count as the nearest of these.
[[nodiscard]] constexpr unsigned width_of_patterns(unsigned width) {
  return width < 2 ? 2 : width > 64 ? 64 : width;
}
/// The maximum raw value that is a measurement.
[[nodiscard]] constexpr std::uint64_t greatest_valid(unsigned width) {
  if (width == 10) {
    return 1000;
  }
  const unsigned bits = width_of_patterns(width);
  return bits < 8 ? greatest_raw(bits) - 2U : (std::uint64_t{0xFB} << (bits - 8U)) - 1U;
}
/// The raw value sent for an error; the highest of the error values.
[[nodiscard]] constexpr std::uint64_t error_value(unsigned width) {
  const unsigned bits = width_of_patterns(width);
  return greatest_raw(bits) -
         (bits < 8 || bits == 10 ? std::uint64_t{1} : std::uint64_t{1} << (bits - 8U));
}
/// The raw value sent for "not available": all ones.
[[nodiscard]] constexpr std::uint64_t not_available_value(unsigned width) {
  return greatest_raw(width_of_patterns(width));
}
/// What a raw value of that width is.
[[nodiscard]] Availability classify(unsigned width, std::uint64_t raw);

/// The bits of byte `byte` that the signal occupies.
[[nodiscard]] constexpr std::uint8_t bits_in(const Coding& signal, std::size_t byte) {
  // Along the signal's own direction: from its first bit's byte, `first` bits are skipped.
  const bool little = signal.order == ByteOrder::little_endian;
  const std::size_t first = little ? signal.bit : 8U * (signal.bit / 8U) + 7U - signal.bit % 8U;
  const std::size_t end = first + signal.width;
  unsigned bits = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    if (8 * byte + i >= first && 8 * byte + i < end) {
      bits |= little ? 1U << i : 0x80U >> i;
    }
  }
  return static_cast<std::uint8_t>(bits);
}

/// Whether the signal is of 1 .. 64 bits and lies within `bytes` bytes.
[[nodiscard]] constexpr bool fits(const Coding& signal, std::size_t bytes) {
  const std::size_t first = signal.order == ByteOrder::little_endian
                                ? signal.bit
                                : 8U * (signal.bit / 8U) + 7U - signal.bit % 8U;
  return signal.width >= 1 && signal.width <= 64 && first + signal.width <= 8 * bytes;
}

/// Why the row is none; empty where it is one.
[[nodiscard]] constexpr std::string_view defect(const Coding& signal, std::size_t bytes) {
  const auto finite = [](double x) {
    constexpr double kGreatest = std::numeric_limits<double>::max();
    return x >= -kGreatest && x <= kGreatest;
  };
  if (signal.width < 1 || signal.width > 64) {
    return "a signal has 1 to 64 bits";
  }
  if (!fits(signal, bytes)) {
    return "the signal does not lie within its message";
  }
  if (signal.is_float && signal.width != 32 && signal.width != 64) {
    return "a floating-point signal has 32 or 64 bits";
  }
  if (signal.reserved == Reserved::j1939 &&
      (signal.is_signed || signal.is_float || signal.width < 2)) {
    return "patterns are reserved in unsigned numbers of 2 bits or more";
  }
  if (!finite(signal.scale) || signal.scale == 0.0 || !finite(signal.offset)) {
    return "scale and offset are finite, and the scale is not 0";
  }
  return signal.lower <= signal.upper ? "" : "the lower limit is above the upper one";
}

/// What the signal's bits can carry as physical values, for a sender without limits of its own.
struct Range {
  double lower = 0.0;
  double upper = 0.0;
};
[[nodiscard]] constexpr Range carried(const Coding& signal) {
  if (signal.is_float) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {-kInfinity, kInfinity};
  }
  const auto counts =
      static_cast<double>(signal.reserved == Reserved::j1939 ? greatest_valid(signal.width)
                                                             : greatest_raw(signal.width));
  const double half = static_cast<double>(greatest_raw(signal.width) / 2U);
  const double least = (signal.is_signed ? -half - 1.0 : 0.0) * signal.scale + signal.offset;
  const double greatest = (signal.is_signed ? half : counts) * signal.scale + signal.offset;
  return least <= greatest ? Range{least, greatest} : Range{greatest, least};
}
/// Returns the signal with the limits that its bits can carry.
template <class Row>
[[nodiscard]] constexpr Row unlimited(Row signal) {
  const Range range = carried(signal);
  signal.lower = range.lower;
  signal.upper = range.upper;
  return signal;
}

/// The raw value nearest to `physical`, saturated. Where patterns are reserved, NaN is not
/// available and an infinity an error; else NaN counts as 0 and an infinity as the limit. A
/// floating-point signal carries both, infinities as far as its limits are infinite.
[[nodiscard]] std::uint64_t to_raw(const Coding& signal, double physical);
/// Ignores bits beyond the width. A floating-point signal that is NaN is not available, an infinite
/// one an error.
[[nodiscard]] Reading from_raw(const Coding& signal, std::uint64_t raw);

/// Raw access to a message's bits; ignores bits of `raw` beyond the width. Where the signal does
/// not lie within `data`, nothing is written, and 0 is read.
void put_raw(const Coding& signal, std::span<std::uint8_t> data, std::uint64_t raw);
[[nodiscard]] std::uint64_t get_raw(const Coding& signal, std::span<const std::uint8_t> data);

/// Combines to_raw and put_raw, but NaN leaves the bits as they are if the signal cannot express
/// it.
void put(const Coding& signal, std::span<std::uint8_t> data, double physical);
/// Not available when the message is too short to hold the signal, as J1939-21 has it for short
/// messages; never reads past the end.
[[nodiscard]] Reading get(const Coding& signal, std::span<const std::uint8_t> data);

// Texts and rows either live for ever, as those of a table in the program do, or belong to the
// value, as those of a file do.
struct Borrowed {
  using Text = std::string_view;
  template <class T>
  using List = std::span<const T>;
};
struct Owned {
  using Text = std::string;
  template <class T>
  using List = std::vector<T>;
};

/// A name for one raw value of a signal; of a signed one as the number that it is.
template <class Keep>
struct BasicNamedValue {
  std::int64_t raw = 0;
  typename Keep::Text text;
};

/// Raw values from `first` to `last`.
struct RawRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};
/// Multiplexor of a signal that is always present.
inline constexpr std::uint16_t kNoMultiplexor = 0xFFFF;

template <class Keep>
struct BasicSignal : Coding {
  typename Keep::Text name;  ///< Unique within its message.
  typename Keep::Text unit;  ///< Unit of the physical value; empty or "1" for bare numbers.
  typename Keep::Text text;  ///< What it means; source.
  std::uint32_t spn = 0;     ///< Suspect parameter number of J1939; 0: none.
  typename Keep::template List<BasicNamedValue<Keep>> values;
  /// Unit in the signal's document, and the size of that unit in `unit`; negative if its sign is
  /// reversed. Empty: the same unit.
  typename Keep::Text document_unit;
  double document_size = 1.0;
  /// Index in the message of the signal whose raw value decides whether this one is present, and
  /// the raw values at which it is.
  std::uint16_t multiplexor = kNoMultiplexor;
  typename Keep::template List<RawRange> present_at;
};

using NamedValue = BasicNamedValue<Borrowed>;
using Signal = BasicSignal<Borrowed>;
using OwnedNamedValue = BasicNamedValue<Owned>;
using OwnedSignal = BasicSignal<Owned>;

}  // namespace rigwire::protocols::can
