// The excavator strikes itself.
#include "sim/excavator/own_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "allocation_counter.h"
#include "digging_site.h"
#include "sim/contact/closest.h"
#include "sim/excavator/excavator.h"

namespace rigwire::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kBucket = kLinks - 1;

/// How deep any body of the bucket is in the body of that name.
double deepest_m(const Excavator& machine, const ExcavatorParameters& p, std::string_view name) {
  double deepest = 0.0;
  const std::vector<ContactBody> bodies = contact_bodies(p.solid, kExcavatorLinks, 1500.0);
  const ContactBody& inner = *std::ranges::find(bodies, name, &ContactBody::name);
  const PlacedShape b{&inner.shape, machine.links()[inner.link].X_WL * inner.X_LS};
  for (const ContactBody& body : bodies) {
    if (body.link == kBucket) {
      const PlacedShape a{&body.shape, machine.links()[body.link].X_WL * body.X_LS};
      deepest = std::max(deepest, -separation(a, b, 0.1).gap_m);
    }
  }
  return deepest;
}

/// What the bucket is driven into, from where and by which valves.
struct Blow {
  const char* into;
  ExcavatorPose from;
  double boom = 0.0;
  double stick = 0.0;
};
constexpr std::array<Blow, 3> kBlows{{{"cab", {0.0, 0.75, -2.3, -1.0}, 0.0, 0.5},
                                      {"undercarriage", {0.0, 0.7, -2.6, -0.6}, -0.5, 0.0},
                                      {"left tyres", {0.6, 0.7, -2.6, -0.6}, -0.5, 0.0}}};

ValveCommand valves(const Blow& blow) {
  ValveCommand command;
  command.opening[1] = blow.boom;
  command.opening[2] = blow.stick;
  return command;
}

class BucketBlow : public testing::TestWithParam<Blow> {};

TEST_P(BucketBlow, IsStoppedAndGivesNoEnergy) {
  const Blow& blow = GetParam();
  for (const ExcavatorCarrier carrier : {ExcavatorCarrier::fixed, ExcavatorCarrier::moving}) {
    for (const ExcavatorLevel level : {ExcavatorLevel::kinematic, ExcavatorLevel::quasi_static,
                                       ExcavatorLevel::dynamic, ExcavatorLevel::chambers}) {
      if (carrier == ExcavatorCarrier::moving && level == ExcavatorLevel::kinematic) {
        continue;
      }
      SCOPED_TRACE(std::to_string(static_cast<int>(level)) +
                   (carrier == ExcavatorCarrier::fixed ? ", fixed" : ", moving"));
      const Ground ground;
      ExcavatorParameters p;
      p.level = level;
      p.initial = blow.from;
      p.carrier = carrier;
      // Without it the bucket passes through.
      p.strikes_itself = false;
      Excavator ghost(p, Eigen::Isometry3d::Identity(), &ground);
      ghost.command(valves(blow));
      double entered = 0.0;
      for (int i = 0; i < 400; ++i) {
        ghost.step(milliseconds(10));
        entered = std::max(entered, deepest_m(ghost, p, blow.into));
      }
      EXPECT_GT(entered, 0.05);

      p.strikes_itself = true;
      Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
      ASSERT_EQ(deepest_m(machine, p, blow.into), 0.0);
      machine.command(valves(blow));
      double deepest = 0.0;
      const auto before = rigwire::test::allocations();
      for (int i = 0; i < 400; ++i) {
        machine.step(milliseconds(10));
        deepest = std::max(deepest, machine.own_contact()->deepest_ever_m());
      }
      EXPECT_EQ(rigwire::test::allocations(), before);
      ASSERT_TRUE(machine.finite());
      EXPECT_LT(deepest_m(machine, p, blow.into), 5e-3);
      EXPECT_LT(deepest, 5e-3);
      if (carrier == ExcavatorCarrier::fixed) {
        EXPECT_LT(machine.joint_rates_radps().norm(), 0.02);  // The other gives way.
      }
      if (level != ExcavatorLevel::kinematic) {
        EXPECT_GT(machine.own_contact()->force_n(), 1e4);
        EXPECT_EQ(machine.own_contact()->inner(), blow.into);
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

INSTANTIATE_TEST_SUITE_P(OwnContact, BucketBlow, testing::ValuesIn(kBlows), [](const auto& blow) {
  std::string name = blow.param.into;
  std::ranges::replace(name, ' ', '_');
  return name;
});

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

// A plane figure has its points where the machine's pins, and not its boxes, say that its links
// are.
using Point = Eigen::Vector2d;
using Outline = std::vector<Point>;

double apart_m(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto side = [](const Point& p, const Point& q, const Point& r) {
    return (q - p).x() * (r - p).y() - (q - p).y() * (r - p).x();
  };
  if (side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0) {
    return 0.0;
  }
  const auto to_line = [](const Point& p, const Point& q, const Point& r) {
    const double share = std::clamp((p - q).dot(r - q) / (r - q).squaredNorm(), 0.0, 1.0);
    return (p - q - share * (r - q)).norm();
  };
  return std::min({to_line(a, c, d), to_line(b, c, d), to_line(c, a, b), to_line(d, a, b)});
}

/// Between the lines along the corners, the bucket's closed.
double apart_m(const Outline& boom, const Outline& bucket) {
  double least = 1e300;
  for (std::size_t i = 0; i + 1 < boom.size(); ++i) {
    for (std::size_t k = 0; k < bucket.size(); ++k) {
      least = std::min(least,
                       apart_m(boom[i], boom[i + 1], bucket[k], bucket[(k + 1) % bucket.size()]));
    }
  }
  return least;
}

// One straight box for the boom stopped a curled bucket 0.6 m short of it.
TEST(OwnContact, BucketAndBoomMeetWhereTheirPinsSayAndNowhereElse) {
  const ExcavatorParameters p;
  const DrivenArm arm(p, Eigen::Vector3d(0.0, 0.0, -9.8));
  const std::vector<ContactBody> bodies = contact_bodies(p.solid, kExcavatorLinks, 1500.0);
  // Foot, cylinders' pin in the bend, stick: the boom's middle line. Pin, lug, shell, teeth.
  const Outline boom{{0.0, 0.0}, p.boom_linkage.rod_pin_m, {p.boom_length_m, 0.0}};
  const BucketLinkageParameters& four_bar = p.bucket_linkage;
  const Point lug(four_bar.lug_radius_m * std::cos(four_bar.lug_angle_rad),
                  four_bar.lug_radius_m * std::sin(four_bar.lug_angle_rad));
  const double lip_rad = BucketSoilParameters{}.lip_angle_rad;
  const Point heel(p.bucket_tip_m - lug.y() / std::tan(lip_rad), lug.y());
  const Outline bucket{{0.0, 0.0}, lug, heel, {p.bucket_tip_m, 0.0}};
  constexpr double kThick_m = 0.35;  // Half of the boom, and how far its bend is from the pin.
  constexpr int kSteps = 30;
  const WorkingRange& stick = arm.linkages().range(1);
  const WorkingRange& curl = arm.linkages().range(2);
  int met = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      JointVector q = JointVector::Zero();
      q[2] = stick.q_min_rad() + (stick.q_max_rad() - stick.q_min_rad()) * i / kSteps;
      q[3] = curl.q_min_rad() + (curl.q_max_rad() - curl.q_min_rad()) * k / kSteps;
      const auto motion = arm.dynamics().motion(q, JointVector::Zero(), JointVector::Zero());
      const auto placed = [&](const ContactBody& body) {
        Eigen::Isometry3d X_CL = Eigen::Isometry3d::Identity();
        X_CL.linear() = motion[body.link - 1].R_CB;
        X_CL.translation() = motion[body.link - 1].p_CB_C;
        return PlacedShape{&body.shape, X_CL * body.X_LS};
      };
      double gap = 1e300;
      for (const ContactBody& outer : bodies) {
        for (const ContactBody& inner : bodies) {
          if (outer.link == kBucket && inner.link == 2) {
            gap = std::min(gap, separation(placed(outer), placed(inner), 1.0).gap_m);
          }
        }
      }
      // The bucket's outline in the boom's frame.
      const Point pin =
          Point(p.boom_length_m, 0.0) + p.stick_length_m * Point(std::cos(q[2]), std::sin(q[2]));
      Outline turned = bucket;
      for (Point& point : turned) {
        point = pin + Eigen::Rotation2Dd(q[2] + q[3]) * point;
      }
      const double apart = apart_m(boom, turned);
      met += gap < 0.0 ? 1 : 0;
      if (gap < 0.0) {
        EXPECT_LT(apart, kThick_m) << q.transpose() << ": a contact in the air";
      }
      if (apart == 0.0) {
        EXPECT_LT(gap, 0.0) << q.transpose() << ": passes through";
      }
    }
  }
  // Drawn in to the end and curled beyond 85 degrees the teeth would pass the boom's line.
  EXPECT_GT(met, 0);
  EXPECT_LT(met, 0.03 * (kSteps + 1) * (kSteps + 1));
}

TEST(OwnContact, NoPoseOfADigMeetsItself) {
  test::Site with;
  ExcavatorParameters p = test::ready_to_dig();
  p.strikes_itself = false;
  test::Site without(test::sandy(), {}, p);
  for (test::Site* site : {&with, &without}) {
    site->dig();
    site->run(2.5, 0.6, 0.5, -0.3, 0.0);
    site->run(3.0, 0.0, 0.0, -0.5, -0.9);
  }
  EXPECT_EQ(with.machine.excavator().own_contact()->lost_j(), 0.0);
  EXPECT_EQ(with.machine.excavator().joint_angles_rad(),
            without.machine.excavator().joint_angles_rad());
  EXPECT_EQ(with.machine.bucket().units(), without.machine.bucket().units());
}

}  // namespace
}  // namespace rigwire::sim
