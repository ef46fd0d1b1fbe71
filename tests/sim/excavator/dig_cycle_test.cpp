#include "sim/excavator/digging_excavator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "allocation_counter.h"
#include "digging_site.h"
#include "sanitized.h"

namespace rigwire::sim {
namespace {

using namespace test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using std::chrono::milliseconds;

TEST(DigCycle, BucketFillsIsWeighedIsDumpedAndNothingIsLost) {
  Site site;
  const double empty_boom_load = site.machine.excavator().drive_forces()[1];
  EXPECT_GT(empty_boom_load, 0.0);
  site.dig();
  const BucketSoil& bucket = site.machine.bucket();
  EXPECT_GT(bucket.volume_m3(), 0.5);
  EXPECT_LE(bucket.volume_m3(), bucket.capacity().heaped_m3() + 1e-9);
  EXPECT_NEAR(bucket.mass_kg(), 1700.0 * bucket.volume_m3(), 1e-6);
  EXPECT_EQ(site.machine.excavator().payload_kg(), bucket.mass_kg());
  EXPECT_EQ(bucket.depth_m(), 0.0);
  site.run(25.0, 0.0, 0.0, 0.0, 0.0);

  // At rest the cylinders carry arm and soil: F = tau_g / lever.
  const Excavator& arm = site.machine.excavator();
  const JointVector loaded = arm.arm()
                                 .dynamics()
                                 .gravity_load(arm.joint_angles_rad())
                                 .cwiseQuotient(arm.arm().pose(arm.joint_angles_rad()).lever);
  for (int i = 1; i < 4; ++i) {
    EXPECT_NEAR(arm.drive_forces()[i] / loaded[i], 1.0, 1e-3) << i;
  }

  const double carried = bucket.mass_kg();
  site.run(2.0, 0.6, 0.0, 0.0, 0.0);
  site.run(1.0, 0.0, 0.0, 0.0, 0.0);
  EXPECT_EQ(bucket.mass_kg(), carried);
  site.run(3.0, 0.0, 0.0, 0.0, -0.9);
  site.run(3.0, 0.0, 0.0, 0.0, 0.0);
  EXPECT_EQ(bucket.units(), 0);
  EXPECT_EQ(arm.payload_kg(), 0.0);
  EXPECT_EQ(site.worst_imbalance, 0);
  EXPECT_EQ(site.machine.terrain().gained_units(), 0);
  EXPECT_FALSE(site.machine.non_finite().has_value());
}

TEST(DigCycle, HeapUnderTheBucketLiesAtTheAngleOfRepose) {
  const double cell = 0.2;
  Ground ground = sandy(cell);
  DiggableTerrain terrain(ground, {});
  const LinkMotion over = bucket_at(3.0, 5.0, -0.3);
  BucketSoil bucket({}, 1.40, kGravity, terrain, over);
  for (int load = 0; load < 12; ++load) {
    bucket.fill(0.8, 1360.0);
    for (int i = 0; i < 2500; ++i) {
      bucket.advance(1e-3, over);
    }
    ASSERT_EQ(bucket.units(), 0);
  }
  while (!terrain.settled()) {
    terrain.settle();
  }
  const double tangent = std::tan(sand().repose_rad);
  const double height = std::cbrt(3.0 * 12 * 0.8 * tangent * tangent / std::numbers::pi);
  const double x = 3.0 + 1.40 * std::cos(0.3);
  double top = 0.0;
  for (const double h : ground.field().heights_m) {
    top = std::max(top, h);
  }
  EXPECT_NEAR(top, height, cell * tangent);
  const double low = height / tangent * 0.7;
  const double high = height / tangent * 0.3;
  for (const double angle : {0.0, 1.571, 3.142, 4.712}) {
    const Vector3d out(std::cos(angle), std::sin(angle), 0.0);
    const double slope = (terrain.height_m(x + high * out.x(), high * out.y()) -
                          terrain.height_m(x + low * out.x(), low * out.y())) /
                         (low - high);
    EXPECT_NEAR(std::atan(slope), sand().repose_rad, 0.05) << angle;
  }
}

TEST(DigCycle, ManyCyclesKeepTheBalanceAndAllocateNothing) {
  Site site;
  const auto before = rigwire::test::allocations();
  for (int cycle = 0; cycle < 5; ++cycle) {
    site.run(0.9, 0.0, -0.5, 0.0, 0.0);
    site.run(2.0, 0.0, 0.1, 0.8, 0.4);
    site.run(1.5, 0.2, 0.8, 0.0, 0.8);
    site.run(1.5, 0.0, 0.0, -0.9, -1.0);
    site.run(1.0, -0.3, 0.0, 0.0, 0.0);
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_EQ(site.worst_imbalance, 0);
  EXPECT_FALSE(site.machine.non_finite().has_value());
}

// A stick drawn thicker than it is met the trench's floor: the third and fourth of four digs took a
// tenth of what they took with bodies that pass through the ground.
TEST(DigCycle, FourDigsInOneTrenchMeetTheGroundWithTheBucketAlone) {
  const auto dig_four = [](const ExcavatorParameters& excavator) {
    Site site(sandy(), {}, excavator);
    const Excavator& arm = site.machine.excavator();
    const JointVector start = arm.joint_angles_rad();
    const auto go = [&](const JointVector& to, double span_s) {
      for (int i = 0; i < static_cast<int>(span_s * 20.0); ++i) {
        const JointVector left = to - arm.joint_angles_rad();
        const auto opening = [](double wanted, double most) {
          return std::abs(wanted) < 2e-3
                     ? 0.0
                     : std::clamp(wanted + std::copysign(0.04, wanted), -most, most);
        };
        site.run(0.05, opening(0.8 * left[0] - 0.6 * arm.joint_rates_radps()[0], 0.5),
                 opening(2.0 * left[1], 0.8), opening(-2.0 * left[2], 0.8),
                 opening(-2.0 * left[3], 0.8));
      }
    };
    std::vector<double> taken(kSanitized ? 1 : 4);  // Minutes each under a sanitizer.
    for (double& each : taken) {
      site.dig();
      each = site.machine.bucket().volume_m3();
      // Dumped aside, and back.
      JointVector pose = arm.joint_angles_rad();
      pose[0] = 1.4;
      pose[1] = 0.6;
      go(pose, 8.0);
      pose[3] = 0.4;
      go(pose, 5.0);
      pose[0] = 0.0;
      go(pose, 8.0);
      go(start, 6.0);
    }
    return taken;
  };
  ExcavatorParameters p = ready_to_dig();
  p.level = ExcavatorLevel::quasi_static;
  p.carrier = ExcavatorCarrier::moving;
  const std::vector<double> with_bodies = dig_four(p);
  p.solid.boxes.clear();
  EXPECT_EQ(with_bodies, dig_four(p));
  for (const double volume : with_bodies) {
    EXPECT_GT(volume, 0.25);
  }
}

TEST(DigCycle, StandstillInTheSoilIsSilent) {
  Site site;
  site.run(0.9, 0.0, -0.4, 0.0, 0.0);
  ASSERT_GT(site.machine.bucket().depth_m(), 0.3);
  site.run(20.0, 0.0, 0.0, 0.0, 0.0);
  const Excavator& arm = site.machine.excavator();
  const JointVector rest = arm.joint_angles_rad();
  const std::int64_t held = site.machine.bucket().units();
  // What the soil holds creeps, slower than ramp_speed_mps.
  EXPECT_LT(arm.joint_rates_radps().norm(), 2e-4);
  for (const double force : arm.bucket_resistances_n()) {
    EXPECT_TRUE(std::isfinite(force));
  }
  int changes = 0;
  double before = arm.joint_rates_radps()[1];
  for (int i = 0; i < 2000; ++i) {
    site.machine.step(milliseconds(1));
    const double now = arm.joint_rates_radps()[1];
    changes += now * before < 0.0 ? 1 : 0;
    before = now;
  }
  EXPECT_LT(changes, 3);
  EXPECT_LT((arm.joint_angles_rad() - rest).norm(), 4e-4);
  EXPECT_NEAR(static_cast<double>(site.machine.bucket().units()), static_cast<double>(held),
              2e-3 * static_cast<double>(held));
}

TEST(DigCycle, BucketOnRockStallsAtTheReliefAndDoesNotJumpWhenReleased) {
  SoilParameters rock;
  rock.name = "rock";
  Site site(Ground(level_field(0.4), SoilMap{{rock}, {}}, {}));
  const Excavator& arm = site.machine.excavator();
  site.run(3.0, 0.0, -0.4, 0.0, 0.0);
  site.run(20.0, 0.0, -0.4, 0.0, 0.0);
  // The boom cylinders pull at their relief; the teeth rest on the rock.
  const ExcavatorParameters parameters;
  const double relief_n =
      parameters.supply.relief_pressure_pa * parameters.boom_cylinder.rod_side_area_m2() -
      parameters.supply.tank_pressure_pa * parameters.boom_cylinder.bottom_area_m2();
  EXPECT_NEAR(arm.drive_forces()[1], -relief_n, 1e-6 * relief_n);
  EXPECT_NEAR(arm.tip_W().z(), 0.0, 0.02);
  EXPECT_LT(arm.joint_rates_radps().norm(), 1e-3);
  EXPECT_EQ(site.machine.bucket().units(), 0);
  const double before = arm.tip_W().z();
  double highest = before;
  ValveCommand stop;
  site.machine.valve_port()->command(stop);
  for (int i = 0; i < 2000; ++i) {
    site.machine.step(milliseconds(1));
    highest = std::max(highest, arm.tip_W().z());
  }
  EXPECT_LT(highest - before, 0.02);
}

TEST(DigCycle, OneCallEqualsManyAndEqualRunsAreEqual) {
  Site a;
  Site b;
  ValveCommand command;
  command.opening = {0.1, -0.4, 0.3, 0.2};
  a.machine.valve_port()->command(command);
  b.machine.valve_port()->command(command);
  a.machine.step(milliseconds(1500));
  for (int i = 0; i < 1500; ++i) {
    b.machine.step(milliseconds(1));
    b.machine.step(Duration{0});
  }
  EXPECT_EQ(a.machine.bucket().units(), b.machine.bucket().units());
  EXPECT_EQ(a.machine.excavator().joint_angles_rad(), b.machine.excavator().joint_angles_rad());
  EXPECT_EQ(a.ground.field().heights_m, b.ground.field().heights_m);
  EXPECT_GT(a.machine.bucket().units(), 0);
}

TEST(DigCycle, DiggingTakesEnergyFromTheMachineAndNeverGivesAny) {
  Site site;
  site.run(0.5, 0.0, -0.4, 0.0, 0.0);
  ValveCommand command;
  command.opening = {0.0, -0.1, 0.5, 0.2};
  site.machine.valve_port()->command(command);
  double work = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const Excavator& arm = site.machine.excavator();
    const LinkMotion& link = arm.link(Link::bucket);
    const BucketGroundLoad load = site.machine.bucket().load(1e-3, link);
    site.machine.step(milliseconds(1));
    const LinkMotion& after = arm.link(Link::bucket);
    const Vector3d v = after.v_WL_W + after.w_WL_W.cross(arm.tip_W() - after.X_WL.translation());
    Vector3d force = load.force_W;
    const auto resisted = arm.bucket_resistances_n();
    ASSERT_EQ(resisted.size(), load.count);
    for (std::size_t k = 0; k < load.count; ++k) {
      force += resisted[k] * load.resistances[k].direction_W;
    }
    const double power = force.dot(v);
    EXPECT_LE(power, 50.0) << i;  // Up to what the pose turns within a step.
    work += 1e-3 * power;
  }
  EXPECT_LT(work, -5e3);
}

TEST(DigCycle, PayloadLimitFollowsTheBucket) {
  DiggingParameters digging;
  digging.bucket.struck_capacity_m3 = 1.2;
  digging.bucket.width_m = 1.5;
  Site site(sandy(), digging);
  site.machine.excavator().set_payload_kg(1e9);
  EXPECT_NEAR(site.machine.excavator().payload_kg(),
              site.machine.bucket().capacity().heaped_m3() * 1700.0, 1e-6);
}

TEST(DigCycle, StatusAndTruthTellOfTheSoil) {
  Site site;
  site.dig();
  const Machine& machine = site.machine;
  std::vector<double> status(machine.status_quantities().size());
  machine.read_status(status);
  EXPECT_EQ(machine.status_quantities()[status.size() - 2].name, "payload");
  EXPECT_EQ(status[status.size() - 2], site.machine.bucket().mass_kg());
  std::size_t numbers = 0;
  for (const TruthField& field : machine.truth_fields()) {
    numbers += field.count;
  }
  std::vector<double> truth(numbers);
  machine.read_truth(truth);
  EXPECT_EQ(truth[numbers - 4], site.machine.bucket().volume_m3());
}

// On tyres: the machine leans into the cut, and the soil is still all there.
TEST(DigCycle, OnAMovingCarrierTheMachineRocksAndNothingIsLost) {
  ExcavatorParameters parameters = ready_to_dig();
  parameters.carrier = ExcavatorCarrier::moving;
  Site site(sandy(), {}, parameters);
  const auto pitch = [&site] {
    const Eigen::Matrix3d R = site.machine.links()[0].X_WL.linear();
    return std::asin(-R(2, 0));
  };
  site.run(2.0, 0.0, 0.0, 0.0, 0.0);
  const double before = pitch();
  double least = before;
  double greatest = before;
  const auto work = [&](double dig_cycle_seconds, double boom, double stick, double bucket) {
    for (int i = 0; i < std::lround(dig_cycle_seconds * 10.0); ++i) {
      site.run(0.1, 0.0, boom, stick, bucket);
      least = std::min(least, pitch());
      greatest = std::max(greatest, pitch());
    }
  };
  work(0.75, -0.35, 0.0, 0.0);
  work(4.0, 0.1, 0.6, 0.1);
  work(2.0, 0.2, 0.0, 0.9);
  work(2.0, 0.5, 0.0, 0.0);
  EXPECT_FALSE(site.machine.non_finite());
  EXPECT_EQ(site.worst_imbalance, 0);
  EXPECT_GT(greatest - least, 1e-3);
  EXPECT_LT(greatest - least, 0.3);
}

}  // namespace
}  // namespace rigwire::sim
