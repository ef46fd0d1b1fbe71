// What an exception says to people. The standard library's own words for exhausted memory name
// neither what was being made nor a remedy.
#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rigwire::fields {

/// The exception's own words; where memory was exhausted, what was being made (`making`, a noun:
/// "the run") and what to do.
[[nodiscard]] inline std::string failure_text(const std::exception& failure,
                                              std::string_view making) {
  const bool exhausted = dynamic_cast<const std::bad_alloc*>(&failure) != nullptr ||
                         dynamic_cast<const std::length_error*>(&failure) != nullptr;
  return exhausted
             ? "no memory left for " + std::string(making) +
                   "; give the process more (ulimit -v, the container's limit), or make scene, "
                   "pictures or files smaller"
             : std::string(failure.what());
}

}  // namespace rigwire::fields
