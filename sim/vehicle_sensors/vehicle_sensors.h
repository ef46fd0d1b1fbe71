// The machine's own sensors, which give its controllers readings with errors.
//
// - Wheel speed: a toothed wheel with `ticks_per_revolution`. Whole ticks are counted over a gate
//   (the period of the bus message) and divided by it, so that a reading is quantised by
//   2 pi / (ticks * gate), lags by half a gate and loses no distance: a fraction of a tick counts
//   next time. Below `dead_rate_radps` the pick-up gives nothing. 0 ticks: continuous, no gate.
// - Wheel radius: the true one or a constant, so that lowered pressure shows as too much distance;
//   off by a factor drawn once for each wheel.
// - Steering angle: play (the sensor follows only beyond it), then an offset drawn once for each
//   axle, then quantisation.
// - Ground radar: Doppler pulses by distance over the ground, whole ones counted over a gate and
//   divided by it, as the wheels' ticks are; nothing below `least`, and at most `greatest`. Its
//   mounting angle causes a factor that is drawn once. It senses no direction.
// - Pressures: an offset drawn once for each, quantised, never negative.
// - Odometry is computed from these readings.
//
// Everything else passes through. Errors come from the streams "<name>/wheel_radius",
// "<name>/steering", "<name>/pressure", "<name>/ground_radar", drawn at construction only; a
// reading's error depends on the readings before it, not on the physics step.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "fields/rules.h"
#include "sim/odometry/odometry.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::sim {

/// Speed over the ground by radar. Defaults: Parker TGSS 740 (user manual, 5.2: 0.3 to 44 mph, 58.9
/// Hz per mph at 35 degrees and 24.125 GHz); gate and error are estimates.
struct GroundRadarParameters {
  bool fitted = true;
  double least_mps = 0.134;
  double greatest_mps = 19.67;
  double pulses_pm = 131.8;
  double gate_s = 0.3;
  double scale_error = 0.01;  ///< Standard deviation, share: 0.8 degrees of mounting angle.

  friend bool operator==(const GroundRadarParameters&, const GroundRadarParameters&) = default;
};
void visit(fields::Visitor& v, GroundRadarParameters& p);

/// Defaults are estimates for an industrial vehicle.
struct VehicleSensorParameters {
  bool perfect = false;  ///< No error at all, whatever the others say.

  int ticks_per_revolution = 500;  ///< 0: continuous.
  double gate_s = 0.1;
  double dead_rate_radps = 0.5;  ///< Passive pick-up below about 1 km/h.
  /// Constant that the controller turns rates into speeds with, whatever load and tyre pressure
  /// make of the true radius; 0: it knows the true one.
  double known_radius_m = 0.0;
  double radius_error = 0.01;         ///< Standard deviation, share.
  double steer_offset_rad = 0.003;    ///< Standard deviation.
  double steer_quantum_rad = 0.0017;  ///< 0: continuous.
  double steer_play_rad = 0.004;      ///< Whole width.
  double pressure_offset_pa = 5e3;    ///< Standard deviation.
  double pressure_quantum_pa = 4e3;   ///< 0: continuous.
  GroundRadarParameters ground_radar;

  friend bool operator==(const VehicleSensorParameters&, const VehicleSensorParameters&) = default;
};

void visit(fields::Visitor& v, VehicleSensorParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const VehicleSensorParameters& parameters);

class VehicleSensors {
 public:
  /// Throws as validate() of both parameter sets.
  VehicleSensors(const VehicleSensorParameters& parameters, const OdometryParameters& odometry,
                 std::uint64_t seed, std::string_view name);

  /// Returns the sensors' readings for the truth `exact`. Call in order of time, at least about
  /// once per gate: between two calls a wheel's rate counts as their mean. Until the first gate is
  /// over the wheel's present rate is quantised as a gate would. Non-finite rates, angles and
  /// pressures pass through and are not counted.
  [[nodiscard]] VehicleSample measure(const VehicleSample& exact);

 private:
  struct Encoder {
    double ticks = 0.0;  ///< In this gate, with what the last one cut off.
    double last_radps = 0.0;
    double reading_radps = 0.0;
  };
  /// Doppler pulses of the ground radar.
  struct Radar {
    double factor = 1.0;
    double pulses = 0.0;
    double last_mps = 0.0;
    double reading_mps = 0.0;
    double elapsed_s = 0.0;
  };
  /// The sensor's shaft behind a joint with play.
  struct Steering {
    double offset_rad = 0.0;
    double shaft_rad = 0.0;
    bool known = false;
  };

  void count(const VehicleSample& exact);
  [[nodiscard]] double ground_speed(const VehicleSample& exact);
  [[nodiscard]] double steering_angle(Steering& steering, double angle_rad) const;
  [[nodiscard]] double pressure(double exact_pa, double offset_pa) const;

  VehicleSensorParameters parameters_;
  OdometryParameters odometry_;
  std::array<double, kWheels> radius_factor_{};
  std::array<double, kWheels + 1> pressure_offset_pa_{};  ///< Tyres, then hydraulics.
  std::array<Encoder, kWheels> encoders_{};
  std::array<Steering, 2> steering_{};
  Radar radar_;
  SimTime last_time_{};
  double gate_elapsed_s_ = 0.0;
  bool started_ = false;
};

}  // namespace rigwire::sim
