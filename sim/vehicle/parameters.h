// Parameters of a wheeled vehicle with two axles: masses, axles, springs, tyres, steering, brakes,
// tyre pressure system. Defaults: Mercedes-Benz Unimog U5023; for independent wheels, the John
// Deere Gator XUV 855D.
//
// Sources: few numbers are makers' (docs/machines/unimog-u5023.md and gator-855d.md list them); the
// others are estimates until a data sheet is available. The drive line has its own parameters
// (sim/driveline).
//
// Body frame B: x forward, y left, z up; origin on the ground below the middle of the rear axle
// when the vehicle stands on level ground with its tyres at their reference pressure ("design
// position"). Wheels: front left, front right, rear left, rear right.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "fields/rules.h"
#include "sim/contact/contact_boxes.h"
#include "sim/samples/vehicle_sample.h"
#include "sim/tyre/tyre.h"
#include "sim/vehicle/travel_control.h"

namespace rigwire::sim {

/// How much of the vehicle is computed. All levels drive, steer and report through the same
/// interface.
enum class VehicleLevel : std::uint8_t {
  kinematic,  ///< Bicycle without slip along the terrain; the drive line and brakes set the speed.
  planar,     ///< 3 degrees of freedom and 4 wheel spins; loads quasi-static; slip.
  full,       ///< 14 degrees of freedom: body 6, suspension 4, wheel spins 4.
};

enum class AxleType : std::uint8_t {
  beam,         ///< Rigid axle on a push tube: heave and roll.
  independent,  ///< Each wheel has its own travel.
};

/// What the springs carry.
struct SprungBodyParameters {
  double mass_kg = 7600.0;
  Eigen::Vector3d center_of_mass_m{2.05, 0.0, 1.22};            ///< In B.
  Eigen::Vector3d principal_inertia_kgm2{5.5e3, 2.3e4, 2.4e4};  ///< About it, along B's axes.
};
void visit(fields::Visitor& v, SprungBodyParameters& p);
/// Throws std::invalid_argument; also where one moment exceeds the sum of the other two.
void validate(const SprungBodyParameters& parameters);

/// One-sided spring at the end of a travel, whose stiffness grows linearly over the ramp:
/// stiffness x^2 / (2 ramp) within it, stiffness (x - ramp / 2) beyond.
struct StopParameters {
  double stiffness = 1.0e6;  ///< N/m, or N m/rad.
  double ramp = 0.02;        ///< m, or rad.
};

/// Push tube, heave and roll. Springs carry the static load at heave 0.
struct BeamAxleParameters {
  double mass_kg = 700.0;            ///< With wheels.
  double roll_inertia_kgm2 = 450.0;  ///< With wheels, about its centre; also in yaw.
  double pitch_inertia_kgm2 = 20.0;  ///< Without the wheels' spin.
  double tube_length_m = 1.3;        ///< Axle to spherical pivot, towards the vehicle's middle; 0
                                     ///< guides the axle straight up and down.
  double tube_rise_m = 0.05;         ///< Pivot above the axle's centre.
  double roll_centre_rise_m = 0.20;  ///< Panhard rod above the axle's centre.
  double spring_npm = 1.6e5;         ///< Stiffness of each side.
  double damper_nspm = 1.0e4;        ///< Damping of each side.
  double spring_base_m = 1.05;       ///< Left to right spring, and damper.
  double roll_bar_nmprad = 0.0;      ///< Between the two sides.
  double bump_travel_m = 0.16;       ///< Heave up to the bump stop.
  double rebound_travel_m = 0.20;
  StopParameters bump_stop{1.5e6, 0.03};
  double articulation_rad = 30.0 * std::numbers::pi / 180.0;  ///< Roll up to the limiter.
  StopParameters articulation_stop{2.0e6, 0.035};             ///< Ramp of 2 degrees.
};
void visit(fields::Visitor& v, BeamAxleParameters& p);

/// Wheel carrier that moves up and down in B.
struct IndependentAxleParameters {
  double corner_mass_kg = 30.0;      ///< Wheel, carrier and half the arms.
  double corner_inertia_kgm2 = 0.7;  ///< About any diameter of the wheel.
  double spring_npm = 2.5e4;         ///< At the wheel, per side.
  double damper_nspm = 1.6e3;        ///< At the wheel, per side.
  double roll_bar_npm = 0.0;         ///< Force per difference of travels.
  double bump_travel_m = 0.11;
  double rebound_travel_m = 0.12;
  StopParameters bump_stop{3.0e5, 0.03};
  double camber_gain_radpm = -0.3;  ///< Top of the wheel outward positive, per bump.
  double toe_gain_radpm = 0.0;      ///< Toe-in positive, per bump.
};
void visit(fields::Visitor& v, IndependentAxleParameters& p);

struct SteeringParameters {
  /// Angle of the equivalent single wheel; 0: the axle does not steer.
  double angle_max_rad = 0.0;
  double rate_max_radps = 0.6;  ///< Rate of the equivalent single wheel.
  double time_constant_s = 0.08;
};
void visit(fields::Visitor& v, SteeringParameters& p);

struct VehicleAxleParameters {
  AxleType type = AxleType::beam;
  double position_x_m = 0.0;  ///< In B.
  double track_m = 1.94;
  double portal_offset_m = 0.13;  ///< Wheel's centre below the beam's.
  double wheel_spin_inertia_kgm2 = 33.0;
  BeamAxleParameters beam;
  IndependentAxleParameters independent;
  TyreParameters tyre;
  SteeringParameters steering;
  double brake_torque_nm = 3.0e4;      ///< Torque of both wheels together, pedal down.
  double parking_brake_nm = 0.0;       ///< Torque of both wheels together.
  double initial_pressure_pa = 4.5e5;  ///< Pressure of its tyres, above ambient.
};
void visit(fields::Visitor& v, VehicleAxleParameters& p);

/// Central tyre inflation: each pressure follows its set point.
struct TyrePressureParameters {
  bool adjustable = true;  ///< Without: set points are ignored.
  double inflate_time_constant_s = 150.0;
  double deflate_time_constant_s = 90.0;
  double pressure_min_pa = 0.8e5;
  double pressure_max_pa = 6.0e5;
};
void visit(fields::Visitor& v, TyrePressureParameters& p);
/// Throws std::invalid_argument.
void validate(const TyrePressureParameters& parameters);

struct ChassisPoint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< In B.
};
void visit(fields::Visitor& v, ChassisPoint& p);

inline constexpr std::size_t kChassisPoints = 16;

/// Corners of body and underbody that may hit the ground. The ground there is as strong as under
/// the boxes (solid). Obstacles contact only the boxes.
struct ChassisContactParameters {
  std::vector<ChassisPoint> points;  ///< At most kChassisPoints.
  double stiffness_npm = 4.0e7;  ///< Same stiffness as the boxes; the damping below is theirs, too.
  double damping_nspm = 3.6e5;
};
void visit(fields::Visitor& v, ChassisContactParameters& p);
/// Throws std::invalid_argument.
void validate(const ChassisContactParameters& parameters);

/// A three-point hitch without its implement: its own way only, no load on it and no mass.
struct HitchParameters {
  bool fitted = false;
  double travel_time_s = 3.0;  ///< From down to up.
};
void visit(fields::Visitor& v, HitchParameters& p);

/// A power take-off shaft that turns with the engine, nothing on it.
struct PowerTakeOffParameters {
  bool fitted = false;
  double ratio = 2.0;          ///< Engine's speed over the shaft's.
  double engage_time_s = 1.0;  ///< Engagement time of its clutch.
};
void visit(fields::Visitor& v, PowerTakeOffParameters& p);

/// Hitches and power take-offs for implements, front and rear.
struct ImplementParameters {
  std::array<HitchParameters, kImplementEnds> hitch;
  std::array<PowerTakeOffParameters, kImplementEnds> power_take_off;
};
void visit(fields::Visitor& v, ImplementParameters& p);

inline constexpr std::array<std::string_view, 7> kWheeledLinks{"body",
                                                               "front_axle",
                                                               "rear_axle",
                                                               "front_left_wheel",
                                                               "front_right_wheel",
                                                               "rear_left_wheel",
                                                               "rear_right_wheel"};

struct WheeledVehicleParameters {
  VehicleLevel level = VehicleLevel::full;
  SprungBodyParameters body;
  VehicleAxleParameters front;
  VehicleAxleParameters rear;
  double brake_stiffness_nmprad = 4.0e5;  ///< Stiffness of a holding brake, at the wheel.
  /// First-order lag of the service brake's torque. UNECE R13, annex 6, gives air brakes 0.6 s to
  /// three quarters, 1.4 lags; this is an estimate for new ones.
  double brake_lag_s = 0.2;
  TyrePressureParameters tyre_pressure;
  ChassisContactParameters chassis;
  SolidBodyParameters solid;  ///< Against obstacles, as the wheels are.
  TravelControlParameters travel;
  ImplementParameters implements;
  double air_drag_ns2pm2 = 3.3;  ///< Force per speed squared, at the centre of mass.
  double step_s = 1e-3;          ///< Longest inner step; longer calls of step() are divided.
  double gravity_mps2 = 9.80665;

  /// The Unimog U5023.
  WheeledVehicleParameters();

  [[nodiscard]] double wheelbase_m() const { return front.position_x_m - rear.position_x_m; }
  [[nodiscard]] double axle_mass_kg(const VehicleAxleParameters& axle) const {
    return axle.type == AxleType::beam ? axle.beam.mass_kg : 2.0 * axle.independent.corner_mass_kg;
  }
  [[nodiscard]] double mass_kg() const {
    return body.mass_kg + axle_mass_kg(front) + axle_mass_kg(rear);
  }
};
void visit(fields::Visitor& v, WheeledVehicleParameters& p);

/// Loads and heights of a vehicle at rest on level ground, in design position.
struct StaticLoads {
  std::array<double, 2> spring_n{};        ///< Load of both springs together, front and rear axle.
  std::array<double, 2> wheel_n{};         ///< Load of one wheel, front and rear axle.
  std::array<double, 2> wheel_height_m{};  ///< Wheel's centre above ground.
  std::array<double, 2> rolling_radius_m{};  ///< Way per radian of a wheel that rolls freely.
  /// Centre of mass of the whole vehicle, in B.
  Eigen::Vector3d center_of_mass_m = Eigen::Vector3d::Zero();
};
[[nodiscard]] StaticLoads static_loads(const WheeledVehicleParameters& parameters);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const WheeledVehicleParameters& parameters);

}  // namespace rigwire::sim
