#include "hil/configuration/build_facts.h"

namespace rigwire::hil {

std::string version() {
  return RIGWIRE_VERSION;
}

std::string source_configs() {
  return RIGWIRE_CONFIG_DIR;
}

std::string source_page() {
  return RIGWIRE_DASHBOARD_DIR;
}

}  // namespace rigwire::hil
