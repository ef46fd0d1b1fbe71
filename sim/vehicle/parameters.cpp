#include "sim/vehicle/parameters.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string text(double value) {
  std::ostringstream stream;
  stream.precision(9);
  stream << value;
  return stream.str();
}

void require(bool fine, const std::string& name, double found, const std::string& allowed) {
  if (!fine) {
    throw std::invalid_argument(name + ": found " + text(found) + ", allowed " + allowed);
  }
}

void positive(const std::string& name, double found) {
  require(std::isfinite(found) && found > 0.0, name, found, "finite and > 0");
}

void not_negative(const std::string& name, double found) {
  require(std::isfinite(found) && found >= 0.0, name, found, "finite and >= 0");
}

void finite(const std::string& name, double found) {
  require(std::isfinite(found), name, found, "finite");
}

void check(const std::string& name, const StopParameters& stop) {
  positive(name + ".stiffness", stop.stiffness);
  positive(name + ".ramp", stop.ramp);
}

void check(const std::string& name, const BeamAxleParameters& beam, double track_m) {
  positive(name + ".mass_kg", beam.mass_kg);
  positive(name + ".roll_inertia_kgm2", beam.roll_inertia_kgm2);
  positive(name + ".pitch_inertia_kgm2", beam.pitch_inertia_kgm2);
  require(beam.pitch_inertia_kgm2 <= 2.0 * beam.roll_inertia_kgm2, name + ".pitch_inertia_kgm2",
          beam.pitch_inertia_kgm2, "at most twice the roll inertia");
  not_negative(name + ".tube_length_m", beam.tube_length_m);
  finite(name + ".tube_rise_m", beam.tube_rise_m);
  finite(name + ".roll_centre_rise_m", beam.roll_centre_rise_m);
  positive(name + ".spring_npm", beam.spring_npm);
  not_negative(name + ".damper_nspm", beam.damper_nspm);
  require(std::isfinite(beam.spring_base_m) && beam.spring_base_m > 0.0 &&
              beam.spring_base_m <= 2.0 * track_m,
          name + ".spring_base_m", beam.spring_base_m, "> 0 and at most twice the track");
  not_negative(name + ".roll_bar_nmprad", beam.roll_bar_nmprad);
  positive(name + ".bump_travel_m", beam.bump_travel_m);
  positive(name + ".rebound_travel_m", beam.rebound_travel_m);
  check(name + ".bump_stop", beam.bump_stop);
  require(beam.articulation_rad > 0.0 && beam.articulation_rad <= 60.0 * kDegree,
          name + ".articulation_rad", beam.articulation_rad, "> 0 and at most 60 degrees");
  check(name + ".articulation_stop", beam.articulation_stop);
}

void check(const std::string& name, const IndependentAxleParameters& corner) {
  positive(name + ".corner_mass_kg", corner.corner_mass_kg);
  positive(name + ".corner_inertia_kgm2", corner.corner_inertia_kgm2);
  positive(name + ".spring_npm", corner.spring_npm);
  not_negative(name + ".damper_nspm", corner.damper_nspm);
  not_negative(name + ".roll_bar_npm", corner.roll_bar_npm);
  positive(name + ".bump_travel_m", corner.bump_travel_m);
  positive(name + ".rebound_travel_m", corner.rebound_travel_m);
  check(name + ".bump_stop", corner.bump_stop);
  require(std::abs(corner.camber_gain_radpm) <= 5.0, name + ".camber_gain_radpm",
          corner.camber_gain_radpm, "-5 .. 5");
  require(std::abs(corner.toe_gain_radpm) <= 5.0, name + ".toe_gain_radpm", corner.toe_gain_radpm,
          "-5 .. 5");
}

void check(const std::string& name, const VehicleAxleParameters& axle,
           const TyrePressureParameters& pressure) {
  finite(name + ".position_x_m", axle.position_x_m);
  positive(name + ".track_m", axle.track_m);
  finite(name + ".portal_offset_m", axle.portal_offset_m);
  positive(name + ".wheel_spin_inertia_kgm2", axle.wheel_spin_inertia_kgm2);
  if (axle.type == AxleType::beam) {
    check(name + ".beam", axle.beam, axle.track_m);
  } else {
    check(name + ".independent", axle.independent);
  }
  validate(axle.tyre, (name + ".tyre").c_str());
  require(axle.steering.angle_max_rad >= 0.0 && axle.steering.angle_max_rad <= 60.0 * kDegree,
          name + ".steering.angle_max_rad", axle.steering.angle_max_rad, "0 .. 60 degrees");
  positive(name + ".steering.rate_max_radps", axle.steering.rate_max_radps);
  not_negative(name + ".steering.time_constant_s", axle.steering.time_constant_s);
  not_negative(name + ".brake_torque_nm", axle.brake_torque_nm);
  not_negative(name + ".parking_brake_nm", axle.parking_brake_nm);
  require(axle.initial_pressure_pa >= pressure.pressure_min_pa &&
              axle.initial_pressure_pa <= pressure.pressure_max_pa,
          name + ".initial_pressure_pa", axle.initial_pressure_pa,
          "tyre_pressure.pressure_min_pa .. pressure_max_pa");
}

void check(const SprungBodyParameters& body) {
  positive("body.mass_kg", body.mass_kg);
  for (Eigen::Index i = 0; i < 3; ++i) {
    finite("body.center_of_mass_m[" + std::to_string(i) + "]", body.center_of_mass_m[i]);
    const double found = body.principal_inertia_kgm2[i];
    const double others = body.principal_inertia_kgm2.sum() - found;
    require(std::isfinite(found) && found > 0.0 && found <= others * (1.0 + 1e-9),
            "body.principal_inertia_kgm2[" + std::to_string(i) + "]", found,
            "> 0 and at most the sum of the other two (" + text(others) + ")");
  }
}

/// Larger |eigenvalue| of inertia x'' + damping x' + stiffness x = 0.
double fastest_radps(double inertia, double damping, double stiffness) {
  const double half = 0.5 * damping / inertia;
  const double square = stiffness / inertia;
  return half * half > square ? half + std::sqrt(half * half - square) : std::sqrt(square);
}

double fastest_mode_radps(const WheeledVehicleParameters& parameters,
                          const VehicleAxleParameters& axle, double wheel_n) {
  constexpr double kLoadFactor = 2.0;
  const TyreParameters& tyre = axle.tyre;
  const double pressure = parameters.tyre_pressure.adjustable
                              ? parameters.tyre_pressure.pressure_max_pa
                              : axle.initial_pressure_pa;
  const double tyre_npm = tyre.carcass_stiffness_npm + tyre.stiffness_per_pressure_m * pressure;
  const double tyre_nspm = tyre.vertical_damping_nspm;
  const double share = kLoadFactor * wheel_n / tyre.reference_load_n;
  const double carried_kg = wheel_n / std::max(parameters.gravity_mps2, 1e-3);
  const auto bristle_damping = [&](double stiffness) {
    return 2.0 * tyre.damping_ratio * std::sqrt(stiffness * carried_kg);
  };

  double fastest = 0.0;
  if (axle.type == AxleType::beam) {
    const BeamAxleParameters& beam = axle.beam;
    fastest = fastest_radps(beam.mass_kg, 2.0 * (tyre_nspm + beam.damper_nspm),
                            2.0 * (tyre_npm + beam.spring_npm) + beam.bump_stop.stiffness);
    const double track2 = 0.5 * axle.track_m * axle.track_m;
    const double base2 = 0.5 * beam.spring_base_m * beam.spring_base_m;
    const double lateral = share * tyre.lateral_stiffness_npm;
    const double drop = beam.roll_centre_rise_m + axle.portal_offset_m + tyre.unloaded_radius_m;
    fastest = std::max(
        fastest, fastest_radps(beam.roll_inertia_kgm2,
                               tyre_nspm * track2 + beam.damper_nspm * base2 +
                                   2.0 * bristle_damping(lateral) * drop * drop,
                               tyre_npm * track2 + beam.spring_npm * base2 + beam.roll_bar_nmprad +
                                   beam.articulation_stop.stiffness + 2.0 * lateral * drop * drop));
  } else {
    const IndependentAxleParameters& corner = axle.independent;
    fastest = fastest_radps(
        corner.corner_mass_kg, tyre_nspm + corner.damper_nspm,
        tyre_npm + corner.spring_npm + 2.0 * corner.roll_bar_npm + corner.bump_stop.stiffness);
  }
  const double inertia = axle.wheel_spin_inertia_kgm2;
  const double radius2 = tyre.unloaded_radius_m * tyre.unloaded_radius_m;
  const double along = share * tyre.longitudinal_stiffness_npm;
  const double brake_damping = 1.4 * std::sqrt(parameters.brake_stiffness_nmprad * inertia);
  return std::max(fastest, fastest_radps(inertia, bristle_damping(along) * radius2 + brake_damping,
                                         along * radius2 + parameters.brake_stiffness_nmprad));
}

void check_scheme(const WheeledVehicleParameters& parameters) {
  if (parameters.scheme == IntegrationScheme::linearly_implicit_euler) {
    return;
  }
  if (parameters.level != VehicleLevel::full) {
    throw std::invalid_argument(
        "scheme: found another than linearly_implicit_euler, allowed that alone unless level is "
        "full: the other levels have steps of their own");
  }
  if (parameters.scheme != IntegrationScheme::runge_kutta4) {
    return;
  }
  const double fastest = fastest_mode_radps(parameters);
  if (parameters.step_s * fastest > kRungeKutta4StepLimit) {
    throw std::invalid_argument("step_s: found " + text(parameters.step_s) + ", allowed at most " +
                                text(kRungeKutta4StepLimit / fastest) +
                                " with runge_kutta4, whose stability the fastest mode (estimated " +
                                text(fastest / (2.0 * std::numbers::pi)) + " Hz) bounds");
  }
}

}  // namespace

double fastest_mode_radps(const WheeledVehicleParameters& parameters) {
  const StaticLoads loads = static_loads(parameters);
  return std::max(fastest_mode_radps(parameters, parameters.front, loads.wheel_n[0]),
                  fastest_mode_radps(parameters, parameters.rear, loads.wheel_n[1]));
}

WheeledVehicleParameters::WheeledVehicleParameters() {
  front.position_x_m = 3.85;
  front.steering.angle_max_rad = 32.0 * kDegree;
  rear.parking_brake_nm = 3.2e4;
  front.parking_brake_nm = 3.2e4;
  rear.beam.articulation_rad = 15.0 * kDegree;
  chassis.points = {{{4.75, 1.1, 0.85}},   {{4.75, -1.1, 0.85}}, {{-1.05, 1.1, 0.95}},
                    {{-1.05, -1.1, 0.95}}, {{4.6, 1.1, 2.7}},    {{4.6, -1.1, 2.7}},
                    {{-1.0, 1.2, 1.9}},    {{-1.0, -1.2, 1.9}},  {{1.9, 0.4, 0.62}},
                    {{1.9, -0.4, 0.62}}};
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
    const double rise = axle.type == AxleType::beam ? axle.portal_offset_m : 0.0;
    moment += mass * Eigen::Vector3d(axle.position_x_m, 0.0, loads.wheel_height_m[i] + rise);
  }
  loads.center_of_mass_m = moment / parameters.mass_kg();
  return loads;
}

WheeledVehicleParameters gator_855d() {
  WheeledVehicleParameters p;
  p.body = {880.0, {0.95, 0.0, 0.66}, {230.0, 640.0, 730.0}};
  for (VehicleAxleParameters* axle : {&p.front, &p.rear}) {
    axle->type = AxleType::independent;
    axle->track_m = 1.29;
    axle->portal_offset_m = 0.0;
    axle->wheel_spin_inertia_kgm2 = 1.1;
    axle->brake_torque_nm = 1.6e3;
    axle->parking_brake_nm = 0.0;
    axle->initial_pressure_pa = 1.0e5;
    TyreParameters& tyre = axle->tyre;
    tyre.unloaded_radius_m = 0.330;
    tyre.width_m = 0.229;
    tyre.rim_radius_m = 0.152;
    tyre.carcass_stiffness_npm = 4.0e4;
    tyre.stiffness_per_pressure_m = 0.6;
    tyre.vertical_damping_nspm = 600.0;
    tyre.reference_load_n = 2.45e3;
    tyre.reference_pressure_pa = 1.0e5;
    tyre.slip_stiffness_n = 2.2e4;
    tyre.cornering_stiffness_nprad = 1.8e4;
    tyre.longitudinal_stiffness_npm = 1.0e5;
    tyre.lateral_stiffness_npm = 7.0e4;
    tyre.rolling_resistance = 0.018;
  }
  p.front.position_x_m = 2.0;
  p.front.steering = {27.0 * kDegree, 1.2, 0.05};
  p.rear.steering = {0.0, 1.2, 0.05};
  p.rear.tyre.width_m = 0.279;
  p.rear.independent.spring_npm = 3.0e4;
  p.rear.parking_brake_nm = 3.2e3;
  p.brake_stiffness_nmprad = 2.0e4;
  p.tyre_pressure.adjustable = false;
  p.tyre_pressure.pressure_min_pa = 0.3e5;
  p.tyre_pressure.pressure_max_pa = 2.5e5;
  p.chassis.stiffness_npm = 2.0e5;
  p.chassis.damping_nspm = 4.0e3;
  p.chassis.points = {{{2.45, 0.6, 0.5}},   {{2.45, -0.6, 0.5}}, {{-0.55, 0.7, 0.6}},
                      {{-0.55, -0.7, 0.6}}, {{1.3, 0.6, 1.9}},   {{1.3, -0.6, 1.9}},
                      {{0.5, 0.6, 1.9}},    {{0.5, -0.6, 1.9}},  {{1.0, 0.3, 0.3}},
                      {{1.0, -0.3, 0.3}}};
  p.air_drag_ns2pm2 = 1.2;
  return p;
}

void validate(const WheeledVehicleParameters& parameters) {
  check(parameters.body);
  const TyrePressureParameters& pressure = parameters.tyre_pressure;
  positive("tyre_pressure.inflate_time_constant_s", pressure.inflate_time_constant_s);
  positive("tyre_pressure.deflate_time_constant_s", pressure.deflate_time_constant_s);
  positive("tyre_pressure.pressure_min_pa", pressure.pressure_min_pa);
  require(pressure.pressure_max_pa > pressure.pressure_min_pa &&
              std::isfinite(pressure.pressure_max_pa),
          "tyre_pressure.pressure_max_pa", pressure.pressure_max_pa, "above pressure_min_pa");
  check("front", parameters.front, pressure);
  check("rear", parameters.rear, pressure);
  require(parameters.wheelbase_m() > 0.0, "front.position_x_m", parameters.front.position_x_m,
          "in front of the rear axle, " + text(parameters.rear.position_x_m));
  require(parameters.body.center_of_mass_m.x() > parameters.rear.position_x_m &&
              parameters.body.center_of_mass_m.x() < parameters.front.position_x_m,
          "body.center_of_mass_m[0]", parameters.body.center_of_mass_m.x(), "between the axles");
  positive("brake_stiffness_nmprad", parameters.brake_stiffness_nmprad);
  not_negative("air_drag_ns2pm2", parameters.air_drag_ns2pm2);
  positive("chassis.stiffness_npm", parameters.chassis.stiffness_npm);
  not_negative("chassis.damping_nspm", parameters.chassis.damping_nspm);
  require(parameters.chassis.points.size() <= 16, "chassis.points",
          static_cast<double>(parameters.chassis.points.size()), "at most 16 points");
  for (const ChassisPoint& point : parameters.chassis.points) {
    finite("chassis.points.position_m", point.position_m.sum());
  }
  require(parameters.step_s > 0.0 && parameters.step_s <= 0.02, "step_s", parameters.step_s,
          "> 0 and at most 0.02");
  not_negative("gravity_mps2", parameters.gravity_mps2);
  const StaticLoads loads = static_loads(parameters);
  for (std::size_t i = 0; i < 2; ++i) {
    const VehicleAxleParameters& axle = i == 0 ? parameters.front : parameters.rear;
    require(loads.wheel_height_m[i] > axle.tyre.rim_radius_m,
            std::string(i == 0 ? "front" : "rear") + ".tyre.carcass_stiffness_npm",
            axle.tyre.carcass_stiffness_npm, "enough to carry the wheel's static load off the rim");
  }
  check_scheme(parameters);
}

}  // namespace rigwire::sim
