#include "fields/rules.h"

namespace rigwire::fields {

namespace {

template <class Print>
std::string range(std::int64_t lower, std::int64_t upper, Print print) {
  const bool has_lower = lower != std::numeric_limits<std::int64_t>::min();
  const bool has_upper = upper != std::numeric_limits<std::int64_t>::max();
  if (has_lower && has_upper) {
    return print(lower) + " .. " + print(upper);
  }
  if (has_lower) {
    return ">= " + print(lower);
  }
  return has_upper ? "<= " + print(upper) : std::string();
}

}  // namespace

std::string IntegerRule::range_text() const {
  const std::string numbers =
      range(lower, upper, [](std::int64_t value) { return std::to_string(value); });
  return unit == nullptr || numbers.empty() ? numbers : numbers + " " + std::string(unit->symbol);
}

std::string DurationRule::range_text() const {
  return range(lower_ns, upper_ns, print_duration);
}

std::string print_duration(std::int64_t nanoseconds) {
  struct Step {
    std::int64_t nanoseconds;
    std::string_view symbol;
  };
  constexpr Step kSteps[] = {{1'000'000'000, "s"}, {1'000'000, "ms"}, {1'000, "us"}, {1, "ns"}};
  for (const Step& step : kSteps) {
    if (nanoseconds % step.nanoseconds == 0) {
      return std::to_string(nanoseconds / step.nanoseconds) + " " + std::string(step.symbol);
    }
  }
  return std::to_string(nanoseconds) + " ns";
}

}  // namespace rigwire::fields
