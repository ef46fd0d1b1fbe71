// How long the functions of the machine of configs/machines/excavator_ref18t.yaml take, measured as
// service manuals do, beside what they give.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

#include "bench/machine_files.h"
#include "excavator_rig.h"
#include "fields/constants.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;

/// Returns the posture in which makers time the swing (Takeuchi TB250, service data 2-17): stick
/// stretched out, bucket curled, the bucket's pin as high as the boom's foot.
ExcavatorPose farthest_reach(const ExcavatorParameters& parameters) {
  const Excavator machine = level_machine(parameters);
  ExcavatorPose pose = parameters.initial;
  pose.stick_rad = machine.linkages().angle_at(1, parameters.stick_cylinder.length_min_m);
  pose.bucket_rad = machine.linkages().angle_at(2, parameters.bucket_cylinder.length_max_m);
  const WorkingRange& boom = machine.linkages().range(0);
  double least_m = 1e9;
  for (double angle = boom.q_min_rad(); angle < boom.q_max_rad(); angle += 0.5 * kDegree) {
    ExcavatorParameters tried = parameters;
    tried.initial = pose;
    tried.initial.boom_rad = angle;
    const Excavator there = level_machine(tried);
    const double apart_m =
        std::abs(there.links()[4].X_WL.translation().z() - there.links()[2].X_WL.translation().z());
    if (apart_m < least_m) {
      least_m = apart_m;
      pose.boom_rad = angle;
    }
  }
  return pose;
}

// Finding: it swung 90 degrees in 1.7 s. Komatsu PC130-8, 13 t, shop manual p. 302: 90 degrees
// in 2.9
// +- 0.3 s and 180 in 4.3 +- 0.4 s from the lever, of which the operator's hand and the stop watch
// take some tenths; overrun 75 +- 10 degrees.
TEST(WorkSpeed, TheSwingTakesAsLongAsMakersSay) {
  ExcavatorParameters parameters = bench::excavator_ref18t();
  parameters.initial = farthest_reach(parameters);
  Excavator machine = level_machine(parameters);
  machine.command(openings(1.0, 0.0, 0.0, 0.0));
  double quarter_s = 0.0;
  double half_s = 0.0;
  for (double now_s = 0.0; half_s == 0.0 && now_s < 20.0; now_s += 0.01) {
    machine.step(10ms);
    const double angle = machine.joint_angles_rad()[0] - parameters.initial.swing_rad;
    quarter_s = quarter_s == 0.0 && angle >= 0.5 * std::numbers::pi ? now_s : quarter_s;
    half_s = angle >= std::numbers::pi ? now_s : half_s;
  }
  machine.command(openings(0.0, 0.0, 0.0, 0.0));
  const double from_rad = machine.joint_angles_rad()[0];
  machine.step(10s);
  EXPECT_NEAR(quarter_s, 2.9 - 0.3, 0.3);
  EXPECT_NEAR(half_s, 4.3 - 0.3, 0.4);
  EXPECT_NEAR((machine.joint_angles_rad()[0] - from_rad) / kDegree, 75.0, 10.0);
}

// Finding: the bucket dumped in 1.2 s and the stick went out in 1.7 s, twice as fast as machines of
// 18 to 20 t. Full strokes without load at full speed; references from memory of their manuals.
TEST(WorkSpeed, StrokesTakeAsLongAsTheClassHasThem) {
  struct Stroke {
    std::size_t section;
    double opening;
    double takes_s;
  };
  const ExcavatorParameters& parameters = bench::excavator_ref18t();
  for (const Stroke& stroke : {Stroke{1, 1.0, 4.0}, Stroke{1, -1.0, 2.4}, Stroke{2, 1.0, 3.3},
                               Stroke{2, -1.0, 2.7}, Stroke{3, 1.0, 2.5}, Stroke{3, -1.0, 2.1}}) {
    Excavator machine = level_machine(parameters);
    ValveCommand command;
    command.opening[stroke.section] = -stroke.opening;
    machine.command(command);
    machine.step(10s);
    command.opening[stroke.section] = stroke.opening;
    machine.command(command);
    std::vector<double> angles_rad;
    for (int i = 0; i < 1000; ++i) {
      machine.step(10ms);
      angles_rad.push_back(machine.joint_angles_rad()[static_cast<Eigen::Index>(stroke.section)]);
    }
    // The last degrees are the cushion's.
    const auto moving = std::find_if(angles_rad.rbegin(), angles_rad.rend(), [&](double angle) {
      return std::abs(angle - angles_rad.back()) > 2.0 * kDegree;
    });
    const double took_s = 0.01 * static_cast<double>(angles_rad.rend() - moving);
    EXPECT_NEAR(took_s, stroke.takes_s, 0.15 * stroke.takes_s)
        << "section " << stroke.section << ", opening " << stroke.opening;
  }
}

}  // namespace
}  // namespace rigwire::sim::test
