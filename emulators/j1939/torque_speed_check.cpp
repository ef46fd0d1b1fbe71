#include "emulators/j1939/torque_speed_check.h"

#include <utility>

namespace rigwire::emulators {

bool TorqueSpeedCheck::passes(const protocols::can::Frame& frame,
                              const protocols::vehicle::Tsc1& request, std::uint8_t source) {
  constexpr std::uint8_t kNotUsed = 0xF;
  constexpr std::uint8_t kGreatestCounter = 7;
  if (request.counter == kNotUsed && request.checksum == kNotUsed) {
    counters_[source] = kNone;
    return !required_;
  }
  const std::uint8_t last = std::exchange(counters_[source], request.counter);
  return request.counter != last && request.counter <= kGreatestCounter &&
         request.checksum == protocols::vehicle::torque_speed_checksum(frame);
}

}  // namespace rigwire::emulators
