// The dig cycle: approach, dig, lift, swing to the truck, dump, return. A state machine over
// beliefs; it knows neither wires nor clocks.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "dig_cycle/estimator.h"
#include "dig_cycle/joint_control.h"
#include "dig_cycle/machine.h"

namespace rigwire::dig_cycle {

enum class Phase : std::uint8_t { approach, dig, lift, swing_to_truck, dump, swing_back };
[[nodiscard]] std::string_view name(Phase phase);

struct CycleSettings {
  double dig_azimuth_rad = 0.0;              ///< Swing angle of the face.
  double dump_azimuth_rad = 90.0 * kDegree;  ///< Swing angle of the truck.
  double dig_start_radius_m = 7.0;           ///< Tip from the swing axis where the pull begins.
  double dig_end_radius_m = 4.4;
  double approach_clearance_m = 0.8;  ///< Tip above the ground before it goes in.
  double dig_depth_m = 0.35;          ///< Tip below the ground that the lidar sees.
  double dig_duration_s = 8.0;        ///< The pull, when the arm follows.
  double bucket_attack_rad = -20.0 * kDegree;
  double bucket_curled_rad = -105.0 * kDegree;
  double bucket_open_rad = 25.0 * kDegree;
  double carry_boom_rad = 56.0 * kDegree;  ///< High enough to clear the truck's side.
  double carry_stick_rad = -95.0 * kDegree;
  double dump_stick_rad = -65.0 * kDegree;  ///< Stretched out over the truck.
  double arm_tolerance_rad = 3.0 * kDegree;
  double swing_tolerance_rad = 2.5 * kDegree;
  /// A phase that takes longer ends: the dig goes on to lift, every other is a fault.
  double dig_limit_s = 25.0;
  double phase_limit_s = 60.0;
  std::uint64_t cycles = 0;  ///< Stop after so many; 0 = never.

  /// Throws std::invalid_argument naming the field when the machine cannot do it.
  void validate(const Machine& machine) const;
};

/// What the lidar says that matters to the cycle.
struct View {
  std::optional<double> ground_z_m;  ///< In front of the bucket, upper structure's frame.
  bool obstacle_left = false;        ///< Something stands in the way of a swing to the left.
  bool obstacle_right = false;
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
  [[nodiscard]] bool done() const {
    return settings_.cycles != 0 && completed_ >= settings_.cycles;
  }
  /// Set when the machine does not follow: names phase and joint.
  [[nodiscard]] std::optional<std::string_view> fault() const { return fault_; }

 private:
  void enter(Phase phase);
  void choose_ground(const View& view);
  [[nodiscard]] PerJoint target(const Belief& belief) const;
  [[nodiscard]] PerJoint carry(double bucket_rad, double swing_rad) const;
  [[nodiscard]] PerJoint dig_pose(double progress, double above_m) const;
  [[nodiscard]] bool arrived(const PerJoint& target_rad, const Belief& belief) const;
  void advance(const PerJoint& target_rad, const Belief& belief, double step_s);

  Machine machine_;
  CycleSettings settings_;
  JointControl control_;
  Phase phase_ = Phase::approach;
  double phase_time_s_ = 0.0;
  double dig_progress_ = 0.0;  ///< 0 where the tip goes in, 1 at the end of the pull.
  double ground_z_m_ = 0.0;    ///< Chosen on approach, kept through the dig.
  std::uint64_t completed_ = 0;
  std::optional<std::string_view> fault_;
};

}  // namespace rigwire::dig_cycle
