#include "emulators/modbus/response_delay.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace rigwire::emulators {
namespace {

void check(const char* setting, Duration value, Duration lower, Duration upper) {
  if (value < lower || value > upper) {
    const auto text = [](Duration span) { return std::to_string(to_seconds(span)); };
    throw std::invalid_argument(std::string("modbus response delay, ") + setting + ": found " +
                                text(value) + " s, allowed " + text(lower) + " .. " + text(upper) +
                                " s");
  }
}

}  // namespace

void validate(const ResponseDelaySettings& settings) {
  constexpr Duration kLongest = std::chrono::seconds(10);
  check("typical", settings.typical, Duration{0}, kLongest);
  check("sigma", settings.sigma, Duration{0}, kLongest);
  check("maximum", settings.maximum, Duration{0}, kLongest);
  check("minimum", settings.minimum, Duration{0}, settings.maximum);
}

ResponseDelay::ResponseDelay(const ResponseDelaySettings& settings, std::uint64_t seed)
    : settings_(settings), random_(seed) {
  validate(settings);
}

Duration ResponseDelay::draw() {
  switch (settings_.distribution) {
    case DelayDistribution::constant:
      return settings_.typical;
    case DelayDistribution::uniform:
      return settings_.minimum +
             from_seconds(to_seconds(settings_.maximum - settings_.minimum) * random_.uniform());
    case DelayDistribution::normal:
      break;
  }
  return std::clamp(
      settings_.typical + from_seconds(to_seconds(settings_.sigma) * random_.normal()),
      settings_.minimum, settings_.maximum);
}

}  // namespace rigwire::emulators
