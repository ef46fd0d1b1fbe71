#include "sim/roller/parameters.h"

#include <array>
#include <cmath>
#include <utility>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

constexpr std::array<fields::Choice<RollerLevel>, 2> kRollerLevels{
    {{RollerLevel::kinematic, "kinematic", "Drums roll without slip."},
     {RollerLevel::dynamic, "dynamic", "Slip, scrub, drive and brakes."}}};

}  // namespace

void visit(fields::Visitor& v, DrumParameters& p) {
  v.number("width", p.width_m, in("mm").between(0.001, 10'000), "Width of each drum.");
  v.number("radius", p.radius_m, in("mm").between(0.001, 10'000), "Radius of each drum.");
  v.number("spin_inertia", p.spin_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia of each drum about its axle.");
  v.integer("strips", p.strips, IntegerRule{1, kDrumStripsMax},
            "Contact strips along the width; an even number has the whole scrub moment.");
  v.number("slip_stiffness", p.slip_stiffness_n, in("kN").between(0.001, 1e8),
           "Longitudinal force per slip of 1, at small slip.");
  v.number("cornering_stiffness", p.cornering_stiffness_nprad, in("N/rad").between(1, 1e11),
           "Lateral force per slip angle, at small angles.");
  v.number("relaxation_length", p.relaxation_length_m, in("mm").between(0.001, 10'000),
           "Way on which slip forces build up.");
  v.number("contact_length", p.contact_length_m, in("mm").between(0.001, 10'000),
           "Length of the contact on soft soil.");
  v.number("damping_ratio", p.damping_ratio, plain().between(0, 10),
           "Damping ratio of the contact's bristles.");
  v.number("friction_factor", p.friction_factor, plain().between(0, 1e6),
           "Friction of steel on the ground, against rubber on it.");
  v.number("rolling_resistance", p.rolling_resistance, plain().between(0, 0.99),
           "Coefficient of rolling resistance on hard ground.");
}

EngineConditionParameters roller_engine() {
  EngineConditionParameters p;
  p.tank_m3 = 0.150;
  p.indicated_efficiency = 0.42;
  p.water_equivalent_kg = 45.0;
  p.closed_kpw = 0.03;
  p.open_kpw = 1.0e-3;
  p.charging_v = 14.2;
  p.rest_v = 12.6;
  p.consumers_a = 15.0;
  return p;
}

void visit(fields::Visitor& v, RollerParameters& p) {
  v.choice("level", p.level, kRollerLevels, "What is modelled.");
  v.number("mass", p.mass_kg, in("kg").between(10, 1e6),
           "Mass with drums, without water and chips.");
  v.number("yaw_inertia", p.yaw_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia in yaw about the centre of mass, without water and chips.");
  v.number("roll_inertia", p.roll_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia in roll about the centre of mass, without water and chips.");
  v.number("pitch_inertia", p.pitch_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia in pitch about the centre of mass, without water, chips and the drums' spins.");
  v.number("center_of_mass_x", p.center_of_mass_x_m, in("m").between(-100, 100),
           "Centre of mass forward of half way between the pivots.");
  v.number("center_of_mass_height", p.center_of_mass_height_m, in("m").at_least(0).at_most(100),
           "Centre of mass above ground.");
  v.number("pivot_x", p.pivot_x_m, in("m").between(0.001, 100),
           "Half the distance of the drums' axles.");
  v.section("drum", p.drum, "Both drums.");
  v.section("steering", p.steering, "Both pivots.");
  v.section("drive", p.drive, "Engine, pump and motors.");
  v.boolean("travel_control", p.travel_control,
            "Whether a controller holds a commanded travel speed and brakes at rest.");
  v.section("engine", p.engine, "Temperatures, pressures, fuel and battery.");
  v.number("brake_torque", p.brake_torque_nm, in("kN m").between(0, 1e6),
           "Torque of each drum's service brake, fully applied.");
  v.number("parking_brake_torque", p.parking_brake_torque_nm, in("kN m").between(0, 1e6),
           "Torque of each drum's parking brake.");
  v.number("brake_stiffness", p.brake_stiffness_nmprad, in("N m/rad").between(0.001, 1e12),
           "Stiffness of a held drum against the frame.");
  v.section("front_vibration", p.front_vibration, "Exciter of the front drum.");
  v.section("rear_vibration", p.rear_vibration, "Exciter of the rear drum.");
  v.section("sprinkler", p.sprinkler, "Water for the drums.");
  v.section("spreader", p.spreader, "Chip hopper.");
  v.section("edge_cutter", p.edge_cutter, "Cutting wheel on an arm.");
  v.number("rest_frequency", p.rest_frequency_hz, in("Hz").between(0.01, 1000),
           "Frequency of heave, pitch and roll on mat and mounts.");
  v.number("rest_damping_ratio", p.rest_damping_ratio, plain().between(0, 10),
           "Damping ratio of heave, pitch and roll on mat and mounts.");
  v.section("solid", p.solid,
            "Parts of the machine that collide with trunks, walls and other obstacles.");
  v.number("step", p.step_s, in("ms").between(0.001, 50), "Longest inner step of the roller.");
  v.number("gravity", p.gravity_mps2, in("m/s2").between(0, 1000),
           "Acceleration of gravity, downwards.");
}

SolidBodyParameters roller_boxes() {
  SolidBodyParameters solid;
  solid.stiffness_npm = 1e8;
  solid.crush_n = 1e6;
  solid.crush_npm = 2e6;
  solid.boxes = {{"frame", "frame", {0.0, 0.0, 1.0}, {2.2, 1.4, 0.9}, 0.0},
                 {"cab", "frame", {0.0, 0.0, 2.1}, {1.8, 1.5, 1.6}, 0.0},
                 {"front yoke", "front_yoke", {0.0, 0.0, 0.45}, {1.1, 1.8, 0.3}, 0.0},
                 {"rear yoke", "rear_yoke", {0.0, 0.0, 0.45}, {1.1, 1.8, 0.3}, 0.0}};
  return solid;
}

void validate(const RollerParameters& p) {
  fields::check(p);
  if (p.level == RollerLevel::dynamic) {  // the other has no forces
    validate(p.solid, kRollerLinks, p.mass_kg, p.step_s);
  }
  fields::require(std::abs(p.center_of_mass_x_m) < p.pivot_x_m, "center_of_mass_x",
                  in("m").print(p.center_of_mass_x_m),
                  "between the pivots, " + in("m").print(p.pivot_x_m) + " to either side");
  // No distribution of mass has a moment of inertia above the sum of the other two.
  constexpr fields::NumberRule kUnit = in("kg m2");
  const double sum = p.roll_inertia_kgm2 + p.pitch_inertia_kgm2 + p.yaw_inertia_kgm2;
  for (const auto& [key, found] : {std::pair{"roll_inertia", p.roll_inertia_kgm2},
                                   {"pitch_inertia", p.pitch_inertia_kgm2},
                                   {"yaw_inertia", p.yaw_inertia_kgm2}}) {
    fields::require(2.0 * found <= sum * (1.0 + 1e-9), key, kUnit.print(found),
                    "at most the sum of the other two, " + kUnit.print(sum - found));
  }
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
  sum.inertia_kgm2 = {p.roll_inertia_kgm2, p.pitch_inertia_kgm2, p.yaw_inertia_kgm2};
  const auto move = [&sum](double mass_kg, double x_m, double height_m) {
    const double x2 = mass_kg * (x_m - sum.x_m) * (x_m - sum.x_m);
    const double z2 = mass_kg * (height_m - sum.height_m) * (height_m - sum.height_m);
    sum.inertia_kgm2 += Eigen::Vector3d(z2, x2 + z2, x2);
  };
  move(p.mass_kg, p.center_of_mass_x_m, p.center_of_mass_height_m);
  move(water_kg, p.sprinkler.x_m, p.sprinkler.height_m);
  move(chips_kg, p.spreader.x_m, p.spreader.height_m);
  sum.yaw_inertia_kgm2 = sum.inertia_kgm2.z();
  return sum;
}

}  // namespace rigwire::sim
