// A vehicle's solid bodies (boxes of its file, wheels as cylinders) against obstacles, for the
// three levels: bodies from parameters, links' poses and rows from what a level has.
#pragma once

#include <array>
#include <vector>

#include "sim/contact/contact_set.h"
#include "sim/vehicle/suspension.h"
#include "sim/vehicle/velocity_system.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::sim {

/// Returns the boxes, damped for the whole machine's mass, the wheels with their tyres' width and
/// radial stiffness at the pressures of the start, and in them the rims, as hard as the boxes. At
/// level full the boxes and the chassis' points contact the terrain, too.
[[nodiscard]] ContactSet vehicle_contact(const WheeledVehicleParameters& parameters,
                                         const StaticLoads& loads, const Ground& ground);

/// No point of the vehicle is farther from its origin.
[[nodiscard]] double vehicle_reach_m(const WheeledVehicleParameters& parameters);

/// What a point of contact is to a solver: the three rows of its link's velocities.
struct VehicleContactRows {
  std::array<VelocityRow, 3> rows;

  [[nodiscard]] std::array<double, 3> of(const Velocities& v) const {
    return {rows[0].of(v), rows[1].of(v), rows[2].of(v)};
  }
};

/// Rows at a point given from the body's C in its axes. `wheel`: of which the point is, with its
/// index, or the carrier of an axle with that of one of its wheels; null: of the body.
[[nodiscard]] VehicleContactRows contact_rows(const ContactPoint& point,
                                              const Eigen::Matrix3d& R_WB,
                                              const Eigen::Vector3d& p_C, const WheelFrame* wheel,
                                              std::size_t index);

/// Puts what holds in this pass into the system.
void add_contacts(double h, const Velocities& start, std::span<const ContactPoint> points,
                  std::span<const VehicleContactRows> rows, VelocitySystem& system);
/// True when one is at another limit than in this pass.
[[nodiscard]] bool contacts_change(const Velocities& found, std::span<ContactPoint> points,
                                   std::span<const VehicleContactRows> rows);

}  // namespace rigwire::sim
