// Machines that drive: what a controller asks of drive train, steering and brakes, and what the
// machine's own sensors report.
//
// Wheels are numbered front left, front right, rear left, rear right; a roller's front drum reports
// as the two front wheels. Angles left positive, speeds forward positive, SI units.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim/samples/engine_sample.h"
#include "sim/samples/time.h"

namespace rigwire {

inline constexpr std::size_t kWheels = 4;

/// Differentials, and their places in the arrays below.
enum class Differential : std::size_t { front = 0, centre = 1, rear = 2 };
inline constexpr std::size_t kDifferentials = 3;

enum class EngineControl : std::uint8_t {
  torque,  ///< The accelerator: a share of the torque that the engine has at its speed.
  speed,   ///< The governor holds a speed.
};

/// Ends of the machine that implements hang on, and their places in the arrays below.
enum class ImplementEnd : std::size_t { front = 0, rear = 1 };
inline constexpr std::size_t kImplementEnds = 2;

/// Command for one end's power take-off shaft.
struct PowerTakeOffCommand {
  bool engaged = false;
  /// Speed of the shaft, which the engine's governor then holds; empty: as the engine turns.
  std::optional<double> speed_radps;

  friend bool operator==(const PowerTakeOffCommand&, const PowerTakeOffCommand&) = default;
};

/// Everything holds until the next command. The default is a machine at rest with its brake on.
struct VehicleCommand {
  SimTime time{};        ///< When the controller's output changed.
  bool ignition = true;  ///< Off: the engine gets no fuel.
  EngineControl engine_control = EngineControl::torque;
  double engine_torque_share = 0.0;  ///< 0 .. 1, with EngineControl::torque.
  double engine_speed_radps = 0.0;   ///< With EngineControl::speed.
  /// Travel speed that the machine's own controller holds through engine, gear and brakes, or
  /// through its hydrostatic drive; reverse negative, 0 stops and holds. Nothing: engine, gear and
  /// brakes are as asked for above and below. While it is given, the engine is the controller's.
  std::optional<double> travel_speed_mps;
  /// Limits of the engine while travel_speed_mps is given.
  double engine_speed_limit_radps = std::numeric_limits<double>::infinity();
  double engine_torque_limit_share = 1.0;
  bool automatic_gear = false;  ///< With travel_speed_mps: the controller shifts, `gear` is left.
  double brake_share = 0.0;     ///< 0 .. 1 of the service brake's torque.
  bool parking_brake = true;
  int gear = 0;                  ///< 0 neutral, reverse negative.
  bool crawler_group = false;    ///< The transmission's low group; changes at standstill only.
  double front_steer_rad = 0.0;  ///< Angle of the equivalent single wheel (or drum pivot).
  double rear_steer_rad = 0.0;   ///< Where the rear axle steers.
  std::array<bool, kDifferentials> lock{};         ///< Differential locks.
  std::array<double, kWheels> tyre_pressure_pa{};  ///< Above ambient; 0 = as it is.
  std::array<bool, 2> vibration{};                 ///< Front and rear drum.
  double edge_cutter_share = 0.0;                  ///< 0 raised .. 1 pressed down.
  double spreader_rate_kgpm2 = 0.0;                ///< Rate of the chip spreader.
  /// Height of each hitch, 0 down .. 1 up; nothing: it stays where it is.
  std::array<std::optional<double>, kImplementEnds> hitch_share{};
  std::array<PowerTakeOffCommand, kImplementEnds> power_take_off{};

  friend bool operator==(const VehicleCommand&, const VehicleCommand&) = default;
};

/// Speed, curvature and slip angle as the machine's kinematic model has them from wheel speeds and
/// steering angles: a slipping wheel shows, the body's true motion does not enter.
struct OdometryReading {
  double speed_mps = 0.0;       ///< Speed of the reference point along the body's x.
  double curvature_1pm = 0.0;   ///< Curvature of the reference point's path, left positive.
  double slip_angle_rad = 0.0;  ///< Angle of the reference point's velocity to the body's x.
};

/// Why a travel speed that is asked for is not held.
enum class TravelLimit : std::uint8_t {
  none,
  power,    ///< Slower than asked for, with all that drive and gear can give.
  braking,  ///< Faster than asked for, with all that drive and brakes can take.
};

struct HitchReading {
  bool present = false;
  double height_share = 0.0;  ///< 0 down .. 1 up.
};

struct PowerTakeOffReading {
  bool present = false;
  bool engaged = false;
  double speed_radps = 0.0;
};

/// What the machine's own sensors read at one instant.
struct VehicleSample {
  SimTime time{};
  EngineSample engine;
  /// Whether the machine travels by these commands; without, only engine, hitches and power
  /// take-offs mean anything.
  bool drives = true;
  int gear = 0;  ///< Engaged.
  int gear_requested = 0;
  bool crawler_group = false;
  double gear_ratio = 0.0;  ///< Gearbox input to output; 0 in neutral.
  bool shifting = false;
  bool driveline_engaged = false;
  double input_shaft_radps = 0.0;   ///< Input shaft of the gearbox.
  double output_shaft_radps = 0.0;  ///< Output shaft of the gearbox.
  double clutch_slip_share = 0.0;   ///< 0 .. 1.
  std::array<double, kWheels> wheel_rate_radps{};
  std::array<double, kWheels> wheel_radius_m{};  ///< With which rates are turned into speeds.
  double front_steer_rad = 0.0;
  double rear_steer_rad = 0.0;
  double brake_share = 0.0;
  bool parking_brake = true;
  std::array<bool, kDifferentials> lock{};  ///< Engaged.
  std::array<double, kWheels> tyre_pressure_pa{};
  std::array<double, kWheels> tyre_pressure_target_pa{};
  double hydraulic_pressure_pa = 0.0;  ///< Pressure of a hydrostatic drive or the steering.
  std::array<bool, 2> vibration{};
  double edge_cutter_share = 0.0;
  double spreader_rate_kgpm2 = 0.0;
  double hopper_mass_kg = 0.0;
  OdometryReading odometry;
  double ground_speed_mps = kNotMeasured;  ///< Over the ground, forward, whatever the wheels do.
  TravelLimit travel_limit = TravelLimit::none;
  std::array<HitchReading, kImplementEnds> hitch{};
  std::array<PowerTakeOffReading, kImplementEnds> power_take_off{};
};

}  // namespace rigwire
