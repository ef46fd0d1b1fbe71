#include "sim/roller/roller_dynamics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr int kRounds = 12;
constexpr double kPloughing_npm = 1e6;  // of a drum held by the soil in front of it

using RollerMatrix = Eigen::Matrix<double, 5, 5>;

// (u, v, r, w) of one drum out of the roller's velocities.
Eigen::Vector4d of_drum(const RollerVelocity& x, std::size_t drum) {
  return {x[0], x[1], x[2], x[static_cast<Eigen::Index>(3 + drum)]};
}

void add_drum(const DrumForces& forces, double h, std::size_t drum, RollerMatrix& A,
              RollerVelocity& b) {
  const auto w = static_cast<Eigen::Index>(3 + drum);
  A.topLeftCorner<3, 3>() += h * forces.gain.topLeftCorner<3, 3>();
  A.block<3, 1>(0, w) += h * forces.gain.topRightCorner<3, 1>();
  A.block<1, 3>(w, 0) += h * forces.gain.bottomLeftCorner<1, 3>();
  A(w, w) += h * forces.gain(3, 3);
  b.head<3>() += h * forces.offset.head<3>();
  b[w] += h * forces.offset[3];
}

}  // namespace

RollerDynamics::RollerDynamics(const RollerParameters& parameters)
    : parameters_(parameters),
      drums_{DrumContact(parameters.drum, 0.5 * parameters.mass_kg),
             DrumContact(parameters.drum, 0.5 * parameters.mass_kg)},
      train_(parameters),
      ploughing_{SpinFriction(held_bristle(kPloughing_npm, 0.7, 0.5 * parameters.mass_kg)),
                 SpinFriction(held_bristle(kPloughing_npm, 0.7, 0.5 * parameters.mass_kg))} {}

void RollerDynamics::step(double h, const RollerLoads& loads, HydrostaticDrive& drive,
                          RollerVelocity& velocity) {
  // M x + h (gravity + supplements) on the right, M on the left.
  RollerMatrix A0 = RollerMatrix::Zero();
  A0.diagonal() << loads.mass.mass_kg, loads.mass.mass_kg, loads.mass.yaw_inertia_kgm2,
      parameters_.drum.spin_inertia_kgm2, parameters_.drum.spin_inertia_kgm2;
  RollerVelocity b0 = A0.diagonal().cwiseProduct(velocity);
  b0.head<2>() += h * (loads.mass.mass_kg * loads.gravity_mps2);
  b0.head<3>() += h * loads.supplement;

  for (std::size_t i = 0; i < 2; ++i) {
    drums_[i].begin(h, loads.drum[i], of_drum(velocity, i));
    // The drum's centre along its heading: u cos d + (v + r x) sin d.
    const double sine = std::sin(loads.drum[i].steer_rad);
    way_row_[i] = {std::cos(loads.drum[i].steer_rad), sine, loads.drum[i].x_m * sine};
    ploughing_[i].begin(h, loads.ploughing_limit_n[i], way_row_[i].dot(velocity.head<3>()));
  }
  train_.begin(h, loads.torque, drive, velocity.tail<2>());

  RollerVelocity x = velocity;
  bool changed = true;
  for (int round = 0; changed && round < kRounds; ++round) {
    RollerMatrix A = A0;
    RollerVelocity b = b0;
    for (std::size_t i = 0; i < 2; ++i) {
      // Strips: h G and h offsets in (u, v, r, w) of this drum.
      add_drum(drums_[i].forces(), h, i, A, b);
      const ImplicitForce ploughing = ploughing_[i].law();
      A.topLeftCorner<3, 3>() += (h * ploughing.gain) * way_row_[i] * way_row_[i].transpose();
      b.head<3>() += (h * ploughing.offset) * way_row_[i];
    }
    const DrumTrain::Torques torques = train_.torques();
    A.bottomRightCorner<2, 2>() += h * torques.gain;
    b.tail<2>() += h * torques.offset;
    for (const RollerContact& contact : loads.contacts) {
      contact.add(h, A, b);
    }
    // (M + h G) x' = M x + h (offsets + gravity + supplements), clamp last (roller_dynamics.h).
    x = A.llt().solve(b);

    changed = train_.test(x.tail<2>());
    for (const RollerContact& contact : loads.contacts) {
      changed = contact.point->changes(contact.along(x)) || changed;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const bool drum = drums_[i].test(of_drum(x, i));
      const bool ploughing = ploughing_[i].test(way_row_[i].dot(x.head<3>()));
      changed = changed || drum || ploughing;
    }
  }
  unsettled_steps_ += changed ? 1 : 0;

  velocity = x;
  for (std::size_t i = 0; i < 2; ++i) {
    drums_[i].settle(of_drum(x, i));
    ploughing_[i].settle(way_row_[i].dot(x.head<3>()));
  }
  train_.settle(x.tail<2>(), drive);
}

void RollerDynamics::leave_ground() {
  for (std::size_t i = 0; i < 2; ++i) {
    drums_[i].leave_ground();
    ploughing_[i].reset();
  }
}

void RollerDynamics::preload(const RollerLoads& loads, const std::array<double, 2>& normal_n) {
  // Statics: the drums carry the slope's pull by their loads' shares, brakes the torque R F.
  const Eigen::Vector2d held_n = -loads.mass.mass_kg * loads.gravity_mps2;
  const double normal = normal_n[0] + normal_n[1];
  for (std::size_t i = 0; i < 2; ++i) {
    const double share = normal > 0.0 ? normal_n[i] / normal : 0.5;
    double limit = 0.0;
    for (const double strip_n : loads.drum[i].limit_n) {
      limit += strip_n;
    }
    const double size = share * held_n.norm();
    const double scale = size > limit ? limit / size : 1.0;
    const Eigen::Vector2d force = scale * share * held_n;
    drums_[i].preload(force.x(), force.y(), loads.drum[i].limit_n);
    const double torque = parameters_.drum.radius_m * force.x();
    train_.preload(i, torque, loads.torque.brake_nm[i]);
  }
}

Eigen::Vector2d RollerDynamics::ground_force_n() const {
  Eigen::Vector2d sum = (drums_[0].generalised() + drums_[1].generalised()).head<2>();
  for (std::size_t i = 0; i < 2; ++i) {
    sum += ploughing_[i].torque_nm() * way_row_[i].head<2>();
  }
  return sum;
}

}  // namespace rigwire::sim
