// The receivers that every scripted driver talks to.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "emulators/ublox/profile.h"
#include "emulators/ublox/receiver.h"

namespace rigwire::emulators::conversation {

struct ReceiverType {
  std::string name;  ///< For test names.
  int generation = 7;
  std::size_t pvt_bytes = 84;
  UbloxSettings settings;
};

[[nodiscard]] inline ReceiverType receiver_type(std::string name, const UbloxProfile& profile) {
  UbloxSettings settings;
  settings.profile = &profile;
  settings.baud = profile.baud;
  return {std::move(name), profile.generation, profile.generation < 8 ? 84U : 92U, settings};
}

[[nodiscard]] inline std::vector<ReceiverType> receiver_types() {
  return {receiver_type("NEO7P", ublox_neo_7p()), receiver_type("NEOM8N", ublox_neo_m8()),
          receiver_type("NEOM8T", ublox_neo_m8t()), receiver_type("ZEDF9P", ublox_zed_f9p())};
}

[[nodiscard]] inline std::string name_of(const ReceiverType& type) {
  return type.name;
}

/// For test names.
inline void PrintTo(const ReceiverType& type, std::ostream* out) {
  *out << type.name;
}

}  // namespace rigwire::emulators::conversation
