#include "emulators/ublox/signal_security.h"

#include <algorithm>
#include <cmath>

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

constexpr Duration kCoolOff = 10s;
constexpr std::size_t kLeastSatellites = 6;
// Thresholds of the signal strengths, dB: max standard deviation among false signals, min standard
// deviation among real ones, and min rise of the mean.
constexpr double kEven_db = 0.8;
constexpr double kUneven_db = 2.0;
constexpr double kRise_db = 1.5;
/// Share of the radio that is taken by what is no signal.
constexpr double kSensitive = 0.2;
constexpr double kInsensitive = 0.5;

struct Strength {
  double mean_db = 0.0;
  double deviation_db = 0.0;
};

Strength strength_of(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  Strength strength;
  for (const double value : values) {
    strength.mean_db += value / count;
  }
  double square = 0.0;
  for (const double value : values) {
    square += (value - strength.mean_db) * (value - strength.mean_db) / count;
  }
  strength.deviation_db = std::sqrt(square);
  return strength;
}

/// From real signals to false ones.
bool taken_over(const Strength& before, const Strength& after) {
  return before.deviation_db >= kUneven_db && after.deviation_db <= kEven_db &&
         after.mean_db - before.mean_db >= kRise_db;
}

}  // namespace

void UbloxSignalSecurity::restart() {
  *this = {};
}

void UbloxSignalSecurity::note(Detection detection, EventKind kind) {
  if (log_.size() == kMostEvents) {
    log_.pop_front();
  }
  log_.push_back({now_, detection, kind});
}

std::uint8_t UbloxSignalSecurity::spoofing() const {
  return indicated_until_ != kNever ? 2 : has_fix_ ? 1 : 0;
}

void UbloxSignalSecurity::look(SimTime now, const std::vector<SatelliteView>& satellites,
                               const RadioState& radio, bool has_fix, bool sensitive) {
  now_ = now;
  // Signal strengths of satellites tracked now and at the epoch before.
  strengths_.clear();
  strengths_before_.clear();
  unsigned systems = 0;
  for (const SatelliteView& view : satellites) {
    const auto same = std::ranges::find_if(before_, [&](const SatelliteView& other) {
      return other.system == view.system && other.number == view.number;
    });
    if (view.tracked && same != before_.end()) {
      strengths_.push_back(view.cn0_dbhz);
      strengths_before_.push_back(same->cn0_dbhz);
      // Augmentation sends as GPS does.
      systems |= view.system == GnssSystem::sbas ? 0U : 1U << static_cast<unsigned>(view.system);
    }
  }
  before_.clear();
  std::ranges::copy_if(satellites, std::back_inserter(before_), &SatelliteView::tracked);

  spoofing_now_ = has_fix ? 1 : 0;
  if (strengths_.size() >= kLeastSatellites && has_fix_) {
    const Strength before = strength_of(strengths_before_);
    const Strength after = strength_of(strengths_);
    if (taken_over(before, after) || taken_over(after, before)) {
      spoofing_now_ = (systems & (systems - 1U)) != 0 ? 3 : 2;
      note(Detection::abrupt_change, EventKind::triggered);
      indicated_until_ = now + kCoolOff;
    }
  }
  if (indicated_until_ != kNever && now >= indicated_until_) {
    note(Detection::abrupt_change, EventKind::timed_out);
    indicated_until_ = kNever;
  }
  has_fix_ = has_fix;

  constexpr std::uint8_t kNoJamming = 1;
  constexpr std::uint8_t kJamming = 2;
  const double least = sensitive ? kSensitive : kInsensitive;
  first_jammed_ = radio.jamming >= least;
  second_jammed_ = radio.second_jamming >= least;
  const std::uint8_t jamming = first_jammed_ || second_jammed_ ? kJamming : kNoJamming;
  if (jamming == kJamming && jamming_ != kJamming) {
    note(Detection::jamming, EventKind::started);
  } else if (jamming != kJamming && jamming_ == kJamming) {
    note(Detection::jamming, EventKind::stopped);
  }
  jamming_ = jamming;
}

}  // namespace rigwire::emulators
