#include "sim/excavator/bucket_soil.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "allocation_counter.h"
#include "sim/excavator/digging_excavator.h"

namespace rigwire::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kGravity = 9.80665;

SoilParameters sand() {
  SoilParameters soil;
  soil.name = "sand";
  soil.soft = true;
  soil.density_kgpm3 = 1700.0;
  soil.cohesion_pa = 2000.0;
  soil.repose_rad = 35.0 * std::numbers::pi / 180.0;
  return soil;
}

HeightField level(double cell_m) {
  HeightField field;
  field.cell_m = cell_m;
  field.columns = static_cast<std::size_t>(std::lround(40.0 / cell_m)) + 1;
  field.rows = field.columns;
  field.origin_m = {-20.0, -20.0};
  field.heights_m.assign(field.columns * field.rows, 0.0);
  return field;
}

Ground sandy(double cell_m = 0.4) {
  return Ground(level(cell_m), SoilMap{{sand()}, {}}, {});
}

/// Stands at the origin, looks east, teeth 0.2 m over the ground.
ExcavatorParameters ready_to_dig() {
  ExcavatorParameters parameters;
  parameters.initial.boom_rad = 0.25;
  parameters.initial.stick_rad = -1.1;
  parameters.initial.bucket_rad = -0.35;
  return parameters;
}

struct Site {
  explicit Site(const Ground& made = sandy(), const DiggingParameters& digging = {})
      : ground(made), machine(ready_to_dig(), digging, Isometry3d::Identity(), ground) {}

  void run(double seconds, double swing, double boom, double stick, double bucket) {
    ValveCommand command;
    command.opening = {swing, boom, stick, bucket};
    machine.valve_port()->command(command);
    const int steps = static_cast<int>(std::lround(seconds * 100.0));
    for (int i = 0; i < steps; ++i) {
      machine.step(milliseconds(10));
      worst_imbalance = std::max(worst_imbalance, std::abs(machine.balance_units()));
    }
  }
  /// Down into the soil, through it, out with a full bucket.
  void dig() {
    run(0.75, 0.0, -0.35, 0.0, 0.0);
    run(4.0, 0.0, 0.1, 0.6, 0.1);
    run(2.0, 0.0, 0.2, 0.0, 0.9);
    run(2.0, 0.0, 0.5, 0.0, 0.0);
  }
  void settle() {
    while (!machine.terrain().settled()) {
      machine.terrain().settle();
    }
  }

  Ground ground;
  DiggingExcavator machine;
  std::int64_t worst_imbalance = 0;
};

/// A bucket at a point, x to the teeth at that pitch in the plane y = 0.
LinkMotion bucket_at(double x, double z, double pitch, const Vector3d& v_W = Vector3d::Zero()) {
  LinkMotion motion;
  motion.X_WL.linear() = Eigen::AngleAxisd(-pitch, Vector3d::UnitY()).toRotationMatrix();
  motion.X_WL.translation() << x, 0.0, z;
  motion.v_WL_W = v_W;
  return motion;
}

TEST(BucketCapacity, LevelBucketHoldsStruckPlusRoofAndTheInvertedNothing) {
  const BucketSoilParameters parameters;
  const BucketCapacity capacity(parameters, 1.40);
  EXPECT_NEAR(capacity.heaped_m3(),
              0.55 + 0.25 * 1.15 * 1.15 * std::tan(parameters.heap_repose_rad) * 1.10, 1e-12);
  const double pi = std::numbers::pi;
  EXPECT_NEAR(capacity.held_m3(pi), capacity.heaped_m3(), 0.01 * capacity.heaped_m3());
  EXPECT_EQ(capacity.held_m3(0.0), 0.0);
  EXPECT_EQ(capacity.held_m3(0.2), 0.0);
  EXPECT_EQ(capacity.held_m3(std::nan("")), 0.0);
  EXPECT_NEAR(capacity.held_m3(pi), capacity.held_m3(-pi), 1e-9);
  EXPECT_NEAR(capacity.held_m3(pi + 0.3), capacity.held_m3(0.3 - pi), 1e-9);
  double before = capacity.held_m3(pi);
  for (double tilt = 0.0; tilt < 1.5; tilt += 0.02) {  // Tipping over the teeth.
    const double held = capacity.held_m3(pi + tilt);
    EXPECT_LE(held, before + 0.015) << tilt;
    before = held;
  }
}

TEST(BucketSoil, ForceActsAgainstTheWayForwardAndVanishesOnTheWayBackAndAtRest) {
  Ground ground = sandy();
  DiggableTerrain terrain(ground, {});
  // Teeth down, opening towards -x, lip 0.5 m deep.
  const double pitch = -0.5 * std::numbers::pi;
  BucketSoil bucket({}, 1.40, kGravity, terrain, bucket_at(5.0, 0.9, pitch));
  const BucketGroundLoad load = bucket.load(1e-3, bucket_at(5.0, 0.9, pitch));
  EXPECT_NEAR(bucket.depth_m(), 0.5, 1e-9);
  ASSERT_GT(bucket.resistance_limit_n(), 3000.0);
  const auto force = [&](const Vector3d& v_W) {
    Vector3d sum = load.force_W;
    for (std::size_t i = 0; i < load.count; ++i) {
      const TipResistance& each = load.resistances[i];
      sum += std::clamp(each.offset_n - each.gain_nspm * v_W.dot(each.direction_W), -each.limit_n,
                        each.limit_n) *
             each.direction_W;
    }
    return sum;
  };
  const double tiny = 1e-6 * bucket.resistance_limit_n();
  EXPECT_LT(force(Vector3d::Zero()).norm(), tiny);
  EXPECT_LT(force({0.3, 0.0, 0.0}).norm(), tiny);
  EXPECT_LT(force({0.3, 0.0, 0.4}).norm(), tiny);
  EXPECT_NEAR(force({-0.3, 0.0, 0.0}).x(), bucket.resistance_limit_n(), tiny);
  EXPECT_GT(force({0.0, 0.0, -0.3}).z(), 1000.0);
  EXPECT_LT(force({0.0, 0.2, 0.0}).y(), -1000.0);
  EXPECT_GT(force({0.0, -0.2, 0.0}).y(), 1000.0);
  for (int i = 0; i < 200; ++i) {  // Passive whatever the motion.
    const Vector3d v(0.5 * std::sin(1.0 * i), 0.3 * std::sin(2.3 * i), 0.4 * std::sin(3.7 * i));
    EXPECT_LE(force(v).dot(v), 1e-9 * bucket.resistance_limit_n());
  }
}

TEST(BucketSoil, OutOfTheGroundThereIsNoForce) {
  Ground ground = sandy();
  DiggableTerrain terrain(ground, {});
  BucketSoil bucket({}, 1.40, kGravity, terrain, bucket_at(5.0, 2.0, -1.5));
  const BucketGroundLoad load = bucket.load(1e-3, bucket_at(5.0, 2.0, -1.5));
  EXPECT_EQ(load.count, 0u);
  EXPECT_TRUE(load.force_W.isZero(0.0));
}

TEST(BucketSoil, NotANumberChangesNothing) {
  Ground ground = sandy();
  DiggableTerrain terrain(ground, {});
  BucketSoil bucket({}, 1.40, kGravity, terrain, bucket_at(5.0, 0.9, -1.5));
  LinkMotion broken = bucket_at(std::nan(""), 0.9, -1.5);
  bucket.advance(1e-3, broken);
  EXPECT_EQ(bucket.load(1e-3, broken).count, 0u);
  broken = bucket_at(4.0, 0.9, -1.5);
  bucket.advance(std::nan(""), broken);
  EXPECT_EQ(bucket.units(), 0);
  EXPECT_EQ(terrain.gained_units(), 0);
}

TEST(BucketSoil, EmptyingTakesTheOutflowTimeAndLeavesNoRest) {
  Ground ground = sandy(0.2);
  DiggableTerrain terrain(ground, {});
  const LinkMotion upside_down = bucket_at(5.0, 4.0, 0.3);
  BucketSoil bucket({}, 1.40, kGravity, terrain, upside_down);
  bucket.fill(0.6, 1000.0);
  const std::int64_t full = bucket.units();
  for (int i = 0; i < 350; ++i) {
    bucket.advance(1e-3, upside_down);
  }
  EXPECT_NEAR(static_cast<double>(bucket.units()) / static_cast<double>(full), std::exp(-1.0),
              0.04);
  EXPECT_NEAR(bucket.mass_kg(),
              1000.0 * static_cast<double>(bucket.units()) / static_cast<double>(full), 1e-6);
  for (int i = 0; i < 3000; ++i) {
    bucket.advance(1e-3, upside_down);
  }
  EXPECT_EQ(bucket.units(), 0);
  EXPECT_EQ(bucket.mass_kg(), 0.0);
  EXPECT_EQ(terrain.gained_units(), full);
}

TEST(BucketSoil, SoilThatFallsIntoATruckIsCountedElsewhere) {
  struct Truck final : FallObstacle {
    [[nodiscard]] bool catches(const Vector3d& from_W, double terrain_m) const override {
      return from_W.z() > 2.0 && terrain_m < 2.0;
    }
  } truck;
  Ground ground = sandy();
  DiggableTerrain terrain(ground, {});
  BucketSoil bucket({}, 1.40, kGravity, terrain, bucket_at(5.0, 4.0, 0.3));
  bucket.set_fall_obstacle(&truck);
  bucket.fill(0.6, 1000.0);
  const std::int64_t full = bucket.units();
  for (int i = 0; i < 4000; ++i) {
    bucket.advance(1e-3, bucket_at(5.0, 4.0, 0.3));
  }
  EXPECT_EQ(bucket.units(), 0);
  EXPECT_EQ(bucket.elsewhere_units(), 0);  // What fill() owed is paid.
  EXPECT_EQ(terrain.gained_units(), 0);
  EXPECT_GT(full, 0);
}

TEST(BucketSoil, BadParametersAreRefusedByName) {
  BucketSoilParameters parameters;
  parameters.width_m = 0.0;
  EXPECT_THAT([&] { validate(parameters, 1.4); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("width_m is 0")));
  parameters = {};
  parameters.rear_lip_m = 1.39;
  EXPECT_THAT([&] { validate(parameters, 1.4); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("rear_lip_m")));
  parameters = {};
  parameters.outflow_time_s = std::nan("");
  EXPECT_THAT([&] { validate(parameters, 1.4); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("outflow_time_s")));
}

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
  JointVector x;
  JointVector lever;
  arm.arm().coordinates(arm.joint_angles_rad(), x, lever);
  const JointVector loaded =
      arm.arm().dynamics().gravity_load(arm.joint_angles_rad()).cwiseQuotient(lever);
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
  const auto before = test::allocations();
  for (int cycle = 0; cycle < 5; ++cycle) {
    site.run(0.9, 0.0, -0.5, 0.0, 0.0);
    site.run(2.0, 0.0, 0.1, 0.8, 0.4);
    site.run(1.5, 0.2, 0.8, 0.0, 0.8);
    site.run(1.5, 0.0, 0.0, -0.9, -1.0);
    site.run(1.0, -0.3, 0.0, 0.0, 0.0);
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_EQ(site.worst_imbalance, 0);
  EXPECT_FALSE(site.machine.non_finite().has_value());
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
  Site site(Ground(level(0.4), SoilMap{{rock}, {}}, {}));
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

}  // namespace
}  // namespace rigwire::sim
