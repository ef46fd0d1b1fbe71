#include "protocols/vehicle/engine.h"

#include <cmath>

namespace rigwire::protocols::vehicle {

bool is_complete(const Tsc1& request) {
  const bool speed = std::isfinite(request.speed_radps);
  const bool torque = std::isfinite(request.torque_share);
  switch (static_cast<OverrideMode>(request.override_mode)) {
    case OverrideMode::speed:
      return speed;
    case OverrideMode::torque:
      return torque;
    case OverrideMode::limit:
      return speed || torque;
    case OverrideMode::disabled:
      break;
  }
  return true;
}

std::uint8_t torque_speed_checksum(const can::Frame& frame) {
  // The sum, folded to three bits.
  unsigned sum = frame.data[7] & 0xFU;
  for (std::size_t i = 0; i < 7; ++i) {
    sum += frame.data[i];
  }
  for (unsigned shift = 0; shift < 32; shift += 8) {
    sum += (frame.id >> shift) & 0xFFU;
  }
  return static_cast<std::uint8_t>((((sum >> 6U) & 3U) + (sum >> 3U) + sum) & 7U);
}

}  // namespace rigwire::protocols::vehicle
