// The dig cycle: approach, dig, lift, swing to the truck, dump, return. A state machine over
// beliefs; it knows neither wires nor clocks.
//
// The soil stays in the bucket while that is level, and runs over its teeth as it opens: the bucket
// is held level until its teeth are over the truck, and opens there while the arm is at rest. A
// bucket that came up nearly empty is not carried to the truck.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "dig_cycle/estimator.h"
#include "dig_cycle/joint_control.h"
#include "dig_cycle/lanes.h"
#include "dig_cycle/load_scale.h"
#include "dig_cycle/machine.h"

namespace rigwire::dig_cycle {

enum class Phase : std::uint8_t { approach, dig, lift, swing_to_truck, dump, swing_back };
[[nodiscard]] std::string_view name(Phase phase);

struct CycleSettings {
  double dig_azimuth_rad = 0.0;              ///< Swing angle of the face's middle.
  double dig_sector_rad = 36.0 * kDegree;    ///< Dug to either side of it.
  double lane_spacing_rad = 9.0 * kDegree;   ///< A bucket's width at 7 m.
  double dump_azimuth_rad = 90.0 * kDegree;  ///< Swing angle of the truck.
  double dig_start_radius_m = 7.0;           ///< Tip from the swing axis where the pull begins.
  double dig_end_radius_m = 4.4;
  double approach_clearance_m = 0.8;  ///< Tip above the ground before it goes in.
  double dig_depth_m = 0.35;          ///< Tip below the ground, of one pull.
  double pit_depth_m = 1.2;           ///< Tip below the ground under the machine, at most.
  double dig_duration_s = 6.0;        ///< The pull, when the arm follows.
  double bucket_attack_rad = -20.0 * kDegree;
  double bucket_curled_rad = -105.0 * kDegree;
  double bucket_open_rad = -10.0 * kDegree;
  double level_pitch_rad = -178.0 * kDegree;  ///< Pitch of the bucket at which it holds most.
  double carry_boom_rad = 55.0 * kDegree;     ///< Drawn in: clear of the truck's side.
  double carry_stick_rad = -105.0 * kDegree;
  double dump_boom_rad = 46.0 * kDegree;  ///< Stretched out over the truck.
  double dump_stick_rad = -58.0 * kDegree;
  double arm_tolerance_rad = 3.0 * kDegree;
  double swing_tolerance_rad = 2.5 * kDegree;
  /// A phase that takes longer ends: the dig goes on to lift, every other is a fault.
  double dig_limit_s = 25.0;
  double phase_limit_s = 60.0;
  /// The bucket came up empty when it holds less, where it can be weighed.
  double poor_load_kg = 300.0;
  std::uint64_t cycles = 0;     ///< Stop after so many; 0 = never.
  double truck_load_kg = 30e3;  ///< Stop when the truck has so much, weighed; 0 = never.

  /// Throws std::invalid_argument naming the field when the machine cannot do it.
  void validate(const Machine& machine) const;
};

/// Measurements that the cycle uses.
struct View {
  std::optional<double> ground_z_m;  ///< In front of the bucket, upper structure's frame.
  bool obstacle_left = false;        ///< Something is in the way of a swing to the left.
  bool obstacle_right = false;
  /// Force of the boom's cylinders by their pressures, positive when it raises.
  std::optional<double> boom_force_n;
};

struct CycleOutput {
  PerJoint openings{};    ///< -1..1 per valve section 1..4.
  PerJoint target_rad{};  ///< Where the joints should go.
  bool held_by_obstacle = false;
};

class Cycle {
 public:
  Cycle(const Machine& machine, const CycleSettings& settings,
        const JointControlSettings& control = {});

  /// One control step of `step_s`. Precondition: belief.ready.
  [[nodiscard]] CycleOutput update(const Belief& belief, const View& view, double step_s);
  /// Valves to neutral; the phase stays, its time starts anew.
  void hold();

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] std::uint64_t completed() const { return completed_; }
  /// Why the work is over: enough cycles, the truck full, the pit empty.
  [[nodiscard]] const std::optional<std::string>& finished() const { return finished_; }
  [[nodiscard]] bool done() const { return finished_.has_value(); }
  /// Mass of the last bucket that was weighed, and of all that were emptied into the truck.
  [[nodiscard]] std::optional<double> load_kg() const { return load_kg_; }
  [[nodiscard]] double loaded_kg() const { return loaded_kg_; }
  /// Set when the machine does not follow: names phase and joint.
  [[nodiscard]] std::optional<std::string_view> fault() const { return fault_; }

 private:
  void enter(Phase phase);
  void choose_ground(const View& view);
  [[nodiscard]] PerJoint target(const Belief& belief) const;
  /// The bucket's angle that keeps it level on the arm as that is now.
  [[nodiscard]] double level_rad(const Belief& belief) const;
  [[nodiscard]] PerJoint carry(double bucket_rad, double swing_rad) const;
  [[nodiscard]] PerJoint dig_pose(double progress, double above_m) const;
  [[nodiscard]] PerJoint lift_pose(const Belief& belief) const;
  [[nodiscard]] PerJoint dump_pose(const Belief& belief) const;
  [[nodiscard]] PerJoint return_pose(const Belief& belief) const;
  [[nodiscard]] bool arm_arrived(const PerJoint& target_rad, const Belief& belief) const;
  [[nodiscard]] bool arrived(const PerJoint& target_rad, const Belief& belief) const;
  /// Takes samples while the arm rests there. True when the mean is full, or none is to be had.
  bool weigh(const PerJoint& target_rad, const Belief& belief, const View& view);
  void advance(const PerJoint& target_rad, const Belief& belief, const View& view, double step_s);
  void advance_approach(const PerJoint& target_rad, const Belief& belief, const View& view);
  void advance_dig(const PerJoint& target_rad, const Belief& belief, double step_s);
  void advance_lift(const PerJoint& target_rad, const Belief& belief, const View& view);
  void advance_dump(const PerJoint& target_rad, const Belief& belief, double step_s);
  void advance_return(const PerJoint& target_rad, const Belief& belief);
  void finish_pit();

  Machine machine_;
  CycleSettings settings_;
  JointControl control_;
  Phase phase_ = Phase::approach;
  double phase_time_s_ = 0.0;
  double dig_progress_ = 0.0;  ///< 0 where the tip goes in, 1 at the end of the pull.
  double ground_z_m_ = 0.0;    ///< Chosen on approach, kept through the dig.
  int stage_ = 0;              ///< Stage within dump or return.
  double dwell_s_ = 0.0;       ///< In the dump, with the bucket open.
  double lagging_s_ = 0.0;     ///< In the dig, the arm does not follow.
  double eased_m_ = 0.0;       ///< Distance by which the pull has been raised since.
  bool tare_ = false;          ///< The approach weighs the empty bucket first.
  bool begun_ = false;
  bool dug_ = false;  ///< Dug since the last lift: there may be something in the bucket.
  bool more_to_dig_ = true;
  double seen_z_m_ = 0.0;                ///< The ground that the lidar saw last.
  std::optional<PerJoint> entered_rad_;  ///< Where the arm was when the phase began.
  Lanes lanes_;
  LoadScale scale_;
  std::optional<double> load_kg_;
  double loaded_kg_ = 0.0;
  std::optional<std::string> finished_;
  std::uint64_t completed_ = 0;
  std::optional<std::string_view> fault_;
};

}  // namespace rigwire::dig_cycle
