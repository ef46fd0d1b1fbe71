#include "dig_cycle/cycle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace rigwire::dig_cycle {
namespace {

/// Ground outside this is not taken for ground.
constexpr double kLowestGround_m = -1.5;
constexpr double kHighestGround_m = 1.0;
/// Farther from the wanted swing angle than this, the arm travels high.
constexpr double kTravelSwing_rad = 15.0 * kDegree;
/// The pull waits while the arm is farther behind than this.
constexpr double kLag_rad = 12.0 * kDegree;

constexpr std::array<std::string_view, 6> kFaults{
    "approach: the arm does not follow", "dig: the arm does not follow",
    "lift: the arm does not follow",     "swing to the truck: the machine does not follow",
    "dump: the bucket does not follow",  "return: the machine does not follow"};

}  // namespace

std::string_view name(Phase phase) {
  constexpr std::array<std::string_view, 6> kNames{"approach", "dig",  "lift",
                                                   "swing",    "dump", "return"};
  return kNames[static_cast<std::size_t>(phase)];
}

void CycleSettings::validate(const Machine& machine) const {
  const auto require = [](bool condition, const std::string& what) {
    if (!condition) {
      throw std::invalid_argument("dig cycle: " + what);
    }
  };
  require(dig_duration_s > 0.0,
          "dig_duration_s is " + std::to_string(dig_duration_s) + ", allowed more than 0");
  require(dig_end_radius_m < dig_start_radius_m, "the dig ends farther out than it starts");
  const std::array<PlanePoint, 2> corners{
      {{dig_start_radius_m, -dig_depth_m}, {dig_end_radius_m, -dig_depth_m}}};
  require(reach(machine, corners[0], bucket_attack_rad).has_value(),
          "dig_start_radius_m " + std::to_string(dig_start_radius_m) +
              " m is out of the arm's reach on level ground");
  require(reach(machine, corners[1], bucket_curled_rad).has_value(),
          "dig_end_radius_m " + std::to_string(dig_end_radius_m) +
              " m is out of the arm's reach on level ground");
}

Cycle::Cycle(const Machine& machine, const CycleSettings& settings,
             const JointControlSettings& control)
    : machine_(machine), settings_(settings), control_(machine, control) {
  settings_.validate(machine);
}

void Cycle::enter(Phase phase) {
  phase_ = phase;
  phase_time_s_ = 0.0;
  dig_progress_ = 0.0;
}

void Cycle::hold() {
  control_.neutral();
  phase_time_s_ = 0.0;
}

void Cycle::choose_ground(const View& view) {
  if (view.ground_z_m) {
    ground_z_m_ = std::clamp(*view.ground_z_m, kLowestGround_m, kHighestGround_m);
  }
}

PerJoint Cycle::carry(double bucket_rad, double swing_rad) const {
  return {swing_rad, settings_.carry_boom_rad, settings_.carry_stick_rad, bucket_rad};
}

PerJoint Cycle::dig_pose(double progress, double above_m) const {
  const double radius_m =
      std::lerp(settings_.dig_start_radius_m, settings_.dig_end_radius_m, progress);
  const double bucket_rad =
      std::lerp(settings_.bucket_attack_rad, settings_.bucket_curled_rad, progress);
  // Ground too low or too high for the arm is met as nearly as it can.
  for (const double share : {1.0, 0.75, 0.5, 0.25, 0.0}) {
    if (auto pose = reach(machine_, {radius_m, ground_z_m_ * share + above_m}, bucket_rad)) {
      (*pose)[swing] = settings_.dig_azimuth_rad;
      return *pose;
    }
  }
  return carry(bucket_rad, settings_.dig_azimuth_rad);
}

PerJoint Cycle::target(const Belief& belief) const {
  switch (phase_) {
    case Phase::approach: {
      const double off_rad = settings_.dig_azimuth_rad - belief.angles_rad[swing];
      if (std::abs(off_rad) > kTravelSwing_rad) {
        return carry(settings_.bucket_curled_rad, settings_.dig_azimuth_rad);
      }
      return dig_pose(0.0, settings_.approach_clearance_m);
    }
    case Phase::dig: {
      // The first fifth goes down, the rest pulls.
      const double down = std::min(1.0, dig_progress_ / 0.2);
      const double pull = std::max(0.0, (dig_progress_ - 0.2) / 0.8);
      return dig_pose(pull,
                      std::lerp(settings_.approach_clearance_m, -settings_.dig_depth_m, down));
    }
    case Phase::lift:
      return carry(settings_.bucket_curled_rad, settings_.dig_azimuth_rad);
    case Phase::swing_to_truck:
      return carry(settings_.bucket_curled_rad, settings_.dump_azimuth_rad);
    case Phase::dump:
      return {settings_.dump_azimuth_rad, settings_.carry_boom_rad, settings_.dump_stick_rad,
              settings_.bucket_open_rad};
    case Phase::swing_back:
      return carry(settings_.bucket_attack_rad, settings_.dig_azimuth_rad);
  }
  return belief.angles_rad;
}

bool Cycle::arrived(const PerJoint& target_rad, const Belief& belief) const {
  for (const Joint joint : {boom, stick, bucket}) {
    if (std::abs(target_rad[joint] - belief.angles_rad[joint]) > settings_.arm_tolerance_rad) {
      return false;
    }
  }
  return std::abs(target_rad[swing] - belief.angles_rad[swing]) < settings_.swing_tolerance_rad;
}

void Cycle::advance(const PerJoint& target_rad, const Belief& belief, double step_s) {
  phase_time_s_ += step_s;
  if (phase_ == Phase::dig) {
    double lag_rad = 0.0;
    for (const Joint joint : {boom, stick, bucket}) {
      lag_rad = std::max(lag_rad, std::abs(target_rad[joint] - belief.angles_rad[joint]));
    }
    if (lag_rad < kLag_rad) {
      dig_progress_ = std::min(1.0, dig_progress_ + step_s / settings_.dig_duration_s);
    }
    const bool finished = dig_progress_ >= 1.0 && arrived(target_rad, belief);
    if (finished || phase_time_s_ > settings_.dig_limit_s) {
      enter(Phase::lift);  // ground too hard to finish the pull is lifted with what there is
    }
    return;
  }
  const bool at_face =
      std::abs(settings_.dig_azimuth_rad - belief.angles_rad[swing]) <= kTravelSwing_rad;
  if (arrived(target_rad, belief) && (phase_ != Phase::approach || at_face)) {
    switch (phase_) {
      case Phase::approach:
        return enter(Phase::dig);
      case Phase::lift:
        return enter(Phase::swing_to_truck);
      case Phase::swing_to_truck:
        return enter(Phase::dump);
      case Phase::dump:
        return enter(Phase::swing_back);
      case Phase::swing_back:
        ++completed_;
        return enter(Phase::approach);
      case Phase::dig:
        return;
    }
  }
  if (phase_time_s_ > settings_.phase_limit_s) {
    fault_ = kFaults[static_cast<std::size_t>(phase_)];
  }
}

CycleOutput Cycle::update(const Belief& belief, const View& view, double step_s) {
  CycleOutput output;
  if (fault_ || done()) {
    control_.neutral();
    output.target_rad = belief.angles_rad;
    return output;
  }
  if (phase_ == Phase::approach) {
    choose_ground(view);
  }
  output.target_rad = target(belief);
  const double swing_left_rad = output.target_rad[swing] - belief.angles_rad[swing];
  output.held_by_obstacle =
      (view.obstacle_left && swing_left_rad > settings_.swing_tolerance_rad) ||
      (view.obstacle_right && swing_left_rad < -settings_.swing_tolerance_rad);
  advance(output.target_rad, belief, output.held_by_obstacle ? 0.0 : step_s);
  PerJoint goal_rad = output.target_rad;
  if (output.held_by_obstacle) {
    goal_rad[swing] = belief.angles_rad[swing];
  }
  output.openings = control_.update(goal_rad, belief.angles_rad, step_s);
  return output;
}

}  // namespace rigwire::dig_cycle
