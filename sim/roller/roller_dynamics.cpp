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

// Torque-angle bristle of a drum's brake.
BristleParameters held(double stiffness, double damping_ratio, double inertia_kgm2) {
  return {stiffness, 2.0 * damping_ratio * std::sqrt(stiffness * inertia_kgm2), 0.0};
}

// One loop pressure: within its limit, or at it.
struct Pressure {
  int side = 0;
  double pressure_pa = 0.0;
};

double flow_taken(const HydrostaticCircuit& circuit, const RollerVelocity& x) {
  return circuit.displacement_m3prad[0] * x[3] + circuit.displacement_m3prad[1] * x[4];
}

int side_of(double value, double limit) {
  return value > limit ? 1 : value < -limit ? -1 : 0;
}

}  // namespace

void SpinFriction::begin(double h, double limit_nm, double rate_before_radps) {
  h_ = h;
  limit_nm_ = limit_nm;
  if (limit_nm == 0.0) {
    bristle_.reset();
    law_ = {};
    side_ = 0;
    return;
  }
  law_ = bristle_.force(parameters_, h, 0.0);
  side_ = side_of(law_.at(rate_before_radps), limit_nm);
}

bool SpinFriction::test(double rate_radps) {
  int side = side_of(law_.at(rate_radps), limit_nm_);
  if (side * side_ < 0) {
    side = 0;  // Through holding, not across it.
  }
  const bool changed = side != side_;
  side_ = side;
  return changed;
}

void SpinFriction::settle(double rate_radps) {
  torque_nm_ = law().at(rate_radps);
  if (limit_nm_ == 0.0) {
    return;
  }
  if (side_ == 0) {
    bristle_.slide(parameters_, h_, 0.0, rate_radps);
  } else {
    bristle_.slide_within(parameters_, h_, 0.0, rate_radps, std::abs(torque_nm_));
  }
}

std::array<BristleParameters, 2> spin_bristles(const RollerParameters& p) {
  return {held(p.brake_stiffness_nmprad, 0.7, p.drum.spin_inertia_kgm2),
          held(0.1 * p.brake_stiffness_nmprad, 0.7, p.drum.spin_inertia_kgm2)};
}

RollerDynamics::RollerDynamics(const RollerParameters& parameters)
    : parameters_(parameters),
      drums_{DrumContact(parameters.drum, 0.5 * parameters.mass_kg),
             DrumContact(parameters.drum, 0.5 * parameters.mass_kg)},
      brakes_{SpinFriction(spin_bristles(parameters)[0]),
              SpinFriction(spin_bristles(parameters)[0])},
      rolling_{SpinFriction(spin_bristles(parameters)[1]),
               SpinFriction(spin_bristles(parameters)[1])},
      ploughing_{SpinFriction(held(kPloughing_npm, 0.7, 0.5 * parameters.mass_kg)),
                 SpinFriction(held(kPloughing_npm, 0.7, 0.5 * parameters.mass_kg))} {}

void RollerDynamics::step(double h, const RollerLoads& loads, HydrostaticDrive& drive,
                          RollerVelocity& velocity) {
  // M x + h (gravity + supplements) on the right, M + h (motors' viscous friction) on the left.
  const double friction =
      drive.parameters().bypass ? 0.0 : drive.parameters().motor_friction_nmsprad;
  RollerMatrix A0 = RollerMatrix::Zero();
  A0.diagonal() << loads.mass.mass_kg, loads.mass.mass_kg, loads.mass.yaw_inertia_kgm2,
      parameters_.drum.spin_inertia_kgm2, parameters_.drum.spin_inertia_kgm2;
  RollerVelocity b0 = A0.diagonal().cwiseProduct(velocity);
  b0.head<2>() += h * (loads.mass.mass_kg * loads.gravity_mps2);
  b0.head<3>() += h * loads.supplement;
  A0(3, 3) += h * friction;
  A0(4, 4) += h * friction;

  for (std::size_t i = 0; i < 2; ++i) {
    const double rate = velocity[static_cast<Eigen::Index>(3 + i)];
    drums_[i].begin(h, loads.drum[i], of_drum(velocity, i));
    brakes_[i].begin(h, loads.brake_limit_nm[i], rate);
    rolling_[i].begin(h, loads.rolling_limit_nm[i], rate);
    // The drum's centre along its heading: u cos d + (v + r x) sin d.
    const double sine = std::sin(loads.drum[i].steer_rad);
    way_row_[i] = {std::cos(loads.drum[i].steer_rad), sine, loads.drum[i].x_m * sine};
    ploughing_[i].begin(h, loads.ploughing_limit_n[i], way_row_[i].dot(velocity.head<3>()));
  }
  std::array<Pressure, 2> pressures;
  const double relief = drive.pressure_limit_pa();
  for (std::size_t i = 0; i < drive.circuits(); ++i) {
    const HydrostaticCircuit& circuit = drive.circuit(i);
    pressures[i].side = side_of(circuit.law.at(flow_taken(circuit, velocity)), relief);
  }

  RollerVelocity x = velocity;
  bool changed = true;
  for (int round = 0; changed && round < kRounds; ++round) {
    RollerMatrix A = A0;
    RollerVelocity b = b0;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto w = static_cast<Eigen::Index>(3 + i);
      // Strips: h G and h offsets in (u, v, r, w) of this drum.
      add_drum(drums_[i].forces(), h, i, A, b);
      const ImplicitForce brake = brakes_[i].law();
      const ImplicitForce rolling = rolling_[i].law();
      A(w, w) += h * (brake.gain + rolling.gain);
      b[w] += h * (brake.offset + rolling.offset);
      const ImplicitForce ploughing = ploughing_[i].law();
      A.topLeftCorner<3, 3>() += (h * ploughing.gain) * way_row_[i] * way_row_[i].transpose();
      b.head<3>() += (h * ploughing.offset) * way_row_[i];
    }
    for (std::size_t i = 0; i < drive.circuits(); ++i) {
      const HydrostaticCircuit& circuit = drive.circuit(i);
      const Eigen::Vector2d d(circuit.displacement_m3prad[0], circuit.displacement_m3prad[1]);
      if (pressures[i].side == 0) {
        // Oil: torque d p with p = offset - gain (d . w); at the relief valve p is the limit.
        A.bottomRightCorner<2, 2>() += (h * circuit.law.gain) * d * d.transpose();
        b.tail<2>() += (h * circuit.law.offset) * d;
      } else {
        b.tail<2>() += (h * pressures[i].side * relief) * d;
      }
    }
    for (const RollerContact& contact : loads.contacts) {
      for (std::size_t i = 0; i < 3; ++i) {
        const ImplicitForce law = contact.point->acting(i);
        A += (h * law.gain) * contact.rows[i] * contact.rows[i].transpose();
        b += (h * law.offset) * contact.rows[i];
      }
    }
    // (M + h G) x' = M x + h (offsets + gravity + supplements), clamp last (roller_dynamics.h).
    x = A.llt().solve(b);

    changed = false;
    for (const RollerContact& contact : loads.contacts) {
      changed = contact.point->changes(contact.along(x)) || changed;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const double rate = x[static_cast<Eigen::Index>(3 + i)];
      const bool drum = drums_[i].test(of_drum(x, i));
      const bool brake = brakes_[i].test(rate);
      const bool rolling = rolling_[i].test(rate);
      const bool ploughing = ploughing_[i].test(way_row_[i].dot(x.head<3>()));
      changed = changed || drum || brake || rolling || ploughing;
    }
    for (std::size_t i = 0; i < drive.circuits(); ++i) {
      const HydrostaticCircuit& circuit = drive.circuit(i);
      // From one limit to the other it leads through being free: no jump across.
      int side = side_of(circuit.law.at(flow_taken(circuit, x)), relief);
      side = side * pressures[i].side < 0 ? 0 : side;
      changed = changed || side != pressures[i].side;
      pressures[i].side = side;
    }
  }
  unsettled_steps_ += changed ? 1 : 0;

  velocity = x;
  std::array<double, 2> found_pa{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double rate = x[static_cast<Eigen::Index>(3 + i)];
    drums_[i].settle(of_drum(x, i));
    brakes_[i].settle(rate);
    rolling_[i].settle(rate);
    ploughing_[i].settle(way_row_[i].dot(x.head<3>()));
  }
  for (std::size_t i = 0; i < drive.circuits(); ++i) {
    const HydrostaticCircuit& circuit = drive.circuit(i);
    found_pa[i] = pressures[i].side == 0
                      ? std::clamp(circuit.law.at(flow_taken(circuit, x)), -relief, relief)
                      : pressures[i].side * relief;
  }
  drive.finish(found_pa);
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
    drums_[i].preload(force.x(), force.y());
    const double torque = parameters_.drum.radius_m * force.x();
    brakes_[i].preload(std::clamp(torque, -loads.brake_limit_nm[i], loads.brake_limit_nm[i]));
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
