// What becomes of the supply when the key is switched off (ISO 11783-7, maintain power; ISO 11783-9
// as far as isobus.net tells it).
//
// The key goes off once, at key_off from the start of the run; 0: never. From then on power stays
// for kLeast, and for kLeast more after each request of an implement ("maintain power" that
// requires ECU or actuator power), but no longer than maximum_power_time in all. Then it is gone.
#pragma once

#include <algorithm>

#include "emulators/vehicle_gateway/settings.h"

namespace rigwire::emulators {

class TractorPower {
 public:
  static constexpr Duration kLeast = std::chrono::seconds{2};

  explicit TractorPower(const VehicleGatewaySettings& settings)
      : key_off_(settings.key_off == Duration{0} ? kNever : kStart + settings.key_off),
        longest_(settings.maximum_power_time),
        off_(key_off_ == kNever ? kNever : key_off_ + std::min(kLeast, longest_)) {}

  [[nodiscard]] bool key_on(SimTime now) const { return now < key_off_; }
  [[nodiscard]] bool supplied(SimTime now) const { return now < off_; }
  [[nodiscard]] SimTime key_off_at() const { return key_off_; }
  [[nodiscard]] SimTime off_at() const { return off_; }
  /// An implement asks for more time; without effect while the key is on.
  void maintain(SimTime now) {
    if (!key_on(now) && supplied(now)) {
      off_ = std::max(off_, std::min(now + kLeast, key_off_ + longest_));
    }
  }
  /// For how long power would last, or lasts, at most.
  [[nodiscard]] Duration longest(SimTime now) const {
    return key_on(now) ? longest_ : std::max(Duration{0}, key_off_ + longest_ - now);
  }

 private:
  SimTime key_off_;
  Duration longest_;
  SimTime off_;
};

}  // namespace rigwire::emulators
