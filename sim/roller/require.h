// How the roller's parameters are refused: "where.member: found 7, allowed > 0".
#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace rigwire::sim {

inline void require_number(bool fine, const char* where, const char* member, double found,
                           const char* allowed) {
  if (!fine) {
    std::ostringstream message;
    message << where << "." << member << ": found " << found << ", allowed " << allowed;
    throw std::invalid_argument(message.str());
  }
}

inline void require_positive(const char* where, const char* member, double found) {
  require_number(std::isfinite(found) && found > 0.0, where, member, found, "finite and > 0");
}

inline void require_not_negative(const char* where, const char* member, double found) {
  require_number(std::isfinite(found) && found >= 0.0, where, member, found, "finite and >= 0");
}

inline void require_finite_number(const char* where, const char* member, double found) {
  require_number(std::isfinite(found), where, member, found, "a finite number");
}

}  // namespace rigwire::sim
