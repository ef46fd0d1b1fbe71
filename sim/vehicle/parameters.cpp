#include "sim/vehicle/parameters.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/visitor.h"
#include "sim/principal_inertia.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr std::array<fields::Choice<VehicleLevel>, 3> kVehicleLevels{
    {{VehicleLevel::kinematic, "kinematic", "Bicycle without slip along the terrain."},
     {VehicleLevel::planar, "planar", "Slip and locks, no suspension: road and odometry."},
     {VehicleLevel::full, "full", "14 degrees of freedom: off the road."}}};

constexpr std::array<fields::Choice<AxleType>, 2> kAxleTypes{
    {{AxleType::beam, "beam", "Rigid axle on a push tube: heave and roll."},
     {AxleType::independent, "independent", "Each wheel has its own travel."}}};

void visit_stop(fields::Visitor& v, StopParameters& p, const fields::NumberRule& stiffness,
                const fields::NumberRule& ramp) {
  v.number("stiffness", p.stiffness, stiffness.between(1, 1e12),
           "Stiffness of the stop beyond its ramp.");
  v.number("ramp", p.ramp, ramp.between(0.001, 10),
           "Travel over which the stiffness grows to that.");
}

/// Visits the travel keys that a beam's side and an independent wheel share.
template <class Axle>
void visit_travel(fields::Visitor& v, Axle& p) {
  v.number("bump_travel", p.bump_travel_m, in("mm").between(0.001, 10'000),
           "Travel up to the bump stop.");
  v.number("rebound_travel", p.rebound_travel_m, in("mm").between(0.001, 10'000),
           "Travel down to the rebound stop.");
  v.group(
      "bump_stop",
      [&](fields::Visitor& w) { visit_stop(w, p.bump_stop, in("N/m"), in("m").at_most(100)); },
      "Spring at both ends of the travel.");
}

void check_beam(const std::string& axle, const BeamAxleParameters& beam, double track_m) {
  fields::require(beam.pitch_inertia_kgm2 <= 2.0 * beam.roll_inertia_kgm2,
                  axle + ".beam.pitch_inertia", in("kg m2").print(beam.pitch_inertia_kgm2),
                  "at most twice roll_inertia, " + in("kg m2").print(beam.roll_inertia_kgm2));
  fields::require(beam.spring_base_m <= 2.0 * track_m, axle + ".beam.spring_base",
                  in("m").print(beam.spring_base_m),
                  "at most twice the track, " + in("m").print(track_m));
}

void check_axle(const std::string& name, const VehicleAxleParameters& axle,
                const TyrePressureParameters& pressure, double wheel_height_m) {
  if (axle.type == AxleType::beam) {
    check_beam(name, axle.beam, axle.track_m);
  }
  fields::require(axle.initial_pressure_pa >= pressure.pressure_min_pa &&
                      axle.initial_pressure_pa <= pressure.pressure_max_pa,
                  name + ".initial_pressure", in("bar").print(axle.initial_pressure_pa),
                  "tyre_pressure.pressure_min .. pressure_max, " +
                      in("bar").print(pressure.pressure_min_pa) + " .. " +
                      in("bar").print(pressure.pressure_max_pa));
  fields::require(wheel_height_m > axle.tyre.rim_radius_m, name + ".tyre.carcass_stiffness",
                  in("kN/m").print(axle.tyre.carcass_stiffness_npm),
                  "enough to carry the wheel's static load off the rim");
}

}  // namespace

WheeledVehicleParameters::WheeledVehicleParameters() {
  for (std::size_t i = 0; i < kImplementEnds; ++i) {
    implements.hitch[i].fitted = true;
    implements.power_take_off[i].fitted = true;
  }
  front.position_x_m = 3.85;
  front.steering.angle_max_rad = 32.0 * kDegree;
  rear.parking_brake_nm = 3.2e4;
  front.parking_brake_nm = 3.2e4;
  rear.beam.articulation_rad = 15.0 * kDegree;
  front.beam.roll_bar_nmprad = 7.0e4;
  rear.beam.roll_bar_nmprad = 5.0e4;
  chassis.points = {{{4.75, 1.1, 0.85}},   {{4.75, -1.1, 0.85}}, {{-1.05, 1.1, 0.95}},
                    {{-1.05, -1.1, 0.95}}, {{4.6, 1.1, 2.7}},    {{4.6, -1.1, 2.7}},
                    {{-1.0, 1.2, 1.9}},    {{-1.0, -1.2, 1.9}},  {{1.9, 0.4, 0.62}},
                    {{1.9, -0.4, 0.62}}};
  solid.boxes = {{"cab", "body", {3.97, 0.0, 1.75}, {1.56, 2.2, 1.8}, 0.0},
                 {"frame", "body", {1.78, 0.0, 0.85}, {5.66, 0.9, 0.42}, 0.0},
                 {"bed", "body", {1.07, 0.0, 1.43}, {4.24, 2.4, 0.94}, 0.0},
                 {"front axle", "front_axle", {0.0, 0.0, -0.035}, {0.35, 1.5, 0.35}, 0.0},
                 {"rear axle", "rear_axle", {0.0, 0.0, -0.035}, {0.35, 1.5, 0.35}, 0.0}};
  solid.stiffness_npm = 4e7;
  solid.crush_n = 2.5e5;
  solid.crush_npm = 4e5;
}

StaticLoads static_loads(const WheeledVehicleParameters& parameters) {
  StaticLoads loads;
  const double g = parameters.gravity_mps2;
  const double share_front = (parameters.body.center_of_mass_m.x() - parameters.rear.position_x_m) /
                             parameters.wheelbase_m();
  const std::array<const VehicleAxleParameters*, 2> axles{&parameters.front, &parameters.rear};
  Eigen::Vector3d moment = parameters.body.mass_kg * parameters.body.center_of_mass_m;
  for (std::size_t i = 0; i < 2; ++i) {
    const VehicleAxleParameters& axle = *axles[i];
    const double mass = parameters.axle_mass_kg(axle);
    const double share = i == 0 ? share_front : 1.0 - share_front;
    loads.spring_n[i] = parameters.body.mass_kg * g * share;
    loads.wheel_n[i] = 0.5 * (loads.spring_n[i] + mass * g);
    const double stiffness = axle.tyre.carcass_stiffness_npm +
                             axle.tyre.stiffness_per_pressure_m * axle.tyre.reference_pressure_pa;
    loads.wheel_height_m[i] = axle.tyre.unloaded_radius_m - loads.wheel_n[i] / stiffness;
    loads.rolling_radius_m[i] = effective_radius_m(axle.tyre, loads.wheel_n[i] / stiffness);
    const double rise = axle.type == AxleType::beam ? axle.portal_offset_m : 0.0;
    moment += mass * Eigen::Vector3d(axle.position_x_m, 0.0, loads.wheel_height_m[i] + rise);
  }
  loads.center_of_mass_m = moment / parameters.mass_kg();
  return loads;
}

void visit(fields::Visitor& v, SprungBodyParameters& p) {
  v.number("mass", p.mass_kg, in("kg").between(10, 1e6), "All that the springs carry.");
  v.vector3("center_of_mass", p.center_of_mass_m, in("m").between(-100, 100),
            "Centre of mass, from the ground below the rear axle's middle.");
  v.vector3("principal_inertia", p.principal_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
            "Moments of inertia about the centre of mass, along the body's axes.");
}

void visit(fields::Visitor& v, BeamAxleParameters& p) {
  v.number("mass", p.mass_kg, in("kg").between(1e-6, 1e6), "Mass of the axle with its wheels.");
  v.number("roll_inertia", p.roll_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia of the axle in roll and yaw, with its wheels.");
  v.number("pitch_inertia", p.pitch_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia of the axle in pitch, without the wheels' spin.");
  v.number("tube_length", p.tube_length_m, in("m").at_least(0).at_most(100),
           "Axle to the push tube's pivot; 0 guides it straight up and down.");
  v.number("tube_rise", p.tube_rise_m, in("m").between(-100, 100),
           "Height of the push tube's pivot above the axle's centre.");
  v.number("roll_centre_rise", p.roll_centre_rise_m, in("m").between(-100, 100),
           "Height of the Panhard rod above the axle's centre.");
  v.number("spring", p.spring_npm, in("N/m").between(1, 1e12), "Spring of each side.");
  v.number("damper", p.damper_nspm, in("N s/m").between(0, 1e9), "Damper of each side.");
  v.number("spring_base", p.spring_base_m, in("m").between(0.001, 100), "Left to right spring.");
  v.number("roll_bar", p.roll_bar_nmprad, in("N m/rad").between(0, 1e12),
           "Roll bar between the two sides.");
  visit_travel(v, p);
  v.number("articulation", p.articulation_rad, in("deg").between(0.01, 60),
           "Roll against the body, to each side, up to the limiter.");
  v.group(
      "articulation_stop",
      [&](fields::Visitor& w) { visit_stop(w, p.articulation_stop, in("N m/rad"), in("rad")); },
      "Spring of the limiter.");
}

void visit(fields::Visitor& v, IndependentAxleParameters& p) {
  v.number("corner_mass", p.corner_mass_kg, in("kg").between(0.01, 1e6),
           "Mass of a wheel, its carrier and half the arms.");
  v.number("corner_inertia", p.corner_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia of a corner about a diameter of the wheel.");
  v.number("spring", p.spring_npm, in("N/m").between(1, 1e12),
           "Spring of each side, at the wheel.");
  v.number("damper", p.damper_nspm, in("N s/m").between(0, 1e9),
           "Damper of each side, at the wheel.");
  v.number("roll_bar", p.roll_bar_npm, in("N/m").between(0, 1e12),
           "Force of the roll bar per difference of travels.");
  visit_travel(v, p);
  v.number("camber_gain", p.camber_gain_radpm, in("rad/m").between(-5, 5),
           "Camber per bump travel, top outward positive.");
  v.number("toe_gain", p.toe_gain_radpm, in("rad/m").between(-5, 5),
           "Toe per bump travel, toe-in positive.");
}

void visit(fields::Visitor& v, SteeringParameters& p) {
  v.number("angle_max", p.angle_max_rad, in("deg").between(0, 60),
           "Greatest angle of the equivalent single wheel; 0: the axle does not steer.");
  v.number("rate_max", p.rate_max_radps, in("deg/s").between(0.01, 10'000),
           "Greatest rate of the equivalent single wheel.");
  v.number("time_constant", p.time_constant_s, in("ms").between(0, 1e6),
           "Lag of the steering below its greatest rate.");
}

void visit(fields::Visitor& v, VehicleAxleParameters& p) {
  v.choice("type", p.type, kAxleTypes, "Beam or independent wheels.");
  v.number("position", p.position_x_m, in("m").between(-100, 100),
           "x of the axle in the body's frame.");
  v.number("track", p.track_m, in("m").between(0.001, 100), "Between the wheels' centres.");
  v.number("portal_offset", p.portal_offset_m, in("mm").between(-10'000, 10'000),
           "Wheel's centre below the beam's.");
  v.number("wheel_spin_inertia", p.wheel_spin_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia of one wheel with tyre and hub about its axle.");
  v.only_if(p.type == AxleType::beam, "type", "type: beam", [&p](fields::Visitor& w) {
    w.section("beam", p.beam, "Beam with its springs and dampers.");
  });
  v.only_if(p.type == AxleType::independent, "type", "type: independent", [&p](fields::Visitor& w) {
    w.section("independent", p.independent, "Springs and dampers of each wheel.");
  });
  v.section("tyre", p.tyre, "Both tyres.");
  v.section("steering", p.steering, "Actuator and linkage.");
  v.number("brake_torque", p.brake_torque_nm, in("N m").between(0, 1e8),
           "Torque of both wheels' brakes, pedal down.");
  v.number("parking_brake", p.parking_brake_nm, in("N m").between(0, 1e8),
           "Torque of both wheels' parking brakes.");
  v.number("initial_pressure", p.initial_pressure_pa, in("bar").between(0.01, 1000),
           "Pressure of the axle's tyres at the start.");
}

void visit(fields::Visitor& v, TyrePressureParameters& p) {
  v.boolean("adjustable", p.adjustable, "Whether set points are followed.");
  v.number("inflate_time_constant", p.inflate_time_constant_s, in("s").between(0.001, 1e5),
           "Lag of a rising pressure.");
  v.number("deflate_time_constant", p.deflate_time_constant_s, in("s").between(0.001, 1e5),
           "Lag of a falling pressure.");
  v.number("pressure_min", p.pressure_min_pa, in("bar").between(0.01, 1000), "Least set point.");
  v.number("pressure_max", p.pressure_max_pa, in("bar").between(0.01, 1000), "Greatest set point.");
}

void visit(fields::Visitor& v, ChassisPoint& p) {
  v.vector3("position", p.position_m, in("m").between(-100, 100), "Corner in the body's frame.");
}

void visit(fields::Visitor& v, ChassisContactParameters& p) {
  v.list("points", p.points, "Corners that may hit the ground, at most 16.");
  v.number("stiffness", p.stiffness_npm, in("N/m").between(1, 1e12), "Stiffness of each corner.");
  v.number("damping", p.damping_nspm, in("N s/m").between(0, 1e9), "Damping of each corner.");
}

void visit(fields::Visitor& v, HitchParameters& p) {
  v.boolean("fitted", p.fitted, "Whether there is a hitch.");
  v.only_if(p.fitted, "fitted", "fitted: true", [&p](fields::Visitor& w) {
    w.number("travel_time", p.travel_time_s, in("s").between(0.001, 1e5), "Time from down to up.");
  });
}

void visit(fields::Visitor& v, PowerTakeOffParameters& p) {
  v.boolean("fitted", p.fitted, "Whether there is a power take-off.");
  v.only_if(p.fitted, "fitted", "fitted: true", [&p](fields::Visitor& w) {
    w.number("ratio", p.ratio, plain().between(1e-6, 1e6), "Engine's speed over the shaft's.");
    w.number("engage_time", p.engage_time_s, in("s").between(0.001, 1e5),
             "Time in which its clutch brings the shaft to speed, and to rest.");
  });
}

void visit(fields::Visitor& v, ImplementParameters& p) {
  v.section("front_hitch", p.hitch[0], "Hitch at the front.");
  v.section("rear_hitch", p.hitch[1], "Hitch at the rear.");
  v.section("front_power_take_off", p.power_take_off[0], "Power take-off at the front.");
  v.section("rear_power_take_off", p.power_take_off[1], "Power take-off at the rear.");
}

void visit(fields::Visitor& v, WheeledVehicleParameters& p) {
  v.choice("level", p.level, kVehicleLevels, "How much of the vehicle is computed.");
  v.section("body", p.body, "What the springs carry.");
  v.section("front", p.front, "Front axle.");
  v.section("rear", p.rear, "Rear axle.");
  v.number("brake_stiffness", p.brake_stiffness_nmprad, in("N m/rad").between(0.001, 1e12),
           "Stiffness of a brake that holds, at the wheel.");
  v.number("brake_lag", p.brake_lag_s, in("ms").between(0, 10'000),
           "Lag of the service brake's torque behind its demand; 0 = none.");
  v.section("tyre_pressure", p.tyre_pressure, "Central tyre inflation.");
  v.section("chassis", p.chassis, "Corners that may hit the ground.");
  v.section("solid", p.solid,
            "Parts of the machine that collide with trunks, rocks, walls and trucks.");
  v.section("travel", p.travel, "Controller of the travel speed.");
  v.section("implements", p.implements, "Hitches and power take-offs.");
  v.number("air_drag", p.air_drag_ns2pm2, plain().between(0, 1e6),
           "Air drag per speed squared, N per (m/s)^2.");
  v.number("step", p.step_s, in("ms").between(0.001, 20), "Longest inner step of the vehicle.");
  v.number("gravity", p.gravity_mps2, in("m/s2").between(0, 1000),
           "Acceleration of gravity, downwards.");
}

void validate(const SprungBodyParameters& p) {
  fields::check(p);
  require_principal_inertia(p.principal_inertia_kgm2);
}

void validate(const TyrePressureParameters& p) {
  fields::check(p);
  fields::require(p.pressure_max_pa > p.pressure_min_pa, "pressure_max",
                  in("bar").print(p.pressure_max_pa),
                  "above pressure_min, " + in("bar").print(p.pressure_min_pa));
}

void validate(const ChassisContactParameters& p) {
  fields::check(p);
  fields::require(p.points.size() <= kChassisPoints, "points",
                  std::to_string(p.points.size()) + " points",
                  "at most " + std::to_string(kChassisPoints) + " points");
}

void validate(const WheeledVehicleParameters& p) {
  fields::check(p);
  fields::require(p.wheelbase_m() > 0.0, "front.position", in("m").print(p.front.position_x_m),
                  "in front of the rear axle, above " + in("m").print(p.rear.position_x_m));
  const double center_x_m = p.body.center_of_mass_m.x();
  fields::require(center_x_m > p.rear.position_x_m && center_x_m < p.front.position_x_m,
                  "body.center_of_mass.0", in("m").print(center_x_m), "between the axles");
  validate(p.solid, kWheeledLinks, p.body.mass_kg, p.step_s);
  const StaticLoads loads = static_loads(p);
  check_axle("front", p.front, p.tyre_pressure, loads.wheel_height_m[0]);
  check_axle("rear", p.rear, p.tyre_pressure, loads.wheel_height_m[1]);
}

}  // namespace rigwire::sim
