#include "sim/excavator/parameters.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/excavator/driven_arm.h"
#include "sim/excavator/linkage.h"
#include "sim/principal_inertia.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

constexpr std::array<fields::Choice<ExcavatorLevel>, 4> kExcavatorLevels{
    {{ExcavatorLevel::kinematic, "kinematic", "Cylinders move as the valves ask, no forces."},
     {ExcavatorLevel::quasi_static, "quasi_static", "Loads limit force and flow; stiff oil."},
     {ExcavatorLevel::dynamic, "dynamic", "Oil as springs, Eq. 5 of the paper."},
     {ExcavatorLevel::chambers, "chambers", "Two pressures per cylinder as states."}}};

constexpr std::array<fields::Choice<ExcavatorCarrier>, 2> kExcavatorCarriers{
    {{ExcavatorCarrier::fixed, "fixed", "The undercarriage does not move."},
     {ExcavatorCarrier::moving, "moving",
      "It rests on its running gear: it rocks, slides, tips."}}};

constexpr std::array<fields::Choice<RunningGear>, 2> kRunningGears{
    {{RunningGear::tyres, "tyres", "Four wheels, their brakes locked."},
     {RunningGear::tracks, "tracks", "Two tracks that travel, sections left_track, right_track."}}};

constexpr std::array<fields::Choice<ExcavatorPumps>, 2> kExcavatorPumps{
    {{ExcavatorPumps::constant, "constant", "They turn as fast as ever, whatever they take."},
     {ExcavatorPumps::engine, "engine", "An engine drives them and slows down under load."}}};

/// Formats computed values that are only displayed.
std::string text(double value) {
  std::ostringstream stream;
  stream.precision(9);
  stream << value;
  return stream.str();
}

void check_initial(const ExcavatorPose& pose, const Linkages& linkages) {
  const std::array<double, 3> angles{pose.boom_rad, pose.stick_rad, pose.bucket_rad};
  const std::array<const char*, 3> names{"initial.boom", "initial.stick", "initial.bucket"};
  const auto degrees = [](double angle_rad) { return text(in("deg").to_written(angle_rad)); };
  for (int joint = 0; joint < 3; ++joint) {
    const auto i = static_cast<std::size_t>(joint);
    const WorkingRange& range = linkages.range(joint);
    fields::require(angles[i] >= range.q_min_rad() && angles[i] <= range.q_max_rad(), names[i],
                    degrees(angles[i]) + " deg",
                    degrees(range.q_min_rad()) + " .. " + degrees(range.q_max_rad()) +
                        " deg (the cylinder's stroke)");
  }
}

// The stiffest pose is searched on a grid of strokes, because levers and masses vary with it.
double stiffest_radps(const DrivenArm& arm) {
  double highest = 0.0;
  for (int boom = 0; boom <= 4; ++boom) {
    for (int stick = 0; stick <= 4; ++stick) {
      for (int bucket = 0; bucket <= 4; ++bucket) {
        const std::array<int, 3> at{boom, stick, bucket};
        JointVector q = JointVector::Zero();
        for (int joint = 0; joint < 3; ++joint) {
          const WorkingRange& range = arm.linkages().range(joint);
          const double share = 0.25 * at[static_cast<std::size_t>(joint)];
          q[joint + 1] = range.q_min_rad() + share * (range.q_max_rad() - range.q_min_rad());
        }
        highest = std::max(highest, arm.highest_frequency_radps(q, arm.gains.stiffness));
      }
    }
  }
  return highest;
}

}  // namespace

void visit(fields::Visitor& v, RigidBodyParameters& p) {
  v.number("mass", p.mass_kg, in("kg").between(0.01, 1e6), "Mass of the link.");
  v.vector3("center_of_mass", p.center_of_mass_m, in("m").between(-100, 100),
            "Centre of mass in the link's frame.");
  v.vector3("principal_inertia", p.principal_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
            "Moments of inertia about the centre of mass, along the link's axes.");
}

void visit(fields::Visitor& v, DirectLinkageParameters& p) {
  v.vector2("base_pin", p.base_pin_m, in("m").between(-100, 100),
            "[x, z] of the cylinder's foot on the link before the joint.");
  v.vector2("rod_pin", p.rod_pin_m, in("m").between(-100, 100),
            "[x, z] of the rod's pin on the link that the joint moves.");
}

void visit(fields::Visitor& v, BucketLinkageParameters& p) {
  v.vector2("base_pin", p.base_pin_m, in("m").between(-100, 100),
            "[x, z] of the cylinder's foot on the stick.");
  v.vector2("idler_pivot", p.idler_pivot_m, in("m").between(-100, 100),
            "[x, z] of the idler's pivot on the stick.");
  v.number("idler_length", p.idler_length_m, in("mm").between(0.001, 10'000),
           "Idler's pivot to the rod's pin.");
  v.number("link_length", p.link_length_m, in("mm").between(0.001, 10'000),
           "Rod's pin to the bucket's lug.");
  v.number("lug_radius", p.lug_radius_m, in("mm").between(0.001, 10'000),
           "Bucket's pin to its lug.");
  v.number("lug_angle", p.lug_angle_rad, in("deg").between(-180, 180),
           "Direction of the lug from the bucket's x, upward positive.");
  v.integer("branch", p.branch, IntegerRule{-1, 1}, "Side of the four-bar: 1 left, -1 right.");
}

void visit(fields::Visitor& v, DriveParameters& p) {
  v.number("swing_stiffness", p.swing_stiffness_nmprad, in("N m/rad").between(0.001, 1e14),
           "Stiffness of the swing's spring, Eq. 5 of the paper.");
  v.number("boom_stiffness", p.boom_stiffness_npm, in("N/m").between(1, 1e14),
           "Stiffness of the boom's spring, Eq. 5 of the paper.");
  v.number("stick_stiffness", p.stick_stiffness_npm, in("N/m").between(1, 1e14),
           "Stiffness of the stick's spring, Eq. 5 of the paper.");
  v.number("bucket_stiffness", p.bucket_stiffness_npm, in("N/m").between(1, 1e14),
           "Stiffness of the bucket's spring, Eq. 5 of the paper.");
  v.number("damping_ratio", p.damping_ratio, plain().between(0, 10),
           "Damping ratio of the dampers, Eq. 5 of the paper.");
  v.number("end_stop_stiffness", p.end_stop_stiffness_npm, in("N/m").between(1e7, 1e12),
           "Stiffness of a piston against the cylinder's head.");
  v.number("cushion", p.cushion, plain().between(0, 0.5),
           "Share of the stroke at each end in which the piston is slowed.");
}

void visit(fields::Visitor& v, ExcavatorPose& p) {
  v.number("swing", p.swing_rad, in("deg").between(-360, 360),
           "Angle of the swing, left positive.");
  v.number("boom", p.boom_rad, in("deg").between(-180, 180),
           "Angle of the boom against the upper, up positive.");
  v.number("stick", p.stick_rad, in("deg").between(-180, 180),
           "Angle of the stick against the boom, up positive.");
  v.number("bucket", p.bucket_rad, in("deg").between(-180, 180),
           "Angle of the bucket against the stick, up positive.");
}

void visit(fields::Visitor& v, ExcavatorParameters& p) {
  v.section("undercarriage", p.undercarriage, "Link on the ground.");
  v.section("upper", p.upper, "Link that swings.");
  v.section("boom", p.boom, "Link from the upper to the stick.");
  v.section("stick", p.stick, "Link from the boom to the bucket.");
  v.section("bucket", p.bucket, "Last link, empty.");
  v.vector3("payload_center_of_mass", p.payload_center_of_mass_m, in("m").between(-100, 100),
            "Centre of mass of the payload in the bucket's frame.");
  v.refused("payload_max",
            "what the bucket holds is decided by digging.bucket.struck_capacity, "
            "digging.bucket.heap_repose and the density of the scene's soils");
  v.number("swing_axis_height", p.swing_axis_height_m, in("m").between(0.001, 100),
           "Height of the slew ring above the ground.");
  v.vector3("boom_foot", p.boom_foot_m, in("m").between(-100, 100),
            "Foot pin of the boom in the upper's frame.");
  v.number("boom_length", p.boom_length_m, in("m").between(0.001, 100),
           "Boom's foot pin to stick pin.");
  v.number("stick_length", p.stick_length_m, in("m").between(0.001, 100),
           "Stick pin to bucket pin.");
  v.number("bucket_tip", p.bucket_tip_m, in("m").between(0.001, 100),
           "Bucket pin to the tip of the teeth.");
  v.section("boom_linkage", p.boom_linkage, "Pins of the boom cylinders; base from the boom foot.");
  v.section("stick_linkage", p.stick_linkage, "Pins of the stick cylinder.");
  v.section("bucket_linkage", p.bucket_linkage, "Four-bar of the bucket.");
  v.section("boom_cylinder", p.boom_cylinder, "Cylinders of the boom.");
  v.section("stick_cylinder", p.stick_cylinder, "Cylinders of the stick.");
  v.section("bucket_cylinder", p.bucket_cylinder, "Cylinders of the bucket.");
  v.number("swing_displacement", p.swing_displacement_m3prad, in("m3/rad").between(1e-9, 1),
           "Oil that motor and gear take per angle of swing.");
  v.section("supply", p.supply, "Pump and pressures.");
  v.choice("pumps", p.pumps, kExcavatorPumps, "What drives the pumps.");
  v.only_if(p.pumps == ExcavatorPumps::engine, "pumps", "pumps: engine", [&p](fields::Visitor& w) {
    w.section("power_unit", p.power_unit, "Engine that drives the pumps.");
  });
  v.section("swing_spool", p.swing_spool, "Valve section 1, the swing's.");
  v.section("boom_spool", p.boom_spool, "Valve section 2, the boom's.");
  v.section("stick_spool", p.stick_spool, "Valve section 3, the stick's.");
  v.section("bucket_spool", p.bucket_spool, "Valve section 4, the bucket's.");
  v.section("drives", p.drives, "Springs and dampers of Eq. 5 of the paper.");
  v.section("chambers", p.chambers, "Oil of level chambers.");
  v.choice("level", p.level, kExcavatorLevels, "How much of the drives is modelled.");
  v.choice("carrier", p.carrier, kExcavatorCarriers, "What the undercarriage does.");
  v.only_if(p.carrier == ExcavatorCarrier::moving, "carrier", "carrier: moving",
            [&p](fields::Visitor& w) {
              w.choice("running_gear", p.running_gear, kRunningGears,
                       "Running gear of a moving carrier.");
              w.only_if(p.running_gear == RunningGear::tracks, "running_gear",
                        "running_gear: tracks", [&p](fields::Visitor& x) {
                          x.section("tracks", p.tracks, "Both tracks and their travel motors.");
                        });
              w.list("supports", p.supports, "Blade and outriggers, each with a valve section.");
            });
  v.section("wheels", p.wheels, "Running gear of a moving carrier, its brakes locked.");
  v.number("step", p.step_s, in("ms").between(0.001, 50), "Longest inner step of the arm.");
  v.number("gravity", p.gravity_mps2, in("m/s2").between(0, 1000),
           "Acceleration of gravity, downwards.");
  v.section("initial", p.initial, "Joint angles at the start.");
  v.section("solid", p.solid,
            "Parts of the machine that collide with trunks, rocks, walls and trucks.");
  v.boolean("strikes_itself", p.strikes_itself,
            "Whether the boxes of links that are no neighbours meet each other.");
}

SolidBodyParameters excavator_boxes() {
  // Converts as a configuration file does, to the last bit.
  constexpr auto from_degrees = [](double angle) { return angle * std::numbers::pi / 180.0; };
  SolidBodyParameters solid;
  solid.stiffness_npm = 1e9;
  solid.damping_ratio = 0.7;
  solid.boxes = {
      {"undercarriage", "undercarriage", {0.0, 0.0, 0.85}, {4.6, 1.3, 0.6}, 0.0},
      {"left tyres", "undercarriage", {0.0, 1.0, 0.75}, {3.7, 0.5, 0.5}, 0.0},
      {"right tyres", "undercarriage", {0.0, -1.0, 0.75}, {3.7, 0.5, 0.5}, 0.0},
      {"house", "upper", {-1.0, 0.0, 0.75}, {2.6, 2.5, 1.3}, 0.0},
      {"cab", "upper", {0.75, 0.8, 0.95}, {1.7, 0.95, 1.75}, 0.0},
      {"lower boom", "boom", {1.2, 0.0, 0.35}, {2.7, 0.4, 0.45}, from_degrees(-16.0)},
      {"upper boom", "boom", {3.75, 0.0, 0.4}, {2.7, 0.36, 0.4}, from_degrees(15.0)},
      {"stick", "stick", {0.95, 0.0, 0.15}, {3.0, 0.32, 0.4}, 0.0},
      {"bucket floor", "bucket", {1.11, 0.0, 0.255}, {0.75, 1.1, 0.1}, from_degrees(34.4)},
      {"bucket back", "bucket", {0.43, 0.0, 0.46}, {0.85, 1.1, 0.2}, from_degrees(-6.0)},
      {"bucket left cheek", "bucket", {0.7, 0.51, 0.22}, {0.9, 0.08, 0.4}, 0.0},
      {"bucket right cheek", "bucket", {0.7, -0.51, 0.22}, {0.9, 0.08, 0.4}, 0.0},
  };
  return solid;
}

std::vector<std::string_view> excavator_actuators(const ExcavatorParameters& p) {
  std::vector<std::string_view> names(kArmActuators.begin(), kArmActuators.end());
  if (p.carrier == ExcavatorCarrier::moving) {
    if (p.running_gear == RunningGear::tracks) {
      names.insert(names.end(), kTrackActuators.begin(), kTrackActuators.end());
    }
    for (const SupportParameters& support : p.supports) {
      names.emplace_back(support.name);
    }
  }
  return names;
}

double lightest_solid_kg(const ExcavatorParameters& p) {
  return std::min({p.boom.mass_kg, p.stick.mass_kg, p.bucket.mass_kg});
}

void validate(const RigidBodyParameters& p) {
  fields::check(p);
  require_principal_inertia(p.principal_inertia_kgm2);
}

void validate(const BucketLinkageParameters& p) {
  fields::check(p);
  fields::require(p.branch != 0, "branch", std::to_string(p.branch), "1 or -1");
}

void validate(const ExcavatorParameters& p) {
  fields::check(p);
  fields::require(p.payload_max_kg >= 0.0, "payload_max", in("kg").print(p.payload_max_kg),
                  ">= 0 kg");
  validate(p.power_unit);
  validate(p.solid, kExcavatorLinks, lightest_solid_kg(p), p.step_s, kMostContactParts);
  fields::require(p.carrier != ExcavatorCarrier::moving || p.level != ExcavatorLevel::kinematic,
                  "carrier", "moving",
                  "fixed where level is kinematic: without forces nothing rocks");

  const std::vector<std::string_view> actuators = excavator_actuators(p);
  fields::require(actuators.size() <= kValveSections, "supports",
                  std::to_string(p.supports.size()) + ", with the rest " +
                      std::to_string(actuators.size()) + " valve sections",
                  "at most " + std::to_string(kValveSections) + " sections together");
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    fields::require(std::count(actuators.begin(), actuators.end(), actuators[i]) == 1, "supports",
                    "section " + std::string(actuators[i]) + " twice",
                    "names that differ from each other and from the machine's own");
  }

  const DrivenArm arm(p, Eigen::Vector3d(0.0, 0.0, -p.gravity_mps2));
  check_initial(p.initial, arm.linkages());
  if (p.level != ExcavatorLevel::dynamic) {
    return;  // No springs.
  }
  const double frequency = stiffest_radps(arm);
  fields::require(p.step_s * frequency <= kDriveStepLimit, "drives",
                  "stiffnesses with a mode of " + text(frequency) + " rad/s, at a step of " +
                      in("ms").print(p.step_s) + " a product of " + text(p.step_s * frequency),
                  "at most " + text(kDriveStepLimit) + ": a step of at most " +
                      text(1e3 * kDriveStepLimit / frequency) + " ms, or stiffnesses " +
                      text(std::pow(p.step_s * frequency / kDriveStepLimit, 2.0)) +
                      " times smaller");
}

}  // namespace rigwire::sim
