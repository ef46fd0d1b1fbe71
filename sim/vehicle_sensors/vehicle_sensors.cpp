#include "sim/vehicle_sensors/vehicle_sensors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/random.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;

namespace {

double quantised(double value, double quantum) {
  return quantum > 0.0 ? std::round(value / quantum) * quantum : value;
}

const VehicleSensorParameters& checked(const VehicleSensorParameters& parameters) {
  validate(parameters);
  return parameters;
}

const OdometryParameters& checked(const OdometryParameters& parameters) {
  validate(parameters);
  return parameters;
}

}  // namespace

void visit(fields::Visitor& v, GroundRadarParameters& p) {
  v.boolean("fitted", p.fitted, "Whether there is one; without, no ground-based speed.");
  v.only_if(p.fitted, "fitted", "fitted: true", [&p](fields::Visitor& w) {
    w.number("least_speed", p.least_mps, in("m/s").between(0, 10),
             "Speed below which it gives no pulses.");
    w.number("greatest_speed", p.greatest_mps, in("m/s").above(0),
             "Speed above which its pulses come no faster.");
    w.number("pulses_per_metre", p.pulses_pm, fields::plain().above(0),
             "Doppler pulses in a metre of way.");
    w.number("gate", p.gate_s, in("ms").above(0), "Time over which pulses are counted.");
    w.number("scale_error", p.scale_error, in("%").between(0, 20),
             "Standard deviation of its scale: of the angle that it is mounted at.");
  });
}

void visit(fields::Visitor& v, VehicleSensorParameters& p) {
  v.boolean("perfect", p.perfect, "No error at all.");
  v.only_if(!p.perfect, "perfect", "perfect: false", [&p](fields::Visitor& w) {
    w.integer("ticks_per_revolution", p.ticks_per_revolution, IntegerRule{0, 1000000},
              "Ticks of a wheel's encoder in a revolution; 0 = continuous.");
    w.number("gate", p.gate_s, in("ms").above(0), "Time over which ticks are counted.");
    w.number("dead_rate", p.dead_rate_radps, in("rad/s").at_least(0),
             "Wheel rate below which there are no ticks.");
    w.number("known_radius", p.known_radius_m, in("m").at_least(0).at_most(100),
             "The controller's wheel radius at every pressure; 0 = the true one.");
    w.number("radius_error", p.radius_error, in("%").between(0, 20),
             "Standard deviation of the radius that the controller knows.");
    w.number("steer_offset", p.steer_offset_rad, in("deg").at_least(0),
             "Standard deviation of each axle's steering offset.");
    w.number("steer_quantum", p.steer_quantum_rad, in("deg").at_least(0),
             "Step of the steering angle; 0 = continuous.");
    w.number("steer_play", p.steer_play_rad, in("deg").at_least(0),
             "Width of the steering sensor's backlash.");
    w.number("pressure_offset", p.pressure_offset_pa, in("kPa").at_least(0),
             "Standard deviation of each pressure's offset.");
    w.number("pressure_quantum", p.pressure_quantum_pa, in("kPa").at_least(0),
             "Step of the pressures; 0 = continuous.");
    w.section("ground_radar", p.ground_radar, "Speed over the ground by Doppler radar.");
  });
}

void validate(const VehicleSensorParameters& p) {
  fields::check(p);
}

VehicleSensors::VehicleSensors(const VehicleSensorParameters& parameters,
                               const OdometryParameters& odometry, std::uint64_t seed,
                               std::string_view name)
    : parameters_(checked(parameters)), odometry_(checked(odometry)) {
  const std::string prefix(name);
  RandomStream radius(seed, prefix + "/wheel_radius");
  for (double& factor : radius_factor_) {
    // Five deviations at most: a radius stays a radius.
    factor = 1.0 + parameters_.radius_error * std::clamp(radius.gaussian(), -4.9, 4.9);
  }
  RandomStream steering(seed, prefix + "/steering");
  for (Steering& axle : steering_) {
    axle.offset_rad = parameters_.steer_offset_rad * steering.gaussian();
  }
  RandomStream radar(seed, prefix + "/ground_radar");
  radar_.factor =
      1.0 + parameters_.ground_radar.scale_error * std::clamp(radar.gaussian(), -4.9, 4.9);
  RandomStream pressure(seed, prefix + "/pressure");
  for (double& offset : pressure_offset_pa_) {
    offset = parameters_.pressure_offset_pa * pressure.gaussian();
  }
}

void VehicleSensors::count(const VehicleSample& exact) {
  const VehicleSensorParameters& p = parameters_;
  const double tick_rad = 2.0 * std::numbers::pi / p.ticks_per_revolution;
  const double span_s = started_ ? std::max(0.0, to_seconds(exact.time - last_time_)) : 0.0;
  gate_elapsed_s_ += span_s;
  const bool gate_ends = gate_elapsed_s_ >= p.gate_s - 1e-9;
  for (std::size_t i = 0; i < kWheels; ++i) {
    Encoder& encoder = encoders_[i];
    const double rate = exact.wheel_rate_radps[i];
    const double seen = std::isfinite(rate) && std::abs(rate) >= p.dead_rate_radps ? rate : 0.0;
    if (!started_) {
      // First reading, as after a gate at this rate: whole ticks.
      encoder.reading_radps = std::round(seen * p.gate_s / tick_rad) * tick_rad / p.gate_s;
    }
    // Angle by the trapezoidal rule, in ticks; the rate is the whole ticks of a gate over its time.
    encoder.ticks += 0.5 * (encoder.last_radps + seen) * span_s / tick_rad;
    encoder.last_radps = seen;
    if (gate_ends) {
      // A count that is whole but for rounding is whole.
      const double whole = std::floor(encoder.ticks + 1e-9);
      encoder.reading_radps = whole * tick_rad / gate_elapsed_s_;
      encoder.ticks -= whole;
    }
  }
  if (gate_ends) {
    gate_elapsed_s_ = 0.0;
  }
}

double VehicleSensors::ground_speed(const VehicleSample& exact) {
  const GroundRadarParameters& p = parameters_.ground_radar;
  if (!p.fitted || !std::isfinite(exact.ground_speed_mps)) {
    return p.fitted ? exact.ground_speed_mps : kNotMeasured;
  }
  const double speed_mps = std::abs(exact.ground_speed_mps);
  const double seen_mps =
      speed_mps < p.least_mps ? 0.0 : radar_.factor * std::min(speed_mps, p.greatest_mps);
  const double span_s = started_ ? std::max(0.0, to_seconds(exact.time - last_time_)) : 0.0;
  if (!started_) {
    radar_.reading_mps = std::round(seen_mps * p.gate_s * p.pulses_pm) / (p.gate_s * p.pulses_pm);
  }
  // Way by the trapezoidal rule, in pulses; whole ones of a gate over its time.
  radar_.pulses += 0.5 * (radar_.last_mps + seen_mps) * span_s * p.pulses_pm;
  radar_.last_mps = seen_mps;
  radar_.elapsed_s += span_s;
  if (radar_.elapsed_s >= p.gate_s - 1e-9) {
    const double whole = std::floor(radar_.pulses + 1e-9);
    radar_.reading_mps = whole / (p.pulses_pm * radar_.elapsed_s);
    radar_.pulses -= whole;
    radar_.elapsed_s = 0.0;
  }
  return radar_.reading_mps;
}

double VehicleSensors::steering_angle(Steering& steering, double angle_rad) const {
  if (!std::isfinite(angle_rad)) {
    return angle_rad;
  }
  // Backlash: the shaft follows only where it would be farther than half the play.
  const double half = 0.5 * parameters_.steer_play_rad;
  if (!steering.known) {
    steering.shaft_rad = angle_rad;
    steering.known = true;
  }
  steering.shaft_rad = std::clamp(steering.shaft_rad, angle_rad - half, angle_rad + half);
  return quantised(steering.shaft_rad + steering.offset_rad, parameters_.steer_quantum_rad);
}

double VehicleSensors::pressure(double exact_pa, double offset_pa) const {
  if (!std::isfinite(exact_pa)) {
    return exact_pa;
  }
  return std::max(0.0, quantised(exact_pa + offset_pa, parameters_.pressure_quantum_pa));
}

// Replaces exact values by readings: encoder ticks or a dead rate, radii and pressures with their
// errors, ground radar and steering sensors; then computes the odometry from the readings.
VehicleSample VehicleSensors::measure(const VehicleSample& exact) {
  VehicleSample reading = exact;
  if (!parameters_.perfect) {
    if (parameters_.ticks_per_revolution > 0) {
      count(exact);
    }
    for (std::size_t i = 0; i < kWheels; ++i) {
      const double rate = exact.wheel_rate_radps[i];
      if (!std::isfinite(rate)) {
        continue;
      }
      if (parameters_.ticks_per_revolution > 0) {
        reading.wheel_rate_radps[i] = encoders_[i].reading_radps;
      } else if (std::abs(rate) < parameters_.dead_rate_radps) {
        reading.wheel_rate_radps[i] = 0.0;
      }
    }
    for (std::size_t i = 0; i < kWheels; ++i) {
      const double known = parameters_.known_radius_m;
      reading.wheel_radius_m[i] =
          (known > 0.0 ? known : exact.wheel_radius_m[i]) * radius_factor_[i];
      reading.tyre_pressure_pa[i] = pressure(exact.tyre_pressure_pa[i], pressure_offset_pa_[i]);
    }
    reading.ground_speed_mps = ground_speed(exact);
    reading.hydraulic_pressure_pa =
        pressure(exact.hydraulic_pressure_pa, pressure_offset_pa_[kWheels]);
    reading.front_steer_rad = steering_angle(steering_[0], exact.front_steer_rad);
    reading.rear_steer_rad = steering_angle(steering_[1], exact.rear_steer_rad);
    last_time_ = started_ ? std::max(last_time_, exact.time) : exact.time;
    started_ = true;
  }
  reading.odometry = odometry(odometry_, reading);
  return reading;
}

}  // namespace rigwire::sim
