#include "sim/vehicle/wheeled_vehicle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "fields/constants.h"
#include "sim/inner_steps.h"
#include "sim/odometry/odometry.h"
#include "sim/vehicle/full_vehicle.h"
#include "sim/vehicle/kinematic_vehicle.h"
#include "sim/vehicle/obstacle_contact.h"
#include "sim/vehicle/planar_vehicle.h"

namespace rigwire::sim {
namespace {

const WheeledVehicleParameters& validated(const WheeledVehicleParameters& parameters) {
  validate(parameters);
  return parameters;
}

constexpr std::array<StatusQuantity, 9> kStatus{{{"speed", "km/h"},
                                                 {"engine", "rpm"},
                                                 {"gear", ""},
                                                 {"steering", "deg"},
                                                 {"pitch", "deg"},
                                                 {"roll", "deg"},
                                                 {"least wheel load", "kN"},
                                                 {"wheels slipping", ""},
                                                 {"mean tyre pressure", "bar"}}};

constexpr std::array<TruthField, 8> kTruth{{{"wheel_rate_radps", kWheels},
                                            {"wheel_load_n", kWheels},
                                            {"wheel_longitudinal_n", kWheels},
                                            {"wheel_lateral_n", kWheels},
                                            {"wheel_slide_mps", kWheels},
                                            {"tyre_pressure_pa", kWheels},
                                            {"suspension", 4},
                                            {"steer_rad", 2}}};

double finite_or(double value, double otherwise) {
  return std::isfinite(value) ? value : otherwise;
}

TravelMachine travel_machine(const WheeledVehicleParameters& p, const StaticLoads& loads) {
  return {p.mass_kg(), loads.rolling_radius_m[1],
          p.front.brake_torque_nm / loads.rolling_radius_m[0] +
              p.rear.brake_torque_nm / loads.rolling_radius_m[1],
          p.gravity_mps2};
}

}  // namespace

WheeledVehicle::WheeledVehicle(const WheeledVehicleParameters& parameters, const Ground& ground,
                               std::unique_ptr<Driveline> driveline)
    : parameters_(validated(parameters)),
      ground_(&ground),
      driveline_(std::move(driveline)),
      static_(static_loads(parameters)),
      contact_(vehicle_contact(parameters, static_, ground)),
      reach_m_(vehicle_reach_m(parameters)),
      steering_{SteeringActuator(parameters.front.steering),
                SteeringActuator(parameters.rear.steering)},
      travel_(parameters.travel, travel_machine(parameters, static_)),
      road_dust_kgpm_(road_dust_kgpm(parameters.mass_kg())),
      inner_span_(std::max(Duration{1}, from_seconds(parameters.step_s))) {
  if (driveline_ == nullptr) {
    throw std::invalid_argument("driveline: found none, allowed: one");
  }
  for (std::size_t i = 0; i < kWheels; ++i) {
    pressure_pa_[i] = axle(i / 2).initial_pressure_pa;
    pressure_target_pa_[i] = pressure_pa_[i];
  }
}

void WheeledVehicle::step(Duration span) {
  if (span <= Duration{0} || non_finite_) {
    return;
  }
  run_inner_steps(span, inner_span_, time_, non_finite_, [this](double h) {
    step_actuators(h);
    inner_step(h);
  });
  update_links();
  update_dust();
}

void WheeledVehicle::update_dust() {
  double sum_n = 0.0;
  for (const WheelState& wheel : wheels_) {
    sum_n += wheel.load_n;
  }
  for (std::size_t i = 0; i < kWheels; ++i) {
    const LinkMotion& wheel = links_[kWheeledLinks.size() - kWheels + i];
    const double radius_m = static_.wheel_height_m[i / 2];
    // Road dust by the greater of surface speed and travel speed, shared by load (dust_emitter.h).
    const double speed_mps =
        std::max(std::abs(wheels_[i].rate_radps) * static_.rolling_radius_m[i / 2],
                 wheel.v_WL_W.head<2>().norm());
    dust_[i] = rolling_dust(road_dust_kgpm_,
                            wheel.X_WL.translation() - radius_m * Eigen::Vector3d::UnitZ(),
                            axle(i / 2).tyre.width_m, wheels_[i].load_n / sum_n, speed_mps);
  }
}

void WheeledVehicle::step_travel(double h) {
  if (!command_.travel_speed_mps) {
    return;
  }
  drive_ = command_;
  travel_.step(h, *driveline_, links_[0].X_WL.linear()(2, 0), drive_);
  driveline_->command(drive_);
}

void WheeledVehicle::step_implements(double h) {
  const ImplementParameters& p = parameters_.implements;
  const auto approach = [](double& share, double target, double most) {
    share += std::clamp(target - share, -most, most);
  };
  for (std::size_t i = 0; i < kImplementEnds; ++i) {
    if (p.hitch[i].fitted && command_.hitch_share[i]) {
      approach(hitch_share_[i], *command_.hitch_share[i], h / p.hitch[i].travel_time_s);
    }
    if (p.power_take_off[i].fitted) {
      approach(shaft_share_[i], command_.power_take_off[i].engaged ? 1.0 : 0.0,
               h / p.power_take_off[i].engage_time_s);
    }
  }
}

void WheeledVehicle::step_actuators(double h) {
  step_travel(h);
  // First-order lag, exact over h.
  const double lag_s = parameters_.brake_lag_s;
  const double missing = drive_.brake_share - brake_share_;
  brake_share_ += lag_s > 0.0 ? -missing * std::expm1(-h / lag_s) : missing;
  step_implements(h);
  steering_[0].step(h);
  steering_[1].step(h);
  update_steering();
  if (!parameters_.tyre_pressure.adjustable) {
    return;
  }
  const TyrePressureParameters& p = parameters_.tyre_pressure;
  for (std::size_t i = 0; i < kWheels; ++i) {
    // First-order lag, exact over h; own time constants for inflating and deflating.
    const double error = pressure_target_pa_[i] - pressure_pa_[i];
    if (error != 0.0) {
      const double lag = error > 0.0 ? p.inflate_time_constant_s : p.deflate_time_constant_s;
      pressure_pa_[i] -= error * std::expm1(-h / lag);
    }
  }
}

void WheeledVehicle::update_steering() {
  const double front = steering_[0].angle_rad();
  const double rear = steering_[1].angle_rad();
  if (front == 0.0 && rear == 0.0) {
    steer_rad_ = {};
    return;
  }
  // Path curvature of the two equivalent wheels, then Ackermann's geometry per axle (steering.h).
  const double curvature = (std::tan(front) - std::tan(rear)) / parameters_.wheelbase_m();
  steer_rad_[0] = ackermann_rad(front, parameters_.front.track_m, curvature);
  steer_rad_[1] = ackermann_rad(rear, parameters_.rear.track_m, curvature);
}

double WheeledVehicle::brake_limit_nm(std::size_t wheel) const {
  const VehicleAxleParameters& a = axle(wheel / 2);
  // Half of its axle's torque each: service brake by its share, and the parking brake.
  return 0.5 *
         (brake_share_ * a.brake_torque_nm + (command_.parking_brake ? a.parking_brake_nm : 0.0));
}

void WheeledVehicle::command(const VehicleCommand& command) {
  const VehicleCommand old = command_;
  command_ = command;
  command_.engine_torque_share =
      std::clamp(finite_or(command.engine_torque_share, old.engine_torque_share), 0.0, 1.0);
  command_.engine_speed_radps =
      std::max(0.0, finite_or(command.engine_speed_radps, old.engine_speed_radps));
  if (command.travel_speed_mps && !std::isfinite(*command.travel_speed_mps)) {
    command_.travel_speed_mps = old.travel_speed_mps;
  }
  command_.engine_speed_limit_radps =
      std::isnan(command.engine_speed_limit_radps) || command.engine_speed_limit_radps < 0.0
          ? old.engine_speed_limit_radps
          : command.engine_speed_limit_radps;
  command_.engine_torque_limit_share = std::clamp(
      finite_or(command.engine_torque_limit_share, old.engine_torque_limit_share), 0.0, 1.0);
  command_.brake_share = std::clamp(finite_or(command.brake_share, old.brake_share), 0.0, 1.0);
  command_.front_steer_rad = finite_or(command.front_steer_rad, old.front_steer_rad);
  command_.rear_steer_rad = finite_or(command.rear_steer_rad, old.rear_steer_rad);
  command_.edge_cutter_share = finite_or(command.edge_cutter_share, old.edge_cutter_share);
  command_.spreader_rate_kgpm2 = finite_or(command.spreader_rate_kgpm2, old.spreader_rate_kgpm2);
  const TyrePressureParameters& p = parameters_.tyre_pressure;
  for (std::size_t i = 0; i < kWheels; ++i) {
    command_.tyre_pressure_pa[i] = finite_or(command.tyre_pressure_pa[i], old.tyre_pressure_pa[i]);
    if (p.adjustable && std::isfinite(command.tyre_pressure_pa[i]) &&
        command.tyre_pressure_pa[i] > 0.0) {
      pressure_target_pa_[i] =
          std::clamp(command.tyre_pressure_pa[i], p.pressure_min_pa, p.pressure_max_pa);
    }
  }
  steering_[0].command(command_.front_steer_rad);
  steering_[1].command(command_.rear_steer_rad);
  for (std::size_t i = 0; i < kImplementEnds; ++i) {
    std::optional<double>& share = command_.hitch_share[i];
    if (share) {
      share = std::clamp(finite_or(*share, hitch_share_[i]), 0.0, 1.0);
    }
    std::optional<double>& speed = command_.power_take_off[i].speed_radps;
    if (speed && !std::isfinite(*speed)) {
      speed.reset();
    }
  }
  if (!command_.travel_speed_mps) {
    travel_.release();
    drive_ = command_;
    for (std::size_t i = 0; i < kImplementEnds; ++i) {
      const PowerTakeOffCommand& shaft = command_.power_take_off[i];
      if (parameters_.implements.power_take_off[i].fitted && shaft.engaged && shaft.speed_radps) {
        // The governor holds the shaft's speed.
        drive_.engine_control = EngineControl::speed;
        drive_.engine_speed_radps =
            *shaft.speed_radps * parameters_.implements.power_take_off[i].ratio;
      }
    }
    driveline_->command(drive_);
  }
}

VehicleSample WheeledVehicle::vehicle_sample(SimTime time) const {
  VehicleSample sample;
  driveline_->read(sample);
  sample.time = time;
  for (std::size_t i = 0; i < kWheels; ++i) {
    sample.wheel_rate_radps[i] = wheels_[i].rate_radps;
    sample.wheel_radius_m[i] = static_.rolling_radius_m[i / 2];
  }
  sample.tyre_pressure_pa = pressure_pa_;
  sample.tyre_pressure_target_pa = pressure_target_pa_;
  sample.front_steer_rad = steering_[0].angle_rad();
  sample.rear_steer_rad = steering_[1].angle_rad();
  sample.brake_share = drive_.brake_share;
  sample.parking_brake = command_.parking_brake;
  const OdometryParameters model{parameters_.front.position_x_m, -parameters_.rear.position_x_m,
                                 parameters_.front.track_m, OdometryWheels::all};
  sample.odometry = odometry(model, sample);
  const LinkMotion& body = links_[0];
  sample.ground_speed_mps = body.X_WL.linear().col(0).dot(body.v_WL_W);
  sample.travel_limit = travel_.limit();
  for (std::size_t i = 0; i < kImplementEnds; ++i) {
    const PowerTakeOffParameters& shaft = parameters_.implements.power_take_off[i];
    sample.hitch[i] = {parameters_.implements.hitch[i].fitted, hitch_share_[i]};
    sample.power_take_off[i] = {shaft.fitted, shaft_share_[i] > 0.0,
                                shaft_share_[i] * sample.engine.speed_radps / shaft.ratio};
  }
  return sample;
}

void WheeledVehicle::record_non_finite(const char* quantity, const char* part) {
  if (!non_finite_) {
    non_finite_ = NonFinite{quantity, part, time_};
  }
}

std::span<const StatusQuantity> WheeledVehicle::status_quantities() const {
  return kStatus;
}

void WheeledVehicle::read_status(std::span<double> values) const {
  VehicleSample sample;
  driveline_->read(sample);
  const LinkMotion& body = links_[0];
  const Eigen::Matrix3d& R = body.X_WL.linear();
  values[0] = 3.6 * R.col(0).dot(body.v_WL_W);
  values[1] = sample.engine.speed_radps * 30.0 / std::numbers::pi;
  values[2] = sample.gear;
  values[3] = steering_[0].angle_rad() / kDegree;
  // Pitch, x above the horizon, and roll about x: of the rotation z-y-x.
  values[4] = std::asin(std::clamp(R(2, 0), -1.0, 1.0)) / kDegree;
  values[5] = std::atan2(R(2, 1), R(2, 2)) / kDegree;
  double least = wheels_[0].load_n;
  double pressure = 0.0;
  int slipping = 0;
  for (std::size_t i = 0; i < kWheels; ++i) {
    least = std::min(least, wheels_[i].load_n);
    slipping += wheels_[i].slipping ? 1 : 0;
    pressure += 0.25 * pressure_pa_[i];
  }
  values[6] = 1e-3 * least;
  values[7] = slipping;
  values[8] = 1e-5 * pressure;
}

std::span<const TruthField> WheeledVehicle::truth_fields() const {
  return kTruth;
}

void WheeledVehicle::read_truth(std::span<double> values) const {
  for (std::size_t i = 0; i < kWheels; ++i) {
    values[i] = wheels_[i].rate_radps;
    values[4 + i] = wheels_[i].load_n;
    values[8 + i] = wheels_[i].longitudinal_n;
    values[12 + i] = wheels_[i].lateral_n;
    values[16 + i] = wheels_[i].slide_mps;
    values[20 + i] = pressure_pa_[i];
    values[24 + i] = suspension_[i];
  }
  values[28] = steering_[0].angle_rad();
  values[29] = steering_[1].angle_rad();
}

std::vector<BodyPoint> WheeledVehicle::body_points() const {
  std::vector<BodyPoint> points;
  for (const ChassisPoint& point : parameters_.chassis.points) {
    points.push_back({kWheeledLinks[0], links_[0].X_WL * point.position_m});
  }
  return points;
}

// Steering.

SteeringActuator::SteeringActuator(const SteeringParameters& parameters)
    : parameters_(parameters) {}

void SteeringActuator::command(double angle_rad) {
  if (!std::isnan(angle_rad)) {
    set_point_rad_ = std::clamp(angle_rad, -parameters_.angle_max_rad, parameters_.angle_max_rad);
  }
}

void SteeringActuator::step(double span_s) {
  const double error = set_point_rad_ - angle_rad_;
  // At full rate while |error| > rate x time constant, then exp(-t / time constant): exact.
  const double knee = parameters_.rate_max_radps * parameters_.time_constant_s;
  double left_s = span_s;
  double rest = std::abs(error);
  if (rest > knee) {
    const double ramp_s = std::min(left_s, (rest - knee) / parameters_.rate_max_radps);
    rest -= parameters_.rate_max_radps * ramp_s;
    left_s -= ramp_s;
  }
  if (left_s > 0.0) {
    rest *=
        parameters_.time_constant_s > 0.0 ? std::exp(-left_s / parameters_.time_constant_s) : 0.0;
  }
  angle_rad_ = set_point_rad_ - std::copysign(rest, error);
}

std::array<double, 2> ackermann_rad(double angle_rad, double track_m, double curvature_1pm) {
  // Ackermann: tan(wheel) = tan(angle) / (1 -+ curvature track / 2).
  const double tangent = std::tan(angle_rad);
  const double part = 0.5 * track_m * curvature_1pm;
  return {std::atan(tangent / (1.0 - part)), std::atan(tangent / (1.0 + part))};
}

// Placing, and making.

Eigen::Isometry3d place_on_ground(const Ground& ground, const WheeledVehicleParameters& parameters,
                                  const VehiclePlace& place) {
  if (!std::isfinite(place.x_m) || !std::isfinite(place.y_m) || !std::isfinite(place.yaw_rad)) {
    throw std::invalid_argument("place: found a value that is not finite, allowed: finite numbers");
  }
  const Eigen::Vector2d ahead(std::cos(place.yaw_rad), std::sin(place.yaw_rad));
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  std::array<Eigen::Vector3d, 4> foot;
  for (std::size_t i = 0; i < 4; ++i) {
    const VehicleAxleParameters& axle = i < 2 ? parameters.front : parameters.rear;
    const double side = (i % 2 == 0 ? 0.5 : -0.5) * axle.track_m;
    const Eigen::Vector2d at = Eigen::Vector2d(place.x_m, place.y_m) +
                               (axle.position_x_m - parameters.rear.position_x_m) * ahead +
                               side * left;
    const double ceiling = ground.height_m(at.x(), at.y()) + axle.tyre.unloaded_radius_m;
    foot[i] = {at.x(), at.y(), ground.at(at.x(), at.y(), ceiling).height_m};
  }
  // x through the axles' mean feet, z square to x and to the sides' mean difference.
  const Eigen::Vector3d front = 0.5 * (foot[0] + foot[1]);
  const Eigen::Vector3d rear = 0.5 * (foot[2] + foot[3]);
  const Eigen::Vector3d across = 0.5 * (foot[0] + foot[2]) - 0.5 * (foot[1] + foot[3]);
  const Eigen::Vector3d x = (front - rear).normalized();
  const Eigen::Vector3d z = x.cross(across).normalized();
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  X_WB.linear().col(0) = x;
  X_WB.linear().col(1) = z.cross(x);
  X_WB.linear().col(2) = z;
  X_WB.translation() = rear - parameters.rear.position_x_m * x;
  return X_WB;
}

std::unique_ptr<WheeledVehicle> make_wheeled_vehicle(const WheeledVehicleParameters& parameters,
                                                     const Ground& ground,
                                                     std::unique_ptr<Driveline> driveline,
                                                     const VehiclePlace& place) {
  switch (parameters.level) {
    case VehicleLevel::kinematic:
      return std::make_unique<KinematicVehicle>(parameters, ground, std::move(driveline), place);
    case VehicleLevel::planar:
      return std::make_unique<PlanarVehicle>(parameters, ground, std::move(driveline), place);
    case VehicleLevel::full:
      break;
  }
  return std::make_unique<FullVehicle>(parameters, ground, std::move(driveline), place);
}

}  // namespace rigwire::sim
