// The receivers that every scripted driver talks to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "emulators/ublox/receiver.h"

namespace rigwire::emulators::conversation {

struct ReceiverType {
  std::string name;
  int generation = 7;
  std::size_t pvt_bytes = 84;
  UbloxSettings settings;
};

[[nodiscard]] inline std::vector<ReceiverType> receiver_types() {
  return {{"NEO7P", 7, 84, {}}};
}

[[nodiscard]] inline std::string name_of(const ReceiverType& type) {
  return type.name;
}

}  // namespace rigwire::emulators::conversation
