// One way of refusing a parameter of a satellite receiver.
#pragma once

#include <stdexcept>
#include <string>

namespace rigwire::sim {

/// Throws std::invalid_argument unless lower <= value <= upper (so also for NaN).
inline void check_parameter(const char* name, double value, double lower, double upper) {
  if (!(value >= lower && value <= upper)) {
    throw std::invalid_argument(std::string("gnss: ") + name + " is " + std::to_string(value) +
                                ", allowed are " + std::to_string(lower) + " .. " +
                                std::to_string(upper));
  }
}

}  // namespace rigwire::sim
