#include "sim/roller/tandem_roller.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "allocation_counter.h"
#include "roller_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool same_bits(const LinkMotion& a, const LinkMotion& b) {
  return a.X_WL.matrix() == b.X_WL.matrix() && a.v_WL_W == b.v_WL_W && a.w_WL_W == b.w_WL_W &&
         a.a_WL_W == b.a_WL_W && a.alpha_WL_W == b.alpha_WL_W;
}

std::vector<LinkMotion> links(const TandemRoller& machine) {
  return {machine.links().begin(), machine.links().end()};
}

void expect_same(const TandemRoller& machine, const std::vector<LinkMotion>& before) {
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_TRUE(same_bits(machine.links()[i], before[i])) << kRollerLinks[i];
  }
}

VehicleCommand busy() {
  VehicleCommand command = travel(1.5, 0.3, -0.25);
  command.vibration = {true, true};
  command.edge_cutter_share = 1.0;
  command.spreader_rate_kgpm2 = 1.0;
  return command;
}

// Standstill: the pivot turns a drum on the spot.
TEST(TandemRoller, TurningAPivotAtStandstillScrubsOverTheWholeWidth) {
  for (const int strips : {6, 7, 8, 9}) {
    RollerParameters p = bare();
    p.drum.strips = strips;
    const double friction = 0.6;
    const Ground ground = level(friction);
    TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
    VehicleCommand command;
    command.front_steer_rad = 0.5;
    command.rear_steer_rad = -0.5;  // The reactions on the frame cancel.
    machine.command(command);
    machine.step(1s);
    const double load = 0.5 * p.mass_kg * kGravity;
    const double wanted = friction * load * p.drum.width_m / 4.0;
    EXPECT_NEAR(machine.pivot_moment_nm(0), -wanted, 0.03 * wanted) << strips;
    EXPECT_NEAR(machine.pivot_moment_nm(1), wanted, 0.03 * wanted) << strips;
    if (strips % 2 == 0) {
      EXPECT_NEAR(machine.pivot_moment_nm(0), -wanted, 1e-9 * wanted) << strips;
    }
  }
}

TEST(TandemRoller, DrumInOnePieceDragsItsEdgesInACurve) {
  RollerParameters p = bare();
  p.drum.strips = 8;
  const Ground ground = level(0.6);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(1.0, 0.3, -0.3));
  machine.step(12s);
  // The moment of the strips stands against the turn, and more than half of them slide.
  EXPECT_LT(machine.pivot_moment_nm(0), 0.0);
  EXPECT_LT(machine.pivot_moment_nm(1), 0.0);
  EXPECT_GE(machine.dynamics().drum(0).sliding_strips(), 4);
  EXPECT_EQ(machine.dynamics().unsettled_steps(), 0u);
}

// Steady turn on the level: what the motors give is what strips, motors' friction and the
// rolling resistance take.
TEST(TandemRoller, SlipLossAndResistanceTakeWhatTheMotorsGive) {
  RollerParameters p = bare();
  p.drum.rolling_resistance = 0.02;
  const Ground ground = level(0.6);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(1.0, 0.3, -0.3));
  machine.step(40s);
  double given = 0.0;
  double taken = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double rate = machine.drum_rate_radps(i);
    given += p.drive.motor_displacement_m3prad * machine.drive().pressure_pa() * rate;
    taken += machine.dynamics().drum(i).loss_w() + p.drive.motor_friction_nmsprad * rate * rate -
             machine.dynamics().rolling_torque_nm(i) * rate;
  }
  EXPECT_GT(given, 1000.0);
  EXPECT_NEAR(taken, given, 1e-3 * given);
}

TEST(TandemRoller, HopperLosesWhatLiesOnTheRoadAndPushesNobody) {
  const Ground ground = level();
  RollerParameters p;
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  VehicleCommand command = travel(1.0);
  machine.command(command);
  machine.step(10s);
  const double begin_m = position(machine).x();
  const double begin_kg = machine.spreader().mass_kg();
  command.spreader_rate_kgpm2 = 1.0;
  machine.command(command);
  machine.step(100s);
  const double area = (position(machine).x() - begin_m) * p.spreader.width_m;
  EXPECT_NEAR(begin_kg - machine.spreader().mass_kg(), area, 1e-3 * area);
  EXPECT_DOUBLE_EQ(machine.spreader().mass_kg() + machine.spreader().spread_kg(),
                   p.spreader.initial_kg);
  EXPECT_NEAR(machine.mass().mass_kg,
              p.mass_kg + machine.spreader().mass_kg() + p.sprinkler.initial_kg - 5.5, 0.1);
  EXPECT_LT(std::abs(frame(machine).a_WL_W.x()), 1e-3);
  machine.step(800s);
  EXPECT_EQ(machine.spreader().mass_kg(), 0.0);
  EXPECT_EQ(machine.vehicle_sample(machine.time()).spreader_rate_kgpm2, 0.0);
}

TEST(TandemRoller, EdgeCutterPushesTheFrameAsideWhilePressedAndMoving) {
  const Ground ground = level();
  const RollerParameters p = bare();
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  VehicleCommand command = travel(0.5);
  machine.command(command);
  machine.step(10s);
  command.edge_cutter_share = 1.0;
  machine.command(command);
  machine.step(1250ms);
  EXPECT_NEAR(machine.edge_cutter().height_m(), 0.3, 1e-3);
  machine.step(10s);
  double across = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    across += machine.dynamics().drum(i).across_n();
  }
  EXPECT_NEAR(across, -p.edge_cutter.lateral_n, 0.01 * p.edge_cutter.lateral_n);
  EXPECT_GT(own_velocity(machine).y() / own_velocity(machine).x(), 1e-3);
}

// Hard case 25.
TEST(TandemRoller, AStepOfNothingChangesNothing) {
  const Ground ground = level();
  TandemRoller machine(bare(), ground, {0.0, 0.0}, 0.0);
  machine.command(busy());
  machine.step(3s);
  const std::vector<LinkMotion> before = links(machine);
  machine.step(0s);
  machine.step(-1s);
  expect_same(machine, before);
  machine.step(1ns);
  EXPECT_FALSE(machine.non_finite());
  EXPECT_TRUE(frame(machine).a_WL_W.allFinite());
}

TEST(TandemRoller, ManyStepsInOneCallAreTheSameBitsAsManyCalls) {
  const Ground ground = rising(0.05, 0.7);
  for (const RollerLevel which : {RollerLevel::kinematic, RollerLevel::dynamic}) {
    RollerParameters p;
    p.level = which;
    TandemRoller one(p, ground, {0.0, 0.0}, 0.7);
    TandemRoller many(p, ground, {0.0, 0.0}, 0.7);
    one.command(busy());
    many.command(busy());
    one.step(4s);
    for (int i = 0; i < 4000; ++i) {
      many.step(1ms);
    }
    expect_same(one, links(many));
  }
}

TEST(TandemRoller, LivesThroughHugeAndIrregularSteps) {
  const Ground ground = rising(0.1, 0.7);
  TandemRoller machine(RollerParameters{}, ground, {0.0, 0.0}, 0.7);
  machine.command(busy());
  for (const Duration span : {Duration(1ns), Duration(100ms), Duration(1234567ns), Duration(17us),
                              Duration(2s), Duration(999999ns)}) {
    machine.step(span);
    EXPECT_FALSE(machine.non_finite());
    EXPECT_TRUE(frame(machine).a_WL_W.allFinite());
    EXPECT_LT(frame(machine).a_WL_W.norm(), 20.0);
  }
}

TEST(TandemRoller, NumbersThatAreNoneKeepTheOldCommand) {
  const Ground ground = level();
  TandemRoller good(bare(), ground, {0.0, 0.0}, 0.0);
  TandemRoller told(bare(), ground, {0.0, 0.0}, 0.0);
  good.command(busy());
  told.command(busy());
  VehicleCommand bad = busy();
  bad.travel_speed_mps = kNaN;
  bad.front_steer_rad = kNaN;
  bad.rear_steer_rad = std::numeric_limits<double>::infinity();
  bad.brake_share = kNaN;
  bad.engine_speed_radps = kNaN;
  bad.engine_torque_share = kNaN;
  bad.edge_cutter_share = kNaN;
  bad.spreader_rate_kgpm2 = kNaN;
  told.command(bad);
  good.step(3s);
  told.step(3s);
  expect_same(told, links(good));
}

TEST(TandemRoller, CommandsOutOfRangeAreClamped) {
  const Ground ground = level();
  const RollerParameters p = bare();
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(100.0, 3.0, -3.0));
  machine.step(20s);
  EXPECT_NEAR(machine.steer_rad(0), p.steering.angle_max_rad, 1e-12);
  EXPECT_NEAR(machine.steer_rad(1), -p.steering.angle_max_rad, 1e-12);
  EXPECT_NEAR(machine.drive().set_point_mps(), p.drive.speed_max_mps, 1e-12);
}

TEST(TandemRoller, StandsStillInItsLastFiniteStateWhenNumbersOverflow) {
  const Ground ground = level();
  TandemRoller machine(bare(), ground, {0.0, 0.0}, 0.0);
  machine.command(travel(1.0));
  machine.step(1s);
  machine.set_motion(1e305, 0.0, 0.0);  // Its momentum is more than a double holds.
  const std::vector<LinkMotion> before = links(machine);
  machine.step(1s);
  ASSERT_TRUE(machine.non_finite());
  EXPECT_STRNE(machine.non_finite()->quantity, "");
  EXPECT_EQ(machine.time(), kStart + 1s);
  EXPECT_EQ(machine.non_finite()->time, machine.time());
  expect_same(machine, before);
  machine.step(1s);
  expect_same(machine, before);
}

TEST(TandemRoller, SteppingCommandingAndReadingDoNotAllocate) {
  const Ground ground = rising(0.05, 0.7);
  TandemRoller machine(RollerParameters{}, ground, {0.0, 0.0}, 0.0);
  std::vector<double> status(machine.status_quantities().size());
  std::size_t numbers = 0;
  for (const TruthField& field : machine.truth_fields()) {
    numbers += field.count;
  }
  std::vector<double> truth(numbers);
  VehicleCommand command = busy();
  double sum = 0.0;
  const auto before = rigwire::test::allocations();
  for (int i = 0; i < 500; ++i) {
    command.travel_speed_mps = i % 100 > 50 ? 2.0 : -2.0;
    command.lock[1] = i % 200 > 100;
    machine.command(command);
    machine.step(5ms);
    machine.read_status(status);
    machine.read_truth(truth);
    sum += machine.vehicle_sample(machine.time()).hydraulic_pressure_pa + status[0] + truth[0];
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

TEST(TandemRoller, RefusesAPlaceThatIsNoNumber) {
  const Ground ground = level();
  EXPECT_THROW(TandemRoller(bare(), ground, {kNaN, 0.0}, 0.0), std::invalid_argument);
}

// Finding: the rut was a moment on the drums only, so that they never slipped in it.
TEST(TandemRoller, SoftSoilTakesTheRutsCompactionFromTheDrumsWay) {
  SoilParameters soil = surface(0.8);
  soil.soft = true;
  soil.cohesion_pa = 5e3;
  const Ground ground = Ground::plane(Eigen::Vector3d::UnitZ(), soil);
  const RollerParameters p = bare();
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(0.5));
  machine.step(10s);
  const double load = 0.5 * p.mass_kg * kGravity;
  const double sinkage = wheel_sinkage_m(soil, load, p.drum.width_m, 2.0 * p.drum.radius_m);
  const double wanted = compaction_resistance_n(soil, sinkage, p.drum.width_m);
  EXPECT_GT(wanted, 100.0);
  EXPECT_NEAR(machine.dynamics().ploughing_n(0), -wanted, 0.03 * wanted);
  // The rear drum rolls in what the front one pressed.
  EXPECT_NEAR(machine.dynamics().ploughing_n(1), 0.0, 0.03 * wanted);
  EXPECT_NEAR(machine.dynamics().rolling_torque_nm(0), 0.0, 1e-9);
  EXPECT_NEAR(own_velocity(machine).x(), 0.5, 0.05);
  // Back over its own lane nothing is left to press.
  machine.command(travel(-0.5));
  machine.step(4s);
  EXPECT_NEAR(machine.dynamics().ploughing_n(1), 0.0, 0.03 * wanted);
}

// Over a ramp the frame turns with the ground, and its velocity is the change of its position.
TEST(TandemRoller, VelocityIsTheChangeOfPositionAlsoOverAKink) {
  HeightField field;
  field.cell_m = 0.5;
  field.columns = 80;
  field.rows = 40;
  field.origin_m = {-10.0, -10.0};
  field.heights_m.resize(3200);
  for (std::size_t row = 0; row < 40; ++row) {
    for (std::size_t column = 0; column < 80; ++column) {
      const double x = -10.0 + 0.5 * static_cast<double>(column);
      field.heights_m[row * 80 + column] = x > 5.0 ? 0.15 * (x - 5.0) : 0.0;
    }
  }
  const Ground ground(field, SoilMap{}, {});
  TandemRoller machine(bare(), ground, {0.0, 0.0}, 0.0);
  machine.command(travel(1.5));
  Eigen::Vector3d before = position(machine);
  double worst = 0.0;
  double greatest = 0.0;
  for (int i = 0; i < 10000; ++i) {
    machine.step(1ms);
    const Eigen::Vector3d now = position(machine);
    worst = std::max(worst, ((now - before) / 1e-3 - frame(machine).v_WL_W).norm());
    greatest = std::max(greatest, frame(machine).a_WL_W.norm());
    before = now;
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT(greatest, 15.0);
  const Eigen::Matrix3d R = frame(machine).X_WL.linear();
  EXPECT_NEAR(R(2, 0) / R(0, 0), 0.15, 2e-3);
  EXPECT_NEAR(position(machine).z(), 0.15 * (position(machine).x() - 5.0), 2e-3);
}

}  // namespace
}  // namespace rigwire::sim
