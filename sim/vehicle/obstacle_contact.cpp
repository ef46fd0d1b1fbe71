#include "sim/vehicle/obstacle_contact.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/vehicle/ground_follower.h"

namespace rigwire::sim {

namespace {

constexpr std::size_t kFirstWheel = kWheeledLinks.size() - kWheels;
constexpr double kTyreDampingRatio = 0.3;
/// Edge length of the cube that has a chassis point as a corner.
constexpr double kCorner_m = 0.4;

/// Adds corners of the body that contact only the terrain: cubes that extend inwards from each
/// point.
void add_corners(const WheeledVehicleParameters& parameters, std::vector<ContactBody>& bodies) {
  const std::vector<ChassisPoint>& points = parameters.chassis.points;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const ChassisPoint& point : points) {
    middle += point.position_m / static_cast<double>(points.size());
  }
  for (const ChassisPoint& point : points) {
    const Eigen::Vector3d inwards = middle - point.position_m;
    ContactBody& corner = bodies.emplace_back(
        ContactBody{"chassis", 0, Eigen::Isometry3d::Identity(),
                    ConvexShape::box(Eigen::Vector3d::Constant(0.5 * kCorner_m)),
                    parameters.chassis.stiffness_npm, parameters.chassis.damping_nspm});
    for (Eigen::Index i = 0; i < 3; ++i) {
      corner.X_LS.translation()[i] =
          point.position_m[i] + std::copysign(0.5 * kCorner_m, inwards[i]);
    }
    corner.crush_n = parameters.solid.crush_n;
    corner.crush_npm = parameters.solid.crush_npm;
    corner.meets_terrain = true;
    corner.meets_obstacles = false;
  }
}

}  // namespace

ContactSet vehicle_contact(const WheeledVehicleParameters& parameters, const StaticLoads& loads,
                           const Ground& ground) {
  std::vector<ContactBody> bodies =
      contact_bodies(parameters.solid, kWheeledLinks, parameters.mass_kg());
  const bool by_wheels = parameters.level == VehicleLevel::full;
  for (ContactBody& box : bodies) {
    box.meets_terrain = true;
  }
  if (by_wheels) {
    add_corners(parameters, bodies);
  }
  for (std::size_t i = 0; i < kWheels; ++i) {
    const VehicleAxleParameters& axle = i < 2 ? parameters.front : parameters.rear;
    const double carried_kg =
        std::max(1.0, loads.wheel_n[i / 2] / std::max(1e-3, parameters.gravity_mps2));
    const double stiffness = Tyre(axle.tyre, carried_kg).stiffness_npm(axle.initial_pressure_pa);
    ContactBody& wheel = bodies.emplace_back(
        ContactBody{std::string(kWheeledLinks[kFirstWheel + i]),
                    kFirstWheel + i,
                    {},
                    ConvexShape::cylinder(axle.tyre.unloaded_radius_m, 0.5 * axle.tyre.width_m),
                    stiffness,
                    2.0 * kTyreDampingRatio * std::sqrt(stiffness * carried_kg),
                    0.0,
                    0.0,
                    true,
                    true});
    wheel.meets_terrain = !by_wheels;
    if (!by_wheels) {
      wheel.step_below_m = loads.wheel_height_m[i / 2] - step_height_m(axle);
      wheel.rolls_over_balls = false;
    }
    // The cylinder's z along the axle.
    wheel.X_LS = Eigen::AngleAxisd(-0.5 * std::numbers::pi, Eigen::Vector3d::UnitX());
    ContactBody rim = wheel;
    rim.name.replace(rim.name.rfind("wheel"), 5, "rim");
    rim.shape = ConvexShape::cylinder(axle.tyre.rim_radius_m, 0.4 * axle.tyre.width_m);
    rim.stiffness_npm = parameters.solid.stiffness_npm;
    rim.damping_nspm =
        2.0 * parameters.solid.damping_ratio * std::sqrt(rim.stiffness_npm * parameters.mass_kg());
    rim.crush_n = parameters.solid.crush_n;
    rim.crush_npm = parameters.solid.crush_npm;
    rim.soft = false;
    bodies.push_back(std::move(rim));
  }
  ContactSet contact(std::move(bodies), kWheeledLinks.size(), ground);
  contact.carry(by_wheels ? Carried::by_wheels : Carried::by_model);
  return contact;
}

double vehicle_reach_m(const WheeledVehicleParameters& parameters) {
  double reach = 0.0;
  for (const ContactBox& box : parameters.solid.boxes) {
    reach = std::max(reach, box.position_m.norm() + 0.5 * box.size_m.norm());
  }
  for (const ChassisPoint& point : parameters.chassis.points) {
    reach = std::max(reach, point.position_m.norm());
  }
  for (const VehicleAxleParameters* axle : {&parameters.front, &parameters.rear}) {
    reach = std::max(reach, std::hypot(axle->position_x_m, 0.5 * axle->track_m) +
                                2.0 * axle->tyre.unloaded_radius_m + axle->tyre.width_m);
  }
  return reach;
}

VehicleContactRows contact_rows(const ContactPoint& point, const Eigen::Matrix3d& R_WB,
                                const Eigen::Vector3d& p_C, const WheelFrame* wheel,
                                std::size_t index) {
  VehicleContactRows result;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d d = R_WB.transpose() * point.direction_W[k];
    VelocityRow& row = result.rows[k];
    // J v = d . (v_C + w x p), and of a wheel its carrier's coordinates and its spin.
    const Eigen::Vector3d moment = p_C.cross(d);
    for (std::size_t i = 0; i < 3; ++i) {
      row.value[i] = d[static_cast<Eigen::Index>(i)];
      row.value[i + 3] = moment[static_cast<Eigen::Index>(i)];
    }
    if (wheel == nullptr) {
      continue;
    }
    const Eigen::Vector3d arm = p_C - wheel->hub_m;
    row.axle = index / 2;
    row.wheel = index;
    for (std::size_t s = 0; s < 2; ++s) {
      row.value[6 + s] = d.dot(wheel->velocity_by_s[s] + wheel->rate_by_s[s].cross(arm));
    }
    row.value[8] = d.dot(wheel->axis.cross(arm));
  }
  return result;
}

void add_contacts(double h, const Velocities& start, std::span<const ContactPoint> points,
                  std::span<const VehicleContactRows> rows, VelocitySystem& system) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < 3 && !points[i].released; ++k) {
      const ImplicitForce law = points[i].acting(k);
      const VelocityRow& row = rows[i].rows[k];
      system.add(row, h * law.gain, h * law.at(row.of(start)));
    }
  }
}

bool contacts_change(const Velocities& found, std::span<ContactPoint> points,
                     std::span<const VehicleContactRows> rows) {
  bool changed = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    changed = points[i].changes(rows[i].of(found)) || changed;
  }
  return changed;
}

}  // namespace rigwire::sim
