// The excavator behind the interface that every machine has.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <numbers>
#include <span>

#include "sim/excavator/excavator.h"
#include "sim/machine.h"

namespace rigwire::sim {
namespace {

TEST(ExcavatorMachine, LinksFollowTheirNamesInTheOrderOfTheArm) {
  Excavator excavator({}, Eigen::Isometry3d::Identity());
  const Machine& machine = excavator;
  ASSERT_EQ(machine.links().size(), 5u);
  ASSERT_EQ(machine.link_names().size(), 5u);
  EXPECT_EQ(machine.link_names()[0], "undercarriage");
  EXPECT_EQ(machine.link_names()[4], "bucket");
  for (std::size_t i = 0; i < kLinks; ++i) {
    EXPECT_EQ(&machine.links()[i], &excavator.link(static_cast<Link>(i)));
  }
}

TEST(ExcavatorMachine, StatusAndTruthAreTheStateInTheirUnits) {
  Excavator excavator({}, Eigen::Isometry3d::Identity());
  Machine& machine = excavator;
  ValveCommand command;
  command.opening = {0.3, 0.4, 0.5, 0.6};
  ASSERT_NE(machine.valve_port(), nullptr);
  EXPECT_EQ(machine.vehicle_port(), nullptr);
  machine.valve_port()->command(command);
  machine.step(std::chrono::milliseconds(500));

  std::array<double, 6> status{};
  ASSERT_EQ(machine.status_quantities().size(), status.size());
  machine.read_status(status);
  const double degree = std::numbers::pi / 180.0;
  EXPECT_NEAR(status[1] * degree, excavator.joint_angles_rad()[1], 1e-12);
  EXPECT_EQ(machine.status_quantities()[4].name, "tip height");
  EXPECT_EQ(status[4], excavator.tip_W().z());
  EXPECT_NEAR(status[5] * 1e5, excavator.supply_pressure_pa(), 1e-6);

  std::array<double, 19> truth{};
  std::size_t count = 0;
  for (const TruthField& field : machine.truth_fields()) {
    count += field.count;
  }
  ASSERT_EQ(count, truth.size());
  machine.read_truth(truth);
  EXPECT_EQ(truth[3], excavator.joint_angles_rad()[3]);
  EXPECT_EQ(truth[4], excavator.joint_rates_radps()[0]);
  EXPECT_EQ(truth[10], excavator.valve_sample(machine.time()).spool_position[2]);
  EXPECT_EQ(truth[14], excavator.tip_W().z());
  EXPECT_EQ(truth[15], excavator.power_unit().speed_radps());
  EXPECT_EQ(truth[16], excavator.power_unit().torque_nm());
  EXPECT_EQ(truth[17], excavator.power_unit().pump_flow_m3ps());
  EXPECT_EQ(truth[18], 0.0) << "it meets itself nowhere";
}

TEST(ExcavatorMachine, PumpsWithoutAnEngineMoveTheArmAlikeAndHaveNothingToCommand) {
  ExcavatorParameters parameters;
  Excavator with_engine(parameters, Eigen::Isometry3d::Identity());
  parameters.pumps = ExcavatorPumps::constant;
  Excavator without(parameters, Eigen::Isometry3d::Identity());
  ASSERT_NE(with_engine.power_unit_port(), nullptr);
  EXPECT_EQ(without.power_unit_port(), nullptr);

  // Half of what the pumps give: neither the engine nor the supply binds.
  ValveCommand command;
  command.opening = {0.4, 0.3, -0.3, 0.3};
  for (Excavator* excavator : {&with_engine, &without}) {
    excavator->command(command);
    excavator->step(std::chrono::milliseconds(700));
  }
  EXPECT_EQ(with_engine.joint_angles_rad(), without.joint_angles_rad());
  EXPECT_NE(without.joint_rates_radps()[1], 0.0);

  std::size_t count = 0;
  for (const TruthField& field : without.truth_fields()) {
    EXPECT_NE(field.key, "engine_radps");
    count += field.count;
  }
  std::array<double, 17> truth{};
  truth.back() = -1.0;
  ASSERT_EQ(count, truth.size() - 1);
  without.read_truth(std::span(truth).first(count));
  EXPECT_EQ(truth[14], without.tip_W().z());
  EXPECT_EQ(truth.back(), -1.0) << "written past its fields";
}

}  // namespace
}  // namespace rigwire::sim
