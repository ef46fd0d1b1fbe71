// Checks of settings.
#pragma once

#include <stdexcept>
#include <string>

namespace rigwire::field {

/// Throws std::invalid_argument "WHO: MEMBER is ..., allowed ..." unless `lower` <= value <=
/// `upper`.
inline void require_between(const std::string& who, double value, double lower, double upper,
                            const std::string& member) {
  if (!(value >= lower && value <= upper)) {
    throw std::invalid_argument(who + ": " + member + " is " + std::to_string(value) +
                                ", allowed " + std::to_string(lower) + " to " +
                                std::to_string(upper));
  }
}

}  // namespace rigwire::field
