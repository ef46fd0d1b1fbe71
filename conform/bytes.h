// Bytes of a message that a suite makes, joined from its parts.
#pragma once

#include <cstdint>
#include <vector>

namespace rigwire::conform {

[[nodiscard]] inline std::vector<std::uint8_t> operator+(std::vector<std::uint8_t> left,
                                                         const std::vector<std::uint8_t>& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

}  // namespace rigwire::conform
