#include "hil/devices/valve_driver.h"

#include <stdexcept>

#include "hil/configuration/problems.h"
#include "hil/files/valve_map_file.h"

namespace rigwire::hil {

emulators::ValveDriverSettings driver_settings(const ValveDriverConfiguration& configuration) {
  emulators::ValveDriverSettings settings = configuration.driver;
  if (!configuration.map.empty()) {
    settings.map = load_valve_map(configuration.map);
  }
  return settings;
}

void validate(const ValveDriverConfiguration& p) {
  try {
    validate(driver_settings(p));
  } catch (const ConfigurationError& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace rigwire::hil
