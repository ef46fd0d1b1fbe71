// Refusals of the scene's set-up, in one form.
#pragma once

#include <stdexcept>
#include <string>

namespace rigwire::sim {

/// Throws std::invalid_argument "member is value, allowed: lower to upper" outside of them, and for
/// what is no number.
inline void require_within(double value, double lower, double upper, const std::string& member) {
  if (!(value >= lower && value <= upper)) {
    throw std::invalid_argument(member + " is " + std::to_string(value) + ", allowed: " +
                                std::to_string(lower) + " to " + std::to_string(upper));
  }
}

}  // namespace rigwire::sim
