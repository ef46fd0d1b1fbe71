// The drum's contact in continuous time (drum_contact.h).
#include <algorithm>
#include <cmath>

#include "sim/roller/drum_contact.h"

namespace rigwire::sim {
namespace {

/// z' = u - |V| z / sigma and F = -(k z + c z') as F = -(stiffness z + damping u) (bristle.h).
DrumTangent::Law law(const BristleParameters& parameters, double rolling_mps) {
  const double renewal = rolling_mps / parameters.relaxation_length;
  const double damping = renewal == 0.0
                             ? parameters.damping
                             : std::min(parameters.damping, parameters.stiffness / renewal);
  return {parameters.stiffness - damping * renewal, damping, renewal};
}

}  // namespace

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
