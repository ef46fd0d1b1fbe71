#include "hil/configuration/fields.h"

#include <fmt/format.h>

namespace rigwire::hil {

namespace {

template <class Print>
std::string range(std::int64_t lower, std::int64_t upper, Print print) {
  const bool has_lower = lower != std::numeric_limits<std::int64_t>::min();
  const bool has_upper = upper != std::numeric_limits<std::int64_t>::max();
  if (has_lower && has_upper) {
    return fmt::format("{} .. {}", print(lower), print(upper));
  }
  if (has_lower) {
    return fmt::format(">= {}", print(lower));
  }
  return has_upper ? fmt::format("<= {}", print(upper)) : std::string();
}

}  // namespace

std::string IntegerRule::range_text() const {
  return range(lower, upper, [](std::int64_t value) { return fmt::format("{}", value); });
}

std::string DurationRule::range_text() const {
  return range(lower_ns, upper_ns, print_duration);
}

Location Origins::of(const std::string& path) const {
  const auto it = places_.find(path);
  return it == places_.end() ? Location{} : it->second;
}

Location Origins::nearest(std::string path) const {
  while (true) {
    const auto it = places_.find(path);
    if (it != places_.end()) {
      return it->second;
    }
    if (path.empty()) {
      return {};
    }
    const std::size_t dot = path.rfind('.');
    path = dot == std::string::npos ? std::string() : path.substr(0, dot);
  }
}

std::string print_duration(std::int64_t nanoseconds) {
  struct Step {
    std::int64_t nanoseconds;
    std::string_view symbol;
  };
  constexpr Step kSteps[] = {{1'000'000'000, "s"}, {1'000'000, "ms"}, {1'000, "us"}, {1, "ns"}};
  for (const Step& step : kSteps) {
    if (nanoseconds % step.nanoseconds == 0) {
      return fmt::format("{} {}", nanoseconds / step.nanoseconds, step.symbol);
    }
  }
  return fmt::format("{} ns", nanoseconds);
}

}  // namespace rigwire::hil
