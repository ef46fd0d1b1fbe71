// What the roller shows: motion of its links, its sensors, its numbers.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/roller/tandem_roller.h"

namespace rigwire::sim {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

constexpr std::array<StatusQuantity, 8> kStatus{{{"speed", "km/h"},
                                                 {"front steer", "deg"},
                                                 {"rear steer", "deg"},
                                                 {"pressure", "bar"},
                                                 {"engine", "rpm"},
                                                 {"sliding strips", ""},
                                                 {"water", "kg"},
                                                 {"chips", "kg"}}};

constexpr std::array<TruthField, 9> kTruth{{{"drum_rate_radps", 2},
                                            {"steer_rad", 2},
                                            {"drum_load_n", 2},
                                            {"pivot_moment_nm", 2},
                                            {"slip_loss_w", 2},
                                            {"pressure_pa", 1},
                                            {"engine_speed_radps", 1},
                                            {"water_kg", 1},
                                            {"chips_kg", 1}}};

// Motion of a frame at r in `base`, moving along r with rate and acceleration, axes as base's.
LinkMotion carried(const LinkMotion& base, const Eigen::Vector3d& r, const Eigen::Vector3d& rate,
                   const Eigen::Vector3d& acceleration) {
  const Eigen::Matrix3d R = base.X_WL.linear();
  const Eigen::Vector3d r_W = R * r;
  const Eigen::Vector3d rate_W = R * rate;
  LinkMotion moved = base;
  moved.X_WL.translation() += r_W;
  // Relative motion: w x r + r', and alpha x r + w x (w x r) + 2 w x r' + r''.
  moved.v_WL_W += base.w_WL_W.cross(r_W) + rate_W;
  moved.a_WL_W += base.alpha_WL_W.cross(r_W) + base.w_WL_W.cross(base.w_WL_W.cross(r_W)) +
                  2.0 * base.w_WL_W.cross(rate_W) + R * acceleration;
  return moved;
}

// The same origin, turned by `angle` about an own axis (unit, in `base`).
LinkMotion rotated(const LinkMotion& base, const Eigen::Vector3d& axis, double angle, double rate,
                   double acceleration) {
  const Eigen::Vector3d axis_W = base.X_WL.linear() * axis;
  LinkMotion moved = base;
  moved.X_WL.linear() = base.X_WL.linear() * Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  // w + rate axis, alpha + rate' axis + rate (w x axis).
  moved.w_WL_W += rate * axis_W;
  moved.alpha_WL_W += acceleration * axis_W + rate * base.w_WL_W.cross(axis_W);
  return moved;
}

Eigen::Vector3d upward(double value) {
  return {0.0, 0.0, value};
}

}  // namespace

void TandemRoller::update_dust() {
  const double sum_n = load_n_[0] + load_n_[1];
  const double road_kgpm = road_dust_kgpm(mass_.mass_kg);
  for (std::size_t i = 0; i < 2; ++i) {
    const LinkMotion& drum = links_[3 + i];
    // Road dust by the greater of surface and travel speed, shared by load (dust_emitter.h).
    const double speed_mps = std::max(std::abs(spin_radps_[i]) * parameters_.drum.radius_m,
                                      drum.v_WL_W.head<2>().norm());
    dust_[i] = rolling_dust(road_kgpm, drum.X_WL.translation() - upward(parameters_.drum.radius_m),
                            parameters_.drum.width_m, load_n_[i] / sum_n, speed_mps);
  }
}

void TandemRoller::update_links() {
  LinkMotion base;
  const Eigen::Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  base.X_WL.linear() = R_WB;
  base.X_WL.translation() = start_W_ + state_.displacement_W;
  base.v_WL_W = state_.v_WB_W;
  base.w_WL_W = R_WB * state_.w_WB_B;
  base.a_WL_W = state_.a_WB_W;
  base.alpha_WL_W = R_WB * state_.alpha_WB_B;

  const double l = parameters_.pivot_x_m;
  LinkMotion frame = base;
  if (vibration_[0].speed_share() > 0.0 || vibration_[1].speed_share() > 0.0) {
    const Oscillation front = vibration_[0].frame();
    const Oscillation rear = vibration_[1].frame();
    // Frame on both mounts: heave is the mean of their motions, pitch the difference over the base.
    frame = carried(base, upward(0.5 * (front.position_m + rear.position_m)),
                    upward(0.5 * (front.velocity_mps + rear.velocity_mps)),
                    upward(0.5 * (front.acceleration_mps2 + rear.acceleration_mps2)));
    const double lever = 1.0 / (2.0 * l);
    frame = rotated(frame, Eigen::Vector3d::UnitY(), (rear.position_m - front.position_m) * lever,
                    (rear.velocity_mps - front.velocity_mps) * lever,
                    (rear.acceleration_mps2 - front.acceleration_mps2) * lever);
  }
  links_[0] = frame;
  for (std::size_t i = 0; i < 2; ++i) {
    const PivotSteering& pivot = steering_[i];
    const Eigen::Vector3d centre(i == 0 ? l : -l, 0.0, parameters_.drum.radius_m);
    const auto steered = [&pivot](const LinkMotion& motion) {
      return rotated(motion, Eigen::Vector3d::UnitZ(), pivot.angle_rad(), pivot.rate_radps(),
                     pivot.acceleration_radps2());
    };
    links_[1 + i] = steered(carried(frame, centre, upward(0.0), upward(0.0)));
    const Oscillation shake = vibration_[i].drum();
    const LinkMotion axle =
        steered(carried(base, centre + upward(shake.position_m), upward(shake.velocity_mps),
                        upward(shake.acceleration_mps2)));
    links_[3 + i] = rotated(axle, Eigen::Vector3d::UnitY(), spin_angle_rad_[i], spin_radps_[i],
                            spin_acceleration_radps2_[i]);
  }
}

OdometryReading TandemRoller::odometry() const {
  const double front = steering_[0].angle_rad();
  const double rear = steering_[1].angle_rad();
  OdometryReading reading;
  // The kinematic bicycle read backwards from drum rates and angles (docs/machines/bomag-bw174.md).
  reading.speed_mps = 0.5 * parameters_.drum.radius_m *
                      (spin_radps_[0] * std::cos(front) + spin_radps_[1] * std::cos(rear));
  reading.slip_angle_rad = std::atan(0.5 * (std::tan(front) + std::tan(rear)));
  reading.curvature_1pm = std::cos(reading.slip_angle_rad) * (std::tan(front) - std::tan(rear)) /
                          (2.0 * parameters_.pivot_x_m);
  return reading;
}

VehicleSample TandemRoller::vehicle_sample(SimTime time) const {
  VehicleSample sample;
  sample.time = time;
  sample.engine = drive_.engine_sample();
  engine_.read(sample.engine);
  sample.driveline_engaged = !parameters_.drive.bypass;
  sample.wheel_rate_radps = {spin_radps_[0], spin_radps_[0], spin_radps_[1], spin_radps_[1]};
  sample.wheel_radius_m.fill(parameters_.drum.radius_m);
  sample.front_steer_rad = steering_[0].angle_rad();
  sample.rear_steer_rad = steering_[1].angle_rad();
  sample.brake_share = brake_share_;
  sample.parking_brake = command_.parking_brake;
  sample.lock[static_cast<std::size_t>(Differential::centre)] = drive_.divided();
  sample.hydraulic_pressure_pa = pressure_pa_;
  sample.vibration = {vibration_[0].on(), vibration_[1].on()};
  sample.edge_cutter_share = cutter_.share();
  sample.spreader_rate_kgpm2 = spreader_.rate_kgpm2();
  sample.hopper_mass_kg = spreader_.mass_kg();
  sample.odometry = odometry();
  sample.ground_speed_mps = links_[0].X_WL.linear().col(0).dot(links_[0].v_WL_W);
  sample.travel_limit = travel_limit_;
  return sample;
}

std::span<const StatusQuantity> TandemRoller::status_quantities() const {
  return kStatus;
}

void TandemRoller::read_status(std::span<double> values) const {
  const double forward = state_.v_WB_W.dot(state_.q_WB * Eigen::Vector3d::UnitX());
  const std::array<double, kStatus.size()> all{
      3.6 * forward,
      kDegrees * steering_[0].angle_rad(),
      kDegrees * steering_[1].angle_rad(),
      1e-5 * pressure_pa_,
      30.0 / std::numbers::pi * drive_.engine_speed_radps(),
      static_cast<double>(dynamics_.drum(0).sliding_strips() + dynamics_.drum(1).sliding_strips()),
      sprinkler_.mass_kg(),
      spreader_.mass_kg()};
  std::copy(all.begin(), all.end(), values.begin());
}

std::span<const TruthField> TandemRoller::truth_fields() const {
  return kTruth;
}

void TandemRoller::read_truth(std::span<double> values) const {
  const std::array<double, 14> all{spin_radps_[0],
                                   spin_radps_[1],
                                   steering_[0].angle_rad(),
                                   steering_[1].angle_rad(),
                                   load_n_[0],
                                   load_n_[1],
                                   pivot_moment_nm(0),
                                   pivot_moment_nm(1),
                                   dynamics_.drum(0).loss_w(),
                                   dynamics_.drum(1).loss_w(),
                                   pressure_pa_,
                                   drive_.engine_speed_radps(),
                                   sprinkler_.mass_kg(),
                                   spreader_.mass_kg()};
  std::copy(all.begin(), all.end(), values.begin());
}

}  // namespace rigwire::sim
