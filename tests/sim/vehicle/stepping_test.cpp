// Steps of every size, bad commands, guards, allocation: dynamics cases 24, 25, 34, 35.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "allocation_counter.h"
#include "sim/driveline/driveline.h"
#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;

bool same_bits(const Machine& a, const Machine& b) {
  for (std::size_t i = 0; i < a.links().size(); ++i) {
    const LinkMotion& l = a.links()[i];
    const LinkMotion& r = b.links()[i];
    if (std::memcmp(l.X_WL.data(), r.X_WL.data(), 16 * sizeof(double)) != 0 ||
        std::memcmp(l.v_WL_W.data(), r.v_WL_W.data(), 3 * sizeof(double)) != 0 ||
        std::memcmp(l.w_WL_W.data(), r.w_WL_W.data(), 3 * sizeof(double)) != 0 ||
        std::memcmp(l.a_WL_W.data(), r.a_WL_W.data(), 3 * sizeof(double)) != 0 ||
        std::memcmp(l.alpha_WL_W.data(), r.alpha_WL_W.data(), 3 * sizeof(double)) != 0) {
      return false;
    }
  }
  return true;
}

class VehicleStepping : public testing::TestWithParam<VehicleLevel> {
 protected:
  [[nodiscard]] std::unique_ptr<WheeledVehicle> make() const {
    WheeledVehicleParameters parameters;
    parameters.level = GetParam();
    auto machine =
        make_wheeled_vehicle(parameters, ground_, make_driveline(DrivelineParameters()), {});
    VehicleCommand command = released();
    command.gear = 2;
    command.engine_torque_share = 0.7;
    command.front_steer_rad = 0.2;
    machine->command(command);
    return machine;
  }

  Ground ground_ = slope(3.0 * kDegree);
};

TEST_P(VehicleStepping, ManyStepsInOneCallAreTheSameBits) {
  const auto one = make();
  const auto many = make();
  one->step(1500ms);
  for (int i = 0; i < 1500; ++i) {
    many->step(1ms);
  }
  EXPECT_TRUE(same_bits(*one, *many));
  EXPECT_EQ(one->time(), many->time());
}

TEST_P(VehicleStepping, NoTimeChangesNoBit) {
  const auto moved = make();
  const auto still = make();
  moved->step(700ms);
  still->step(700ms);
  still->step(0ns);
  still->step(-5ms);
  EXPECT_TRUE(same_bits(*moved, *still));
  EXPECT_EQ(moved->time(), still->time());
}

TEST_P(VehicleStepping, TinyHugeAndIrregularStepsStayFiniteAndClose) {
  const auto regular = make();
  const auto irregular = make();
  regular->step(2s);
  Duration left = 2s;
  const std::array<Duration, 6> spans{1ns, 333us, 7ms, 1234567ns, 1us, 100ms};
  for (std::size_t i = 0; left > 0ns; ++i) {
    const Duration span = std::min(left, spans[i % spans.size()]);
    irregular->step(span);
    left -= span;
  }
  ASSERT_FALSE(irregular->non_finite());
  EXPECT_EQ(irregular->time(), regular->time());
  EXPECT_LT(
      (irregular->links()[0].X_WL.translation() - regular->links()[0].X_WL.translation()).norm(),
      0.02);
}

TEST_P(VehicleStepping, StepsDoNotAllocate) {
  const auto machine = make();
  machine->step(100ms);
  VehicleCommand command = braked();
  const std::uint64_t before = rigwire::test::allocations();
  machine->step(1s);
  machine->command(command);
  machine->step(1s);
  EXPECT_EQ(machine->vehicle_sample(machine->time()).brake_share, 1.0);
  EXPECT_EQ(rigwire::test::allocations(), before);
}

TEST_P(VehicleStepping, CommandsThatAreNoNumbersKeepTheOldOnes) {
  const auto good = make();
  const auto bad = make();
  VehicleCommand command = released();
  command.gear = 2;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  command.engine_torque_share = nan;
  command.engine_speed_radps = nan;
  command.travel_speed_mps = nan;
  command.brake_share = nan;
  command.front_steer_rad = nan;
  command.rear_steer_rad = nan;
  command.tyre_pressure_pa.fill(nan);
  bad->command(command);
  good->step(1s);
  bad->step(1s);
  EXPECT_FALSE(bad->non_finite());
  EXPECT_TRUE(same_bits(*good, *bad));
}

TEST_P(VehicleStepping, StatusAndTruthHaveTheirPlaces) {
  const auto machine = make();
  machine->step(2s);
  std::vector<double> status(machine->status_quantities().size());
  machine->read_status(status);
  EXPECT_GT(status[0], 1.0);
  std::size_t count = 0;
  for (const TruthField& field : machine->truth_fields()) {
    count += field.count;
  }
  std::vector<double> truth(count);
  machine->read_truth(truth);
  EXPECT_GT(truth[0], 0.1);
  EXPECT_EQ(machine->links().size(), machine->link_names().size());
  EXPECT_NE(machine->vehicle_port(), nullptr);
}

// A sensor on any link sees positions, velocities and accelerations that belong together.
TEST_P(VehicleStepping, LinksMoveAsTheirVelocitiesSay) {
  const auto machine = make();
  machine->step(2500ms);
  std::vector<LinkMotion> before(machine->links().begin(), machine->links().end());
  machine->step(1ms);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const LinkMotion& now = machine->links()[i];
    const Eigen::Vector3d v = (now.X_WL.translation() - before[i].X_WL.translation()) / 1e-3;
    EXPECT_LT((v - now.v_WL_W).norm(), 5e-3) << i;
    const Eigen::Vector3d a = (now.v_WL_W - before[i].v_WL_W) / 1e-3;
    EXPECT_LT((a - now.a_WL_W).norm(), 0.1) << i;
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(now.X_WL.linear() * before[i].X_WL.linear().transpose()));
    EXPECT_LT((turn.angle() * turn.axis() / 1e-3 - now.w_WL_W).norm(), 2e-2) << i;
    EXPECT_LT(((now.w_WL_W - before[i].w_WL_W) / 1e-3 - now.alpha_WL_W).norm(), 0.2) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Levels, VehicleStepping,
                         testing::Values(VehicleLevel::kinematic, VehicleLevel::planar,
                                         VehicleLevel::full),
                         testing::PrintToStringParamName());

TEST(VehicleGuard, NamesTheFirstQuantityThatIsNoNumberAndStandsStill) {
  BareVehicle rig(slope(0.0));
  rig.machine.command(released());
  rig.machine.step(5ms);
  const Eigen::Vector3d at = rig.position();
  rig.equations.torque_nm[2] = std::numeric_limits<double>::infinity();
  rig.machine.step(5ms);
  ASSERT_TRUE(rig.machine.non_finite());
  EXPECT_STRNE(rig.machine.non_finite()->quantity, "");
  EXPECT_EQ(rig.machine.non_finite()->time, SimTime(5ms));
  rig.machine.step(1s);
  EXPECT_EQ(rig.machine.time(), SimTime(5ms));
  EXPECT_TRUE(rig.position().allFinite());
  EXPECT_LT((rig.position() - at).norm(), 1e-6);
}

TEST(VehicleSteering, DoesNotDependOnTheStep) {
  const SteeringParameters parameters{0.5, 0.6, 0.08};
  SteeringActuator coarse(parameters);
  SteeringActuator fine(parameters);
  coarse.command(0.4);
  fine.command(0.4);
  coarse.step(0.9);
  for (int i = 0; i < 9000; ++i) {
    fine.step(1e-4);
  }
  EXPECT_NEAR(coarse.angle_rad(), fine.angle_rad(), 1e-12);
  coarse.command(7.0);
  coarse.step(100.0);
  EXPECT_DOUBLE_EQ(coarse.angle_rad(), 0.5);
}

TEST(VehicleSteering, WheelsTurnAboutOneCentre) {
  const double angle = 32.0 * kDegree;
  const std::array<double, 2> wheels = ackermann_rad(angle, 1.94, std::tan(angle) / 3.85);
  EXPECT_NEAR(1.0 / std::tan(wheels[1]) - 1.0 / std::tan(wheels[0]), 1.94 / 3.85, 1e-12);
  EXPECT_GT(wheels[0], angle);
  EXPECT_LT(wheels[1], angle);
}

TEST(VehicleParameters, RefusesWhatCannotBe) {
  const auto refused = [](auto change) {
    WheeledVehicleParameters parameters;
    change(parameters);
    try {
      validate(parameters);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused([](auto&) {}), "");
  EXPECT_NE(refused([](auto& p) {
              p.body.principal_inertia_kgm2.x() = 9e4;
            }).find("body.principal_inertia.0: found 90000 kg m2"),
            std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.body.mass_kg = -1.0; }).find("body.mass: found -1 kg"),
            std::string::npos);
  EXPECT_NE(
      refused([](auto& p) { p.front.position_x_m = -1.0; }).find("front.position: found -1 m"),
      std::string::npos);
  EXPECT_NE(refused([](auto& p) {
              p.rear.initial_pressure_pa = -1e5;
            }).find("rear.initial_pressure: found -1 bar"),
            std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.step_s = 0.0; }).find("step: found 0 ms"), std::string::npos);
  EXPECT_NE(refused([](auto& p) {
              p.front.tyre.unloaded_radius_m = std::nan("");
            }).find("front.tyre.unloaded_radius: found nan"),
            std::string::npos);
}

}  // namespace
}  // namespace rigwire::sim::test
