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
  if (text == "step") {
    return ClockMode{ClockMode::Kind::step, 1.0};
  }
  if (text == "drained") {
    return ClockMode{ClockMode::Kind::drained, 1.0};
  }
  constexpr std::string_view kPrefix = "scaled:";
  if (text.starts_with(kPrefix)) {
    const std::string number(text.substr(kPrefix.size()));
    char* end = nullptr;
    const double factor = std::strtod(number.c_str(), &end);
    if (!number.empty() && *end == '\0' && factor >= kLeastFactor && factor <= kGreatestFactor) {
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
    case ClockMode::Kind::step:
      return "step";
    case ClockMode::Kind::drained:
      return "drained";
    case ClockMode::Kind::scaled:
      break;
  }
  return fmt::format("scaled:{:g}", mode.factor);
}

SimTime PacedClock::Course::at(WallTime when) const {
  if (stands) {
    return sim;
  }
  const auto elapsed = std::chrono::duration_cast<std::chrono::nanoseconds>(when - wall).count();
  return sim +
         Duration{factor == 1.0 ? elapsed : std::llround(static_cast<double>(elapsed) * factor)};
}

WallTime PacedClock::Course::wall_of(SimTime instant) const {
  if (stands && instant > sim) {
    return WallTime::max();
  }
  const auto simulated = (instant - sim).count();
  return wall +
         std::chrono::nanoseconds{
             factor == 1.0 ? simulated : std::llround(static_cast<double>(simulated) / factor)};
}

PacedClock::PacedClock(WallTime start, double factor)
    : course_{.wall = start, .sim = kStart, .factor = factor} {
  assert(factor > 0.0);
}

PacedClock::Course PacedClock::course() const {
  const std::scoped_lock lock(mutex_);
  return course_;
}

SimTime PacedClock::at(WallTime wall) const {
  return course().at(wall);
}

WallTime PacedClock::wall_of(SimTime instant) const {
  return course().wall_of(instant);
}

void PacedClock::slip(Duration lag) {
  const std::scoped_lock lock(mutex_);
  course_.sim -= lag;
  slipped_ += lag;
}

Duration PacedClock::slipped() const {
  const std::scoped_lock lock(mutex_);
  return slipped_;
}

void PacedClock::stand(SimTime instant) {
  const std::scoped_lock lock(mutex_);
  course_.wall = course_.wall_of(instant);
  course_.sim = instant;
  course_.stands = true;
}

void PacedClock::go_on(WallTime wall) {
  const std::scoped_lock lock(mutex_);
  if (course_.stands) {
    course_.wall = wall;
    course_.stands = false;
  }
}

void PacedClock::set_factor(WallTime wall, double factor) {
  assert(factor > 0.0);
  const std::scoped_lock lock(mutex_);
  course_.sim = course_.at(wall);
  course_.wall = wall;
  course_.factor = factor;
}

double PacedClock::factor() const {
  return course().factor;
}

}  // namespace rigwire::hil
