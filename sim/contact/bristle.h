// Dry friction with true sticking: an elasto-plastic bristle, solved implicitly, clamped last.
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
// only then compares |F| with the limit. If |F| exceeds it, F is set to the limit, the solve is
// repeated without the gain, and the bristle yields: it slides, and its deflection is at most limit
// / k. It is not set to z = -F / k: where the damper contributed to F, that would bend the bristle
// further than it has slid. Testing the limit before solving causes endless chatter at low speed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace rigwire::sim {

/// F = offset - gain u.
struct ImplicitForce {
  double offset = 0.0;
  double gain = 0.0;

  [[nodiscard]] double at(double u) const { return offset - gain * u; }
};

/// What a contact bears across its normal: Mohr-Coulomb, friction x normal force + cohesion.
struct ShearLimit {
  double friction = 0.0;
  double cohesion_n = 0.0;

  [[nodiscard]] double limit_n(double normal_n) const {
    return normal_n > 0.0 ? friction * normal_n + cohesion_n : 0.0;
  }
};

struct BristleParameters {
  double stiffness = 0.0;          ///< k: N/m, or N m/rad.
  double damping = 0.0;            ///< c: N s/m, or N m s/rad.
  double relaxation_length = 0.0;  ///< sigma, m; only used where V is not 0.
};

class Bristle {
 public:
  /// Precondition: h > 0, parameters.stiffness > 0; relaxation_length > 0 where rolling_speed != 0.
  /// The damping is reduced where c |V| / sigma would exceed k, so that A stays positive.
  [[nodiscard]] ImplicitForce force(const BristleParameters& parameters, double h,
                                    double rolling_speed) const {
    const double renewal = renewal_1ps(parameters, rolling_speed);
    const double damping = renewal == 0.0
                               ? parameters.damping
                               : std::min(parameters.damping, parameters.stiffness / renewal);
    const double share = (parameters.stiffness - damping * renewal) / (1.0 + h * renewal);
    return {-share * deflection_, share * h + damping};
  }

  /// Ends the step with the sliding velocity found. Not clamped.
  void slide(const BristleParameters& parameters, double h, double rolling_speed, double u) {
    deflection_ = (deflection_ + h * u) / (1.0 + h * renewal_1ps(parameters, rolling_speed));
  }

  /// Ends the step with the force at its limit, of magnitude `limit`.
  void slide_within(const BristleParameters& parameters, double h, double rolling_speed, double u,
                    double limit) {
    slide(parameters, h, rolling_speed, u);
    const double most = limit / parameters.stiffness;
    deflection_ = std::clamp(deflection_, -most, most);
  }

  /// Sets the deflection that the force causes at rest.
  void yield(const BristleParameters& parameters, double force) {
    deflection_ = -force / parameters.stiffness;
  }

  void reset() { deflection_ = 0.0; }
  [[nodiscard]] double deflection() const { return deflection_; }

 private:
  /// |V| / sigma.
  static double renewal_1ps(const BristleParameters& parameters, double rolling_speed) {
    return rolling_speed == 0.0 ? 0.0 : std::abs(rolling_speed) / parameters.relaxation_length;
  }

  double deflection_ = 0.0;
};

/// Ends a step of two bristles across each other, both slid, under a force of at most `limit`
/// together: they yield as far as they are bent, not as far as their dampers push, so that they
/// never give back what was not put in.
inline void yield_as_bent(Bristle& first, const BristleParameters& of_first, Bristle& second,
                          const BristleParameters& of_second, double limit) {
  const double bent = std::hypot(of_first.stiffness * first.deflection(),
                                 of_second.stiffness * second.deflection());
  if (bent > limit) {
    first.yield(of_first, -of_first.stiffness * (limit / bent) * first.deflection());
    second.yield(of_second, -of_second.stiffness * (limit / bent) * second.deflection());
  }
}
inline void yield_as_bent(std::array<Bristle, 2>& across, const BristleParameters& parameters,
                          double limit) {
  yield_as_bent(across[0], parameters, across[1], parameters, limit);
}

}  // namespace rigwire::sim
