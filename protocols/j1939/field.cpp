#include "protocols/j1939/field.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace rigwire::protocols::j1939 {

Availability classify(unsigned width, std::uint32_t raw) {
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

std::uint32_t to_raw(const Field& field, double physical) {
  if (std::isnan(physical)) {
    return not_available_value(field.width);
  }
  const double clamped = std::clamp(physical, field.lower, field.upper);
  const double counts = std::round((clamped - field.offset) / field.scale);
  const auto greatest = static_cast<double>(greatest_valid(field.width));
  return static_cast<std::uint32_t>(std::clamp(counts, 0.0, greatest));
}

Reading from_raw(const Field& field, std::uint32_t raw) {
  return {classify(field.width, raw), static_cast<double>(raw) * field.scale + field.offset};
}

void put_raw(const Field& field, std::span<std::uint8_t> data, std::uint32_t raw) {
  assert(static_cast<std::size_t>(field.bit) + field.width <= 8 * data.size());
  for (unsigned i = 0; i < field.width; ++i) {
    const unsigned position = field.bit + i;
    const auto mask = static_cast<std::uint8_t>(1U << (position % 8));
    std::uint8_t& byte = data[position / 8];
    byte = static_cast<std::uint8_t>(((raw >> i) & 1U) != 0U ? byte | mask : byte & ~mask);
  }
}

std::uint32_t get_raw(const Field& field, std::span<const std::uint8_t> data) {
  assert(static_cast<std::size_t>(field.bit) + field.width <= 8 * data.size());
  std::uint32_t raw = 0;
  for (unsigned i = 0; i < field.width; ++i) {
    const unsigned position = field.bit + i;
    raw |= ((static_cast<std::uint32_t>(data[position / 8]) >> (position % 8)) & 1U) << i;
  }
  return raw;
}

void encode(const Field& field, std::span<std::uint8_t> data, double physical) {
  put_raw(field, data, to_raw(field, physical));
}

Reading decode(const Field& field, std::span<const std::uint8_t> data) {
  if (static_cast<std::size_t>(field.bit) + field.width > 8 * data.size()) {
    return {};
  }
  return from_raw(field, get_raw(field, data));
}

}  // namespace rigwire::protocols::j1939
