// How well an inertial unit measures.
#pragma once

#include <array>

#include "fields/visitor.h"
#include "sim/imu/imu_sensor.h"

namespace rigwire::sim {

/// The same parameters in the units of a gyroscope and of an accelerometer.
struct GyroscopeParameters {
  sim::InertialTriadParameters* triad;
};
struct AccelerometerParameters {
  sim::InertialTriadParameters* triad;
};

inline void visit_errors(fields::Visitor& v, sim::InertialTriadParameters& p) {
  v.number("scale_error", p.scale_error, fields::in("%").at_least(0),
           "Standard deviation, per axis.");
  v.number("misalignment", p.misalignment_rad, fields::in("deg").at_least(0),
           "Standard deviation.");
  v.number("scale_temperature", p.scale_temperature, fields::plain(), "Per kelvin from 25 degC.");
}

inline void visit(fields::Visitor& v, GyroscopeParameters& gyroscope) {
  sim::InertialTriadParameters& p = *gyroscope.triad;
  v.number("range", p.range, fields::in("deg/s").at_least(0), "Clamped beyond; 0 = unlimited.");
  v.number("resolution", p.resolution, fields::in("deg/s").at_least(0),
           "One count; 0 = continuous.");
  v.number("noise_density", p.random.noise_density, fields::in("deg/s/sqrt(Hz)").at_least(0),
           "White.");
  v.number("bias_instability", p.random.bias_instability, fields::in("deg/h").at_least(0),
           "Floor of the Allan deviation.");
  v.number("random_walk", p.random.random_walk, fields::plain().at_least(0),
           "Of the bias, rad/s/sqrt(s).");
  v.number("turn_on_bias", p.turn_on_bias, fields::in("deg/s").at_least(0), "Standard deviation.");
  v.number("bias_temperature", p.bias_temperature, fields::in("deg/s"), "Per kelvin from 25 degC.");
  visit_errors(v, p);
}

inline void visit(fields::Visitor& v, AccelerometerParameters& accelerometer) {
  sim::InertialTriadParameters& p = *accelerometer.triad;
  v.number("range", p.range, fields::in("m/s2").at_least(0), "Clamped beyond; 0 = unlimited.");
  v.number("resolution", p.resolution, fields::in("m/s2").at_least(0),
           "One count; 0 = continuous.");
  v.number("noise_density", p.random.noise_density, fields::in("ug/sqrt(Hz)").at_least(0),
           "White.");
  v.number("bias_instability", p.random.bias_instability, fields::in("ug").at_least(0),
           "Floor of the Allan deviation.");
  v.number("random_walk", p.random.random_walk, fields::plain().at_least(0),
           "Of the bias, m/s2/sqrt(s).");
  v.number("turn_on_bias", p.turn_on_bias, fields::in("mg").at_least(0), "Standard deviation.");
  v.number("bias_temperature", p.bias_temperature, fields::in("mg"), "Per kelvin from 25 degC.");
  visit_errors(v, p);
}

inline constexpr std::array<fields::Choice<sim::ImuPart>, 5> kImuParts{
    {{sim::ImuPart::perfect, "perfect", "No error at all."},
     {sim::ImuPart::openimu300, "openimu300", "Class of the ACEINNA OpenIMU300."},
     {sim::ImuPart::adis16470, "adis16470", "Analog Devices ADIS16470."},
     {sim::ImuPart::mti300, "mti300", "Xsens MTi-300."},
     {sim::ImuPart::mti30, "mti30", "Xsens MTi-30."}}};
inline constexpr std::array<fields::Choice<sim::ImuAcceleration>, 2> kImuAccelerations{
    {{sim::ImuAcceleration::solver, "solver", "That of the machine's equations."},
     {sim::ImuAcceleration::velocity_difference, "velocity_difference",
      "The paper's: change of velocity between two samples."}}};

inline void visit(fields::Visitor& v, sim::ImuParameters& p) {
  // A part sets all the others; keys beside it are read after it and count more. Printing visits
  // with the part already chosen and changes nothing.
  const sim::ImuPart before = p.part;
  v.choice("part", p.part, kImuParts, "Set of parameters that the other keys change.");
  if (p.part != before) {
    p = sim::parameters_of(p.part);
  }
  v.choice("acceleration", p.acceleration, kImuAccelerations, "Where accelerations come from.");
  GyroscopeParameters gyroscope{&p.gyroscope};
  AccelerometerParameters accelerometer{&p.accelerometer};
  v.section("gyroscope", gyroscope, "Errors of the angular rates.");
  v.section("accelerometer", accelerometer, "Errors of the specific forces.");
  v.number("g_sensitivity", p.g_sensitivity_radps_per_mps2, fields::plain(),
           "rad/s per m/s2, same axis.");
  v.number("ambient_temperature", p.ambient_temperature_c, fields::in("degC").between(-60, 150),
           "Around the device.");
  v.number("self_heating", p.self_heating_k, fields::plain().between(0, 100), "K, when warm.");
  v.number("warm_up", p.warm_up_s, fields::in("s").above(0), "Time constant of the case.");
  v.boolean("earth_rate", p.earth_rate, "Whether it feels the Earth turn.");
}

}  // namespace rigwire::sim
