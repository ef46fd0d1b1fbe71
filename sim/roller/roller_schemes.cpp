// ROS2 and Runge-Kutta 4 for the roller's equations in continuous time.
//
// Written in the frame's axes at the start of the step, so that there is no centrifugal term and
// gravity is constant; ground forces and supplements turn with the yaw since then. Pivots and set
// point are known functions of time. Loads, friction limits and the surface's slope are those of
// the start.
//
// ROS2 is a W-method: of second order with any matrix. Its matrix has what the linearly implicit
// Euler step has on its left (strips, brakes, oil), with gamma h for h; bristles and pressures are
// eliminated, so that a stage costs one 5 x 5 solve.
#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "sim/roller/roller_dynamics.h"

namespace rigwire::sim {
namespace {

constexpr double kGamma = 1.0 - 0.5 * std::numbers::sqrt2;

// Places in the vector of everything that moves on.
constexpr Eigen::Index kPlace = 0;     // x, y, yaw since the start.
constexpr Eigen::Index kVelocity = 3;  // u, v, r, w_f, w_r.
constexpr Eigen::Index kPressure = 8;
constexpr Eigen::Index kEngine = 10;
constexpr Eigen::Index kSwash = 11;
constexpr Eigen::Index kBrake = 12;
constexpr Eigen::Index kRolling = 14;
constexpr Eigen::Index kBristles = 16;  // Of each drum, along and across.
constexpr Eigen::Index kDrumBristles = 2 * kDrumStripsMax;
constexpr Eigen::Index kStates = kBristles + 2 * kDrumBristles;

using RollerVector = Eigen::Matrix<double, kStates, 1>;

Eigen::Index at(Eigen::Index first, std::size_t drum) {
  return first + static_cast<Eigen::Index>(drum);
}

DrumBristles bristles_of(const RollerVector& y, std::size_t drum) {
  const Eigen::Index first = kBristles + static_cast<Eigen::Index>(drum) * kDrumBristles;
  DrumBristles result;
  for (std::size_t i = 0; i < kDrumStripsMax; ++i) {
    result.along[i] = y[at(first, i)];
    result.across[i] = y[at(first + kDrumStripsMax, i)];
  }
  return result;
}

void put_bristles(const DrumBristles& bristles, std::size_t drum, RollerVector& y) {
  const Eigen::Index first = kBristles + static_cast<Eigen::Index>(drum) * kDrumBristles;
  for (std::size_t i = 0; i < kDrumStripsMax; ++i) {
    y[at(first, i)] = bristles.along[i];
    y[at(first + kDrumStripsMax, i)] = bristles.across[i];
  }
}

HydrostaticState drive_of(const RollerVector& y) {
  return {{y[kPressure], y[kPressure + 1]}, y[kEngine], y[kSwash]};
}

void put_drive(const HydrostaticState& state, RollerVector& y) {
  y[kPressure] = state.pressure_pa[0];
  y[kPressure + 1] = state.pressure_pa[1];
  y[kEngine] = state.engine_speed_radps;
  y[kSwash] = state.swash;
}

}  // namespace

/// One step's equations.
class RollerStages {
 public:
  RollerStages(const RollerDynamics& dynamics, double h, const RollerLoads& loads,
               const HydrostaticDrive& drive);

  [[nodiscard]] RollerVector start(const RollerVelocity& velocity) const;
  /// Rates at the start (0), the middle (1) or the end (2) of the step; false: a limit is met.
  [[nodiscard]] bool rates(std::size_t instant, const RollerVector& y, RollerVector& rate) const;
  /// Prepares the matrix of ROS2 at the start.
  void linearise(const RollerVector& y);
  /// (1 - gamma h A) k = right.
  [[nodiscard]] RollerVector solve(const RollerVector& right) const;
  [[nodiscard]] DrumInstant drum_at(std::size_t instant, std::size_t drum,
                                    const RollerVector& y) const;

 private:
  const RollerDynamics* dynamics_;
  const RollerLoads* loads_;
  const HydrostaticDrive* drive_;
  double h_;
  double motor_friction_;
  RollerVelocity mass_;
  std::array<double, 2> slowest_mps_{};
  // Of the matrix.
  double ahead_s_ = 0.0;
  std::array<DrumTangent, 2> tangent_;
  std::array<double, 2> lag_scale_{1.0, 1.0};  // Engine, swash.
  HydrostaticSlopes slopes_;
  double pressure_scale_ = 1.0;
  Eigen::LLT<Eigen::Matrix<double, 5, 5>> matrix_;
};

RollerStages::RollerStages(const RollerDynamics& dynamics, double h, const RollerLoads& loads,
                           const HydrostaticDrive& drive)
    : dynamics_(&dynamics), loads_(&loads), drive_(&drive), h_(h) {
  const RollerParameters& p = dynamics.parameters_;
  motor_friction_ = drive.parameters().bypass ? 0.0 : drive.parameters().motor_friction_nmsprad;
  mass_ << loads.mass.mass_kg, loads.mass.mass_kg, loads.mass.yaw_inertia_kgm2,
      p.drum.spin_inertia_kgm2, p.drum.spin_inertia_kgm2;
  // Friction that turns with its velocity is as stiff as limit / speed: bounded by the step.
  const double mobility =
      p.drum.radius_m * p.drum.radius_m / p.drum.spin_inertia_kgm2 + 2.0 / loads.mass.mass_kg;
  for (std::size_t i = 0; i < 2; ++i) {
    double limit_n = 0.0;
    for (const double strip_n : loads.drum[i].limit_n) {
      limit_n += strip_n;
    }
    slowest_mps_[i] = h * mobility * limit_n;
  }
}

RollerVector RollerStages::start(const RollerVelocity& velocity) const {
  RollerVector y = RollerVector::Zero();
  y.segment<5>(kVelocity) = velocity;
  put_drive(drive_->state(), y);
  for (std::size_t i = 0; i < 2; ++i) {
    y[at(kBrake, i)] = dynamics_->brakes_[i].deflection_rad();
    y[at(kRolling, i)] = dynamics_->rolling_[i].deflection_rad();
    put_bristles(dynamics_->drums_[i].bristles(), i, y);
  }
  return y;
}

DrumInstant RollerStages::drum_at(std::size_t instant, std::size_t drum,
                                  const RollerVector& y) const {
  // Velocity from the axes at the step's start into those turned by the yaw since then.
  const double c = std::cos(y[kPlace + 2]);
  const double s = std::sin(y[kPlace + 2]);
  const SteerInstant& steer = loads_->steer[instant][drum];
  return {steer.angle_rad,
          steer.rate_radps,
          {c * y[kVelocity] + s * y[kVelocity + 1], c * y[kVelocity + 1] - s * y[kVelocity],
           y[kVelocity + 2], y[at(kVelocity + 3, drum)]}};
}

bool RollerStages::rates(std::size_t instant, const RollerVector& y, RollerVector& rate) const {
  rate.setZero();
  rate.segment<3>(kPlace) = y.segment<3>(kVelocity);
  const HydrostaticState state = drive_of(y);
  const HydrostaticState change = drive_->rates(state, 0.5 * h_ * static_cast<double>(instant),
                                                {y[kVelocity + 3], y[kVelocity + 4]});
  put_drive(change, rate);
  bool fine = true;
  Eigen::Vector3d body = loads_->supplement;
  for (std::size_t i = 0; i < 2; ++i) {
    const DrumInstant drum = drum_at(instant, i, y);
    Eigen::Vector4d force;
    DrumBristles bristles;
    fine = dynamics_->drums_[i].rates(loads_->drum[i], drum, bristles_of(y, i), slowest_mps_[i],
                                      force, bristles) &&
           fine;
    put_bristles(bristles, i, rate);
    body += force.head<3>();
    double brake_nm = 0.0;
    double rolling_nm = 0.0;
    fine = dynamics_->brakes_[i].rates(loads_->brake_limit_nm[i], y[at(kBrake, i)],
                                       drum.velocity[3], brake_nm, rate[at(kBrake, i)]) &&
           fine;
    fine = dynamics_->rolling_[i].rates(loads_->rolling_limit_nm[i], y[at(kRolling, i)],
                                        drum.velocity[3], rolling_nm, rate[at(kRolling, i)]) &&
           fine;
    rate[at(kVelocity + 3, i)] =
        force[3] + brake_nm + rolling_nm - motor_friction_ * drum.velocity[3];
  }
  const double relief = drive_->pressure_limit_pa();
  for (std::size_t i = 0; i < drive_->circuits(); ++i) {
    const double p = state.pressure_pa[i];
    fine = fine && std::abs(p) <= relief &&
           (relief == 0.0 || std::abs(p) < relief || p * change.pressure_pa[i] < 0.0);
    const std::array<double, 2> d = drive_->displacement_m3prad(i);
    // Motors' torque D p.
    rate[kVelocity + 3] += d[0] * p;
    rate[kVelocity + 4] += d[1] * p;
  }
  // Newton and Euler: the ground's forces turned back into the axes at the start, over the masses.
  const double c = std::cos(y[kPlace + 2]);
  const double s = std::sin(y[kPlace + 2]);
  rate[kVelocity] = c * body[0] - s * body[1] + mass_[0] * loads_->gravity_mps2[0];
  rate[kVelocity + 1] = s * body[0] + c * body[1] + mass_[1] * loads_->gravity_mps2[1];
  rate[kVelocity + 2] = body[2];
  rate.segment<5>(kVelocity) = rate.segment<5>(kVelocity).cwiseQuotient(mass_);
  return fine;
}

void RollerStages::linearise(const RollerVector& y) {
  ahead_s_ = kGamma * h_;
  const HydrostaticDriveParameters& p = drive_->parameters();
  // A lag eliminated: 1 / (1 + gamma h / tau).
  const auto lag = [this](double time_constant_s) {
    return time_constant_s > 0.0 ? 1.0 / (1.0 + ahead_s_ / time_constant_s) : 1.0;
  };
  lag_scale_ = {lag(p.engine_time_constant_s), lag(p.swash_time_constant_s)};
  // M + gamma h G of strips, brakes and motors, bristles eliminated.
  Eigen::Matrix<double, 5, 5> A = mass_.asDiagonal();
  for (std::size_t i = 0; i < 2; ++i) {
    const DrumInstant drum = drum_at(0, i, y);
    tangent_[i] = dynamics_->drums_[i].tangent(loads_->drum[i], drum);
    const Eigen::Matrix4d gain =
        ahead_s_ * dynamics_->drums_[i].stage(tangent_[i], ahead_s_, {}).gain;
    const Eigen::Index w = at(3, i);
    A.topLeftCorner<3, 3>() += gain.topLeftCorner<3, 3>();
    A.block<3, 1>(0, w) += gain.topRightCorner<3, 1>();
    A.block<1, 3>(w, 0) += gain.bottomLeftCorner<1, 3>();
    A(w, w) +=
        gain(3, 3) +
        ahead_s_ * (motor_friction_ +
                    dynamics_->brakes_[i].stage(loads_->brake_limit_nm[i], ahead_s_, 0.0).gain +
                    dynamics_->rolling_[i].stage(loads_->rolling_limit_nm[i], ahead_s_, 0.0).gain);
  }
  if (!p.bypass) {
    slopes_ = drive_->slopes(drive_of(y));
    pressure_scale_ = 1.0 / (1.0 + ahead_s_ * slopes_.decay_per_s);
    for (std::size_t i = 0; i < drive_->circuits(); ++i) {
      const std::array<double, 2> each = drive_->displacement_m3prad(i);
      const Eigen::Vector2d d(each[0], each[1]);
      // Oil: (gamma h)^2 d d^T / (C (1 + gamma h decay)), the pressure eliminated.
      A.bottomRightCorner<2, 2>() +=
          (ahead_s_ * ahead_s_ * pressure_scale_ / drive_->capacity_m3ppa()) * d * d.transpose();
    }
  }
  matrix_.compute(A);
}

RollerVector RollerStages::solve(const RollerVector& right) const {
  RollerVector k = right;
  k[kEngine] *= lag_scale_[0];
  k[kSwash] *= lag_scale_[1];
  // Right-hand sides of all that is eliminated, carried over to the five velocities.
  RollerVelocity b = mass_.cwiseProduct(right.segment<5>(kVelocity));
  for (std::size_t i = 0; i < 2; ++i) {
    const DrumForces drum =
        dynamics_->drums_[i].stage(tangent_[i], ahead_s_, bristles_of(right, i));
    b.head<3>() += ahead_s_ * drum.offset.head<3>();
    b[at(3, i)] +=
        ahead_s_ * (drum.offset[3] +
                    dynamics_->brakes_[i]
                        .stage(loads_->brake_limit_nm[i], ahead_s_, right[at(kBrake, i)])
                        .offset +
                    dynamics_->rolling_[i]
                        .stage(loads_->rolling_limit_nm[i], ahead_s_, right[at(kRolling, i)])
                        .offset);
  }
  const bool oil = !drive_->parameters().bypass;
  // Engine and swash do not wait for the pressures.
  const double fed =
      ahead_s_ * (slopes_.per_engine_pa * k[kEngine] + slopes_.per_swash_paps * k[kSwash]);
  for (std::size_t i = 0; oil && i < drive_->circuits(); ++i) {
    const std::array<double, 2> d = drive_->displacement_m3prad(i);
    const double share = ahead_s_ * pressure_scale_ * (right[at(kPressure, i)] + fed);
    b[3] += d[0] * share;
    b[4] += d[1] * share;
  }
  // Back: bristles, brakes and pressures from the velocities found.
  const RollerVelocity v = matrix_.solve(b);
  k.segment<5>(kVelocity) = v;
  for (std::size_t i = 0; i < 2; ++i) {
    const double w = v[at(3, i)];
    put_bristles(dynamics_->drums_[i].stage_bristles(tangent_[i], ahead_s_, bristles_of(right, i),
                                                     {v[0], v[1], v[2], w}),
                 i, k);
    k[at(kBrake, i)] +=
        dynamics_->brakes_[i].follows(loads_->brake_limit_nm[i]) ? ahead_s_ * w : 0.0;
    k[at(kRolling, i)] +=
        dynamics_->rolling_[i].follows(loads_->rolling_limit_nm[i]) ? ahead_s_ * w : 0.0;
  }
  for (std::size_t i = 0; oil && i < 2; ++i) {
    const std::array<double, 2> d = drive_->displacement_m3prad(drive_->divided() ? i : 0);
    k[at(kPressure, i)] =
        pressure_scale_ * (right[at(kPressure, i)] + fed -
                           ahead_s_ / drive_->capacity_m3ppa() * (d[0] * v[3] + d[1] * v[4]));
  }
  return k;
}

bool RollerDynamics::smooth_step(IntegrationScheme scheme, double h, const RollerLoads& loads,
                                 HydrostaticDrive& drive, RollerVelocity& velocity,
                                 Eigen::Vector3d& moved) {
  RollerStages stages(*this, h, loads, drive);
  RollerVector y = stages.start(velocity);
  RollerVector k1;
  RollerVector k2;
  ++smooth_tried_;
  if (!stages.rates(0, y, k1)) {
    return false;
  }
  if (scheme == IntegrationScheme::runge_kutta4) {
    RollerVector k3;
    RollerVector k4;
    if (!stages.rates(1, y + (0.5 * h) * k1, k2) || !stages.rates(1, y + (0.5 * h) * k2, k3) ||
        !stages.rates(2, y + h * k3, k4)) {
      return false;
    }
    // Classical Runge-Kutta.
    y += (h / 6.0) * (k1 + 2.0 * (k2 + k3) + k4);
  } else {
    stages.linearise(y);
    k1 = stages.solve(k1);
    if (!stages.rates(2, y + h * k1, k2)) {
      return false;
    }
    k2 = stages.solve(k2 - 2.0 * k1);
    // ROS2 (Verwer et al. 1999): y + h (3 k1 + k2) / 2.
    y += h * (1.5 * k1 + 0.5 * k2);
  }
  ++smooth_steps_;
  moved = y.segment<3>(kPlace);
  velocity = y.segment<5>(kVelocity);
  for (std::size_t i = 0; i < 2; ++i) {
    const double rate = velocity[static_cast<Eigen::Index>(3 + i)];
    drums_[i].adopt(loads.drum[i], stages.drum_at(2, i, y), bristles_of(y, i));
    brakes_[i].adopt(loads.brake_limit_nm[i], y[at(kBrake, i)], rate);
    rolling_[i].adopt(loads.rolling_limit_nm[i], y[at(kRolling, i)], rate);
  }
  drive.advance(h, drive_of(y));
  return true;
}

}  // namespace rigwire::sim
