#include "sim/vehicle/full_vehicle.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr int kMostPasses = 12;
constexpr double kLocked_nm = 1e12;  // Brakes while the vehicle is put on its wheels.

constexpr std::array<const char*, kVelocities> kPartNames{"body",
                                                          "body",
                                                          "body",
                                                          "body",
                                                          "body",
                                                          "body",
                                                          "front axle",
                                                          "front axle",
                                                          "rear axle",
                                                          "rear axle",
                                                          "front left wheel",
                                                          "front right wheel",
                                                          "rear left wheel",
                                                          "rear right wheel"};

constexpr const char* quantity_name(std::size_t i) {
  if (i < 3) {
    return "acceleration";
  }
  return i < kBodyVelocities
             ? "angular acceleration"
             : (i < kWheelVelocity ? "suspension acceleration" : "wheel acceleration");
}

/// I v of a body of revolution: t v + (a - t) (axis.v) axis.
Vector3d inertia_times(const UnsprungMass& part, const Vector3d& v) {
  return part.transverse_kgm2 * v +
         ((part.axial_kgm2 - part.transverse_kgm2) * part.axis.dot(v)) * part.axis;
}

constexpr double kSettling_s = 10.0;
constexpr double kSettlingStep_s = 2e-3;
// While it is placed the vehicle is heavily damped, so that it settles without overshoot: on a
// slope where it is stable, a swing would topple it. Then the damping is removed.
constexpr double kSyrup_s = 8.0;
constexpr double kSyrup_radps = 15.0;

/// Motion of a point and its frame, from their velocities and accelerations in the axes of B.
LinkMotion in_world(const Matrix3d& R_WB, const Matrix3d& R_BL, const Vector3d& p_W,
                    const Vector3d& v_B, const Vector3d& w_B, const Vector3d& a_B,
                    const Vector3d& alpha_B) {
  LinkMotion link;
  link.X_WL.linear() = R_WB * R_BL;
  link.X_WL.translation() = p_W;
  link.v_WL_W = R_WB * v_B;
  link.w_WL_W = R_WB * w_B;
  link.a_WL_W = R_WB * a_B;
  link.alpha_WL_W = R_WB * alpha_B;
  return link;
}

double carried_kg(const WheeledVehicleParameters& parameters, std::size_t axle) {
  // Weighed with standard gravity, so that the bristles do not depend on the machine's gravity.
  WheeledVehicleParameters weighed = parameters;
  weighed.gravity_mps2 = 9.80665;
  return static_loads(weighed).wheel_n[axle] / 9.80665;
}

Vector3d part_of(const Velocities& v, std::size_t first) {
  return {v[first], v[first + 1], v[first + 2]};
}

}  // namespace

void FullVehicle::update_kinematics(const Vector3d& w_B) {
  for (std::size_t i = 0; i < 2; ++i) {
    axles_[i].update(Vector2d(state_.suspension[2 * i], state_.suspension[2 * i + 1]),
                     Vector2d(state_.suspension_rate[2 * i], state_.suspension_rate[2 * i + 1]),
                     w_B, steer_rad(i));
  }
}

void FullVehicle::add_mass(double mass_kg, const UnsprungMass& part, std::size_t axle, double h,
                           const Vector3d& gravity_B) {
  auto& A = base_.matrix;
  auto& b = base_.right;
  const Vector3d& c = part.position_m;
  const double m = mass_kg;
  const double mx = m * c.x();
  const double my = m * c.y();
  const double mz = m * c.z();
  // Newton-Euler of one rigid body about C: [m 1, -m [c]x; m [c]x, I - m [c]x [c]x].
  for (std::size_t i = 0; i < 3; ++i) {
    A[i][i] += m;
  }
  // m [c]x below the diagonal block.
  A[3][1] -= mz;
  A[3][2] += my;
  A[4][0] += mz;
  A[4][2] -= mx;
  A[5][0] -= my;
  A[5][1] += mx;
  // Steiner: own inertia t 1 + (a - t) axis axis^T, plus m (c.c 1 - c c^T); lower triangle.
  const double t = part.transverse_kgm2;
  const double d = part.axial_kgm2 - t;
  const Vector3d& a = part.axis;
  A[3][3] += t + d * a.x() * a.x() + my * c.y() + mz * c.z();
  A[4][3] += d * a.y() * a.x() - mx * c.y();
  A[4][4] += t + d * a.y() * a.y() + mx * c.x() + mz * c.z();
  A[5][3] += d * a.z() * a.x() - mx * c.z();
  A[5][4] += d * a.z() * a.y() - my * c.z();
  A[5][5] += t + d * a.z() * a.z() + mx * c.x() + my * c.y();

  // d'Alembert: weight less m a_bias, and minus d/dt (I w), with no coordinate accelerating.
  const Vector3d force = m * (gravity_B - part.bias_mps2);
  const Vector3d turn =
      -(inertia_times(part, part.bias_radps2) + part.rate.cross(inertia_times(part, part.rate)));
  const Vector3d torque = c.cross(force) + turn;
  for (std::size_t i = 0; i < 3; ++i) {
    b[i] += h * force[static_cast<Eigen::Index>(i)];
    b[i + 3] += h * torque[static_cast<Eigen::Index>(i)];
  }
  // The axle's two equations by virtual power (Jourdain): partial velocities J give J^T M J, J^T f.
  const std::size_t s = kBodyVelocities + 2 * axle;
  std::array<Vector3d, 2> linear;
  std::array<Vector3d, 2> angular;
  for (std::size_t k = 0; k < 2; ++k) {
    linear[k] = m * part.velocity_by_s[k];
    angular[k] = inertia_times(part, part.rate_by_s[k]);
    const Vector3d moment = c.cross(linear[k]) + angular[k];
    for (std::size_t i = 0; i < 3; ++i) {
      A[s + k][i] += linear[k][static_cast<Eigen::Index>(i)];
      A[s + k][i + 3] += moment[static_cast<Eigen::Index>(i)];
    }
    b[s + k] += h * (part.velocity_by_s[k].dot(force) + part.rate_by_s[k].dot(turn));
  }
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t j = 0; j <= k; ++j) {
      A[s + k][s + j] += part.velocity_by_s[k].dot(linear[j]) + part.rate_by_s[k].dot(angular[j]);
    }
  }
}

void FullVehicle::add_suspension(double h, const Velocities& start) {
  for (std::size_t i = 0; i < 2; ++i) {
    // Linearly implicit springs and dampers: h D + h^2 K on the left, h (f - h K s') on the right.
    const std::size_t s = kBodyVelocities + 2 * i;
    const Vector2d rate(start[s], start[s + 1]);
    const SuspensionForce f =
        axles_[i].force(Vector2d(state_.suspension[2 * i], state_.suspension[2 * i + 1]), rate);
    const double cross = h * f.cross_stiffness;
    const double first = h * f.stiffness[0];
    const double second = h * f.stiffness[1];
    base_.matrix[s][s] += h * (first + f.damping[0]);
    base_.matrix[s + 1][s + 1] += h * (second + f.damping[1]);
    base_.matrix[s + 1][s] += h * cross;
    base_.right[s] += h * (f.force[0] - first * rate[0] - cross * rate[1]);
    base_.right[s + 1] += h * (f.force[1] - second * rate[1] - cross * rate[0]);
  }
}

void FullVehicle::assemble(double h, const Vector3d& w_B, const Velocities& start) {
  base_ = {};
  auto& A = base_.matrix;
  auto& b = base_.right;
  const Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  const Vector3d gravity_B = -parameters_.gravity_mps2 * R_WB.row(2).transpose();

  // Sprung body: weight, quadratic air drag, Euler's -w x I w in its principal axes.
  const SprungBodyParameters& body = parameters_.body;
  const Vector3d& I = body.principal_inertia_kgm2;
  const Vector3d v_B(start[0], start[1], start[2]);
  const Vector3d force =
      body.mass_kg * gravity_B - (parameters_.air_drag_ns2pm2 * v_B.norm()) * v_B;
  Vector3d torque = -w_B.cross(I.cwiseProduct(w_B));

  for (std::size_t i = 0; i < 2; ++i) {
    for (int k = 0; k < axles_[i].masses(); ++k) {
      const UnsprungMass& part = axles_[i].mass(k);
      add_mass(part.mass_kg, part, i, h, gravity_B);
    }
  }
  // What keeps the wheels' angular momentum turning with the carriers acts back on them.
  for (std::size_t i = 0; i < kWheels; ++i) {
    const WheelFrame& frame = axles_[i / 2].wheel(i % 2);
    const double spin_inertia = wheel_terms_[i].spin_inertia_kgm2();
    // d/dt (J spin axis) of a wheel: J spin (rate x axis) across the axle, J bias along it.
    const double bias = -h * spin_inertia * frame.axis.dot(frame.bias_radps2);
    const double spin = spin_inertia * (start[kWheelVelocity + i] + frame.axis.dot(frame.rate));
    const Vector3d gyro = -spin * frame.rate.cross(frame.axis);
    const Vector3d whole = h * gyro + bias * frame.axis;
    for (std::size_t k = 0; k < 3; ++k) {
      b[3 + k] += whole[static_cast<Eigen::Index>(k)];
    }
    const std::size_t s = kBodyVelocities + 2 * (i / 2);
    b[s] += frame.rate_by_s[0].dot(whole);
    b[s + 1] += frame.rate_by_s[1].dot(whole);
    b[kWheelVelocity + i] += bias;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    A[i][i] += body.mass_kg;
    A[i + 3][i + 3] += I[k];
    b[i] += h * force[k];
    b[i + 3] += h * torque[k];
  }
}

void FullVehicle::add_syrup(double h, const Velocities& start) {
  // Rayleigh's damping in proportion to mass: alpha M v, taken at the end of the step.
  for (std::size_t i = 0; i < kWheelVelocity; ++i) {
    for (std::size_t j = 0; j < kWheelVelocity; ++j) {
      base_.right[i] -= h * syrup_radps_ * base_.matrix[std::max(i, j)][std::min(i, j)] * start[j];
    }
  }
  for (std::size_t i = 0; i < kWheelVelocity; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      base_.matrix[i][j] *= 1.0 + h * syrup_radps_;
    }
  }
}

void FullVehicle::contacts(double h, const Velocities& start) {
  const Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  for (std::size_t i = 0; i < kWheels; ++i) {
    const WheelFrame& frame = axles_[i / 2].wheel(i % 2);
    const auto contact = ground_->wheel_contact(state_.p_WC + R_WB * frame.hub_m, R_WB * frame.axis,
                                                axle(i / 2).tyre.unloaded_radius_m);
    wheel_terms_[i].begin(h, frame, R_WB, contact, *ground_, tyre_pressure_pa(i),
                          settling_ ? kLocked_nm : brake_limit_nm(i), start);
  }
  meet_obstacles(h, start);
}

/// Computes pose and velocity of body, axles and wheels for the contact, v_C + w x p plus the rates
/// of suspension and spin, and for each contact point its row of the velocity system.
void FullVehicle::meet_obstacles(double h, const Velocities& start) {
  near_ = contact_.near(h, state_.v_WC_W.norm() + 2.0 * reach_m_ * state_.w_WB_B.norm() + 0.1);
  if (!near_) {
    return;
  }
  const Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  const Vector3d v_C = part_of(start, 0);
  const Vector3d w = part_of(start, 3);
  const Vector3d origin = -parameters_.body.center_of_mass_m;
  const auto put = [&](ContactLink& link, const Vector3d& p, const Matrix3d& R_BL,
                       const Vector3d& v_B, const Vector3d& w_B) {
    link.X_WL.linear() = R_WB * R_BL;
    link.X_WL.translation() = state_.p_WC + R_WB * p;
    link.v_WL_W = R_WB * v_B;
    link.w_WL_W = R_WB * w_B;
  };
  put(contact_links_[0], origin, Matrix3d::Identity(), v_C + w.cross(origin), w);
  for (std::size_t i = 0; i < kWheels; ++i) {
    const WheelFrame& frame = axles_[i / 2].wheel(i % 2);
    const double r0 = state_.suspension_rate[2 * (i / 2)];
    const double r1 = state_.suspension_rate[2 * (i / 2) + 1];
    put(contact_links_[3 + i], frame.hub_m, frame.R_BH(),
        v_C + w.cross(frame.hub_m) + frame.velocity_by_s[0] * r0 + frame.velocity_by_s[1] * r1,
        frame.rate + state_.wheel_rate_radps[i] * frame.axis);
  }
  std::array<WheelFrame, 2> carriers;
  for (std::size_t i = 0; i < 2; ++i) {
    carriers[i] = axles_[i].carrier();
    const double r0 = state_.suspension_rate[2 * i];
    const double r1 = state_.suspension_rate[2 * i + 1];
    put(contact_links_[1 + i], carriers[i].hub_m, axles_[i].R_BA(),
        v_C + w.cross(carriers[i].hub_m) + carriers[i].velocity_by_s[0] * r0 +
            carriers[i].velocity_by_s[1] * r1,
        carriers[i].rate);
  }
  contact_.begin(h, contact_links_);
  contact_rows_.clear();
  for (ContactPoint& point : contact_.points()) {
    const Vector3d p_C = R_WB.transpose() * (point.p_W - state_.p_WC);
    if (point.link == 0) {
      contact_rows_.push_back(contact_rows(point, R_WB, p_C, nullptr, 0));
    } else if (point.link < 3) {
      contact_rows_.push_back(
          contact_rows(point, R_WB, p_C, &carriers[point.link - 1], 2 * (point.link - 1)));
    } else {
      const std::size_t index = point.link - 3;
      contact_rows_.push_back(
          contact_rows(point, R_WB, p_C, &axles_[index / 2].wheel(index % 2), index));
    }
    point.begin(h, contact_rows_.back().of(start));
  }
}

void FullVehicle::inner_step(double h) {
  if (!settling_) {
    WheelVector rates(state_.wheel_rate_radps.data());
    driveline_->begin(h, wheel_terms_[0].spin_inertia_kgm2(), rates);
    for (std::size_t i = 0; i < kWheels; ++i) {
      state_.wheel_rate_radps[i] = rates[static_cast<Eigen::Index>(i)];
    }
  }
  const Vector3d& w = state_.w_WB_B;
  // Euler's equation free of torque, half a step ahead: w_mid = w - (h / 2) I^-1 (w x I w).
  half_turn_ = -0.5 * h * (whole_inertia_inverse_ * w.cross(whole_inertia_ * w));
  const Vector3d w_mid = w + half_turn_;
  update_kinematics(w_mid);

  Velocities start;
  const Vector3d v_B = state_.q_WB.conjugate() * state_.v_WC_W;
  for (std::size_t i = 0; i < 3; ++i) {
    start[i] = v_B[static_cast<Eigen::Index>(i)];
    start[i + 3] = w[static_cast<Eigen::Index>(i)];
  }
  for (std::size_t i = 0; i < 4; ++i) {
    start[kBodyVelocities + i] = state_.suspension_rate[i];
    start[kWheelVelocity + i] = state_.wheel_rate_radps[i];
  }
  contacts(h, start);
  assemble(h, w_mid, start);
  if (settling_) {
    add_syrup(h, start);
  }
  add_suspension(h, start);

  // (M + h sum g J^T J) dv = h (f + sum J^T F(start)), clamp last: unimog-u5023.md.
  static const SpinEquations kNoDriveline;
  Velocities change{};
  Velocities found{};
  for (passes_ = 1;; ++passes_) {
    VelocitySystem system = base_;
    for (const WheelTerms& wheel : wheel_terms_) {
      wheel.add(h, start, system);
    }
    if (near_) {
      add_contacts(h, start, contact_.points(), contact_rows_, system);
    }
    const SpinEquations& drive = settling_ ? kNoDriveline : driveline_->equations();
    if (!settling_) {
      system.add_wheels(drive.inertia + h * drive.damping, h * drive.torque_nm);
    }
    change = system.solve(drive.basis, drive.coordinates);
    for (std::size_t i = 0; i < kVelocities; ++i) {
      found[i] = start[i] + change[i];
    }
    if (passes_ >= kMostPasses) {
      break;
    }
    bool changed = near_ && contacts_change(found, contact_.points(), contact_rows_);
    for (WheelTerms& wheel : wheel_terms_) {
      changed = wheel.changes(found) || changed;
    }
    if (!changed && !settling_) {
      changed = !driveline_->accept(h, WheelVector(&found[kWheelVelocity]));
    }
    if (!changed) {
      break;
    }
  }
  if (finite(change)) {
    advance(h, found, change);
  }
}

bool FullVehicle::finite(const Velocities& change) {
  for (std::size_t i = 0; i < kVelocities; ++i) {
    if (!std::isfinite(change[i])) {
      record_non_finite(quantity_name(i), kPartNames[i]);
      return false;
    }
  }
  return true;
}

void FullVehicle::advance(double h, const Velocities& found, const Velocities& change) {
  for (std::size_t i = 0; i < kVelocities; ++i) {
    acceleration_[i] = change[i] / h;
  }
  for (std::size_t i = 0; i < kWheels; ++i) {
    // Linearly implicit Euler: suspension and wheel angles go with the velocities found.
    wheel_terms_[i].settle(h, found, wheels_[i]);
    if (!settling_) {
      wheel_terms_[i].press(*ground_);
    }
    state_.suspension_rate[i] = found[kBodyVelocities + i];
    state_.suspension[i] += h * state_.suspension_rate[i];
    state_.wheel_rate_radps[i] = found[kWheelVelocity + i];
    state_.wheel_angle_rad[i] += h * state_.wheel_rate_radps[i];
    if (std::abs(state_.wheel_angle_rad[i]) > std::numbers::pi) {
      state_.wheel_angle_rad[i] = std::remainder(state_.wheel_angle_rad[i], 2.0 * std::numbers::pi);
    }
  }
  suspension_ = state_.suspension;
  if (near_) {
    contact_.settle(h, [&](const ContactPoint& point) {
      return contact_rows_[static_cast<std::size_t>(&point - contact_.points().data())].of(found);
    });
  }
  state_.v_WC_W = state_.q_WB * Vector3d(found[0], found[1], found[2]);
  state_.p_WC += h * state_.v_WC_W;
  state_.w_WB_B = Vector3d(found[3], found[4], found[5]);
  // Exponential map of the step's mean rate: q (cos |turn|/2, sin(|turn|/2) turn/|turn|).
  const Vector3d turn = h * (state_.w_WB_B - half_turn_);
  const double angle = turn.norm();
  const double half_sine = angle > 1e-8 ? std::sin(0.5 * angle) / angle : 0.5;
  state_.q_WB = state_.q_WB * Eigen::Quaterniond(std::cos(0.5 * angle), half_sine * turn.x(),
                                                 half_sine * turn.y(), half_sine * turn.z());
  state_.q_WB.normalize();
  if (!settling_) {
    driveline_->finish(h, WheelVector(&found[kWheelVelocity]));
  }
}

// Placing the full vehicle, and its links' motion.

FullVehicle::FullVehicle(const WheeledVehicleParameters& parameters, const Ground& ground,
                         std::unique_ptr<Driveline> driveline, const VehiclePlace& place)
    : WheeledVehicle(parameters, ground, std::move(driveline)),
      axles_{AxleSuspension(parameters.front, true, parameters.body.center_of_mass_m,
                            static_.wheel_height_m[0], static_.spring_n[0]),
             AxleSuspension(parameters.rear, false, parameters.body.center_of_mass_m,
                            static_.wheel_height_m[1], static_.spring_n[1])},
      wheel_terms_{WheelTerms(parameters.front, carried_kg(parameters, 0), 0,
                              parameters.brake_stiffness_nmprad),
                   WheelTerms(parameters.front, carried_kg(parameters, 0), 1,
                              parameters.brake_stiffness_nmprad),
                   WheelTerms(parameters.rear, carried_kg(parameters, 1), 2,
                              parameters.brake_stiffness_nmprad),
                   WheelTerms(parameters.rear, carried_kg(parameters, 1), 3,
                              parameters.brake_stiffness_nmprad)} {
  contact_rows_.reserve(kMostContactPoints);
  update_kinematics(Vector3d::Zero());
  // About the common centre of mass; it moves with the suspension, which the prediction neglects.
  Matrix3d inertia = parameters.body.principal_inertia_kgm2.asDiagonal();
  double mass = parameters.body.mass_kg;
  Vector3d moment = Vector3d::Zero();
  const auto add = [&](double m, const Vector3d& c, const Matrix3d& own) {
    // Steiner, from the part's centre of mass to C.
    inertia += own + m * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
    mass += m;
    moment += m * c;
  };
  for (std::size_t i = 0; i < 2; ++i) {
    for (int k = 0; k < axles_[i].masses(); ++k) {
      const UnsprungMass& part = axles_[i].mass(k);
      Matrix3d own = part.transverse_kgm2 * Matrix3d::Identity();
      own += (part.axial_kgm2 - part.transverse_kgm2) * part.axis * part.axis.transpose();
      add(part.mass_kg, part.position_m, own);
    }
  }
  // Steiner back, from C to the common centre of mass.
  const Vector3d c = moment / mass;
  inertia -= mass * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
  whole_inertia_ = inertia;
  whole_inertia_inverse_ = inertia.inverse();
  stand(place);
}

void FullVehicle::stand(const VehiclePlace& place) {
  const Eigen::Isometry3d X_WB = place_on_ground(*ground_, parameters_, place);
  state_ = {};
  state_.q_WB = Eigen::Quaterniond(X_WB.linear()).normalized();
  state_.p_WC = X_WB * parameters_.body.center_of_mass_m;
  if (parameters_.gravity_mps2 > 0.0) {
    // Dynamic relaxation: the damped equations with locked brakes for 10 s, then all rates dropped.
    settling_ = true;
    const auto steps = static_cast<int>(kSettling_s / kSettlingStep_s);
    for (int i = 0; i < steps && !non_finite(); ++i) {
      syrup_radps_ = i * kSettlingStep_s < kSyrup_s ? kSyrup_radps : 0.0;
      inner_step(kSettlingStep_s);
    }
    settling_ = false;
    for (const WheelTerms& wheel : wheel_terms_) {
      wheel.press(*ground_);
    }
    state_.v_WC_W.setZero();
    state_.w_WB_B.setZero();
    state_.suspension_rate = {};
    state_.wheel_rate_radps = {};
    state_.wheel_angle_rad = {};
    acceleration_ = {};
  }
  update_links();
}

void FullVehicle::start_rolling(double speed_mps) {
  state_.v_WC_W = speed_mps * (state_.q_WB * Vector3d::UnitX());
  for (std::size_t i = 0; i < kWheels; ++i) {
    // Rolling without slip, rate = v / r.
    const double radius = wheels_[i].rolling_radius_m > 0.0 ? wheels_[i].rolling_radius_m
                                                            : axle(i / 2).tyre.unloaded_radius_m;
    state_.wheel_rate_radps[i] = speed_mps / radius;
    wheels_[i].rate_radps = state_.wheel_rate_radps[i];
  }
  update_links();
}

void FullVehicle::set_state(const FullVehicleState& state) {
  state_ = state;
  state_.q_WB.normalize();
  contact_.forget();
  suspension_ = state.suspension;
  acceleration_ = {};
  update_links();
}

void FullVehicle::update_links() {
  update_kinematics(state_.w_WB_B);
  const Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  const Vector3d& w = state_.w_WB_B;
  const Vector3d v_C = R_WB.transpose() * state_.v_WC_W;
  const Vector3d a_C = part_of(acceleration_, 0);
  const Vector3d alpha = part_of(acceleration_, 3);

  const Vector3d origin = -parameters_.body.center_of_mass_m;
  // Rigid body, from C to B's origin: v + w x r, a + alpha x r + w x (w x r).
  links_[0] =
      in_world(R_WB, Matrix3d::Identity(), state_.p_WC + R_WB * origin, v_C + w.cross(origin), w,
               a_C + alpha.cross(origin) + w.cross(w.cross(origin)), alpha);

  // A part on two coordinates: partial velocities times their rates, bias = Coriolis, centripetal.
  const auto moving = [&](const Vector3d& p, const std::array<Vector3d, 2>& by_s,
                          const std::array<Vector3d, 2>& rate_by_s, const Vector3d& bias,
                          const Vector3d& bias_rate, const Vector3d& rate, std::size_t axle,
                          const Matrix3d& R_BL) {
    const std::size_t s = 2 * axle;
    const double r0 = state_.suspension_rate[s];
    const double r1 = state_.suspension_rate[s + 1];
    const double a0 = acceleration_[kBodyVelocities + s];
    const double a1 = acceleration_[kBodyVelocities + s + 1];
    return in_world(R_WB, R_BL, state_.p_WC + R_WB * p,
                    v_C + w.cross(p) + by_s[0] * r0 + by_s[1] * r1, rate,
                    a_C + alpha.cross(p) + by_s[0] * a0 + by_s[1] * a1 + bias,
                    alpha + rate_by_s[0] * a0 + rate_by_s[1] * a1 + bias_rate);
  };
  for (std::size_t i = 0; i < 2; ++i) {
    const WheelFrame part = axles_[i].carrier();
    links_[1 + i] = moving(part.hub_m, part.velocity_by_s, part.rate_by_s, part.bias_mps2,
                           part.bias_radps2, part.rate, i, axles_[i].R_BA());
  }
  for (std::size_t i = 0; i < kWheels; ++i) {
    const WheelFrame& frame = axles_[i / 2].wheel(i % 2);
    const double spin = state_.wheel_rate_radps[i];
    const Matrix3d turned =
        frame.R_BH() *
        Eigen::AngleAxisd(state_.wheel_angle_rad[i], Vector3d::UnitY()).toRotationMatrix();
    // Spin on a turning axle: alpha = bias + spin (rate x axis) + spin' axis.
    const Vector3d bias_rate = frame.bias_radps2 + spin * frame.rate.cross(frame.axis) +
                               acceleration_[kWheelVelocity + i] * frame.axis;
    links_[3 + i] = moving(frame.hub_m, frame.velocity_by_s, frame.rate_by_s, frame.bias_mps2,
                           bias_rate, frame.rate + spin * frame.axis, i / 2, turned);
  }
}

VehicleMomentum FullVehicle::momentum() const {
  VehicleMomentum sum;
  const double g = parameters_.gravity_mps2;
  const Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  const Vector3d& w = state_.w_WB_B;
  const Vector3d v_C = R_WB.transpose() * state_.v_WC_W;
  // Per body m v, p x m v + I w, (m v.v + w.I w) / 2 (Koenig's theorems) and m g z.
  const auto add = [&](double m, const Vector3d& p_W, const Vector3d& v_B, const Vector3d& spin_B,
                       const Vector3d& rate_B) {
    const Vector3d v_W = R_WB * v_B;
    sum.linear_W += m * v_W;
    sum.angular_W += m * p_W.cross(v_W) + R_WB * spin_B;
    sum.kinetic_j += 0.5 * m * v_W.squaredNorm() + 0.5 * spin_B.dot(rate_B);
    sum.potential_j += m * g * p_W.z();
  };
  add(parameters_.body.mass_kg, state_.p_WC, v_C,
      parameters_.body.principal_inertia_kgm2.cwiseProduct(w), w);
  for (std::size_t i = 0; i < 2; ++i) {
    const double r0 = state_.suspension_rate[2 * i];
    const double r1 = state_.suspension_rate[2 * i + 1];
    for (int k = 0; k < axles_[i].masses(); ++k) {
      const UnsprungMass& part = axles_[i].mass(k);
      const Vector3d v =
          v_C + w.cross(part.position_m) + part.velocity_by_s[0] * r0 + part.velocity_by_s[1] * r1;
      const Vector3d rate = w + part.rate_by_s[0] * r0 + part.rate_by_s[1] * r1;
      const Vector3d spin =
          part.transverse_kgm2 * rate +
          ((part.axial_kgm2 - part.transverse_kgm2) * part.axis.dot(rate)) * part.axis;
      add(part.mass_kg, state_.p_WC + R_WB * part.position_m, v, spin, rate);
    }
    for (std::size_t side = 0; side < 2; ++side) {
      const WheelFrame& frame = axles_[i].wheel(side);
      const Vector3d carrier = w + frame.rate_by_s[0] * r0 + frame.rate_by_s[1] * r1;
      const double rate = state_.wheel_rate_radps[2 * i + side] + frame.axis.dot(carrier);
      const double inertia = wheel_terms_[2 * i].spin_inertia_kgm2();
      add(0.0, state_.p_WC, Vector3d::Zero(), inertia * rate * frame.axis, rate * frame.axis);
    }
    const VehicleAxleParameters& a = axle(i);
    // Work against springs, bars and the static preload since the design position.
    const double s0 = state_.suspension[2 * i];
    const double s1 = state_.suspension[2 * i + 1];
    if (a.type == AxleType::beam) {
      const double base2 = 0.5 * a.beam.spring_base_m * a.beam.spring_base_m;
      sum.spring_j += a.beam.spring_npm * s0 * s0 + static_.spring_n[i] * s0 +
                      0.5 * (a.beam.spring_npm * base2 + a.beam.roll_bar_nmprad) * s1 * s1;
    } else {
      sum.spring_j += 0.5 * a.independent.spring_npm * (s0 * s0 + s1 * s1) +
                      0.5 * static_.spring_n[i] * (s0 + s1) +
                      0.5 * a.independent.roll_bar_npm * (s0 - s1) * (s0 - s1);
    }
  }
  return sum;
}

}  // namespace rigwire::sim
