// Checks of the valve driver's settings.
#include <stdexcept>
#include <string>

#include "emulators/valve_driver/valve_driver.h"

namespace rigwire::emulators {

using namespace std::chrono_literals;

void validate(const ValveDriverSettings& settings) {
  validate(settings.amplifier);
  if (settings.sample_period < 1ms || settings.sample_period > 1s) {
    throw std::invalid_argument("valve driver sample_period: found " +
                                std::to_string(to_seconds(settings.sample_period) * 1e3) +
                                " ms, allowed 1 .. 1000 ms");
  }
  if (settings.map) {
    validate(*settings.map);
    return;
  }
  const Duration watchdog = settings.amplifier.parameters.watchdog;
  const bool fits = watchdog >= 20ms && watchdog <= 5s && watchdog % 1ms == 0ns;
  if (watchdog != 0ns && !fits) {
    throw std::invalid_argument("valve driver watchdog: found " +
                                std::to_string(to_seconds(watchdog) * 1e3) +
                                " ms, allowed 0 or 20 .. 5000 ms, whole milliseconds");
  }
}

}  // namespace rigwire::emulators
