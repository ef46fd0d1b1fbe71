#include "dig_cycle/estimator.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rigwire::dig_cycle {
namespace {

/// Slower than this is standing, whatever the rate's offset.
constexpr double kStill_radps = 0.03;
/// Faster than this the swing's centripetal acceleration (7 degrees at 0.5 rad/s and 5 m) spoils
/// the vertical; a swing is short enough for the rates alone.
constexpr double kSwinging_radps = 0.1;

constexpr double kGravity_mps2 = 9.80665;

}  // namespace

Inclination::Inclination(const InclinationSettings& settings) : settings_(settings) {}

// In the first rest the offset is the mean rate. Later the angle against gravity shows it, so that
// a link that creeps is not taken for one with an offset.
void Inclination::rate(double pitch_rate_radps, bool quiet, double step_s) {
  if (quiet && first_rest_s_ < settings_.first_rest_s) {
    first_rest_s_ += step_s;
    learn((pitch_rate_radps - offset_radps_) * step_s / first_rest_s_);
  }
  pitch_rate_radps_ = pitch_rate_radps - offset_radps_;
  if (ready_) {
    pitch_rad_ = wrapped(pitch_rad_ + pitch_rate_radps_ * step_s);
  }
}

void Inclination::specific_force(double along_mps2, double up_mps2, bool quiet, double step_s) {
  const double size_mps2 = std::hypot(along_mps2, up_mps2);
  if (!(std::abs(size_mps2 - kGravity_mps2) <= settings_.largest_gravity_deviation_mps2)) {
    return;
  }
  const double apparent_rad = std::atan2(along_mps2, up_mps2);
  if (!ready_) {
    pitch_rad_ = apparent_rad;
    ready_ = true;
    return;
  }
  const double error_rad = wrapped(apparent_rad - pitch_rad_);
  if (!quiet) {
    waiting_ = 0;
    pitch_rad_ =
        wrapped(pitch_rad_ + error_rad * std::min(1.0, step_s / settings_.moving_time_constant_s));
    return;
  }
  // A link that starts to move accelerates before it has a rate: at rest an error counts only when
  // the link is still at rest kStillSamples later.
  const double settled_rad = std::exchange(errors_rad_[next_], error_rad);
  next_ = (next_ + 1) % errors_rad_.size();
  if (waiting_ < errors_rad_.size()) {
    ++waiting_;
    return;
  }
  const double share = std::min(1.0, step_s / settings_.quiet_time_constant_s);
  pitch_rad_ = wrapped(pitch_rad_ + settled_rad * share);
  learn(-settled_rad * share / settings_.offset_time_constant_s);
}

void Inclination::learn(double change_radps) {
  offset_radps_ = std::clamp(offset_radps_ + change_radps, -settings_.largest_offset_radps,
                             settings_.largest_offset_radps);
}

Estimator::Estimator(double imu_period_s, const InclinationSettings& settings)
    : imu_period_s_(imu_period_s),
      links_{Inclination(settings), Inclination(settings), Inclination(settings),
             Inclination(settings)} {}

void Estimator::imu_rate(Link link, double pitch_rate_radps) {
  const bool still = std::abs(pitch_rate_radps - links_[link].rate_offset_radps()) < kStill_radps;
  still_samples_[link] =
      still ? std::min(still_samples_[link] + 1, static_cast<int>(kStillSamples)) : 0;
  links_[link].rate(pitch_rate_radps, quiet(), imu_period_s_);
}

void Estimator::imu_specific_force(Link link, double along_mps2, double up_mps2) {
  if (links_[link].ready() && std::abs(swing_rate_radps_) > kSwinging_radps) {
    return;
  }
  links_[link].specific_force(along_mps2, up_mps2, quiet(), imu_period_s_);
}

void Estimator::swing(double angle_rad, double rate_radps) {
  swing_rad_ = angle_rad;
  swing_rate_radps_ = rate_radps;
  swing_known_ = true;
}

bool Estimator::quiet() const {
  return std::abs(swing_rate_radps_) < kStill_radps &&
         std::all_of(still_samples_.begin(), still_samples_.end(),
                     [](int samples) { return samples >= static_cast<int>(kStillSamples); });
}

Belief Estimator::belief() const {
  Belief belief;
  belief.ready = swing_known_ && std::all_of(links_.begin(), links_.end(),
                                             [](const Inclination& link) { return link.ready(); });
  belief.rested = std::all_of(links_.begin(), links_.end(),
                              [](const Inclination& link) { return link.rested(); });
  belief.chassis_pitch_rad = links_[chassis_link].pitch_rad();
  belief.angles_rad[dig_cycle::swing] = swing_rad_;
  belief.rates_radps[dig_cycle::swing] = swing_rate_radps_;
  const std::array<std::pair<Joint, Link>, 3> chain{
      {{boom, boom_link}, {stick, stick_link}, {bucket, bucket_link}}};
  for (const auto& [joint, link] : chain) {
    const Inclination& outer = links_[link];
    const Inclination& inner = links_[link - 1];
    belief.angles_rad[joint] = wrapped(outer.pitch_rad() - inner.pitch_rad());
    belief.rates_radps[joint] = outer.pitch_rate_radps() - inner.pitch_rate_radps();
  }
  return belief;
}

}  // namespace rigwire::dig_cycle
