#include "sim/roller/parameters.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "sim/roller/require.h"
#include "sim/roller/stability.h"

namespace rigwire::sim {
namespace {

void validate_drum(const DrumParameters& p) {
  const char* where = "roller.drum";
  require_positive(where, "width_m", p.width_m);
  require_positive(where, "radius_m", p.radius_m);
  require_positive(where, "spin_inertia_kgm2", p.spin_inertia_kgm2);
  require_number(p.strips >= 1 && p.strips <= kDrumStripsMax, where, "strips", p.strips, "1 .. 9");
  require_positive(where, "slip_stiffness_n", p.slip_stiffness_n);
  require_positive(where, "cornering_stiffness_nprad", p.cornering_stiffness_nprad);
  require_positive(where, "relaxation_length_m", p.relaxation_length_m);
  require_positive(where, "contact_length_m", p.contact_length_m);
  require_number(p.damping_ratio >= 0.0 && p.damping_ratio <= 10.0, where, "damping_ratio",
                 p.damping_ratio, "0 .. 10");
  require_not_negative(where, "friction_factor", p.friction_factor);
  require_number(p.rolling_resistance >= 0.0 && p.rolling_resistance < 1.0, where,
                 "rolling_resistance", p.rolling_resistance, ">= 0 and < 1");
}

void validate_scheme(const RollerParameters& p) {
  if (p.scheme == IntegrationScheme::linearly_implicit_euler) {
    return;
  }
  if (p.level == RollerLevel::kinematic) {
    throw std::invalid_argument(
        "roller.scheme: found another than linearly_implicit_euler, allowed "
        "linearly_implicit_euler where level is kinematic: its steps are exact arcs");
  }
  if (p.scheme == IntegrationScheme::runge_kutta4) {
    const double rate_radps = fastest_rate_radps(p);
    const double greatest_s = kRollerExplicitLimit / rate_radps;
    if (!(p.step_s <= greatest_s)) {
      std::ostringstream message;
      message << "roller.step_s: found " << p.step_s << ", allowed at most " << greatest_s
              << " s with scheme runge_kutta4: times the fastest rate of drums, brakes and oil, "
              << rate_radps << " rad/s, a step must stay below " << kRollerExplicitLimit;
      throw std::invalid_argument(message.str());
    }
  }
}

}  // namespace

void validate(const RollerParameters& p) {
  const char* where = "roller";
  require_positive(where, "mass_kg", p.mass_kg);
  require_positive(where, "yaw_inertia_kgm2", p.yaw_inertia_kgm2);
  require_positive(where, "pivot_x_m", p.pivot_x_m);
  require_number(std::abs(p.center_of_mass_x_m) < p.pivot_x_m, where, "center_of_mass_x_m",
                 p.center_of_mass_x_m, "between the pivots");
  require_not_negative(where, "center_of_mass_height_m", p.center_of_mass_height_m);
  validate_drum(p.drum);
  validate(p.steering, "roller.steering");
  validate(p.drive, "roller.drive");
  require_not_negative(where, "brake_torque_nm", p.brake_torque_nm);
  require_not_negative(where, "parking_brake_torque_nm", p.parking_brake_torque_nm);
  require_positive(where, "brake_stiffness_nmprad", p.brake_stiffness_nmprad);
  validate(p.front_vibration, "roller.front_vibration");
  validate(p.rear_vibration, "roller.rear_vibration");
  validate(p.sprinkler, "roller.sprinkler");
  validate(p.spreader, "roller.spreader");
  validate(p.edge_cutter, "roller.edge_cutter");
  require_positive(where, "rest_frequency_hz", p.rest_frequency_hz);
  require_number(p.rest_damping_ratio >= 0.0 && p.rest_damping_ratio <= 10.0, where,
                 "rest_damping_ratio", p.rest_damping_ratio, "0 .. 10");
  require_number(p.step_s >= 1e-6 && p.step_s <= 0.05, where, "step_s", p.step_s, "1e-6 .. 0.05 s");
  require_not_negative(where, "gravity_mps2", p.gravity_mps2);
  validate_scheme(p);
}

RollerMass loaded_mass(const RollerParameters& p, double water_kg, double chips_kg) {
  RollerMass sum;
  sum.mass_kg = p.mass_kg + water_kg + chips_kg;
  sum.x_m =
      (p.mass_kg * p.center_of_mass_x_m + water_kg * p.sprinkler.x_m + chips_kg * p.spreader.x_m) /
      sum.mass_kg;
  sum.height_m = (p.mass_kg * p.center_of_mass_height_m + water_kg * p.sprinkler.height_m +
                  chips_kg * p.spreader.height_m) /
                 sum.mass_kg;
  const auto moved = [&sum](double mass_kg, double x_m) {
    return mass_kg * (x_m - sum.x_m) * (x_m - sum.x_m);
  };
  sum.yaw_inertia_kgm2 = p.yaw_inertia_kgm2 + moved(p.mass_kg, p.center_of_mass_x_m) +
                         moved(water_kg, p.sprinkler.x_m) + moved(chips_kg, p.spreader.x_m);
  return sum;
}

}  // namespace rigwire::sim
