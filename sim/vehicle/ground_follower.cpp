#include "sim/vehicle/ground_follower.h"

#include <cmath>

namespace rigwire::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFollow_radps = 2.0 * std::numbers::pi * 2.5;

}  // namespace

double step_height_m(const VehicleAxleParameters& axle) {
  return 0.5 * axle.tyre.unloaded_radius_m;
}

void GroundFollower::reset(const Ground& ground, const VehiclePlace& place) {
  const Eigen::Isometry3d X_WB = place_on_ground(ground, *parameters_, place);
  place_m_ = X_WB.translation().head<2>();
  yaw_rad_ = place.yaw_rad;
  const Vector3d normal = X_WB.linear().col(2);
  follow_ = {X_WB.translation().z(), -normal.x() / normal.z(), -normal.y() / normal.z()};
  follow_rate_.setZero();
  // Once more through the same eyes as the steps use, so that the first finds nothing to do.
  const Plane plane = look(ground);
  follow_ = {plane.height_m, plane.slope.x(), plane.slope.y()};
  body_ = {};
  body_.X_WL.linear() = attitude();
  body_.X_WL.translation() = Vector3d(place_m_.x(), place_m_.y(), follow_[0]);
}

GroundFollower::Plane GroundFollower::look(const Ground& ground) {
  const Vector2d ahead(std::cos(yaw_rad_), std::sin(yaw_rad_));
  const Vector2d left(-ahead.y(), ahead.x());
  // Distances in the plane shorten on a slope; x and y of B seen from above.
  const Vector2d slope = follow_.tail<2>();
  const double along = 1.0 / std::sqrt(1.0 + std::pow(slope.dot(ahead), 2));
  const double across = 1.0 / std::sqrt(1.0 + std::pow(slope.dot(left), 2));
  const double upright = 1.0 / std::sqrt(1.0 + slope.squaredNorm());
  std::array<double, kWheels> height;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const VehicleAxleParameters& axle = i < 2 ? parameters_->front : parameters_->rear;
    const double side = (i % 2 == 0 ? 0.5 : -0.5) * axle.track_m;
    const Vector2d offset = along * axle.position_x_m * ahead + across * side * left;
    const Vector2d at = place_m_ + offset;
    const double ceiling = follow_[0] + slope.dot(offset) + upright * step_height_m(axle);
    points_[i] = ground.at(at.x(), at.y(), ceiling);
    height[i] = points_[i].height_m;
    places_[i] = {at.x(), at.y(), height[i]};
  }
  // Plane by the means of axles and sides: its two slopes and the height at B's origin.
  const double front = 0.5 * (height[0] + height[1]);
  const double rear = 0.5 * (height[2] + height[3]);
  const double by_x = (front - rear) / (along * parameters_->wheelbase_m());
  const double by_y = (height[0] + height[2] - height[1] - height[3]) /
                      (across * (parameters_->front.track_m + parameters_->rear.track_m));
  Plane plane;
  plane.height_m = rear - by_x * along * parameters_->rear.position_x_m;
  plane.slope = by_x * ahead + by_y * left;
  return plane;
}

Matrix3d GroundFollower::attitude() const {
  const Vector2d ahead(std::cos(yaw_rad_), std::sin(yaw_rad_));
  const Vector2d slope = follow_.tail<2>();
  Matrix3d R;
  R.col(0) = Vector3d(ahead.x(), ahead.y(), slope.dot(ahead)).normalized();
  R.col(2) = Vector3d(-slope.x(), -slope.y(), 1.0).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

void GroundFollower::step(double h, const Ground& ground, const Vector2d& speed_mps,
                          double yaw_rate_radps) {
  const Matrix3d R = body_.X_WL.linear();
  const Vector3d v_W = R.leftCols<2>() * speed_mps;
  // Yaw change of the heading seen from above, for a turn about the body's z.
  const Vector3d turned = R.col(0) + h * yaw_rate_radps * R.col(1);
  yaw_rad_ = std::remainder(yaw_rad_ + std::atan2(R(0, 0) * turned.y() - R(1, 0) * turned.x(),
                                                  R(0, 0) * turned.x() + R(1, 0) * turned.y()),
                            2.0 * std::numbers::pi);
  place_m_ += h * v_W.head<2>();

  const Plane plane = look(ground);
  const Vector3d target(plane.height_m, plane.slope.x(), plane.slope.y());
  const Vector3d target_rate(plane.slope.dot(v_W.head<2>()), 0.0, 0.0);
  // y'' = w^2 (y_ground - y) + 2 w (y_ground' - y') by backward Euler (ground_follower.h).
  const double w2h = kFollow_radps * kFollow_radps * h;
  // The target's height is that at the end of the step already.
  follow_rate_ = (follow_rate_ + w2h * (target - follow_) + 2.0 * kFollow_radps * h * target_rate) /
                 (1.0 + w2h * h + 2.0 * kFollow_radps * h);
  follow_ += h * follow_rate_;

  const Matrix3d R_new = attitude();
  // sum of r_i x r_i(new) over the three axes is 2 sin(angle) axis: w = half of it over h.
  Vector3d rate = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    rate += R.col(i).cross(R_new.col(i));
  }
  rate *= 0.5 / h;
  const Vector3d velocity(v_W.x(), v_W.y(), follow_rate_[0]);
  body_.a_WL_W = (velocity - body_.v_WL_W) / h;
  body_.alpha_WL_W = (rate - body_.w_WL_W) / h;
  body_.v_WL_W = velocity;
  body_.w_WL_W = rate;
  body_.X_WL.linear() = R_new;
  body_.X_WL.translation() = Vector3d(place_m_.x(), place_m_.y(), follow_[0]);
}

void GroundFollower::set_speed(const Vector2d& speed_mps) {
  body_.v_WL_W = R_WB().leftCols<2>() * speed_mps;
  follow_rate_ = {body_.v_WL_W.z(), 0.0, 0.0};
}

bool GroundFollower::finite() const {
  return body_.X_WL.matrix().allFinite() && body_.v_WL_W.allFinite() && body_.a_WL_W.allFinite() &&
         body_.w_WL_W.allFinite() && body_.alpha_WL_W.allFinite();
}

Vector3d axle_centre_m(const WheeledVehicleParameters& parameters, const StaticLoads& loads,
                       std::size_t axle) {
  const VehicleAxleParameters& at = axle == 0 ? parameters.front : parameters.rear;
  const double rise = at.type == AxleType::beam ? at.portal_offset_m : 0.0;
  return {at.position_x_m, 0.0, loads.wheel_height_m[axle] + rise};
}

Vector3d wheel_centre_m(const WheeledVehicleParameters& parameters, const StaticLoads& loads,
                        std::size_t wheel) {
  const VehicleAxleParameters& axle = wheel < 2 ? parameters.front : parameters.rear;
  return {axle.position_x_m, (wheel % 2 == 0 ? 0.5 : -0.5) * axle.track_m,
          loads.wheel_height_m[wheel / 2]};
}

void place_rigid_links(const WheeledVehicleParameters& parameters, const StaticLoads& loads,
                       const std::array<double, 4>& steer_rad, const LinkMotion& body,
                       std::array<ContactLink, 7>& links) {
  links.fill({body.X_WL, body.v_WL_W, body.w_WL_W});
  for (std::size_t i = 0; i < 2; ++i) {
    ContactLink& link = links[1 + i];
    const Vector3d centre = axle_centre_m(parameters, loads, i);
    link.X_WL.translation() += body.X_WL.linear() * centre;
    link.v_WL_W += body.w_WL_W.cross(body.X_WL.linear() * centre);
  }
  for (std::size_t i = 0; i < kWheels; ++i) {
    Eigen::Isometry3d X_BH = Eigen::Isometry3d::Identity();
    X_BH.translation() = wheel_centre_m(parameters, loads, i);
    X_BH.linear() = Eigen::AngleAxisd(steer_rad[i], Vector3d::UnitZ()).toRotationMatrix();
    ContactLink& link = links[3 + i];
    link.X_WL = body.X_WL * X_BH;
    link.v_WL_W += body.w_WL_W.cross(body.X_WL.linear() * X_BH.translation());
  }
}

void rigid_links(const WheeledVehicleParameters& parameters, const StaticLoads& loads,
                 const std::array<double, 4>& steer_rad, const std::array<double, 4>& spin_rad,
                 const std::array<double, 4>& rate_radps, const std::array<double, 4>& rate_radps2,
                 const LinkMotion& body, std::array<LinkMotion, 7>& links) {
  links[0] = body;
  for (std::size_t i = 0; i < 2; ++i) {
    Eigen::Isometry3d X_BL = Eigen::Isometry3d::Identity();
    X_BL.translation() = axle_centre_m(parameters, loads, i);
    links[1 + i] = at_mount(body, X_BL);
  }
  for (std::size_t i = 0; i < kWheels; ++i) {
    Eigen::Isometry3d X_BH = Eigen::Isometry3d::Identity();
    X_BH.translation() = wheel_centre_m(parameters, loads, i);
    X_BH.linear() = Eigen::AngleAxisd(steer_rad[i], Vector3d::UnitZ()).toRotationMatrix();
    LinkMotion link = at_mount(body, X_BH);
    // Spin on a turning axle: alpha += spin' axis + spin (w x axis), w += spin axis.
    const Vector3d axis_W = link.X_WL.linear().col(1);
    link.alpha_WL_W += rate_radps2[i] * axis_W + rate_radps[i] * link.w_WL_W.cross(axis_W);
    link.w_WL_W += rate_radps[i] * axis_W;
    link.X_WL.linear() =
        link.X_WL.linear() * Eigen::AngleAxisd(spin_rad[i], Vector3d::UnitY()).toRotationMatrix();
    links[3 + i] = link;
  }
}

}  // namespace rigwire::sim
