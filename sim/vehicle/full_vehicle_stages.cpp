// Schemes of the full vehicle that evaluate the equations of motion as they stand: classical
// Runge-Kutta 4, and ROS2 with the matrix of the linearly implicit step as its Jacobian.
//
// Unknowns: place, velocities and the deflections of all bristles. A bristle's rate is
// u - renewal z while its force is within its limit and 0 while it is not; at the end of a step
// limited bristles yield as in the default scheme. Held over a step: steering angles, tyre
// pressures, brake limits, the drive line's lags and shift sequence, the slip that chooses the
// secant on soft soil. Their changes, and forces that reach or leave a limit, cost order: 1 there.
#include <cmath>

#include "sim/vehicle/full_vehicle.h"

namespace rigwire::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGamma = 1.0 - 0.5 * std::numbers::sqrt2;  // ROS2, L-stable

Vector3d part_of(const Velocities& v, std::size_t first) {
  return {v[first], v[first + 1], v[first + 2]};
}

void set_part(Velocities& v, std::size_t first, const Vector3d& part) {
  for (std::size_t i = 0; i < 3; ++i) {
    v[first + i] = part[static_cast<Eigen::Index>(i)];
  }
}

template <std::size_t n>
void add_to(std::array<double, n>& sum, double weight, const std::array<double, n>& term) {
  for (std::size_t i = 0; i < n; ++i) {
    sum[i] += weight * term[i];
  }
}

/// sum += weight term.
void add_to(VehicleStage& sum, double weight, const VehicleStage& term) {
  add_to(sum.place, weight, term.place);
  add_to(sum.velocity, weight, term.velocity);
  add_to(sum.deflection, weight, term.deflection);
}

VehicleStage moved(const VehicleStage& start, double h, const VehicleStage& rate) {
  VehicleStage end = start;
  add_to(end, h, rate);
  return end;
}

/// Exponential map: the unit quaternion of a rotation vector.
Eigen::Quaterniond turned(const Vector3d& rotation) {
  const double angle = rotation.norm();
  const double half_sine = angle > 1e-8 ? std::sin(0.5 * angle) / angle : 0.5;
  return {std::cos(0.5 * angle), half_sine * rotation.x(), half_sine * rotation.y(),
          half_sine * rotation.z()};
}

/// 0 x is 0 for every finite x, and not a number for all others.
bool all_finite(const VehicleStage& stage) {
  double sum = 0.0;
  for (const double x : stage.place) {
    sum += 0.0 * x;
  }
  for (const double x : stage.deflection) {
    sum += 0.0 * x;
  }
  return sum == 0.0;
}

}  // namespace

VehicleStage FullVehicle::start_of_stages() const {
  VehicleStage start;
  set_part(start.velocity, 0, state_.q_WB.conjugate() * state_.v_WC_W);
  set_part(start.velocity, 3, state_.w_WB_B);
  for (std::size_t i = 0; i < 4; ++i) {
    start.velocity[kBodyVelocities + i] = state_.suspension_rate[i];
    start.velocity[kWheelVelocity + i] = state_.wheel_rate_radps[i];
    wheel_terms_[i].read_deflections(start.deflection);
  }
  chassis_.read_deflections(start.deflection);
  return start;
}

void FullVehicle::put(const FullVehicleState& from, const VehicleStage& at) {
  // Exponential coordinates about the step's start (Munthe-Kaas): attitude = start exp(rotation).
  state_.p_WC = from.p_WC + from.q_WB * part_of(at.place, 0);
  state_.q_WB = from.q_WB * turned(part_of(at.place, 3));
  state_.v_WC_W = from.q_WB * part_of(at.velocity, 0);
  state_.w_WB_B = part_of(at.velocity, 3);
  for (std::size_t i = 0; i < 4; ++i) {
    state_.suspension[i] = from.suspension[i] + at.place[kBodyVelocities + i];
    state_.suspension_rate[i] = at.velocity[kBodyVelocities + i];
    state_.wheel_angle_rad[i] = from.wheel_angle_rad[i] + at.place[kWheelVelocity + i];
    state_.wheel_rate_radps[i] = at.velocity[kWheelVelocity + i];
  }
}

void FullVehicle::stage_suspension(StageForces& forces) const {
  for (std::size_t i = 0; i < 2; ++i) {
    const Vector2d rate(state_.suspension_rate[2 * i], state_.suspension_rate[2 * i + 1]);
    const SuspensionForce f =
        axles_[i].force(Vector2d(state_.suspension[2 * i], state_.suspension[2 * i + 1]), rate);
    StageForce force;
    force.row.axle = i;
    force.row.wheel = 2 * i;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto own = static_cast<Eigen::Index>(k);
      force.row.value[6] = k == 0 ? 1.0 : 0.0;
      force.row.value[7] = k == 0 ? 0.0 : 1.0;
      force.force = f.force[own];
      force.stiffness = f.stiffness[own] + f.cross_stiffness;
      force.damping = f.damping[own];
      forces.add(force);
    }
    // The roll bar as its own row, k (s0 - s1), its stiffness taken out of the sides' above.
    if (f.cross_stiffness != 0.0) {  // Its force is in those of the two sides.
      force.row.value[6] = 1.0;
      force.row.value[7] = -1.0;
      force.force = 0.0;
      force.stiffness = -f.cross_stiffness;
      force.damping = 0.0;
      forces.add(force);
    }
  }
}

VehicleStage FullVehicle::rates(const FullVehicleState& from, const WheelVector& start_rates,
                                const VehicleStage& at, StageForces& forces) {
  put(from, at);
  const Vector3d rotation = part_of(at.place, 3);
  const Matrix3d R_from_now = turned(rotation).toRotationMatrix();
  const Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  const Vector3d& w = state_.w_WB_B;
  Velocities now = at.velocity;
  set_part(now, 0, R_from_now.transpose() * part_of(at.velocity, 0));
  update_kinematics(w);

  VehicleStage rate;
  forces.clear();
  for (std::size_t i = 0; i < kWheels; ++i) {
    const WheelFrame& frame = axles_[i / 2].wheel(i % 2);
    const auto contact = ground_->wheel_contact(state_.p_WC + R_WB * frame.hub_m, R_WB * frame.axis,
                                                axle(i / 2).tyre.unloaded_radius_m);
    const SoilParameters& soil = ground_->soil(contact ? contact->ground.soil : std::uint8_t{0});
    wheel_terms_[i].stage(frame, R_WB, contact, soil, tyre_pressure_pa(i), brake_limit_nm(i), now,
                          at.deflection, forces, rate.deflection);
  }
  chassis_.stage(*ground_, state_.p_WC, R_WB, now, at.deflection, forces, rate.deflection);
  stage_suspension(forces);

  // M v' = f + sum J^T F at this state: masses and velocity products with h = 1, then all forces.
  assemble(1.0, w, now);
  for (const WheelTerms& wheel : wheel_terms_) {
    base_.add(wheel.spin(), wheel.spin_inertia_kgm2(), 0.0);
  }
  const SpinEquations& drive = driveline_->equations();
  const WheelVector spins(&now[kWheelVelocity]);
  base_.add_wheels(drive.inertia, drive.torque_nm - drive.damping * (spins - start_rates));
  for (const StageForce& force : forces) {
    base_.add_impulse(force.row, force.force);
  }
  VelocitySystem system = base_;
  rate.velocity = system.solve(drive.basis, drive.coordinates);

  set_part(rate.velocity, 0, R_from_now * part_of(rate.velocity, 0));
  rate.place = at.velocity;
  // Rotation vector's rate after Bortz (1971), w + r x w / 2 + r x (r x w) / 12, to order 2 in r.
  const Vector3d turn = rotation.cross(w);
  set_part(rate.place, 3, w + 0.5 * turn + rotation.cross(turn) / 12.0);
  return rate;
}

VehicleStage FullVehicle::runge_kutta4(const FullVehicleState& from, const VehicleStage& start,
                                       double h) {
  const WheelVector spins(&start.velocity[kWheelVelocity]);
  // Classical Runge-Kutta: stages at 0, h/2, h/2, h, weights 1/6, 1/3, 1/3, 1/6.
  const VehicleStage k1 = rates(from, spins, start, forces_);
  const VehicleStage k2 = rates(from, spins, moved(start, 0.5 * h, k1), later_forces_);
  const VehicleStage k3 = rates(from, spins, moved(start, 0.5 * h, k2), later_forces_);
  const VehicleStage k4 = rates(from, spins, moved(start, h, k3), later_forces_);
  VehicleStage end = moved(start, h / 6.0, k1);
  add_to(end, h / 3.0, k2);
  add_to(end, h / 3.0, k3);
  add_to(end, h / 6.0, k4);
  return end;
}

// (I - g J) k1 = f(y),  (I - g J) k2 = f(y + h k1) - 2 k1,  y += h (3 k1 + k2) / 2,  g = gamma h.
// Places and deflections are eliminated, so that one matrix over the velocities is left: the masses
// and, per force, its gain for g seconds.
VehicleStage FullVehicle::rosenbrock2(const FullVehicleState& from, const VehicleStage& start,
                                      double h) {
  const double g = kGamma * h;
  const WheelVector spins(&start.velocity[kWheelVelocity]);
  const SpinEquations& drive = driveline_->equations();
  // Matrix of both stages: M + g sum gain(g) J^T J + g D of the drive line (stage_forces.h).
  const VehicleStage f1 = rates(from, spins, start, forces_);
  masses_ = base_;
  VelocitySystem shifted = base_;
  for (const StageForce& force : forces_) {
    shifted.add(force.row, g * force.gain(g), 0.0);
  }
  shifted.add_wheels(g * drive.damping, WheelVector::Zero());

  // k_z = (r_z + g J k_v) / (1 + g renewal), put into M k_v = M r_v - g J^T (k k_z + c J k_v).
  const auto solve = [&](const VehicleStage& r) {
    VelocitySystem system = shifted;
    system.right = masses_.times(r.velocity);
    for (const StageForce& force : forces_) {
      if (force.deflection != DeflectionOf::limited) {
        const double change = force.deflection == DeflectionOf::bristle
                                  ? r.deflection[force.bristle]
                                  : force.row.of(r.place);
        system.add_impulse(force.row, -g * force.share(g) * change);
      }
    }
    VehicleStage k = r;
    k.velocity = system.solve(drive.basis, drive.coordinates);
    add_to(k.place, g, k.velocity);
    for (const StageForce& force : forces_) {
      if (force.deflection == DeflectionOf::bristle) {
        k.deflection[force.bristle] = (r.deflection[force.bristle] + g * force.row.of(k.velocity)) /
                                      (1.0 + g * force.renewal);
      }
    }
    return k;
  };

  const VehicleStage k1 = solve(f1);
  VehicleStage r2 = rates(from, spins, moved(start, h, k1), later_forces_);
  add_to(r2, -2.0, k1);
  const VehicleStage k2 = solve(r2);
  VehicleStage end = moved(start, 1.5 * h, k1);
  add_to(end, 0.5 * h, k2);
  return end;
}

void FullVehicle::staged_step(double h) {
  constexpr int kMostPasses = 6;
  const FullVehicleState from = state_;
  const VehicleStage start = start_of_stages();
  VehicleStage end;
  for (passes_ = 1;; ++passes_) {
    end = parameters_.scheme == IntegrationScheme::runge_kutta4 ? runge_kutta4(from, start, h)
                                                                : rosenbrock2(from, start, h);
    if (driveline_->accept(h, WheelVector(&end.velocity[kWheelVelocity])) ||
        passes_ >= kMostPasses) {
      break;
    }
  }
  Velocities change = end.velocity;
  add_to(change, -1.0, start.velocity);
  if (!finite(change)) {
    state_ = from;
    return;
  }
  if (!all_finite(end)) {
    record_non_finite("position", "body");
    state_ = from;
    return;
  }
  for (std::size_t i = 0; i < kVelocities; ++i) {
    acceleration_[i] = change[i] / h;
  }
  Velocities now = end.velocity;
  // From the body's axes at the step's start to those at its end.
  set_part(now, 0, turned(part_of(end.place, 3)).conjugate() * part_of(end.velocity, 0));
  put(from, end);
  state_.q_WB.normalize();
  for (std::size_t i = 0; i < kWheels; ++i) {
    state_.wheel_angle_rad[i] = std::remainder(state_.wheel_angle_rad[i], 2.0 * std::numbers::pi);
    wheel_terms_[i].keep_deflections(end.deflection, now, wheels_[i]);
  }
  chassis_.keep_deflections(end.deflection);
  suspension_ = state_.suspension;
  driveline_->finish(h, WheelVector(&end.velocity[kWheelVelocity]));
}

}  // namespace rigwire::sim
