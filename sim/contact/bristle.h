// Dry friction that can stand still: an elasto-plastic bristle, solved implicitly, clamped last.
//
//     z' = u - |V| z / sigma,    F = -(k z + c z'),    |F| <= limit
//
// u is the sliding velocity of the body's surface against its support, z the bristle's deflection,
// V the speed at which new bristles enter the contact (a rolling tyre; 0 elsewhere), sigma the
// relaxation length. At steady rolling F = -k sigma u / |V|: a slip law with slip stiffness k
// sigma. At V = 0 it is a spring with damping, so that a body on a slope stops and stays.
//
// With the backward Euler rule the force at the end of a step of h seconds is linear in the sliding
// velocity u there:  F = offset - gain u,
//
//     b = 1 + h |V| / sigma,   A = (k - c |V| / sigma) / b,   offset = -A z,   gain = A h + c.
//
// The caller puts `gain` on the left-hand side of its velocity solve and `offset` on the right, and
// only then compares |F| with the limit; where it is exceeded, F is set to the limit, the solve is
// repeated without the gain, and the bristle yields (z = -F / k). Testing before solving hums for
// ever at low speed.
#pragma once

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

/// F = offset - gain u.
struct ImplicitForce {
  double offset = 0.0;
  double gain = 0.0;

  [[nodiscard]] double at(double u) const { return offset - gain * u; }
};

struct BristleParameters {
  double stiffness = 0.0;          ///< k: N/m, or N m/rad.
  double damping = 0.0;            ///< c: N s/m, or N m s/rad.
  double relaxation_length = 0.0;  ///< sigma, m; only used where V is not 0.
};

/// The same in continuous time: z' = u - renewal z, F = -(stiffness z + damping u).
struct BristleLaw {
  double stiffness = 0.0;
  double damping = 0.0;
  double renewal = 0.0;  ///< |V| / sigma, 1/s.
};

/// Preconditions and reduced damping as Bristle::force().
[[nodiscard]] inline BristleLaw bristle_law(const BristleParameters& parameters,
                                            double rolling_speed) {
  const double renewal =
      rolling_speed == 0.0 ? 0.0 : std::abs(rolling_speed) / parameters.relaxation_length;
  const double damping = renewal == 0.0
                             ? parameters.damping
                             : std::min(parameters.damping, parameters.stiffness / renewal);
  return {parameters.stiffness - damping * renewal, damping, renewal};
}

class Bristle {
 public:
  /// Precondition: h > 0, parameters.stiffness > 0; relaxation_length > 0 where rolling_speed != 0.
  /// The damping is reduced where c |V| / sigma would exceed k, so that A stays positive.
  [[nodiscard]] ImplicitForce force(const BristleParameters& parameters, double h,
                                    double rolling_speed) const {
    const BristleLaw law = bristle_law(parameters, rolling_speed);
    const double share = law.stiffness / (1.0 + h * law.renewal);
    return {-share * deflection_, share * h + law.damping};
  }

  /// Ends the step with the sliding velocity found. Not clamped.
  void slide(const BristleParameters& parameters, double h, double rolling_speed, double u) {
    const double renewal =
        rolling_speed == 0.0 ? 0.0 : std::abs(rolling_speed) / parameters.relaxation_length;
    deflection_ = (deflection_ + h * u) / (1.0 + h * renewal);
  }

  /// Ends the step with the force at its limit.
  void yield(const BristleParameters& parameters, double force) {
    deflection_ = -force / parameters.stiffness;
  }

  void reset() { deflection_ = 0.0; }
  void set_deflection(double deflection) { deflection_ = deflection; }
  [[nodiscard]] double deflection() const { return deflection_; }

 private:
  double deflection_ = 0.0;
};

}  // namespace rigwire::sim
