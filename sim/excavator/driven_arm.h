// The arm with its four drives, and the step that moves them together.
//
// A drive is the paper's Eq. 5, F = k (x_t - x) + d (v_t - dx/dt), between a moving target x_t and
// the drive's coordinate x: the joint angle for swing, the cylinder length for boom, stick and
// bucket. One-sided stiff end stops bound the cylinders, relief valves bound F.
//
// The step is the linearly implicit Euler rule (h step, J = dx/dq, diagonal):
//
//     (M + h d J^2 + h^2 k J^2) a = rest + J (k (x_t(t+h) - x - h J v) + d (v_t - J v))
//     v += h a,   q += h v
//
// Of order 1, one solve per active set. Forces that leave their limits are set to the limit and the
// step is solved again (clamp last); end stops enter the same way.
#pragma once

#include <span>

#include "sim/contact/bristle.h"
#include "sim/contact/contact_point.h"
#include "sim/excavator/arm_dynamics.h"
#include "sim/excavator/bucket_load.h"
#include "sim/excavator/linkage.h"

namespace rigwire::sim {

/// Joint angles and rates.
struct ArmState {
  JointVector q_rad = JointVector::Zero();
  JointVector v_radps = JointVector::Zero();
};

/// One configuration with everything that depends on it alone.
struct ArmPose {
  ArmAngles angles;
  JointVector x = JointVector::Zero();      ///< Drive coordinates.
  JointVector lever = JointVector::Zero();  ///< J = dx/dq.
};

/// What the drives exert during one step: each a force linear in the rate of its coordinate at the
/// step's end, within limits.
struct DriveLaws {
  std::array<ImplicitForce, kArmJoints> force;
  JointVector least = JointVector::Constant(-1e300);
  JointVector greatest = JointVector::Constant(1e300);
};

/// The drives' gains and limits; units per drive as its coordinate has them.
struct DriveGains {
  JointVector stiffness = JointVector::Zero();
  JointVector damping = JointVector::Zero();
  JointVector force_least = JointVector::Constant(-1e300);
  JointVector force_greatest = JointVector::Constant(1e300);
  bool end_stops = false;
};

/// One point of contact as the joints feel it: speeds along its three directions are rows . v.
struct ArmContact {
  ContactPoint* point = nullptr;
  std::array<JointVector, 3> rows;

  [[nodiscard]] std::array<double, 3> along(const JointVector& v_radps) const {
    return {rows[0].dot(v_radps), rows[1].dot(v_radps), rows[2].dot(v_radps)};
  }
};

/// Load of a bucket (bucket_load.h) in joint coordinates, during one step.
struct ArmLoad {
  JointVector torque = JointVector::Zero();  ///< Torque that does not depend on the velocity.
  /// Torque jacobian (offset - gain jacobian . v), the bracket within -limit .. limit.
  struct Resistance {
    JointVector jacobian = JointVector::Zero();
    double offset = 0.0;
    double gain = 0.0;
    double limit = 0.0;
  };
  std::array<Resistance, kTipResistances> resistances;
  std::size_t resistance_count = 0;
  /// Contacts of this step; their points determine their forces.
  std::span<const ArmContact> contacts;
};

/// Result of one step.
struct ArmStep {
  JointVector acceleration_radps2 = JointVector::Zero();  ///< At the step's end.
  JointVector force = JointVector::Zero();  ///< Forces of the drives, within their limits.
  std::array<bool, kArmJoints> relieved{};  ///< Force is at its limit; the target has to yield.
  /// Forces of the resistances, within their limits.
  std::array<double, kTipResistances> resistance_n{};
};

class DrivenArm {
 public:
  DrivenArm(const ExcavatorParameters& parameters, const Eigen::Vector3d& gravity_C_mps2);

  [[nodiscard]] const ArmDynamics& dynamics() const { return dynamics_; }
  [[nodiscard]] ArmDynamics& dynamics() { return dynamics_; }
  [[nodiscard]] const Linkages& linkages() const { return linkages_; }

  DriveGains gains;

  /// Acts during every step until it is changed.
  ArmLoad load;

  /// d = 2 ratio sqrt(k m), m the mass each drive feels at q with the other joints free.
  [[nodiscard]] JointVector damping_for(const JointVector& q_rad, const JointVector& stiffness,
                                        double ratio) const;
  /// Mass (inertia for swing) that each drive feels at q, the other joints free.
  [[nodiscard]] JointVector free_mass(const JointVector& q_rad) const;
  /// The highest natural frequency of arm and stiffness at q, rad/s.
  [[nodiscard]] double highest_frequency_radps(const JointVector& q_rad,
                                               const JointVector& stiffness) const;

  [[nodiscard]] ArmPose pose(const JointVector& q_rad) const;

  /// Eq. 5 as a law of one step of h seconds that ends with this target and rate.
  [[nodiscard]] DriveLaws laws(const ArmPose& at, double h, const JointVector& target,
                               const JointVector& rate) const;
  /// A cylinder's end stop (joint 1 .. 3) in its rate at the step's end; to be kept from pulling.
  [[nodiscard]] ImplicitForce stop_law(int joint, bool low, double h, double x) const;
  /// Lengths at which the stops begin, without bounds for swing.
  [[nodiscard]] const JointVector& length_least_m() const { return length_least_; }
  [[nodiscard]] const JointVector& length_greatest_m() const { return length_greatest_; }
  /// One step of h > 0 from `at`, the pose of state.q_rad, with any laws, and with end stops and
  /// the load. Accelerations and forces are the solver's own unknowns: the springs evaluated at the
  /// new state also see the linkage's curvature over the step, which times k is no force that ever
  /// acted.
  ArmStep advance(double h, const ArmPose& at, const DriveLaws& laws, ArmState& state) const;

 private:
  struct Inertia {
    JointMatrix inverse;  ///< M^-1
    JointVector lever;    ///< J
  };
  [[nodiscard]] Inertia inertia_at(const JointVector& q_rad) const;

  ArmDynamics dynamics_;
  Linkages linkages_;
  JointVector length_least_;     ///< -1e300 for swing.
  JointVector length_greatest_;  ///< 1e300 for swing.
  double stop_stiffness_;
  JointVector stop_damping_;
};

}  // namespace rigwire::sim
