// The excavator strikes itself.
#include "sim/excavator/own_contact.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include "allocation_counter.h"
#include "sim/contact/closest.h"
#include "sim/excavator/excavator.h"

namespace rigwire::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Its bucket in front of its cab, which has a guard over it.
ExcavatorParameters with_cab(ExcavatorLevel level) {
  ExcavatorParameters p;
  p.level = level;
  p.solid.boxes.push_back({"cab", "upper", {0.8, 0.8, 1.05}, {1.8, 0.95, 2.0}, 0.0});
  p.strikes_itself = true;
  p.initial = {0.0, 0.75, -2.3, -1.0};
  return p;
}

/// How deep any body of the bucket is in the cab.
double deepest_m(const Excavator& machine, const ExcavatorParameters& p) {
  double deepest = 0.0;
  const std::vector<ContactBody> bodies = contact_bodies(p.solid, kExcavatorLinks, 1500.0);
  const ContactBody& cab = bodies.back();
  const PlacedShape b{&cab.shape, machine.links()[cab.link].X_WL * cab.X_LS};
  for (const ContactBody& body : bodies) {
    if (body.link == kLinks - 1) {
      const PlacedShape a{&body.shape, machine.links()[body.link].X_WL * body.X_LS};
      deepest = std::max(deepest, -separation(a, b, 0.1).gap_m);
    }
  }
  return deepest;
}

ValveCommand draw_in() {
  ValveCommand command;
  command.opening[2] = 0.5;
  return command;
}

TEST(OwnContact, ABucketDrawnIntoTheCabIsStopped) {
  for (const ExcavatorCarrier carrier : {ExcavatorCarrier::fixed, ExcavatorCarrier::moving}) {
    for (const ExcavatorLevel level : {ExcavatorLevel::kinematic, ExcavatorLevel::quasi_static,
                                       ExcavatorLevel::dynamic, ExcavatorLevel::chambers}) {
      if (carrier == ExcavatorCarrier::moving && level == ExcavatorLevel::kinematic) {
        continue;
      }
      const Ground ground;
      ExcavatorParameters p = with_cab(level);
      p.carrier = carrier;
      // Without it the bucket passes through.
      p.strikes_itself = false;
      Excavator ghost(p, Eigen::Isometry3d::Identity(), &ground);
      ghost.command(draw_in());
      double entered = 0.0;
      for (int i = 0; i < 400; ++i) {
        ghost.step(milliseconds(10));
        entered = std::max(entered, deepest_m(ghost, p));
      }
      EXPECT_GT(entered, 0.1);

      p.strikes_itself = true;
      Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
      ASSERT_EQ(deepest_m(machine, p), 0.0);
      machine.command(draw_in());
      double deepest = 0.0;
      const auto before = test::allocations();
      for (int i = 0; i < 400; ++i) {
        machine.step(milliseconds(10));
        deepest = std::max(deepest, machine.own_contact()->deepest_ever_m());
      }
      EXPECT_EQ(test::allocations(), before);
      ASSERT_TRUE(machine.finite());
      EXPECT_LT(deepest_m(machine, p), 5e-3) << static_cast<int>(level);
      EXPECT_LT(deepest, 5e-3) << static_cast<int>(level);
      EXPECT_LT(machine.joint_rates_radps().norm(), 0.02) << static_cast<int>(level);
      if (level != ExcavatorLevel::kinematic) {
        EXPECT_GT(machine.own_contact()->force_n(), 1e4);
        EXPECT_EQ(machine.own_contact()->inner(), "cab");
        EXPECT_EQ(machine.own_contact()->outer().substr(0, 6), "bucket");
        EXPECT_GT(machine.own_contact()->lost_j(), -1.0) << "gives no energy";
        std::size_t count = 0;
        for (const TruthField& field : machine.truth_fields()) {
          count += field.count;
        }
        std::vector<double> truth(count);
        machine.read_truth(truth);
        EXPECT_EQ(truth.back(), machine.own_contact()->force_n());
      }
    }
  }
}

// What does not touch itself moves as before, to the last bit.
TEST(OwnContact, AnArmThatDoesNotTouchMovesAsWithoutIt) {
  const Ground ground;
  const auto run = [&](bool strikes) {
    ExcavatorParameters p;
    p.strikes_itself = strikes;
    Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
    ValveCommand command;
    command.opening = {0.5, -0.2, -0.3, 0.2};
    machine.command(command);
    machine.step(seconds(2));
    return machine.joint_angles_rad();
  };
  EXPECT_EQ(run(true), run(false));
}

TEST(OwnContact, ABoomLoweredWithADrawnInBucketStandsOnTheUndercarriage) {
  ExcavatorParameters p;
  p.strikes_itself = true;
  p.solid.boxes[0].size_m = {4.2, 2.5, 1.1};  // With its tyres.
  p.initial = {0.0, 0.9, -2.6, -0.4};
  Excavator machine(p, Eigen::Isometry3d::Identity());  // No ground to stand on.
  ValveCommand command;
  command.opening[1] = -0.5;
  machine.command(command);
  machine.step(seconds(8));
  ASSERT_TRUE(machine.finite());
  EXPECT_LT(machine.own_contact()->deepest_ever_m(), 5e-3);
  EXPECT_GT(machine.own_contact()->force_n(), 1e4);
  EXPECT_LT(machine.joint_rates_radps().norm(), 0.02);
}

}  // namespace
}  // namespace rigwire::sim
