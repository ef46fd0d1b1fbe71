// How one row of the tables of configuration_keys.h is written.
#pragma once

#include <bit>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string_view>

#include "protocols/ubx/configuration_keys.h"

namespace rigwire::protocols::ubx::detail {

/// What one count means.
struct Count {
  double scale = 1.0;
  std::string_view unit;
};

/// Limits of the number on the wire.
struct Limits {
  std::int64_t lower = 0;
  std::int64_t upper = 0;
};

[[nodiscard]] constexpr Limits whole_range(KeyType type) {
  switch (type) {
    case KeyType::l:
      return {0, 1};
    case KeyType::u1:
    case KeyType::x1:
    case KeyType::e1:
      return {0, 0xFF};
    case KeyType::u2:
    case KeyType::x2:
      return {0, 0xFFFF};
    case KeyType::u4:
      return {0, 0xFFFFFFFF};
    case KeyType::i1:
      return {-0x80, 0x7F};
    case KeyType::i2:
      return {-0x8000, 0x7FFF};
    case KeyType::i4:
      return {-0x80000000LL, 0x7FFFFFFF};
    case KeyType::x8:
    case KeyType::r4:
    case KeyType::r8:
      break;
  }
  return {0, 0};
}

[[nodiscard]] constexpr ConfigurationKey flag(std::uint32_t id, std::string_view name,
                                              bool initial) {
  return {id, KeyType::l, name, initial ? 1U : 0U, 0, 1, 0, 1.0, {}};
}
/// One of a list of numbers below 64.
[[nodiscard]] constexpr ConfigurationKey choice(std::uint32_t id, std::string_view name,
                                                std::uint64_t initial,
                                                std::initializer_list<unsigned> allowed) {
  std::uint64_t choices = 0;
  for (const unsigned value : allowed) {
    choices |= std::uint64_t{1} << value;
  }
  return {id, KeyType::e1, name, initial, 0, 63, choices, 1.0, {}};
}
/// A number of the type's whole range.
[[nodiscard]] constexpr ConfigurationKey number(std::uint32_t id, KeyType type,
                                                std::string_view name, std::uint64_t initial,
                                                const Count& count = {}) {
  const Limits limits = whole_range(type);
  return {id, type, name, initial, limits.lower, limits.upper, 0, count.scale, count.unit};
}
[[nodiscard]] constexpr ConfigurationKey bounded(std::uint32_t id, KeyType type,
                                                 std::string_view name, std::uint64_t initial,
                                                 const Limits& limits, const Count& count = {}) {
  return {id, type, name, initial, limits.lower, limits.upper, 0, count.scale, count.unit};
}
[[nodiscard]] constexpr ConfigurationKey real4(std::uint32_t id, std::string_view name,
                                               float initial, const Count& count = {}) {
  return number(id, KeyType::r4, name, std::bit_cast<std::uint32_t>(initial), count);
}
[[nodiscard]] constexpr ConfigurationKey real8(std::uint32_t id, std::string_view name,
                                               double initial, const Count& count = {}) {
  return number(id, KeyType::r8, name, std::bit_cast<std::uint64_t>(initial), count);
}

}  // namespace rigwire::protocols::ubx::detail
