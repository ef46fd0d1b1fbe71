// A device's supply as a fault: cut at given instants, back after a given time.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/samples/time.h"

namespace rigwire::emulators {

struct SupplySettings {
  Duration power_on{0};        ///< From the start of the run.
  std::vector<Duration> cuts;  ///< From the start of the run, rising, after power-on.
  Duration off = std::chrono::milliseconds{500};  ///< How long each cut lasts.
};

/// Throws std::invalid_argument with the value found and what is allowed.
inline void validate(const SupplySettings& settings) {
  if (settings.power_on < Duration{0}) {
    throw std::invalid_argument("power_on is " + std::to_string(settings.power_on.count()) +
                                " ns, allowed is 0 or more");
  }
  if (settings.off <= Duration{0}) {
    throw std::invalid_argument("power_off is " + std::to_string(settings.off.count()) +
                                " ns, allowed is more than 0");
  }
  Duration free = settings.power_on;
  for (const Duration cut : settings.cuts) {
    if (cut <= free) {
      throw std::invalid_argument("power_cycles has " + std::to_string(cut.count()) +
                                  " ns, allowed is later than " + std::to_string(free.count()) +
                                  " ns, when the supply is back");
    }
    free = cut + settings.off;
  }
}

class Supply {
 public:
  explicit Supply(SupplySettings settings) : settings_(std::move(settings)) {
    next_ = kStart + settings_.power_on;
  }

  [[nodiscard]] bool on() const { return on_; }
  /// When it is switched next; kNever when no more.
  [[nodiscard]] SimTime next_change() const { return next_; }
  /// Switches. To be called at next_change().
  void change() {
    on_ = !on_;
    if (on_) {
      next_ = cut_ < settings_.cuts.size() ? kStart + settings_.cuts[cut_++] : kNever;
    } else {
      next_ += settings_.off;
    }
  }

 private:
  SupplySettings settings_;
  std::size_t cut_ = 0;  ///< The next one of settings_.cuts.
  SimTime next_ = kNever;
  bool on_ = false;
};

}  // namespace rigwire::emulators
