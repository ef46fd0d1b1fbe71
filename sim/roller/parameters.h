// Parameters of a tandem roller with both drums on steered pivots; the defaults are a 9.5 t machine
// of the BOMAG BW 174 AP AM's size.
//
// Sources: drum width 1.68 m and diameter 1.22 m, mass 9.5 t and speed 11.5 km/h are remembered
// from brochures and not confirmed; everything else is an engineering estimate. See
// docs/machines/bomag-bw174.md.
//
// Frame B: x forward, y left, z up; origin on the ground half way between the pivots, so that the
// front pivot is at (pivot_x_m, 0) and the rear one at (-pivot_x_m, 0).
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "fields/rules.h"
#include "sim/contact/contact_boxes.h"
#include "sim/driveline/hydrostatic_drive.h"
#include "sim/engine/engine_condition.h"
#include "sim/roller/steering.h"
#include "sim/roller/supplements.h"
#include "sim/roller/vibration.h"

namespace rigwire::sim {

enum class RollerLevel : std::uint8_t {
  kinematic,  ///< Drums roll without slip, as a bicycle that steers at both ends.
  dynamic,    ///< Planar motion and drum spins with slip, scrub, drive and brakes.
};

inline constexpr int kDrumStripsMax = 9;

/// Both drums are equal.
struct DrumParameters {
  double width_m = 1.68;
  double radius_m = 0.61;
  double spin_inertia_kgm2 = 480.0;
  int strips = 6;  ///< 1 .. 9 along the width. An even number has the whole scrub moment mu N b/4.
  double slip_stiffness_n = 7.0e5;           ///< dF/dslip of a drum at slip 0.
  double cornering_stiffness_nprad = 7.0e5;  ///< dF/dslip angle of a drum.
  /// Relaxation length of the bristles: half the contact's length.
  double relaxation_length_m = 0.06;
  double contact_length_m = 0.12;    ///< On soft soil, for cohesion.
  double damping_ratio = 0.7;        ///< Damping ratio of the bristles.
  double friction_factor = 0.75;     ///< Friction of steel on the ground over that of rubber.
  double rolling_resistance = 0.02;  ///< Coefficient on hard ground.

  friend bool operator==(const DrumParameters&, const DrumParameters&) = default;
};
void visit(fields::Visitor& v, DrumParameters& p);

/// Diesel of 3.6 litres on 12 V; estimates.
[[nodiscard]] EngineConditionParameters roller_engine();

/// The machine's rigid links. Frames when all steer angles are zero: frame on the ground half way
/// between the pivots; yokes and drums at the drums' centres, turned with the pivot; the drums roll
/// about their y.
inline constexpr std::array<std::string_view, 5> kRollerLinks{"frame", "front_yoke", "rear_yoke",
                                                              "front_drum", "rear_drum"};

/// Frame with cab and hood, and the yokes over the drums: estimates. The drums themselves are
/// cylinders.
[[nodiscard]] SolidBodyParameters roller_boxes();

struct RollerParameters {
  RollerLevel level = RollerLevel::dynamic;
  double mass_kg = 8700.0;  ///< With both drums, without water and chips.
  /// Moment of inertia about its centre of mass, without water and chips.
  double yaw_inertia_kgm2 = 2.4e4;
  /// About the same point, when it tips; without the drums' spins.
  double roll_inertia_kgm2 = 4.5e3;
  double pitch_inertia_kgm2 = 2.2e4;
  double center_of_mass_x_m = 0.0;
  double center_of_mass_height_m = 0.95;
  double pivot_x_m = 1.7;  ///< Half the distance of the drums' axles.
  DrumParameters drum;
  PivotSteeringParameters steering;
  HydrostaticDriveParameters drive;
  /// A speed controller corrects the drive by the drums' error from the commanded travel speed, and
  /// brakes at rest. Without it the pump's set point alone counts: the machine creeps by leakage.
  bool travel_control = true;
  EngineConditionParameters engine = roller_engine();
  double brake_torque_nm = 1.7e4;          ///< Torque of each drum's service brake, fully applied.
  double parking_brake_torque_nm = 1.7e4;  ///< Torque of each drum's parking brake.
  double brake_stiffness_nmprad = 1.2e7;   ///< Stiffness of a held drum against the frame.
  VibrationParameters front_vibration;
  VibrationParameters rear_vibration;
  SprinklerParameters sprinkler;
  SpreaderParameters spreader;
  EdgeCutterParameters edge_cutter;
  /// How heave, pitch and roll follow the ground under the drums: the mat and the mounts are
  /// elastic.
  double rest_frequency_hz = 10.0;
  double rest_damping_ratio = 0.7;
  SolidBodyParameters solid = roller_boxes();
  double step_s = 1e-3;  ///< Longest inner step.
  double gravity_mps2 = 9.80665;

  friend bool operator==(const RollerParameters&, const RollerParameters&) = default;
};
void visit(fields::Visitor& v, RollerParameters& p);

/// Throws std::invalid_argument that names the key, the value and what is allowed.
void validate(const RollerParameters& parameters);

/// Mass, centre and inertia with what the machine carries now.
struct RollerMass {
  double mass_kg = 0.0;
  double x_m = 0.0;  ///< Centre of mass in the frame.
  double height_m = 0.0;
  double yaw_inertia_kgm2 = 0.0;                           ///< About the centre of mass.
  Eigen::Vector3d inertia_kgm2 = Eigen::Vector3d::Zero();  ///< Roll, pitch, yaw.
};
[[nodiscard]] RollerMass loaded_mass(const RollerParameters& parameters, double water_kg,
                                     double chips_kg);

}  // namespace rigwire::sim
