#include "protocols/can/signal.h"

#include <algorithm>
#include <bit>

namespace rigwire::protocols::can {
namespace {

/// Bits of a signal that lie in one byte.
struct Part {
  std::size_t byte;
  unsigned shift;  ///< Position of its least significant bit in the byte.
  unsigned bits;
  unsigned low;  ///< Position of that bit in the raw value.
};

/// Calls `use` for each part. Precondition: the signal fits.
template <class Use>
void each_part(const Coding& signal, const Use& use) {
  if (signal.order == ByteOrder::little_endian) {
    for (unsigned done = 0; done < signal.width;) {
      const unsigned at = signal.bit + done;
      const unsigned bits = std::min(8U - at % 8U, signal.width - done);
      use(Part{at / 8U, at % 8U, bits, done});
      done += bits;
    }
    return;
  }
  std::size_t byte = signal.bit / 8U;
  unsigned free = signal.bit % 8U + 1U;  // bits of this byte from here down
  for (unsigned left = signal.width; left > 0; ++byte, free = 8) {
    const unsigned bits = std::min(free, left);
    left -= bits;
    use(Part{byte, free - bits, bits, left});
  }
}

/// Held within the limits, which may be in any order.
double held(const Coding& signal, double physical) {
  return std::min(std::max(physical, signal.lower), signal.upper);
}

std::uint64_t float_bits(const Coding& signal, double physical) {
  const double value =
      std::isnan(physical) ? physical : (held(signal, physical) - signal.offset) / signal.scale;
  if (signal.width == 64) {
    return std::bit_cast<std::uint64_t>(value);
  }
  constexpr double kGreatest = std::numeric_limits<float>::max();
  const double carried = std::isfinite(value) ? std::clamp(value, -kGreatest, kGreatest) : value;
  return std::bit_cast<std::uint32_t>(static_cast<float>(carried));
}

Reading from_float(const Coding& signal, std::uint64_t raw) {
  const double carried =
      signal.width == 64
          ? std::bit_cast<double>(raw)
          : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
  if (std::isnan(carried)) {
    return {};
  }
  return {std::isinf(carried) ? Availability::error : Availability::valid,
          carried * signal.scale + signal.offset};
}

bool is_reserved(const Coding& signal) {
  return signal.reserved == Reserved::j1939 && signal.width >= 2 && signal.width <= 64;
}

}  // namespace

Availability classify(unsigned width, std::uint64_t raw) {
  width = width_of_patterns(width);
  if (raw <= greatest_valid(width)) {
    return Availability::valid;
  }
  if (width == 10 && raw < error_value(width)) {
    return Availability::indicator;
  }
  if (width < 8 || width == 10) {
    return raw == not_available_value(width) ? Availability::not_available : Availability::error;
  }
  switch (raw >> (width - 8)) {
    case 0xFF:
      return Availability::not_available;
    case 0xFE:
      return Availability::error;
    default:
      return Availability::indicator;
  }
}

std::uint64_t to_raw(const Coding& signal, double physical) {
  if (signal.is_float) {
    return float_bits(signal, physical);
  }
  const bool reserved = is_reserved(signal);
  if (!std::isfinite(physical)) {
    if (reserved) {
      return std::isnan(physical) ? not_available_value(signal.width) : error_value(signal.width);
    }
    physical = std::isnan(physical) ? 0.0 : physical;
  }
  const double counts = std::round((held(signal, physical) - signal.offset) / signal.scale);
  // Compared as doubles, which round the ends of wide signals up: what is below them fits.
  if (signal.is_signed && !reserved) {
    const std::uint64_t greatest = greatest_raw(signal.width) >> 1U;
    const auto end = static_cast<double>(greatest);
    if (!(counts > -end - 1.0)) {
      return greatest + 1U;
    }
    return counts >= end ? greatest
                         : static_cast<std::uint64_t>(static_cast<std::int64_t>(counts)) &
                               greatest_raw(signal.width);
  }
  const std::uint64_t greatest =
      reserved ? greatest_valid(signal.width) : greatest_raw(signal.width);
  if (!(counts > 0.0)) {
    return 0;
  }
  return counts >= static_cast<double>(greatest) ? greatest : static_cast<std::uint64_t>(counts);
}

Reading from_raw(const Coding& signal, std::uint64_t raw) {
  raw &= greatest_raw(signal.width);
  if (signal.is_float) {
    return from_float(signal, raw);
  }
  if (is_reserved(signal)) {
    return {classify(signal.width, raw), static_cast<double>(raw) * signal.scale + signal.offset};
  }
  const bool negative = signal.is_signed && raw > greatest_raw(signal.width) >> 1U;
  const double counts =
      negative ? static_cast<double>(static_cast<std::int64_t>(raw | ~greatest_raw(signal.width)))
               : static_cast<double>(raw);
  return {Availability::valid, counts * signal.scale + signal.offset};
}

void put_raw(const Coding& signal, std::span<std::uint8_t> data, std::uint64_t raw) {
  if (!fits(signal, data.size())) {
    return;
  }
  each_part(signal, [&](const Part& part) {
    const unsigned mask = ((1U << part.bits) - 1U) << part.shift;
    const auto bits = static_cast<unsigned>((raw >> part.low) & 0xFFU) << part.shift;
    data[part.byte] = static_cast<std::uint8_t>((data[part.byte] & ~mask) | (bits & mask));
  });
}

std::uint64_t get_raw(const Coding& signal, std::span<const std::uint8_t> data) {
  std::uint64_t raw = 0;
  if (fits(signal, data.size())) {
    each_part(signal, [&](const Part& part) {
      const unsigned bits =
          (static_cast<unsigned>(data[part.byte]) >> part.shift) & ((1U << part.bits) - 1U);
      raw |= static_cast<std::uint64_t>(bits) << part.low;
    });
  }
  return raw;
}

void put(const Coding& signal, std::span<std::uint8_t> data, double physical) {
  if (!std::isnan(physical) || signal.is_float || is_reserved(signal)) {
    put_raw(signal, data, to_raw(signal, physical));
  }
}

Reading get(const Coding& signal, std::span<const std::uint8_t> data) {
  return fits(signal, data.size()) ? from_raw(signal, get_raw(signal, data)) : Reading{};
}

}  // namespace rigwire::protocols::can
