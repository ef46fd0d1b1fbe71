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
/// The scale takes samples while the boom turns more slowly than this.
constexpr double kWeighing_radps = 1.0 * kDegree;
/// Shares of the stick's way out: the boom goes down from the first, and is down at the second.
constexpr double kOverSide = 0.15;
constexpr double kOut = 0.75;
/// Left in the dump's pose with the bucket open, so that the last soil runs out.
constexpr double kPouring_s = 0.8;
/// From this pitch on next to nothing stays in the bucket.
constexpr double kPours_rad = -70.0 * kDegree;
/// A bucket that hangs more than this still has its teeth in the truck.
constexpr double kHanging_rad = -100.0 * kDegree;
/// The arm swings back when the stick is so near to where it is carried.
constexpr double kDrawnIn_rad = 30.0 * kDegree;
/// The stick goes out over the truck when the bucket is so near to its end: the soil stays in.
constexpr double kCurled_rad = 8.0 * kDegree;
/// The stick goes out no faster than it would to a target so far ahead of it.
constexpr double kReachStep_rad = 6.0 * kDegree;
/// A pull that the ground holds for so long is raised, so fast.
constexpr double kStalled_s = 0.3;
constexpr double kEase_mps = 0.25;
/// An arm that moved by this and then stops before its target is blocked by something.
constexpr double kMoved_rad = 5.0 * kDegree;
constexpr double kHeld_s = 10.0;
/// A bucket that is caught is pushed back out and lifted again, by turns of so long.
constexpr double kShake_s = 4.0;

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
  require(pit_depth_m >= dig_depth_m,
          "pit_depth_m is " + std::to_string(pit_depth_m) + ", allowed dig_depth_m or more");
  require(dig_sector_rad >= 0.0 && lane_spacing_rad > 0.0,
          "dig_sector_rad is " + std::to_string(dig_sector_rad) + " and lane_spacing_rad " +
              std::to_string(lane_spacing_rad) + ", allowed 0 or more and more than 0");
  for (const double depth_m : {dig_depth_m, pit_depth_m}) {
    const std::string at = " m is out of the arm's reach at " + std::to_string(-depth_m) + " m";
    require(reach(machine, {dig_start_radius_m, -depth_m}, bucket_attack_rad).has_value(),
            "dig_start_radius_m " + std::to_string(dig_start_radius_m) + at);
    require(reach(machine, {dig_end_radius_m, -depth_m}, bucket_curled_rad).has_value(),
            "dig_end_radius_m " + std::to_string(dig_end_radius_m) + at);
  }
}

Cycle::Cycle(const Machine& machine, const CycleSettings& settings,
             const JointControlSettings& control)
    : machine_(machine),
      settings_(settings),
      control_(machine, control),
      lanes_({.middle_rad = settings.dig_azimuth_rad,
              .sector_rad = settings.dig_sector_rad,
              .spacing_rad = settings.lane_spacing_rad,
              .depth_m = settings.dig_depth_m,
              .deepest_m = settings.pit_depth_m}),
      scale_(machine) {
  settings_.validate(machine);
}

void Cycle::enter(Phase phase) {
  phase_ = phase;
  phase_time_s_ = 0.0;
  dig_progress_ = 0.0;
  stage_ = 0;
  dwell_s_ = 0.0;
  lagging_s_ = 0.0;
  eased_m_ = 0.0;
  entered_rad_.reset();
  scale_.begin();
}

void Cycle::hold() {
  control_.neutral();
  phase_time_s_ = 0.0;
}

void Cycle::choose_ground(const View& view) {
  if (view.ground_z_m) {
    seen_z_m_ = std::clamp(*view.ground_z_m, kLowestGround_m, kHighestGround_m);
  }
  ground_z_m_ = lanes_.ground_m(seen_z_m_);
}

double Cycle::level_rad(const Belief& belief) const {
  const double arm_rad = belief.angles_rad[boom] + belief.angles_rad[stick];
  return std::clamp(settings_.level_pitch_rad - arm_rad, machine_.lower_rad[bucket],
                    settings_.bucket_open_rad);
}

PerJoint Cycle::carry(double bucket_rad, double swing_rad) const {
  return {swing_rad, settings_.carry_boom_rad, settings_.carry_stick_rad, bucket_rad};
}

PerJoint Cycle::dig_pose(double progress, double above_m) const {
  const double radius_m =
      std::lerp(settings_.dig_start_radius_m, settings_.dig_end_radius_m, progress);
  const double bucket_rad =
      std::lerp(settings_.bucket_attack_rad, settings_.bucket_curled_rad, progress);
  // If the ground is too low or too high for the arm, takes the nearest of five heights in reach.
  for (const double share : {1.0, 0.75, 0.5, 0.25, 0.0}) {
    if (auto pose = reach(machine_, {radius_m, ground_z_m_ * share + above_m}, bucket_rad)) {
      (*pose)[swing] = lanes_.azimuth_rad();
      return *pose;
    }
  }
  return carry(bucket_rad, lanes_.azimuth_rad());
}

PerJoint Cycle::lift_pose(const Belief& belief) const {
  const double caught_s = phase_time_s_ - kHeld_s;
  if (caught_s > 0.0 && std::fmod(caught_s, 2.0 * kShake_s) < kShake_s) {
    return dig_pose(0.0, settings_.approach_clearance_m);
  }
  return carry(level_rad(belief), lanes_.azimuth_rad());
}

PerJoint Cycle::dump_pose(const Belief& belief) const {
  // Over the truck's side first, then down, by the stick's way out.
  const double out = std::clamp((belief.angles_rad[stick] - settings_.carry_stick_rad) /
                                    (settings_.dump_stick_rad - settings_.carry_stick_rad),
                                0.0, 1.0);
  const double down = std::clamp((out - kOverSide) / (kOut - kOverSide), 0.0, 1.0);
  PerJoint pose{settings_.dump_azimuth_rad,
                std::lerp(settings_.carry_boom_rad, settings_.dump_boom_rad, down),
                settings_.dump_stick_rad, settings_.bucket_open_rad};
  if (stage_ == 0) {
    // The bucket cannot follow the stick by as much as that goes out: it curls before.
    pose[bucket] = machine_.lower_rad[bucket];
    if (out < kOverSide && belief.angles_rad[bucket] > machine_.lower_rad[bucket] + kCurled_rad) {
      pose[stick] = settings_.carry_stick_rad;
    }
    pose[stick] = std::min(pose[stick], belief.angles_rad[stick] + kReachStep_rad);
  }
  return pose;
}

PerJoint Cycle::return_pose(const Belief& belief) const {
  // The teeth come up first, then the arm in, then it swings.
  PerJoint pose = carry(level_rad(belief), belief.angles_rad[swing]);
  if (stage_ == 0) {
    pose[boom] = settings_.dump_boom_rad;
    pose[stick] = settings_.dump_stick_rad;
  } else if (stage_ == 2) {
    pose[swing] = lanes_.azimuth_rad();
  }
  return pose;
}

PerJoint Cycle::target(const Belief& belief) const {
  switch (phase_) {
    case Phase::approach: {
      const double off_rad = lanes_.azimuth_rad() - belief.angles_rad[swing];
      if (tare_ || std::abs(off_rad) > kTravelSwing_rad) {
        return carry(level_rad(belief), lanes_.azimuth_rad());
      }
      return dig_pose(0.0, settings_.approach_clearance_m);
    }
    case Phase::dig: {
      // The first fifth goes down, the rest pulls.
      const double down = std::min(1.0, dig_progress_ / 0.2);
      const double pull = std::max(0.0, (dig_progress_ - 0.2) / 0.8);
      return dig_pose(
          pull, std::lerp(settings_.approach_clearance_m, -settings_.dig_depth_m, down) + eased_m_);
    }
    case Phase::lift:
      return lift_pose(belief);
    case Phase::swing_to_truck:
      return carry(level_rad(belief), settings_.dump_azimuth_rad);
    case Phase::dump:
      return dump_pose(belief);
    case Phase::swing_back:
      return return_pose(belief);
  }
  return belief.angles_rad;
}

bool Cycle::arm_arrived(const PerJoint& target_rad, const Belief& belief) const {
  return std::ranges::all_of(std::array{boom, stick, bucket}, [&](Joint joint) {
    return std::abs(target_rad[joint] - belief.angles_rad[joint]) <= settings_.arm_tolerance_rad;
  });
}

bool Cycle::arrived(const PerJoint& target_rad, const Belief& belief) const {
  return arm_arrived(target_rad, belief) &&
         std::abs(target_rad[swing] - belief.angles_rad[swing]) < settings_.swing_tolerance_rad;
}

bool Cycle::weigh(const PerJoint& target_rad, const Belief& belief, const View& view) {
  if (!view.boom_force_n) {
    return true;
  }
  if (arm_arrived(target_rad, belief) && std::abs(belief.rates_radps[boom]) < kWeighing_radps &&
      std::abs(belief.rates_radps[stick]) < kWeighing_radps) {
    scale_.add(*view.boom_force_n);
  }
  return scale_.full();
}

void Cycle::advance_approach(const PerJoint& target_rad, const Belief& belief, const View& view) {
  if (tare_) {
    if (weigh(target_rad, belief, view)) {
      scale_.tare();
      tare_ = false;
      phase_time_s_ = 0.0;
    }
    return;
  }
  const bool at_face =
      std::abs(lanes_.azimuth_rad() - belief.angles_rad[swing]) <= kTravelSwing_rad;
  if (arrived(target_rad, belief) && at_face) {
    dug_ = true;
    return enter(Phase::dig);
  }
  const bool moved = std::ranges::any_of(std::array{boom, stick, bucket}, [&](Joint joint) {
    return std::abs(belief.angles_rad[joint] - (*entered_rad_)[joint]) > kMoved_rad;
  });
  if (at_face && moved && phase_time_s_ > kHeld_s) {
    lanes_.block();
    enter(Phase::lift);
  }
}

void Cycle::advance_dig(const PerJoint& target_rad, const Belief& belief, double step_s) {
  double lag_rad = 0.0;
  for (const Joint joint : {boom, stick, bucket}) {
    lag_rad = std::max(lag_rad, std::abs(target_rad[joint] - belief.angles_rad[joint]));
  }
  if (lag_rad < kLag_rad) {
    lagging_s_ = 0.0;
    dig_progress_ = std::min(1.0, dig_progress_ + step_s / settings_.dig_duration_s);
  } else {
    lagging_s_ += step_s;
    eased_m_ += lagging_s_ > kStalled_s ? kEase_mps * step_s : 0.0;
  }
  const bool finished = dig_progress_ >= 1.0 && arrived(target_rad, belief);
  if (finished || phase_time_s_ > settings_.dig_limit_s) {
    enter(Phase::lift);  // ground too hard to finish the pull is lifted with what there is
  }
}

void Cycle::advance_lift(const PerJoint& target_rad, const Belief& belief, const View& view) {
  if (phase_time_s_ > kHeld_s) {
    lanes_.block();
  }
  if (!arrived(target_rad, belief) || !weigh(target_rad, belief, view)) {
    return;
  }
  load_kg_ = scale_.load_kg(belief.angles_rad);
  const bool poor = !dug_ || (load_kg_ && *load_kg_ < settings_.poor_load_kg);
  if (dug_) {
    lanes_.cut(ground_z_m_, poor);
    dug_ = false;
  }
  if (!poor) {
    return enter(Phase::swing_to_truck);
  }
  if (!lanes_.next()) {
    finish_pit();
  }
  enter(Phase::approach);
}

void Cycle::advance_dump(const PerJoint& target_rad, const Belief& belief, double step_s) {
  const double pitch_rad =
      belief.angles_rad[boom] + belief.angles_rad[stick] + belief.angles_rad[bucket];
  if (stage_ == 0) {
    const bool out = target_rad[stick] >= settings_.dump_stick_rad;
    stage_ = out && arm_arrived(target_rad, belief) ? 1 : 0;
    return;
  }
  dwell_s_ += pitch_rad > kPours_rad ? step_s : 0.0;
  if (dwell_s_ >= kPouring_s) {
    loaded_kg_ += load_kg_.value_or(0.0);
    more_to_dig_ = lanes_.next();
    enter(Phase::swing_back);
  }
}

void Cycle::advance_return(const PerJoint& target_rad, const Belief& belief) {
  const double pitch_rad =
      belief.angles_rad[boom] + belief.angles_rad[stick] + belief.angles_rad[bucket];
  if (stage_ == 0 && pitch_rad < kHanging_rad) {
    stage_ = 1;
  } else if (stage_ == 1 &&
             std::abs(belief.angles_rad[stick] - settings_.carry_stick_rad) < kDrawnIn_rad) {
    stage_ = 2;
  } else if (stage_ == 2 && arrived(target_rad, belief)) {
    ++completed_;
    if (settings_.cycles != 0 && completed_ >= settings_.cycles) {
      finished_ = std::to_string(completed_) + " cycles done";
    } else if (settings_.truck_load_kg > 0.0 && loaded_kg_ >= settings_.truck_load_kg) {
      finished_ = "the truck is full: " + std::to_string(std::lround(loaded_kg_)) + " kg in " +
                  std::to_string(completed_) + " cycles";
    } else if (!more_to_dig_) {
      finish_pit();
    }
    enter(Phase::approach);
  }
}

void Cycle::finish_pit() {
  finished_ = "the pit is empty as far as the arm reaches: " + std::to_string(lanes_.count()) +
              " lanes, " + std::to_string(lanes_.blocked()) + " of them blocked";
}

void Cycle::advance(const PerJoint& target_rad, const Belief& belief, const View& view,
                    double step_s) {
  phase_time_s_ += step_s;
  const Phase before = phase_;
  switch (phase_) {
    case Phase::approach:
      advance_approach(target_rad, belief, view);
      break;
    case Phase::dig:
      return advance_dig(target_rad, belief, step_s);
    case Phase::lift:
      advance_lift(target_rad, belief, view);
      break;
    case Phase::swing_to_truck:
      if (arrived(target_rad, belief)) {
        enter(Phase::dump);
      }
      break;
    case Phase::dump:
      advance_dump(target_rad, belief, step_s);
      break;
    case Phase::swing_back:
      advance_return(target_rad, belief);
      break;
  }
  if (phase_ == before && phase_time_s_ > settings_.phase_limit_s) {
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
  if (!begun_) {
    begun_ = true;
    tare_ = view.boom_force_n.has_value();
  }
  if (!entered_rad_) {
    entered_rad_ = belief.angles_rad;
  }
  if (phase_ == Phase::approach) {
    choose_ground(view);
  }
  output.target_rad = target(belief);
  const double swing_left_rad = output.target_rad[swing] - belief.angles_rad[swing];
  output.held_by_obstacle =
      (view.obstacle_left && swing_left_rad > settings_.swing_tolerance_rad) ||
      (view.obstacle_right && swing_left_rad < -settings_.swing_tolerance_rad);
  advance(output.target_rad, belief, view, output.held_by_obstacle ? 0.0 : step_s);
  PerJoint goal_rad = output.target_rad;
  if (output.held_by_obstacle) {
    goal_rad[swing] = belief.angles_rad[swing];
  }
  output.openings = control_.update(goal_rad, belief.angles_rad, step_s);
  return output;
}

}  // namespace rigwire::dig_cycle
