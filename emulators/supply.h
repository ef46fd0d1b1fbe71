// A device's supply as a fault: cut at given instants, back after a given time.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "fields/rules.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct SupplySettings {
  Duration power_on{0};        ///< From the start of the run.
  std::vector<Duration> cuts;  ///< From the start of the run, rising, after power-on.
  Duration off = std::chrono::milliseconds{500};  ///< How long each cut lasts.
};

/// The keys of a device that can lose its supply, to be called within the device's visit().
void visit(fields::Visitor& v, SupplySettings& p);
/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const SupplySettings& settings);

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
