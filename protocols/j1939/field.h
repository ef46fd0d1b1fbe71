// Parameters inside a J1939 message: where they sit, what one count means, and which raw values
// are no measurement. One Field row serves encoder and decoder.
//
// Source: SAE J1939-71, 5.1.4 (valid ranges); 10 bits, which only joysticks have: ISO 11783-6 by
// general knowledge. Values are unsigned, little-endian, physical = raw *
// scale + offset. The greatest values of each width carry meaning instead of a number:
//
//   width          valid              indicator            error            not available
//   2 bit          0..1               -                    2                3
//   4 bit          0..0xD             -                    0xE              0xF
//   8 bit          0..0xFA            0xFB..0xFD           0xFE             0xFF
//   10 bit         0..1000            1001..1021           1022             1023
//   16, 24, 32     top byte <= 0xFA   top byte 0xFB..0xFD  top byte 0xFE    top byte 0xFF
//
// Encoding clamps to the valid range and to the field's own range; it never wraps into the
// indicators. The rounding error of encode then decode is at most half a count.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace rigwire::protocols::j1939 {

/// One parameter of a message.
struct Field {
  std::string_view name;
  std::uint16_t spn = 0;   ///< Suspect parameter number; 0 for proprietary ones.
  std::uint8_t bit = 0;    ///< Least significant bit, counted from bit 0 of byte 0.
  std::uint8_t width = 8;  ///< 2, 4, 8, 10, 16, 24 or 32 bits.
  double scale = 1.0;      ///< Unit per count, greater than zero.
  double offset = 0.0;     ///< Physical value of raw 0.
  double lower = 0.0;      ///< Least physical value that the sender emits.
  double upper = 0.0;      ///< Greatest.
  std::string_view unit{};
};

enum class Availability : std::uint8_t { valid, indicator, error, not_available };

/// A decoded parameter; `value` is meaningful only when valid.
struct Reading {
  Availability availability = Availability::not_available;
  double value = 0.0;

  [[nodiscard]] bool valid() const { return availability == Availability::valid; }
};

/// Whether the field's width is one of those above and it lies within `bytes` bytes.
[[nodiscard]] constexpr bool is_well_formed(const Field& field, unsigned bytes = 8) {
  const unsigned w = field.width;
  const bool width_ok = w == 2 || w == 4 || w == 8 || w == 10 || w == 16 || w == 24 || w == 32;
  return width_ok && field.bit + w <= 8 * bytes && field.scale > 0.0 && field.lower < field.upper;
}

/// The greatest raw value that is a measurement.
[[nodiscard]] constexpr std::uint32_t greatest_valid(unsigned width) {
  if (width == 2) {
    return 1;
  }
  if (width == 10) {
    return 1000;
  }
  return width < 8 ? 0xDU : (0xFBU << (width - 8)) - 1U;
}
/// The raw value sent for an error; the least of the error values.
[[nodiscard]] constexpr std::uint32_t error_value(unsigned width) {
  if (width < 8 || width == 10) {
    return (1U << width) - 2U;
  }
  return (0xFEU << (width - 8)) | ((1U << (width - 8)) - 1U);
}
/// The raw value sent for "not available": all ones.
[[nodiscard]] constexpr std::uint32_t not_available_value(unsigned width) {
  return width == 32 ? 0xFFFFFFFFU : (1U << width) - 1U;
}
[[nodiscard]] Availability classify(unsigned width, std::uint32_t raw);

/// The raw value nearest to `physical`, saturated; not available for NaN.
[[nodiscard]] std::uint32_t to_raw(const Field& field, double physical);
[[nodiscard]] Reading from_raw(const Field& field, std::uint32_t raw);

/// Raw access to a message's bits. Precondition: the field lies within `data`.
void put_raw(const Field& field, std::span<std::uint8_t> data, std::uint32_t raw);
[[nodiscard]] std::uint32_t get_raw(const Field& field, std::span<const std::uint8_t> data);

/// to_raw and put_raw in one. Precondition: the field lies within `data`.
void encode(const Field& field, std::span<std::uint8_t> data, double physical);
/// Not available when the message is too short to hold the field, as J1939-21 has it for short
/// messages; never reads past the end.
[[nodiscard]] Reading decode(const Field& field, std::span<const std::uint8_t> data);

}  // namespace rigwire::protocols::j1939
