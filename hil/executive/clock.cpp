#include "hil/executive/clock.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <cstdlib>

namespace rigwire::hil {

std::optional<ClockMode> parse_clock_mode(std::string_view text) {
  if (text == "real") {
    return ClockMode{ClockMode::Kind::real, 1.0};
  }
  if (text == "free") {
    return ClockMode{ClockMode::Kind::free, 1.0};
  }
  constexpr std::string_view kPrefix = "scaled:";
  if (text.starts_with(kPrefix)) {
    const std::string number(text.substr(kPrefix.size()));
    char* end = nullptr;
    const double factor = std::strtod(number.c_str(), &end);
    if (!number.empty() && *end == '\0' && factor >= 0.01 && factor <= 1000.0) {
      return ClockMode{ClockMode::Kind::scaled, factor};
    }
  }
  return std::nullopt;
}

std::string to_string(const ClockMode& mode) {
  switch (mode.kind) {
    case ClockMode::Kind::real:
      return "real";
    case ClockMode::Kind::free:
      return "free";
    case ClockMode::Kind::scaled:
      break;
  }
  return fmt::format("scaled:{:g}", mode.factor);
}

PacedClock::PacedClock(WallTime start, double factor) : start_(start), factor_(factor) {
  assert(factor > 0.0);
}

SimTime PacedClock::at(WallTime wall) const {
  const auto elapsed = std::chrono::duration_cast<std::chrono::nanoseconds>(wall - start_).count();
  const auto scaled =
      factor_ == 1.0 ? elapsed : std::llround(static_cast<double>(elapsed) * factor_);
  return SimTime{Duration{scaled} - slipped()};
}

WallTime PacedClock::wall_of(SimTime instant) const {
  const auto simulated = (instant.time_since_epoch() + slipped()).count();
  const auto wall =
      factor_ == 1.0 ? simulated : std::llround(static_cast<double>(simulated) / factor_);
  return start_ + std::chrono::nanoseconds{wall};
}

void PacedClock::slip(Duration lag) {
  slipped_ns_.fetch_add(lag.count());
}

}  // namespace rigwire::hil
