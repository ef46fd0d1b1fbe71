#include "sim/roller/drum_contact.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

namespace {

// Returns the law of a bristle deflected by one metre.
ImplicitForce unit_law(const BristleParameters& parameters, double h, double rolling_mps) {
  Bristle unit;
  unit.yield(parameters, -parameters.stiffness);
  return unit.force(parameters, h, rolling_mps);
}

}  // namespace

DrumContact::DrumContact(const DrumParameters& parameters, double carried_mass_kg)
    : parameters_(parameters), count_(static_cast<std::size_t>(parameters.strips)) {
  const double share = 1.0 / static_cast<double>(parameters.strips);
  const auto bristle = [&](double slip_stiffness_n) {
    // k = slip stiffness / relaxation length, c = 2 zeta sqrt(k m), each strip its share.
    const double stiffness = slip_stiffness_n / parameters.relaxation_length_m * share;
    return BristleParameters{
        stiffness, 2.0 * parameters.damping_ratio * std::sqrt(stiffness * carried_mass_kg * share),
        parameters.relaxation_length_m};
  };
  along_parameters_ = bristle(parameters.slip_stiffness_n);
  across_parameters_ = bristle(parameters.cornering_stiffness_nprad);
  for (std::size_t i = 0; i < count_; ++i) {
    y_m_[i] = ((static_cast<double>(i) + 0.5) * share - 0.5) * parameters.width_m;
  }
}

double DrumContact::slide_along(const Eigen::Vector4d& velocity, std::size_t strip) const {
  return along_row_.dot(velocity) - (velocity[2] + situation_.steer_rate_radps) * y_m_[strip];
}

double DrumContact::slide_across(const Eigen::Vector4d& velocity) const {
  return across_row_.dot(velocity);
}

void DrumContact::limit(Strip& strip, double limit_n) {
  // Friction circle: the trial force scaled to the limit, its direction kept.
  const double size = std::sqrt(strip.trial_along_n * strip.trial_along_n +
                                strip.trial_across_n * strip.trial_across_n);
  const double scale = size > 0.0 ? limit_n / size : 0.0;
  strip.force_along_n = scale * strip.trial_along_n;
  strip.force_across_n = scale * strip.trial_across_n;
}

void DrumContact::begin(double h, const DrumSituation& situation, const Eigen::Vector4d& before) {
  h_ = h;
  situation_ = situation;
  rolling_mps_ = std::abs(parameters_.radius_m * situation.spin_radps);
  const double c = std::cos(situation.steer_rad);
  const double s = std::sin(situation.steer_rad);
  // Rows of s and t (drum_contact.h) at y = 0.
  along_row_ << c, s, situation.x_m * s, -parameters_.radius_m;
  across_row_ << -s, c, situation.x_m * c, 0.0;
  const double across = slide_across(before);
  // A law's gain is the same for all strips, its offset in proportion to the deflection.
  const ImplicitForce unit_along = unit_law(along_parameters_, h, rolling_mps_);
  const ImplicitForce unit_across = unit_law(across_parameters_, h, rolling_mps_);
  for (std::size_t i = 0; i < count_; ++i) {
    Strip& strip = strips_[i];
    strip.law_along = {unit_along.offset * strip.along.deflection(), unit_along.gain};
    strip.law_across = {unit_across.offset * strip.across.deflection(), unit_across.gain};
    strip.trial_along_n = strip.law_along.at(slide_along(before, i));
    strip.trial_across_n = strip.law_across.at(across);
    const double limit_n = situation.limit_n[i];
    strip.sliding =
        strip.trial_along_n * strip.trial_along_n + strip.trial_across_n * strip.trial_across_n >
        limit_n * limit_n;
    if (strip.sliding) {
      limit(strip, limit_n);
    }
  }
}

DrumForces DrumContact::forces() const {
  double gain = 0.0;
  double gain_y = 0.0;
  double gain_yy = 0.0;
  double offset = 0.0;
  double offset_y = 0.0;
  double gain_across = 0.0;
  double offset_across = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Strip& strip = strips_[i];
    const double y = y_m_[i];
    if (strip.sliding) {
      offset += strip.force_along_n;
      offset_y += strip.force_along_n * y;
      offset_across += strip.force_across_n;
      continue;
    }
    const double g = strip.law_along.gain;
    // Strip at y: row less y in the yaw rate, and y d' of the pivot's own turning to the offset.
    const double o = strip.law_along.offset + g * situation_.steer_rate_radps * y;
    gain += g;
    gain_y += g * y;
    gain_yy += g * y * y;
    offset += o;
    offset_y += o * y;
    gain_across += strip.law_across.gain;
    offset_across += strip.law_across.offset;
  }
  // sum g (J - y e_r)(J - y e_r)^T by the moments of g over y.
  DrumForces sum;
  sum.gain.noalias() = (gain * along_row_) * along_row_.transpose() +
                       (gain_across * across_row_) * across_row_.transpose();
  sum.gain.row(2) -= gain_y * along_row_.transpose();
  sum.gain.col(2) -= gain_y * along_row_;
  sum.gain(2, 2) += gain_yy;
  sum.offset = offset * along_row_ + offset_across * across_row_;
  sum.offset[2] -= offset_y;
  return sum;
}

bool DrumContact::test(const Eigen::Vector4d& velocity) {
  const double across = slide_across(velocity);
  std::array<bool, kDrumStripsMax> slides{};
  bool changed = false;
  for (std::size_t i = 0; i < count_; ++i) {
    Strip& strip = strips_[i];
    strip.trial_along_n = strip.law_along.at(slide_along(velocity, i));
    strip.trial_across_n = strip.law_across.at(across);
    const double limit_n = situation_.limit_n[i];
    slides[i] =
        strip.trial_along_n * strip.trial_along_n + strip.trial_across_n * strip.trial_across_n >
        limit_n * limit_n;
    // A strip that would slide the other way is tried as holding first: no jump across.
    if (strip.sliding && slides[i] &&
        strip.trial_along_n * strip.force_along_n + strip.trial_across_n * strip.force_across_n <
            0.0) {
      slides[i] = false;
    }
    changed = changed || slides[i] != strip.sliding;
  }
  if (changed) {
    for (std::size_t i = 0; i < count_; ++i) {
      strips_[i].sliding = slides[i];
      if (slides[i]) {
        limit(strips_[i], situation_.limit_n[i]);
      }
    }
  }
  return changed;
}

void DrumContact::settle(const Eigen::Vector4d& velocity) {
  const double across = slide_across(velocity);
  along_n_ = 0.0;
  across_n_ = 0.0;
  pivot_moment_nm_ = 0.0;
  loss_w_ = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    Strip& strip = strips_[i];
    const double along = slide_along(velocity, i);
    strip.along.slide(along_parameters_, h_, rolling_mps_, along);
    strip.across.slide(across_parameters_, h_, rolling_mps_, across);
    if (strip.sliding) {
      yield_as_bent(strip.along, along_parameters_, strip.across, across_parameters_,
                    std::hypot(strip.force_along_n, strip.force_across_n));
    } else {
      strip.force_along_n = strip.law_along.at(along);
      strip.force_across_n = strip.law_across.at(across);
    }
    along_n_ += strip.force_along_n;
    across_n_ += strip.force_across_n;
    // Scrub about the pivot, and the power that the sliding strips lose.
    pivot_moment_nm_ -= strip.force_along_n * y_m_[i];
    loss_w_ -= strip.force_along_n * along + strip.force_across_n * across;
  }
  generalised_ = along_n_ * along_row_ + across_n_ * across_row_;
  generalised_[2] += pivot_moment_nm_;
}

void DrumContact::preload(double along_n, double across_n,
                          const std::array<double, kDrumStripsMax>& limit_n) {
  double sum = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    sum += limit_n[i];
  }
  for (std::size_t i = 0; i < count_; ++i) {
    const double share = sum > 0.0 ? limit_n[i] / sum : 1.0 / static_cast<double>(count_);
    strips_[i].along.yield(along_parameters_, along_n * share);
    strips_[i].across.yield(across_parameters_, across_n * share);
  }
  along_n_ = along_n;
  across_n_ = across_n;
  generalised_ << along_n, across_n, 0.0, -parameters_.radius_m * along_n;
}

void DrumContact::leave_ground() {
  strips_ = {};
  along_n_ = across_n_ = pivot_moment_nm_ = loss_w_ = 0.0;
  generalised_.setZero();
}

int DrumContact::sliding_strips() const {
  int sum = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    sum += strips_[i].sliding ? 1 : 0;
  }
  return sum;
}

}  // namespace rigwire::sim
