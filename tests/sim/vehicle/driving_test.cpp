// Under power: dynamics cases 15, 16, 17; circles; all levels and both machines.
#include <gtest/gtest.h>

#include <tuple>

#include "bench/machine_files.h"
#include "sim/driveline/driveline.h"
#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;

struct Driven {
  explicit Driven(const Ground& ground_under, VehicleLevel level = VehicleLevel::full,
                  bool gator = false)
      : ground(ground_under) {
    WheeledVehicleParameters parameters =
        gator ? bench::gator_855d().vehicle : WheeledVehicleParameters();
    parameters.level = level;
    machine = make_wheeled_vehicle(
        parameters, ground,
        make_driveline(gator ? bench::gator_855d().driveline : DrivelineParameters()), {});
  }
  [[nodiscard]] double speed() const {
    const LinkMotion& body = machine->links()[0];
    return body.X_WL.linear().col(0).dot(body.v_WL_W);
  }

  Ground ground;
  std::unique_ptr<WheeledVehicle> machine;
};

/// Ice to the left of the x axis, dry ground to the right.
Ground half_ice() {
  HeightField field;
  field.origin_m = {-500.0, -500.0};
  field.cell_m = 500.0;
  field.columns = 3;
  field.rows = 3;
  field.heights_m.assign(9, 0.0);
  SoilMap soils;
  soils.soils.resize(2);
  soils.soils[1].name = "ice";
  soils.soils[1].friction = 0.05;
  soils.cells = {0, 0, 1, 1};
  return {std::move(field), std::move(soils), {}};
}

VehicleCommand crawling_pull() {
  VehicleCommand command = released();
  command.gear = 1;
  command.engine_torque_share = 0.5;
  return command;
}

TEST(VehicleDrive, OpenDifferentialsPullNoMoreThanTheIceLets) {
  Driven rig(half_ice());
  rig.machine->command(crawling_pull());
  rig.machine->step(600ms);
  const auto& w = rig.machine->wheels();
  for (std::size_t axle = 0; axle < 2; ++axle) {
    EXPECT_TRUE(w[2 * axle].slipping);
    EXPECT_FALSE(w[2 * axle + 1].slipping);
  }
  // The spinning wheel's inertia takes a little more while it still gains speed.
  EXPECT_LT(w[1].longitudinal_n + w[3].longitudinal_n, 0.2 * (w[1].load_n + w[3].load_n));
}

TEST(VehicleDrive, LocksPullWithTheDryWheels) {
  Driven open(half_ice());
  Driven locked(half_ice());
  VehicleCommand command = crawling_pull();
  open.machine->command(command);
  command.lock.fill(true);
  VehicleCommand stand = command;
  stand.gear = 0;
  locked.machine->command(stand);
  locked.machine->step(1s);
  open.machine->step(1s);
  locked.machine->command(command);
  open.machine->step(700ms);
  locked.machine->step(700ms);
  const auto& w = locked.machine->wheels();
  EXPECT_NEAR(w[0].rate_radps, w[1].rate_radps, 1e-9);
  EXPECT_NEAR(w[0].rate_radps, w[2].rate_radps, 1e-9);
  EXPECT_NEAR(w[2].rate_radps, w[3].rate_radps, 1e-9);
  EXPECT_GT(locked.speed(), 1.5 * open.speed());
}

TEST(VehicleDrive, AllLocksInATightTurnUndersteerAndUnlockFreely) {
  const auto yaw_rate = [](bool lock) {
    Driven rig(slope(0.0));
    VehicleCommand command = released();
    command.lock.fill(lock);
    rig.machine->command(command);
    rig.machine->step(500ms);
    command.gear = 1;
    command.engine_control = EngineControl::speed;
    command.engine_speed_radps = 120.0;
    command.front_steer_rad = 0.5;
    rig.machine->command(command);
    rig.machine->step(8s);
    double slide_loss_w = 0.0;
    for (const WheelState& wheel : rig.machine->wheels()) {
      slide_loss_w += std::hypot(wheel.longitudinal_n, wheel.lateral_n) * wheel.slide_mps;
    }
    const double rate = rig.machine->links()[0].w_WL_W.z() / rig.speed();
    return std::array{rate, slide_loss_w};
  };
  const auto open = yaw_rate(false);
  const auto locked = yaw_rate(true);
  EXPECT_NEAR(open[0], std::tan(0.5) / 3.85, 0.05 * std::tan(0.5) / 3.85);
  EXPECT_LT(locked[0], open[0]);
  EXPECT_GT(locked[1], open[1]);
}

TEST(VehicleDrive, ShiftsThroughAllGearsUnderLoad) {
  Driven rig(slope(0.0));
  VehicleCommand command = released();
  command.engine_torque_share = 0.5;
  double last = 0.0;
  double jump = 0.0;
  const auto drive = [&](int gear, Duration span) {
    command.gear = gear;
    rig.machine->command(command);
    for (Duration t{0}; t < span; t += 10ms) {
      rig.machine->step(10ms);
      jump = std::max(jump, std::abs(rig.speed() - last));
      last = rig.speed();
    }
  };
  for (int gear = 1; gear <= 8; ++gear) {
    drive(gear, 4s);
    const VehicleSample sample = rig.machine->vehicle_sample(rig.machine->time());
    EXPECT_EQ(sample.gear, gear);
    if (sample.driveline_engaged) {
      // Overall ratio exact: gearbox times axle (6.5).
      double mean = 0.0;
      for (const double rate : sample.wheel_rate_radps) {
        mean += 0.25 * rate;
      }
      EXPECT_NEAR(sample.input_shaft_radps, sample.gear_ratio * 6.5 * mean,
                  1e-6 * sample.input_shaft_radps);
    }
  }
  for (int gear = 7; gear >= 1; --gear) {
    drive(gear, 2s);
  }
  command.engine_torque_share = 0.0;
  command.brake_share = 0.5;
  drive(0, 5s);
  command.brake_share = 0.0;
  command.engine_torque_share = 0.5;
  for (int gear = 1; gear <= 6; ++gear) {
    drive(-gear, 3s);
    EXPECT_EQ(rig.machine->vehicle_sample(rig.machine->time()).gear, -gear);
  }
  EXPECT_LT(rig.speed(), -2.0);
  EXPECT_LT(jump, 0.25);  // m/s in 10 ms
  EXPECT_FALSE(rig.machine->non_finite());
}

TEST(VehicleDrive, CrawlerGroupMovesAtWalkingPaceOfASnail) {
  Driven rig(slope(0.0));
  VehicleCommand command = released();
  command.crawler_group = true;
  command.gear = 1;
  command.engine_control = EngineControl::speed;
  command.engine_speed_radps = 230.0;
  rig.machine->command(command);
  rig.machine->step(10s);
  const VehicleSample sample = rig.machine->vehicle_sample(rig.machine->time());
  EXPECT_TRUE(sample.crawler_group);
  EXPECT_GT(rig.speed(), 0.005);
  EXPECT_LT(rig.speed(), 0.05);
  EXPECT_FALSE(rig.machine->non_finite());
}

class VehicleLevels : public testing::TestWithParam<std::tuple<VehicleLevel, bool>> {};

TEST_P(VehicleLevels, DrivesACircleOfTheSteeringsRadius) {
  const auto [level, gator] = GetParam();
  Driven rig(slope(0.0), level, gator);
  VehicleCommand command = released();
  command.gear = 1;
  command.engine_control = EngineControl::speed;
  command.engine_speed_radps = gator ? 200.0 : 120.0;
  command.engine_torque_share = 0.3;
  command.front_steer_rad = 0.25;
  rig.machine->command(command);
  rig.machine->step(8s);
  ASSERT_FALSE(rig.machine->non_finite());
  EXPECT_GT(rig.speed(), 0.3);
  const double expected = std::tan(0.25) / rig.machine->parameters().wheelbase_m();
  const double curvature = rig.machine->links()[0].w_WL_W.z() / rig.speed();
  EXPECT_NEAR(curvature, expected, 0.06 * expected);
  const OdometryReading odometry = rig.machine->vehicle_sample(rig.machine->time()).odometry;
  EXPECT_NEAR(odometry.curvature_1pm, expected, 1e-3 * expected);
  EXPECT_NEAR(odometry.speed_mps, rig.speed(), 0.03 * rig.speed());
}

TEST_P(VehicleLevels, BrakesToStandstillOnASlopeAndStays) {
  const auto [level, gator] = GetParam();
  Driven rig(slope(8.0 * kDegree), level, gator);
  rig.machine->command(released());
  rig.machine->start_rolling(5.0);
  rig.machine->step(200ms);
  rig.machine->command(braked());
  rig.machine->step(12s);
  const Eigen::Vector3d at = rig.machine->links()[0].X_WL.translation();
  rig.machine->step(5s);
  EXPECT_LT((rig.machine->links()[0].X_WL.translation() - at).norm(), 1e-6);
  EXPECT_NEAR(rig.machine->links()[0].X_WL.linear()(2, 0), std::sin(8.0 * kDegree), 0.05);
}

// Finding: with the loaded radius as the rolling one, odometry read 13.9 % too much.
TEST(VehicleDrive, SoftTyresShortenTheWayPerTurnByAThirdOfTheirDeflection) {
  WheeledVehicleParameters parameters;
  parameters.front.initial_pressure_pa = 1.2e5;
  parameters.rear.initial_pressure_pa = 1.2e5;
  BareVehicle rig(slope(0.0), parameters);
  rig.machine.command(released());
  rig.machine.start_rolling(3.0);
  rig.machine.step(1s);
  // Both axles alike but for their loads (unimog-u5023.md, tyre stiffness).
  double expected = 0.0;
  double found = 0.0;
  for (const WheelState& wheel : rig.machine.wheels()) {
    expected += 0.25 * (0.59 - wheel.load_n / (3.4e4 + 1.555 * 1.2e5) / 3.0);
    found += 0.25 * rig.speed() / wheel.rate_radps;
  }
  EXPECT_NEAR(found, expected, 2e-3);
  const OdometryReading odometry = rig.machine.vehicle_sample(rig.machine.time()).odometry;
  EXPECT_NEAR(odometry.speed_mps / rig.speed(), 1.04, 0.005);
}

// Maker's figure: 52 km/h (docs/machines/gator-855d.md).
// Finding: the Gator's circle was 10.0 m, its data sheet has 8.24 m.
TEST(VehicleDrive, GatorTurnsWithinItsTurningCircle) {
  Driven driven(test::slope(0.0), VehicleLevel::full, true);
  VehicleCommand command = released();
  command.automatic_gear = true;
  command.travel_speed_mps = 1.0;
  command.front_steer_rad = 1.5;  // as far as it goes, to the left
  driven.machine->command(command);
  driven.machine->step(8s);
  double least_m = 1e9;
  double most_m = -1e9;
  for (int i = 0; i < 4000; ++i) {
    driven.machine->step(10ms);
    const double y_m = driven.machine->links()[kWheeledLinks.size() - 3].X_WL.translation().y();
    least_m = std::min(least_m, y_m);  // of the outer front wheel's middle
    most_m = std::max(most_m, y_m);
  }
  EXPECT_NEAR(most_m - least_m, 8.24, 0.02 * 8.24);
}

TEST(VehicleDrive, GatorReachesItsTopSpeed) {
  Driven rig(slope(0.0), VehicleLevel::full, true);
  VehicleCommand command = released();
  command.gear = 2;
  command.engine_torque_share = 1.0;
  rig.machine->command(command);
  rig.machine->step(90s);
  EXPECT_NEAR(3.6 * rig.speed(), 52.0, 0.3);
}

INSTANTIATE_TEST_SUITE_P(All, VehicleLevels,
                         testing::Combine(testing::Values(VehicleLevel::kinematic,
                                                          VehicleLevel::planar, VehicleLevel::full),
                                          testing::Bool()),
                         [](const auto& test) {
                           return testing::PrintToString(std::get<0>(test.param)) +
                                  (std::get<1>(test.param) ? "_gator" : "_unimog");
                         });

}  // namespace
}  // namespace rigwire::sim::test
