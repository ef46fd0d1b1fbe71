// What the gateway makes of a sample.
#include "emulators/vehicle_gateway/report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace vehicle = protocols::vehicle;
using vehicle::Switch;

constexpr double kKmph = vehicle::kKilometrePerHour_mps;
constexpr double kDegree = vehicle::kDegree_rad;

VehicleGatewaySettings crab_machine() {
  VehicleGatewaySettings settings;
  settings.steering = SteeringLayout::crab;
  settings.engine.reference_torque_nm = 1000.0;
  return settings;
}

/// Everything different from everything else.
VehicleSample driving() {
  VehicleSample s;
  s.engine.speed_radps = 1800.0 * kRpm;
  s.engine.torque_nm = 340.0;
  s.engine.friction_nm = 60.0;
  s.engine.full_load_nm = 740.0;
  s.gear = 3;
  s.gear_requested = 4;
  s.crawler_group = true;
  s.gear_ratio = 2.5;
  s.shifting = true;
  s.driveline_engaged = true;
  s.input_shaft_radps = 1790.0 * kRpm;
  s.output_shaft_radps = 716.0 * kRpm;
  s.clutch_slip_share = 0.1;
  s.wheel_radius_m.fill(0.5);
  s.wheel_rate_radps = {10.0, 10.4, 10.8, 11.2};  // 5, 5.2, 5.4, 5.6 m/s
  s.front_steer_rad = 10.0 * kDegree;
  s.rear_steer_rad = -5.0 * kDegree;
  s.brake_share = 0.2;
  s.parking_brake = false;
  s.lock = {true, false, true};
  s.tyre_pressure_pa = {300e3, 310e3, 320e3, 330e3};
  s.tyre_pressure_target_pa = {200e3, 0.0, 200e3, 200e3};
  s.hydraulic_pressure_pa = 20e6;
  s.vibration = {true, false};
  s.edge_cutter_share = 0.5;
  s.spreader_rate_kgpm2 = 4.0;
  s.hopper_mass_kg = 1200.0;
  s.odometry = {5.1, 0.02, 3.0 * kDegree};
  return s;
}

struct Driving : testing::Test {
  Driving() : rig(crab_machine()) { rig.run(1s, driving()); }
  template <class Message>
  [[nodiscard]] Message latest() const {
    return rig.output.latest<Message>();
  }
  VehicleRig rig;
};
using VehicleReportTest = Driving;

TEST_F(VehicleReportTest, Engine) {
  const auto first = latest<vehicle::Eec1>();
  EXPECT_NEAR(first.speed_radps, 1800.0 * kRpm, 0.07 * kRpm);
  EXPECT_NEAR(first.actual_torque_share, 0.4, 0.005);
  EXPECT_NEAR(latest<vehicle::Eec2>().load_share, 0.5, 0.005);
}

TEST_F(VehicleReportTest, Gearbox) {
  const auto first = latest<vehicle::Etc1>();
  EXPECT_EQ(first.driveline_engaged, Switch::on);
  EXPECT_EQ(first.shift_in_process, Switch::on);
  EXPECT_EQ(first.converter_lockup, Switch::not_available);
  EXPECT_NEAR(first.input_shaft_radps, 1790.0 * kRpm, 0.07 * kRpm);
  EXPECT_NEAR(first.output_shaft_radps, 716.0 * kRpm, 0.07 * kRpm);
  EXPECT_NEAR(first.clutch_slip_share, 0.1, 0.002);
  const auto second = latest<vehicle::Etc2>();
  EXPECT_EQ(vehicle::gear_of(second.current_gear), 3);
  EXPECT_EQ(vehicle::gear_of(second.selected_gear), 4);
  EXPECT_NEAR(second.ratio, 2.5, 0.0005);
  EXPECT_EQ(second.current_range_first, 'D');
  EXPECT_EQ(second.current_range_second, 'C');
}

TEST_F(VehicleReportTest, NeutralHasNoRatioAndReverseSaysSo) {
  VehicleSample sample = driving();
  sample.gear = 0;
  sample.gear_ratio = 0.0;
  rig.run(200ms, sample);
  EXPECT_TRUE(std::isnan(latest<vehicle::Etc2>().ratio));
  EXPECT_EQ(latest<vehicle::Etc2>().current_range_first, 'N');
  sample.gear = -2;
  sample.gear_ratio = -3.0;
  rig.run(200ms, sample);
  EXPECT_NEAR(latest<vehicle::Etc2>().ratio, 3.0, 0.0005);
  EXPECT_EQ(vehicle::gear_of(latest<vehicle::Etc2>().current_gear), -2);
  EXPECT_EQ(latest<vehicle::Etc2>().current_range_first, 'R');
}

TEST_F(VehicleReportTest, Locks) {
  const auto locks = latest<vehicle::Eac1>();
  EXPECT_EQ(locks.front_lock_1, Switch::on);
  EXPECT_EQ(locks.central_lock, Switch::off);
  EXPECT_EQ(locks.rear_lock_1, Switch::on);
  EXPECT_EQ(locks.rear_lock_2, Switch::not_available);
}

TEST_F(VehicleReportTest, WheelSpeeds) {
  const auto fine = latest<vehicle::Hrw>();
  const double half = 0.5 * kKmph / 256.0;
  EXPECT_NEAR(fine.front_left_mps, 5.0, half);
  EXPECT_NEAR(fine.front_right_mps, 5.2, half);
  EXPECT_NEAR(fine.rear_left_mps, 5.4, half);
  EXPECT_NEAR(fine.rear_right_mps, 5.6, half);
  const auto axle = latest<vehicle::Ebc2>();
  EXPECT_NEAR(axle.front_axle_mps, 5.1, half);
  EXPECT_NEAR(axle.front_left_mps, -0.1, 0.5 * kKmph / 16.0);
  EXPECT_NEAR(axle.front_right_mps, 0.1, 0.5 * kKmph / 16.0);
  EXPECT_NEAR(axle.rear_1_left_mps, 0.3, 0.5 * kKmph / 16.0);
  EXPECT_NEAR(axle.rear_1_right_mps, 0.5, 0.5 * kKmph / 16.0);
  EXPECT_TRUE(std::isnan(axle.rear_2_left_mps));
}

TEST_F(VehicleReportTest, ReverseIsAMagnitudeWithADirection) {
  VehicleSample sample = driving();
  sample.odometry.speed_mps = -1.5;
  for (double& rate : sample.wheel_rate_radps) {
    rate = -rate;
  }
  rig.run(200ms, sample);
  EXPECT_NEAR(latest<vehicle::Hrw>().rear_right_mps, 5.6, 0.5 * kKmph / 256.0);
  EXPECT_NEAR(latest<vehicle::Ebc2>().rear_1_right_mps, 0.5, 0.5 * kKmph / 16.0);
  EXPECT_NEAR(latest<vehicle::Ccvs1>().wheel_based_speed_mps, 1.5, 0.5 * kKmph / 256.0);
  EXPECT_NEAR(latest<vehicle::MachineSelectedSpeed>().speed_mps, 1.5, 0.0005);
  EXPECT_EQ(latest<vehicle::MachineSelectedSpeed>().forward, Switch::off);
  EXPECT_EQ(latest<vehicle::WheelBasedSpeed>().forward, Switch::off);
}

TEST_F(VehicleReportTest, SpeedAndDistance) {
  const auto selected = latest<vehicle::MachineSelectedSpeed>();
  EXPECT_NEAR(selected.speed_mps, 5.1, 0.0005);
  EXPECT_EQ(selected.forward, Switch::on);
  EXPECT_EQ(selected.source, static_cast<std::uint8_t>(vehicle::SpeedSource::wheel_based));
  // Samples from 200 ms on; the latest message is of 910 ms.
  EXPECT_NEAR(selected.distance_m, 5.1 * 0.71, 0.001);
  const auto vehicle_speed = latest<vehicle::Ccvs1>();
  EXPECT_NEAR(vehicle_speed.wheel_based_speed_mps, 5.1, 0.5 * kKmph / 256.0);
  EXPECT_EQ(vehicle_speed.parking_brake, Switch::off);
  EXPECT_EQ(vehicle_speed.brake_switch, Switch::on);
  EXPECT_NEAR(latest<vehicle::Ebc1>().pedal_share, 0.2, 0.002);
}

TEST_F(VehicleReportTest, Steering) {
  EXPECT_NEAR(latest<vehicle::Vdc2>().steering_wheel_rad, 200.0 * kDegree, 0.5 / 1024.0);
  EXPECT_TRUE(std::isnan(latest<vehicle::Vdc2>().yaw_rate_radps));
  const auto axles = rig.output.of(vehicle::Esc1::kGroup.pgn);
  const auto rear = *vehicle::decode<vehicle::Esc1>(axles.back());
  const auto front = *vehicle::decode<vehicle::Esc1>(axles[axles.size() - 2]);
  EXPECT_EQ(front.location, vehicle::kFrontAxle);
  EXPECT_NEAR(front.steer_rad, 10.0 * kDegree, 0.5 * kDegree / 256.0);
  EXPECT_EQ(rear.location, vehicle::kRearAxle);
  EXPECT_NEAR(rear.steer_rad, -5.0 * kDegree, 0.5 * kDegree / 256.0);
  const auto guidance = latest<vehicle::GuidanceMachineInfo>();
  EXPECT_NEAR(guidance.curvature_1pm, 0.02, 0.125e-3);
  EXPECT_EQ(guidance.ready, Switch::on);
  EXPECT_EQ(guidance.reset_required, Switch::off);
}

TEST_F(VehicleReportTest, TyresAndMachine) {
  const auto tyres = rig.output.of(vehicle::Tire2::kGroup.pgn);
  ASSERT_EQ(tyres.size(), kWheels);
  for (std::size_t i = 0; i < kWheels; ++i) {
    const auto tyre = *vehicle::decode<vehicle::Tire2>(tyres[i]);
    EXPECT_EQ(vehicle::tyre_of(tyre.location), i);
    EXPECT_NEAR(tyre.pressure_pa, 300e3 + 10e3 * static_cast<double>(i), 500.0);
    if (i == 1) {
      EXPECT_TRUE(std::isnan(tyre.required_pressure_pa));
    } else {
      EXPECT_NEAR(tyre.required_pressure_pa, 200e3, 500.0);
    }
  }
  EXPECT_NEAR(latest<vehicle::Tire1>().pressure_pa, 330e3, 2000.0);
  EXPECT_NEAR(latest<vehicle::Hpg>().pressure_pa, 20e6, 1000.0);
  const auto state = latest<vehicle::MachineFunctionState>();
  EXPECT_EQ(state.parking_brake, Switch::off);
  EXPECT_EQ(state.crawler_group, Switch::on);
  EXPECT_EQ(state.vibration_front, Switch::on);
  EXPECT_EQ(state.vibration_rear, Switch::off);
  EXPECT_NEAR(state.edge_cutter_share, 0.5, 0.002);
  EXPECT_NEAR(state.spreader_rate_kgpm2, 4.0, 0.0005);
  EXPECT_NEAR(state.hopper_mass_kg, 1200.0, 0.5);
  EXPECT_NEAR(state.slip_angle_rad, 3.0 * kDegree, 0.5 * kDegree / 256.0);
}

TEST_F(VehicleReportTest, WhatTheFormatCannotCarrySaturates) {
  VehicleSample sample = driving();
  sample.wheel_rate_radps = {100.0, 100.0, 200.0, 0.0};  // 50, 50, 100, 0 m/s
  sample.engine.speed_radps = 1e6;
  sample.hopper_mass_kg = 1e9;
  rig.run(200ms, sample);
  EXPECT_NEAR(latest<vehicle::Hrw>().rear_left_mps, 64255.0 / 256.0 * kKmph, 1e-6);
  EXPECT_NEAR(latest<vehicle::Ebc2>().rear_1_left_mps, 7.8125 * kKmph, 1e-6);
  EXPECT_NEAR(latest<vehicle::Ebc2>().rear_1_right_mps, -7.8125 * kKmph, 1e-6);
  EXPECT_NEAR(latest<vehicle::Eec1>().speed_radps, 8031.875 * kRpm, 1e-6);
  EXPECT_NEAR(latest<vehicle::MachineFunctionState>().hopper_mass_kg, 64255.0, 1e-6);
}

}  // namespace
}  // namespace rigwire::emulators
