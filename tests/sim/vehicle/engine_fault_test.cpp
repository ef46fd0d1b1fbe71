// Engines that fail under vehicles that drive: by what the wheels still get.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <tuple>

#include "bench/machine_files.h"
#include "sim/driveline/driveline.h"
#include "vehicle_rig.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

/// Gator or Unimog on a plane that rises ahead.
class EngineFault : public testing::TestWithParam<std::tuple<bool, VehicleLevel>> {
 protected:
  explicit EngineFault(double slope_rad = 0.0) : ground_(test::slope(slope_rad)) {
    const bool gator = std::get<0>(GetParam());
    WheeledVehicleParameters parameters =
        gator ? bench::gator_855d().vehicle : WheeledVehicleParameters();
    parameters.level = std::get<1>(GetParam());
    machine_ = make_wheeled_vehicle(
        parameters, ground_,
        make_driveline(gator ? bench::gator_855d().driveline : DrivelineParameters()), {});
    command_.parking_brake = false;
    command_.automatic_gear = true;
  }
  void travel(double speed_mps) {
    command_.travel_speed_mps = speed_mps;
    machine_->command(command_);
  }
  [[nodiscard]] VehicleSample sample() const { return machine_->vehicle_sample(machine_->time()); }
  [[nodiscard]] double speed_mps() const { return sample().ground_speed_mps; }
  [[nodiscard]] double idle_radps() const {
    return machine_->engine_data().full_load.front().speed_radps;
  }

  Ground ground_;
  std::unique_ptr<WheeledVehicle> machine_;
  VehicleCommand command_;
};

TEST_P(EngineFault, WithoutFuelItRollsOutAndDrivesOnWithIt) {
  travel(5.0);
  machine_->step(14s);
  ASSERT_NEAR(speed_mps(), 5.0, 0.15);
  machine_->fail({.fuel = false});
  machine_->step(1s);
  EXPECT_LE(sample().engine.torque_nm, 0.0) << "it drags";
  machine_->step(39s);
  EXPECT_EQ(sample().engine.speed_radps, 0.0);
  EXPECT_LT(speed_mps(), 2.0);
  machine_->fail({});
  machine_->step(25s);
  EXPECT_NEAR(speed_mps(), 5.0, 0.15);
}

TEST_P(EngineFault, DeratedItGivesItsShareAndIdlesAsEver) {
  machine_->step(2s);
  const double idling_radps = sample().engine.speed_radps;
  machine_->fail({.torque_share = 0.0});
  machine_->step(5s);
  EXPECT_NEAR(sample().engine.speed_radps, idling_radps, 0.1 * idling_radps);

  const double reference_nm = machine_->engine_data().reference_torque_nm;
  const auto most_nm = [&](double share) {
    travel(0.0);
    machine_->fail({});
    machine_->step(20s);
    machine_->fail({.torque_share = share});
    travel(8.0);
    machine_->step(2s);  // until the clutch has closed
    double most = 0.0;
    for (int i = 0; i < 300; ++i) {
      machine_->step(10ms);
      const EngineSample engine = sample().engine;
      most = std::max(most, engine.torque_nm + engine.friction_nm);
    }
    return std::pair(most / reference_nm, speed_mps());
  };
  const auto [well_share, well_mps] = most_nm(1.0);
  const auto [left_share, left_mps] = most_nm(0.4);
  RecordProperty("well", std::to_string(well_share) + ", " + std::to_string(well_mps) + " m/s");
  RecordProperty("left", std::to_string(left_share) + ", " + std::to_string(left_mps) + " m/s");
  EXPECT_GT(well_share, 0.5);
  EXPECT_LE(left_share, 0.4 + 0.02);
  EXPECT_GT(left_share, 0.3) << "it gives what it has";
  EXPECT_LT(left_mps, 0.95 * well_mps);  // its ramp is the same
}

INSTANTIATE_TEST_SUITE_P(, EngineFault,
                         testing::Combine(testing::Bool(), testing::Values(VehicleLevel::kinematic,
                                                                           VehicleLevel::full)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param) ? "gator" : "unimog") +
                                  (std::get<1>(test.param) == VehicleLevel::full ? "_full"
                                                                                 : "_kinematic");
                         });

}  // namespace
}  // namespace rigwire::sim
