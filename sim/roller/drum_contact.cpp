#include "sim/roller/drum_contact.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

namespace {

// Of a bristle deflected by one metre.
ImplicitForce unit_law(const BristleParameters& parameters, double h, double rolling_mps) {
  Bristle unit;
  unit.yield(parameters, -parameters.stiffness);
  return unit.force(parameters, h, rolling_mps);
}

/// z' = u - |V| z / sigma and F = -(k z + c z') as F = -(stiffness z + damping u) (bristle.h).
DrumTangent::Law law(const BristleParameters& parameters, double rolling_mps) {
  const double renewal = rolling_mps / parameters.relaxation_length;
  const double damping = renewal == 0.0
                             ? parameters.damping
                             : std::min(parameters.damping, parameters.stiffness / renewal);
  return {parameters.stiffness - damping * renewal, damping, renewal};
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
  for (std::size_t i = 0; i < count_; ++i) {
    Strip& strip = strips_[i];
    const double along = slide_along(velocity, i);
    if (strip.sliding) {
      strip.along.yield(along_parameters_, strip.force_along_n);
      strip.across.yield(across_parameters_, strip.force_across_n);
    } else {
      strip.force_along_n = strip.law_along.at(along);
      strip.force_across_n = strip.law_across.at(across);
      strip.along.slide(along_parameters_, h_, rolling_mps_, along);
      strip.across.slide(across_parameters_, h_, rolling_mps_, across);
    }
  }
  sum_up(velocity);
}

void DrumContact::sum_up(const Eigen::Vector4d& velocity) {
  const double across = slide_across(velocity);
  along_n_ = 0.0;
  across_n_ = 0.0;
  pivot_moment_nm_ = 0.0;
  loss_w_ = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Strip& strip = strips_[i];
    const double along = slide_along(velocity, i);
    along_n_ += strip.force_along_n;
    across_n_ += strip.force_across_n;
    // Scrub about the pivot, and the power that the sliding strips lose.
    pivot_moment_nm_ -= strip.force_along_n * y_m_[i];
    loss_w_ -= strip.force_along_n * along + strip.force_across_n * across;
  }
  generalised_ = along_n_ * along_row_ + across_n_ * across_row_;
  generalised_[2] += pivot_moment_nm_;
}

void DrumContact::preload(double along_n, double across_n) {
  const double share = 1.0 / static_cast<double>(count_);
  for (std::size_t i = 0; i < count_; ++i) {
    strips_[i].along.yield(along_parameters_, along_n * share);
    strips_[i].across.yield(across_parameters_, across_n * share);
  }
  along_n_ = along_n;
  across_n_ = across_n;
  generalised_ << along_n, across_n, 0.0, -parameters_.radius_m * along_n;
}

int DrumContact::sliding_strips() const {
  int sum = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    sum += strips_[i].sliding ? 1 : 0;
  }
  return sum;
}

// The drum's contact in continuous time (drum_contact.h).

DrumBristles DrumContact::bristles() const {
  DrumBristles result;
  for (std::size_t i = 0; i < count_; ++i) {
    result.along[i] = strips_[i].along.deflection();
    result.across[i] = strips_[i].across.deflection();
  }
  return result;
}

DrumTangent DrumContact::tangent(const DrumSituation& situation, const DrumInstant& at) const {
  const double rolling = std::abs(parameters_.radius_m * at.velocity[3]);
  const double c = std::cos(at.steer_rad);
  const double s = std::sin(at.steer_rad);
  return {law(along_parameters_, rolling),
          law(across_parameters_, rolling),
          {c, s, situation.x_m * s, -parameters_.radius_m},
          {-s, c, situation.x_m * c, 0.0}};
}

bool DrumContact::rates(const DrumSituation& situation, const DrumInstant& at,
                        const DrumBristles& bristles, double slowest_mps,
                        Eigen::Vector4d& generalised, DrumBristles& rate) const {
  const DrumTangent tangent = this->tangent(situation, at);
  const double along_0 = tangent.along_row.dot(at.velocity);
  const double across = tangent.across_row.dot(at.velocity);
  // Slide along of a strip at y: s(0) - (r + d') y (drum_contact.h).
  const double turn = at.velocity[2] + at.steer_rate_radps;
  const bool alike = along_parameters_.stiffness == across_parameters_.stiffness;
  double sum_along = 0.0;
  double sum_across = 0.0;
  double moment = 0.0;
  bool fine = true;
  for (std::size_t i = 0; i < count_; ++i) {
    const double along = along_0 - turn * y_m_[i];
    const double limit_n = situation.limit_n[i];
    double force_along = 0.0;
    double force_across = 0.0;
    if (strips_[i].sliding) {
      const double size = std::sqrt(along * along + across * across);
      // Goes on sliding as long as its bristle would grow: |u| > renewal limit / stiffness.
      fine = fine && alike && size > slowest_mps &&
             size * along_parameters_.stiffness > tangent.along.renewal * limit_n;
      const double scale = size > 0.0 ? -limit_n / size : 0.0;
      force_along = scale * along;
      force_across = scale * across;
      rate.along[i] = 0.0;
      rate.across[i] = 0.0;
    } else {
      force_along = -(tangent.along.stiffness * bristles.along[i] + tangent.along.damping * along);
      force_across =
          -(tangent.across.stiffness * bristles.across[i] + tangent.across.damping * across);
      fine = fine && force_along * force_along + force_across * force_across <= limit_n * limit_n;
      rate.along[i] = along - tangent.along.renewal * bristles.along[i];
      rate.across[i] = across - tangent.across.renewal * bristles.across[i];
    }
    sum_along += force_along;
    sum_across += force_across;
    moment -= force_along * y_m_[i];
  }
  generalised = sum_along * tangent.along_row + sum_across * tangent.across_row;
  generalised[2] += moment;
  return fine;
}

DrumForces DrumContact::stage(const DrumTangent& tangent, double ahead_s,
                              const DrumBristles& right) const {
  // Bristle eliminated, a ahead: gain = k a / (1 + a renewal) + c, offset = -k z / (1 + a renewal).
  const double share_along = tangent.along.stiffness / (1.0 + ahead_s * tangent.along.renewal);
  const double share_across = tangent.across.stiffness / (1.0 + ahead_s * tangent.across.renewal);
  const double gain_along = share_along * ahead_s + tangent.along.damping;
  const double gain_across = share_across * ahead_s + tangent.across.damping;
  double holding = 0.0;
  double sum_y = 0.0;
  double sum_yy = 0.0;
  double along = 0.0;
  double along_y = 0.0;
  double across = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (strips_[i].sliding) {
      continue;
    }
    holding += 1.0;
    sum_y += y_m_[i];
    sum_yy += y_m_[i] * y_m_[i];
    along += right.along[i];
    along_y += right.along[i] * y_m_[i];
    across += right.across[i];
  }
  DrumForces sum;
  sum.gain.noalias() =
      (holding * gain_along * tangent.along_row) * tangent.along_row.transpose() +
      (holding * gain_across * tangent.across_row) * tangent.across_row.transpose();
  sum.gain.row(2) -= gain_along * sum_y * tangent.along_row.transpose();
  sum.gain.col(2) -= gain_along * sum_y * tangent.along_row;
  sum.gain(2, 2) += gain_along * sum_yy;
  sum.offset =
      -share_along * along * tangent.along_row - share_across * across * tangent.across_row;
  sum.offset[2] += share_along * along_y;
  return sum;
}

DrumBristles DrumContact::stage_bristles(const DrumTangent& tangent, double ahead_s,
                                         const DrumBristles& right,
                                         const Eigen::Vector4d& velocity) const {
  const double along_0 = tangent.along_row.dot(velocity);
  const double across = tangent.across_row.dot(velocity);
  // z = (right + a u) / (1 + a renewal)
  const double scale_along = 1.0 / (1.0 + ahead_s * tangent.along.renewal);
  const double scale_across = 1.0 / (1.0 + ahead_s * tangent.across.renewal);
  DrumBristles result;
  for (std::size_t i = 0; i < count_; ++i) {
    if (!strips_[i].sliding) {
      const double along = along_0 - velocity[2] * y_m_[i];
      result.along[i] = scale_along * (right.along[i] + ahead_s * along);
      result.across[i] = scale_across * (right.across[i] + ahead_s * across);
    }
  }
  return result;
}

void DrumContact::adopt(const DrumSituation& situation, const DrumInstant& at,
                        const DrumBristles& bristles) {
  const DrumTangent tangent = this->tangent(situation, at);
  situation_ = situation;
  situation_.steer_rad = at.steer_rad;
  situation_.steer_rate_radps = at.steer_rate_radps;
  along_row_ = tangent.along_row;
  across_row_ = tangent.across_row;
  const double across = slide_across(at.velocity);
  for (std::size_t i = 0; i < count_; ++i) {
    Strip& strip = strips_[i];
    const double along = slide_along(at.velocity, i);
    if (strip.sliding) {
      const double size = std::sqrt(along * along + across * across);
      const double scale = size > 0.0 ? -situation.limit_n[i] / size : 0.0;
      strip.force_along_n = scale * along;
      strip.force_across_n = scale * across;
      strip.along.yield(along_parameters_, strip.force_along_n);
      strip.across.yield(across_parameters_, strip.force_across_n);
    } else {
      strip.force_along_n =
          -(tangent.along.stiffness * bristles.along[i] + tangent.along.damping * along);
      strip.force_across_n =
          -(tangent.across.stiffness * bristles.across[i] + tangent.across.damping * across);
      strip.along.yield(along_parameters_, -along_parameters_.stiffness * bristles.along[i]);
      strip.across.yield(across_parameters_, -across_parameters_.stiffness * bristles.across[i]);
    }
  }
  sum_up(at.velocity);
}

}  // namespace rigwire::sim
