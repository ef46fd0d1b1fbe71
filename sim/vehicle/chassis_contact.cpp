#include "sim/vehicle/chassis_contact.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

/// J of a point of the body: J v = direction . (v_C + w x point).
VelocityRow body_row(const Eigen::Vector3d& direction, const Eigen::Vector3d& point) {
  VelocityRow row;
  const Eigen::Vector3d moment = point.cross(direction);
  for (Eigen::Index i = 0; i < 3; ++i) {
    row.value[static_cast<std::size_t>(i)] = direction[i];
    row.value[static_cast<std::size_t>(i + 3)] = moment[i];
  }
  return row;
}

}  // namespace

ChassisContact::ChassisContact(const WheeledVehicleParameters& parameters)
    : count_(std::min(parameters.chassis.points.size(), kChassisPoints)),
      stiffness_npm_(parameters.chassis.stiffness_npm),
      damping_nspm_(parameters.chassis.damping_nspm),
      bristle_{0.5 * parameters.chassis.stiffness_npm, parameters.chassis.damping_nspm, 1.0} {
  for (std::size_t i = 0; i < count_; ++i) {
    points_[i].position_m =
        parameters.chassis.points[i].position_m - parameters.body.center_of_mass_m;
  }
}

void ChassisContact::begin(double h, const Ground& ground, const Eigen::Vector3d& p_WC,
                           const Eigen::Matrix3d& R_WB, const Velocities& start) {
  active_ = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    Point& point = points_[i];
    const auto found = ground.terrain_penetration(p_WC + R_WB * point.position_m);
    if (!found || !(found->depth_m > 0.0)) {
      if (point.touching) {
        point.across[0].reset();
        point.across[1].reset();
        point.touching = false;
        point.sliding = false;
      }
      continue;
    }
    ++active_;
    point.touching = true;
    point.released = false;
    point.friction = found->friction;
    const Eigen::Vector3d& n_W = found->normal_W;
    // Two directions across that turn with the normal only.
    const Eigen::Vector3d helper =
        std::abs(n_W.x()) < 0.8 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    const Eigen::Vector3d t1_W = n_W.cross(helper).normalized();
    const Eigen::Vector3d t2_W = n_W.cross(t1_W);
    // k (d - h u) - c u, u away from the ground at the step's end, as offset - gain u.
    point.normal = {stiffness_npm_ * found->depth_m, stiffness_npm_ * h + damping_nspm_};
    point.normal_row = body_row(R_WB.transpose() * n_W, point.position_m);
    point.tangent_row = {body_row(R_WB.transpose() * t1_W, point.position_m),
                         body_row(R_WB.transpose() * t2_W, point.position_m)};
    for (std::size_t k = 0; k < 2; ++k) {
      point.tangent[k] = point.across[k].force(bristle_, h, 0.0);
    }
    // First guess while sliding: last step's direction at mu times this load.
    if (point.sliding) {
      const double limit =
          point.friction * std::max(0.0, point.normal.at(point.normal_row.of(start)));
      const double held = std::hypot(point.held_n[0], point.held_n[1]);
      const double scale = held > 0.0 ? limit / held : 0.0;
      point.held_n[0] *= scale;
      point.held_n[1] *= scale;
    }
  }
}

void ChassisContact::add(double h, const Velocities& start, VelocitySystem& system) const {
  if (active_ == 0) {
    return;
  }
  for (std::size_t i = 0; i < count_; ++i) {
    const Point& point = points_[i];
    if (!point.touching || point.released) {
      continue;
    }
    system.add_body(point.normal_row, h * point.normal.gain,
                    h * point.normal.at(point.normal_row.of(start)));
    for (std::size_t k = 0; k < 2; ++k) {
      if (point.sliding) {
        system.add_body(point.tangent_row[k], 0.0, h * point.held_n[k]);
      } else {
        system.add_body(point.tangent_row[k], h * point.tangent[k].gain,
                        h * point.tangent[k].at(point.tangent_row[k].of(start)));
      }
    }
  }
}

bool ChassisContact::changes(const Velocities& found) {
  bool changed = false;
  for (std::size_t i = 0; active_ > 0 && i < count_; ++i) {
    Point& point = points_[i];
    if (!point.touching) {
      continue;
    }
    // Unilateral contact: a corner that would pull lets go.
    const double normal = point.normal.at(point.normal_row.of(found));
    if ((normal < 0.0) != point.released) {
      point.released = normal < 0.0;
      changed = true;
    }
    if (point.released) {
      continue;
    }
    const double limit = point.friction * normal;
    // Coulomb's cone on the trial force of both bristles, clamped last.
    const double first = point.tangent[0].at(point.tangent_row[0].of(found));
    const double second = point.tangent[1].at(point.tangent_row[1].of(found));
    const double trial = std::hypot(first, second);
    if (trial <= limit) {
      changed = changed || point.sliding;
      point.sliding = false;
      continue;
    }
    const std::array<double, 2> held{limit * first / trial, limit * second / trial};
    if (!point.sliding || std::abs(held[0] - point.held_n[0]) > 1e-2 * limit ||
        std::abs(held[1] - point.held_n[1]) > 1e-2 * limit) {
      changed = true;
      point.sliding = true;
      point.held_n = held;
    }
  }
  return changed;
}

void ChassisContact::settle(double h, const Velocities& found) {
  for (std::size_t i = 0; active_ > 0 && i < count_; ++i) {
    Point& point = points_[i];
    if (!point.touching) {
      continue;
    }
    if (point.released) {
      point.across[0].reset();
      point.across[1].reset();
      continue;
    }
    for (std::size_t k = 0; k < 2; ++k) {
      point.across[k].slide(bristle_, h, 0.0, point.tangent_row[k].of(found));
    }
    yield_as_bent(point.across, bristle_,
                  point.friction * std::max(0.0, point.normal.at(point.normal_row.of(found))));
  }
}

}  // namespace rigwire::sim
