// The arm on an undercarriage that is a free rigid body standing on four tyres with their brakes
// locked: ten degrees of freedom, solved together, so that the machine rocks, slides and tips while
// it works.
//
// Velocities: the undercarriage's six in its own frame C (angular, then linear of C's origin), then
// the joints'. Mass matrix by composite rigid bodies, bias by recursive Newton-Euler, both with
// spatial vectors about C's origin (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 5,
// 6 and 9). One step is linearly implicit Euler: drives, end stops, tyres and the bucket's
// resistances are forces F = offset - gain u with limits, all on the left-hand side; those beyond
// their limits are held there and the step is solved again (clamp last). Positions move with the
// new velocities, the attitude by the exponential map. Order 1; momentum in free flight is kept to
// the step's order.
//
// The tyres are those of sim/tyre, friction on hard ground and on soil theirs; wheels do not turn.
// Never allocates in a step.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim/contact/contact_set.h"
#include "sim/excavator/driven_arm.h"
#include "sim/ground/ground.h"
#include "sim/link_motion.h"
#include "sim/tyre/tyre.h"

namespace rigwire::sim {

inline constexpr std::size_t kCarrierWheels = 4;

class CarriedArm {
 public:
  using Velocities = Eigen::Matrix<double, 10, 1>;
  using SpatialVector = Eigen::Matrix<double, 6, 1>;

  /// Stands at X_WC, the tyres' deflection not yet found. `ground` must outlive it.
  CarriedArm(const ExcavatorParameters& parameters, const Ground& ground,
             const Eigen::Isometry3d& X_WC);

  /// One step of h > 0 seconds from `state`, which is moved, with laws that belong to `at`, its
  /// pose. The arm gives masses, stops and gains; its own gravity and load are not used.
  /// `contacts`: points on the links, whose forces are found and settled here; null: none.
  ArmStep step(double h, const DrivenArm& arm, const ArmPose& at, const DriveLaws& laws,
               const BucketLoad& load, ArmState& state, ContactSet* contacts = nullptr);

  /// Poses and velocities of the links now, for the contact.
  void place_contact_links(const ArmState& state, std::span<ContactLink> links) const;

  /// Undercarriage and links at the last step's end.
  [[nodiscard]] std::array<LinkMotion, 5> motion(const ArmState& state) const;

  [[nodiscard]] const Eigen::Isometry3d& X_WC() const { return X_WC_; }
  /// Where the machine is from now on, at rest and off its bristles.
  void place(const Eigen::Isometry3d& X_WC);
  void set_velocity(const Eigen::Vector3d& w_C, const Eigen::Vector3d& v_C);
  [[nodiscard]] bool finite() const { return X_WC_.matrix().allFinite() && velocity_.allFinite(); }
  /// Of the last step: normal forces front left, front right, rear left, rear right.
  [[nodiscard]] const std::array<double, kCarrierWheels>& wheel_loads_n() const { return loads_n_; }

  /// Momentum in the world, kg m/s, and angular momentum about the common centre of mass, kg m2/s.
  struct Momentum {
    Eigen::Vector3d linear_W;
    Eigen::Vector3d angular_W;
  };
  [[nodiscard]] Momentum momentum(const DrivenArm& arm, const ArmState& state) const;

 private:
  using Matrix = Eigen::Matrix<double, 10, 10>;
  using SpatialMatrix = Eigen::Matrix<double, 6, 6>;

  /// Links at joint angles, in C.
  struct Placement {
    std::array<Eigen::Matrix3d, 5> R_CB;
    std::array<Eigen::Vector3d, 5> origin_C;
    std::array<SpatialVector, 4> axis;
    std::array<SpatialMatrix, 5> inertia;
  };
  /// A force along one row of velocities.
  struct Term {
    Velocities row;
    ImplicitForce law;
    double least = 0.0;
    double greatest = 0.0;
    bool held = false;
    double force = 0.0;
    int switches = 0;
  };
  static constexpr std::size_t kTerms = 8 + kTipResistances + 3 * kCarrierWheels;
  struct Terms {
    std::array<Term, kTerms> all;
    std::size_t count = 0;
    std::size_t add(const Velocities& row, const ImplicitForce& law, double least,
                    double greatest) {
      all[count] = {row, law, least, greatest, false, 0.0, 0};
      return count++;
    }
  };
  /// A touching wheel's terms.
  struct Footing {
    std::size_t normal = 0, along = 0, across = 0;
    bool touching = false;
    bool sliding = false;
    TyreLaws laws;
  };

  [[nodiscard]] Placement place_links(const JointVector& q_rad) const;
  [[nodiscard]] SpatialMatrix inertia_of(const ArmDynamics::Moments& moments,
                                         const Eigen::Matrix3d& R,
                                         const Eigen::Vector3d& origin) const;
  void equations(const DrivenArm& arm, Placement& at, const JointVector& q_rad, Matrix& mass_matrix,
                 Velocities& bias) const;
  [[nodiscard]] Velocities point_row(const Placement& at, const Eigen::Vector3d& point_C,
                                     const Eigen::Vector3d& direction_C, std::size_t link) const;
  void add_wheels(double h, Terms& terms, std::array<Footing, kCarrierWheels>& footings);
  [[nodiscard]] static bool clamp(Terms& terms, std::array<Footing, kCarrierWheels>& footings,
                                  const Velocities& found);

  ExcavatorParameters parameters_;
  ArmDynamics::Moments undercarriage_;
  const Ground* ground_;
  std::vector<std::array<Velocities, 3>> contact_rows_;
  std::vector<Tyre> tyres_;
  std::array<Eigen::Vector3d, kCarrierWheels> wheel_C_;
  Eigen::Isometry3d X_WC_;
  Velocities velocity_ = Velocities::Zero();  ///< Joints' as of the last step.
  Velocities acceleration_ = Velocities::Zero();
  std::array<double, kCarrierWheels> loads_n_{};
};

}  // namespace rigwire::sim
