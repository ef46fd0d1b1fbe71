// Everything that makes one excavator: masses, pins, cylinders, hydraulics, drives. The defaults
// are REF-18t, our own 18 t wheeled machine.
//
// Sources: REF-18t is an engineering estimate throughout (docs/machines/excavator.md); it copies no
// maker's data sheet and no other simulator's file. Lengths in metres, masses in kilograms.
//
// Frames, each x forward along the link, y left, z up when the link lies level:
//   undercarriage  origin on the ground below the swing axis;
//   upper          origin on the swing axis at the slew ring, swing_axis_height_m above that;
//   boom           origin in the boom foot pin, x to the stick pin;
//   stick          origin in the stick pin, x to the bucket pin;
//   bucket         origin in the bucket pin, x to the tip of the teeth.
// Joint angles: swing left positive about z; boom, stick and bucket upward positive, each against
// the link before (boom against the upper structure's x). Pins are (x, z) in their link's frame,
// all in the plane y = 0.
#pragma once

#include <Eigen/Core>
#include <array>
#include <numbers>
#include <string_view>
#include <vector>

#include "fields/rules.h"
#include "sim/contact/contact_boxes.h"
#include "sim/excavator/power_unit.h"
#include "sim/excavator/undercarriage_parameters.h"
#include "sim/hydraulics/parameters.h"

namespace rigwire::sim {

/// How much of the drives is modelled. Cost rises downwards; excavator.cpp has them all.
enum class ExcavatorLevel {
  kinematic,     ///< Cylinders move as the valves ask, whatever the load: no forces.
  quasi_static,  ///< Oil that does not give: inverse dynamics finds the loads, which limit force,
                 ///< pump flow and so speed; stalls at relief. No oscillation.
  dynamic,       ///< Oil as springs, Eq. 5.
  chambers,      ///< Two pressures per actuator as states (sim/hydraulics/chambers.h).
};

/// What the undercarriage does.
enum class ExcavatorCarrier {
  fixed,   ///< At rest where it was placed.
  moving,  ///< Supported by its running gear: rocks, slides, tips; travels on tracks.
};

/// What the pumps hang on.
enum class ExcavatorPumps {
  constant,  ///< They turn as fast as ever, whatever they take: no engine.
  engine,    ///< PowerUnit's: speed and torque are states.
};

/// The machine's rigid links.
enum class Link { undercarriage, upper, boom, stick, bucket };
inline constexpr std::size_t kLinks = 5;
/// Their names, in that order.
inline constexpr std::array<std::string_view, kLinks> kExcavatorLinks{"undercarriage", "upper",
                                                                      "boom", "stick", "bucket"};

/// Valve sections of every excavator, and of tracks.
inline constexpr std::array<std::string_view, 4> kArmActuators{"swing", "boom", "stick", "bucket"};
inline constexpr std::array<std::string_view, 2> kTrackActuators{"left_track", "right_track"};

/// One rigid link.
struct RigidBodyParameters {
  double mass_kg = 0.0;
  Eigen::Vector3d center_of_mass_m = Eigen::Vector3d::Zero();        ///< In the link's frame.
  Eigen::Vector3d principal_inertia_kgm2 = Eigen::Vector3d::Zero();  ///< About the centre of mass,
                                                                     ///< along the link's axes.
};
void visit(fields::Visitor& v, RigidBodyParameters& p);
/// Throws std::invalid_argument; also where one moment exceeds the sum of the other two.
void validate(const RigidBodyParameters& parameters);

/// A cylinder between a pin on the link before the joint and a pin on the link after it.
struct DirectLinkageParameters {
  Eigen::Vector2d base_pin_m;  ///< (x, z) in the frame before, measured as the member says.
  Eigen::Vector2d rod_pin_m;   ///< (x, z) in the frame of the link that the joint moves.
};
void visit(fields::Visitor& v, DirectLinkageParameters& p);

/// The bucket's four-bar: the cylinder from H on the stick to J, the idler K-J on the stick, the
/// link J-L to the lug L on the bucket.
struct BucketLinkageParameters {
  Eigen::Vector2d base_pin_m{0.35, 0.55};     ///< H, in the stick's frame.
  Eigen::Vector2d idler_pivot_m{2.05, 0.06};  ///< K, in the stick's frame.
  double idler_length_m = 0.52;               ///< K to J.
  double link_length_m = 0.50;                ///< J to L.
  double lug_radius_m = 0.42;                 ///< Bucket pin to L.
  /// Direction of L in the bucket's frame, upward positive from x (pin to tip). With 100 degrees
  /// the bucket opens 40 degrees beyond the stick's line and curls 139 degrees under it.
  double lug_angle_rad = 100.0 * std::numbers::pi / 180.0;
  /// Intersection of the idler's and the link's circles at which J is: +1 left of the ray from K to
  /// L (seen with x right and z up), -1 right of it. Never changes while the machine runs.
  int branch = 1;
};
void visit(fields::Visitor& v, BucketLinkageParameters& p);
/// Throws std::invalid_argument.
void validate(const BucketLinkageParameters& parameters);

/// Eq. 5 of the paper, F = k (x_t - L) + d (v_t - dL/dt), per function. The defaults are the oil
/// columns at mid stroke.
struct DriveParameters {
  double swing_stiffness_nmprad = 2.0e6;
  double boom_stiffness_npm = 4.8e7;
  double stick_stiffness_npm = 3.0e7;
  double bucket_stiffness_npm = 1.9e7;
  double damping_ratio = 0.3;  ///< d = 2 ratio sqrt(k m) with m the mass that the cylinder feels in
                               ///< the initial pose, the other joints free.
  double end_stop_stiffness_npm = 1.0e9;  ///< Piston against cylinder head, outside the stroke.
  double cushion = 0.04;  ///< Share of the stroke at each end in which the speed is throttled.
};
void visit(fields::Visitor& v, DriveParameters& p);

/// Joint angles at the start; the machine starts at rest with its drives carrying the load. The
/// default holds the bucket at arm's length, its teeth 2.7 m over the ground: clear of whatever is
/// piled up to be dug.
struct ExcavatorPose {
  double swing_rad = 0.0;
  double boom_rad = 0.75;
  double stick_rad = -1.4;
  double bucket_rad = -0.6;
};
void visit(fields::Visitor& v, ExcavatorPose& p);

/// Frame, tyres, house, cab, the boom in two pieces joined at its bend, the stick: the shapes that
/// the lidar sees of the shipped machine (its file's shapes), the tyres only above 0.5 m; below,
/// they belong to the running gear. The bucket is in four pieces, so that it stays hollow. The
/// teeth touch rock at 1 GN/m: by Hertz a steel corner of 50 mm radius in granite, a few
/// millimetres deep.
[[nodiscard]] SolidBodyParameters excavator_boxes();

struct ExcavatorParameters {
  RigidBodyParameters undercarriage{8000.0, {0.0, 0.0, 0.7}, {7.0e3, 1.5e4, 1.8e4}};
  RigidBodyParameters upper{7500.0, {-0.9, 0.0, 0.9}, {1.2e4, 1.6e4, 1.7e4}};
  RigidBodyParameters boom{1300.0, {2.25, 0.0, 0.45}, {120.0, 3300.0, 3250.0}};
  RigidBodyParameters stick{620.0, {0.75, 0.0, 0.15}, {25.0, 420.0, 410.0}};
  /// The shell hangs on the lug's side of the line from pin to tip.
  RigidBodyParameters bucket{500.0, {0.60, 0.0, 0.20}, {90.0, 110.0, 100.0}};
  Eigen::Vector3d payload_center_of_mass_m{0.65, 0.0, 0.25};  ///< In the bucket's frame.
  /// Limit of set_payload_kg(); raised to the capacity of a digging bucket.
  double payload_max_kg = 1200.0;

  double swing_axis_height_m = 1.25;             ///< Slew ring above the ground.
  Eigen::Vector3d boom_foot_m{0.30, 0.0, 0.85};  ///< In the upper structure's frame.
  double boom_length_m = 5.00;                   ///< Foot pin to stick pin.
  double stick_length_m = 2.45;                  ///< Stick pin to bucket pin.
  double bucket_tip_m = 1.40;                    ///< Bucket pin to tip.

  /// Base on the upper structure, measured from the boom foot; rod on the boom.
  DirectLinkageParameters boom_linkage{{0.55, -0.45}, {2.05, 0.60}};
  /// Base on the boom; rod on the stick, behind the stick pin.
  DirectLinkageParameters stick_linkage{{2.80, 0.95}, {-0.62, 0.28}};
  BucketLinkageParameters bucket_linkage;
  CylinderParameters boom_cylinder{2, 0.115, 0.080, 1.49, 2.54};
  CylinderParameters stick_cylinder{1, 0.125, 0.090, 1.85, 3.05};
  CylinderParameters bucket_cylinder{1, 0.105, 0.075, 1.30, 2.235};
  /// Motor and gear together: 55 kN m at the swing relief.
  double swing_displacement_m3prad = 2.14e-3;

  SupplyParameters supply;
  ExcavatorPumps pumps = ExcavatorPumps::engine;
  PowerUnitParameters power_unit;                             ///< Used with pumps `engine`.
  SpoolParameters swing_spool{.flow_max_m3ps = 148.0 / 6e4};  ///< 11 rpm.
  SpoolParameters boom_spool{.flow_max_m3ps = 320.0 / 6e4};
  SpoolParameters stick_spool{.flow_max_m3ps = 280.0 / 6e4};
  SpoolParameters bucket_spool{.flow_max_m3ps = 220.0 / 6e4};

  DriveParameters drives;
  ChamberParameters chambers;
  ExcavatorLevel level = ExcavatorLevel::dynamic;
  ExcavatorCarrier carrier = ExcavatorCarrier::fixed;
  /// Used with carrier `moving`, like the three below.
  RunningGear running_gear = RunningGear::tyres;
  CarrierParameters wheels;                 ///< Used with running gear `tyres`.
  TrackParameters tracks;                   ///< Used with running gear `tracks`.
  std::vector<SupportParameters> supports;  ///< Blade, outriggers.
  double step_s = 1e-3;           ///< Longest inner step; longer calls of step() are divided.
  double gravity_mps2 = 9.80665;  ///< Along world -z.
  ExcavatorPose initial;
  SolidBodyParameters solid = excavator_boxes();
  bool strikes_itself = true;  ///< Its own bodies collide with each other (own_contact.h).
};

/// Returns what the valve sections move, from section 0 on: the arm's four, then with a moving
/// carrier the tracks and the supports. The names refer to `parameters`.
[[nodiscard]] std::vector<std::string_view> excavator_actuators(
    const ExcavatorParameters& parameters);

/// Maximum number of parts of an inner step within reach of an obstacle (contact_parts).
inline constexpr int kMostContactParts = 200;
/// Returns the smallest mass among boom, stick and bucket, which determines the contact's step.
[[nodiscard]] double lightest_solid_kg(const ExcavatorParameters& parameters);

/// The largest product of step and drive frequency (rad) that is allowed: measured to 0.1 mm there.
inline constexpr double kDriveStepLimit = 30.0;

void visit(fields::Visitor& v, ExcavatorParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed. Checked:
/// every member by its rule; inertias that obey the triangle inequality; every cylinder length
/// reachable with its pins, on one branch and with a margin from dead centre; initial pose inside
/// the strokes; drives and contacts no stiffer than the step allows.
void validate(const ExcavatorParameters& parameters);

}  // namespace rigwire::sim
