// Placing the full vehicle, and its links' motion.
#include <cmath>

#include "sim/vehicle/full_vehicle.h"
#include "sim/vehicle/ground_plane.h"

namespace rigwire::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSettling_s = 10.0;
constexpr double kSettlingStep_s = 2e-3;

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

Vector3d part_of(const Velocities& v, std::size_t first) {
  return {v[first], v[first + 1], v[first + 2]};
}

double carried_kg(const WheeledVehicleParameters& parameters, std::size_t axle) {
  // Weighed with standard gravity, so that the bristles do not depend on the machine's gravity.
  WheeledVehicleParameters weighed = parameters;
  weighed.gravity_mps2 = 9.80665;
  return static_loads(weighed).wheel_n[axle] / 9.80665;
}

}  // namespace

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
                              parameters.brake_stiffness_nmprad)},
      chassis_(parameters) {
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
      inner_step(kSettlingStep_s);
    }
    settling_ = false;
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
    // Rolling without slip, rate = v / r at the loaded radius.
    const double radius =
        wheels_[i].radius_m > 0.0 ? wheels_[i].radius_m : axle(i / 2).tyre.unloaded_radius_m;
    state_.wheel_rate_radps[i] = speed_mps / radius;
    wheels_[i].rate_radps = state_.wheel_rate_radps[i];
  }
  update_links();
}

void FullVehicle::set_state(const FullVehicleState& state) {
  state_ = state;
  state_.q_WB.normalize();
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
    LinkMotion& link = links_[1 + i];
    if (axles_[i].masses() == 1) {
      const UnsprungMass& beam = axles_[i].mass(0);
      link = moving(beam.position_m, beam.velocity_by_s, beam.rate_by_s, beam.bias_mps2,
                    beam.bias_radps2, beam.rate, i, beam.R_BA);
    } else {
      const WheelFrame& l = axles_[i].wheel(0);
      const WheelFrame& r = axles_[i].wheel(1);
      const std::array<Vector3d, 2> by_s{0.5 * l.velocity_by_s[0], 0.5 * r.velocity_by_s[1]};
      const std::array<Vector3d, 2> none{Vector3d::Zero(), Vector3d::Zero()};
      link = moving(0.5 * (l.hub_m + r.hub_m), by_s, none, 0.5 * (l.bias_mps2 + r.bias_mps2),
                    Vector3d::Zero(), w, i, Matrix3d::Identity());
    }
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
