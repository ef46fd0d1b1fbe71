// Bytes of the vehicle messages, worked by hand from the documents that
// docs/devices/vehicle-gateway.md names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "protocols/vehicle/brake.h"
#include "protocols/vehicle/condition.h"
#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/joystick.h"
#include "protocols/vehicle/machine.h"
#include "protocols/vehicle/position.h"
#include "protocols/vehicle/speed.h"
#include "protocols/vehicle/steering.h"
#include "protocols/vehicle/transmission.h"
#include "protocols/vehicle/tyre.h"

namespace rigwire::protocols::vehicle {
namespace {

using testing::ElementsAre;

constexpr double kKmph = kKilometrePerHour_mps;
constexpr double kGoldenRpm = kRevolutionPerMinute_radps;
constexpr std::uint8_t kGateway = 0x00;
constexpr std::uint8_t kController = 0x27;

TEST(VehicleGolden, WheelSpeedsOfARollingMachine) {
  const Ebc2 speeds{18.0 * kKmph, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  const can::Frame frame = encode(speeds, kGateway);
  EXPECT_EQ(frame.id, 0x18FEBF00U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x00, 0x12, 0x7D, 0x7D, 0x7D, 0x7D, 0x7D, 0x7D));

  const can::Frame high = encode(Hrw{36.0 * kKmph, 0.0, kNotAvailable, kError}, kGateway);
  EXPECT_EQ(high.id, 0x08FE6E00U);
  EXPECT_THAT(high.payload(), ElementsAre(0x00, 0x24, 0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xFE));
}

TEST(VehicleGolden, VehicleSpeedAndSwitches) {
  Ccvs1 state;
  state.parking_brake = Switch::on;
  state.wheel_based_speed_mps = 36.0 * kKmph;
  state.brake_switch = Switch::off;
  const can::Frame frame = encode(state, kGateway);
  EXPECT_EQ(frame.id, 0x18FEF100U);
  EXPECT_THAT(frame.payload(), ElementsAre(0xF7, 0x00, 0x24, 0xCF, 0xFF, 0xFF, 0xFF, 0xFF));

  MachineSelectedSpeed selected;
  selected.speed_mps = 2.0;
  selected.distance_m = 1000.0;
  selected.exit_reason = 0;
  selected.forward = Switch::on;
  selected.source = 0;
  selected.limit_status = 0;
  const can::Frame iso = encode(selected, kGateway);
  EXPECT_EQ(iso.id, 0x0CF02200U);
  EXPECT_THAT(iso.payload(), ElementsAre(0xD0, 0x07, 0x40, 0x42, 0x0F, 0x00, 0xC0, 0x01));

  EXPECT_EQ(encode(WheelBasedSpeed{}, 0xF0).id, 0x0CFE48F0U);
}

TEST(VehicleGolden, Engine) {
  Eec1 state;
  state.actual_torque_share = 0.40;
  state.speed_radps = 1800.0 * kGoldenRpm;
  const can::Frame frame = encode(state, kGateway);
  EXPECT_EQ(frame.id, 0x0CF00400U);
  EXPECT_THAT(frame.payload(), ElementsAre(0xFF, 0xFF, 0xA5, 0x40, 0x38, 0xFF, 0xFF, 0xFF));

  const can::Frame second = encode(Eec2{0.5, 0.6}, kGateway);
  EXPECT_EQ(second.id, 0x0CF00300U);
  EXPECT_THAT(second.payload(), ElementsAre(0xFF, 0x7D, 0x3C, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));

  Tsc1 request;
  request.override_mode = static_cast<std::uint8_t>(OverrideMode::speed);
  request.priority = 0;
  request.speed_radps = 1500.0 * kGoldenRpm;
  const can::Frame asked = encode(request, kController, kGateway);
  EXPECT_EQ(asked.id, 0x0C000027U);
  EXPECT_THAT(asked.payload(), ElementsAre(0xCD, 0xE0, 0x2E, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
}

TEST(VehicleGolden, Gearbox) {
  Etc1 shafts;
  shafts.driveline_engaged = Switch::on;
  shafts.shift_in_process = Switch::off;
  shafts.output_shaft_radps = 1000.0 * kGoldenRpm;  // 8000 counts
  shafts.clutch_slip_share = 0.0;
  shafts.input_shaft_radps = 2000.0 * kGoldenRpm;
  const can::Frame frame = encode(shafts, kGateway);
  EXPECT_EQ(frame.id, 0x0CF00200U);
  EXPECT_THAT(frame.payload(), ElementsAre(0xCD, 0x40, 0x1F, 0x00, 0xFF, 0x80, 0x3E, 0xFF));

  Etc2 gears;
  gears.selected_gear = gear_code(3);
  gears.ratio = 1.5;
  gears.current_gear = gear_code(-1);
  gears.current_range_first = 'D';
  gears.current_range_second = ' ';
  const can::Frame second = encode(gears, kGateway);
  EXPECT_EQ(second.id, 0x18F00500U);
  EXPECT_THAT(second.payload(), ElementsAre(0x80, 0xDC, 0x05, 0x7C, 0xFF, 0xFF, 0x44, 0x20));

  Tc1 request;
  request.requested_gear = gear_code(4);
  request.disengage_rear_lock_1 = Switch::off;
  const can::Frame asked = encode(request, kController, kGateway);
  EXPECT_EQ(asked.id, 0x0C010027U);
  EXPECT_THAT(asked.payload(), ElementsAre(0xFF, 0xFF, 0x81, 0xCF, 0xFF, 0xFF, 0xFF, 0xFF));
}

TEST(VehicleGolden, DifferentialLocks) {
  Eac1 locks;
  locks.front_lock_1 = Switch::on;
  locks.rear_lock_1 = Switch::on;
  locks.central_lock = Switch::on;
  const can::Frame frame = encode(locks, kGateway);
  EXPECT_EQ(frame.id, 0x18F00600U);
  EXPECT_THAT(frame.payload(), ElementsAre(0xFF, 0xDD, 0xFD, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
}

TEST(VehicleGolden, Brakes) {
  Ebc1 state;
  state.pedal_share = 0.4;
  state.anti_lock_active = Switch::off;
  const can::Frame frame = encode(state, kGateway);
  EXPECT_EQ(frame.id, 0x18F00100U);
  EXPECT_THAT(frame.payload(), ElementsAre(0xCF, 0x64, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));

  Xbr request;
  request.acceleration_mps2 = -2.0;  // (15.687 - 2) * 2048 = 28031 counts
  request.endurance_integration = 0;
  request.priority = 0;
  request.control_mode = static_cast<std::uint8_t>(BrakeControlMode::maximum);
  const can::Frame asked = encode(request, kController, kGateway);
  EXPECT_EQ(asked.id, 0x0C040027U);
  EXPECT_THAT(asked.payload(), ElementsAre(0x7F, 0x6D, 0xE0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
}

TEST(VehicleGolden, Steering) {
  Vdc2 wheel;
  wheel.steering_wheel_rad = 0.0;
  const can::Frame frame = encode(wheel, kGateway);
  EXPECT_EQ(frame.id, 0x18F00900U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x7F, 0x7D, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));

  const can::Frame axle = encode(Esc1{10.0 * kDegree_rad, kFrontAxle}, kGateway);
  EXPECT_EQ(axle.id, 0x18F00B00U);
  EXPECT_THAT(axle.payload(), ElementsAre(0x00, 0x87, 0x0F, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
}

TEST(VehicleGolden, GuidanceStraightAheadAndLeft) {
  const can::Frame straight = encode(GuidanceCommand{0.0, Switch::on}, kController, kGateway);
  EXPECT_EQ(straight.id, 0x0CAD0027U);
  EXPECT_THAT(straight.payload(), ElementsAre(0x80, 0x7D, 0xFD, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
  // Left circle of 50 m: 20 per km, negative on the wire: 32128 - 80 = 0x7D30.
  const can::Frame left = encode(GuidanceCommand{0.02, Switch::off}, kController, kGateway);
  EXPECT_THAT(left.payload(), ElementsAre(0x30, 0x7D, 0xFC, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));

  GuidanceMachineInfo info;
  info.curvature_1pm = 0.02;
  info.lockout = Switch::off;
  info.ready = Switch::on;
  info.input_position_correct = Switch::on;
  info.reset_required = Switch::off;
  info.limit_status = static_cast<std::uint8_t>(LimitStatus::not_limited);
  info.exit_reason = static_cast<std::uint8_t>(ExitReason::none);
  const can::Frame frame = encode(info, kGateway);
  EXPECT_EQ(frame.id, 0x0CACFF00U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x30, 0x7D, 0x14, 0x1F, 0xC0, 0xFF, 0xFF, 0xFF));
}

TEST(VehicleGolden, SpeedCommandForwardAndReverse) {
  const can::Frame forward =
      encode(MachineSelectedSpeedCommand{1.5, kNotAvailable, Switch::on}, kController);
  EXPECT_EQ(forward.id, 0x0CFD4327U);
  EXPECT_THAT(forward.payload(), ElementsAre(0xDC, 0x05, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFD));
  const can::Frame reverse =
      encode(MachineSelectedSpeedCommand{1.5, 2.0, Switch::off}, kController);
  EXPECT_THAT(reverse.payload(), ElementsAre(0xDC, 0x05, 0xD0, 0x07, 0xFF, 0xFF, 0xFF, 0xFC));
}

TEST(VehicleGolden, Tyres) {
  Tire1 first;
  first.location = kTyreLocations[0];
  first.pressure_pa = 300e3;
  first.temperature_c = 27.0;  // 9600 counts
  const can::Frame frame = encode(first, kGateway);
  EXPECT_EQ(frame.id, 0x18FEF400U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x00, 0x4B, 0x80, 0x25, 0xFF, 0xFF, 0xFF, 0xFF));

  const can::Frame second = encode(Tire2{kTyreLocations[3], 300e3, 250e3}, kGateway);
  EXPECT_EQ(second.id, 0x18FC4200U);
  EXPECT_THAT(second.payload(), ElementsAre(0x11, 0x2C, 0x01, 0xFA, 0x00, 0xFF, 0xFF, 0xFF));

  EXPECT_EQ(encode(Tpri{kTyreLocations[2], 240e3}, kGateway).id, 0x18FDB900U);
  const can::Frame set = encode(Tprs{kTyreLocations[2], 240e3}, kController, kGateway);
  EXPECT_EQ(set.id, 0x18AE0027U);
  EXPECT_THAT(set.payload(), ElementsAre(0x10, 0x1E, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
}

TEST(VehicleGolden, HydraulicPressure) {
  const can::Frame frame = encode(Hpg{20e6}, kGateway);
  EXPECT_EQ(frame.id, 0x18F00800U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x10, 0x27, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
}

TEST(VehicleGolden, MachineFunctions) {
  MachineFunctionCommand command;
  command.parking_brake = Switch::off;
  command.vibration_rear = Switch::on;
  command.steering_mode = static_cast<std::uint8_t>(SteeringMode::crab);
  command.crab_angle_rad = 5.0 * kDegree_rad;  // 130 * 256 counts
  command.edge_cutter_share = 1.0;
  command.spreader_rate_kgpm2 = 4.0;
  const can::Frame frame = encode(command, kController, kGateway);
  EXPECT_EQ(frame.id, 0x18EF0027U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x7C, 0xF2, 0x00, 0x82, 0xFA, 0xA0, 0x0F, 0xFF));

  MachineFunctionState state;
  state.parking_brake = Switch::on;
  state.crawler_group = Switch::off;
  state.vibration_front = Switch::off;
  state.vibration_rear = Switch::off;
  state.edge_cutter_share = 0.0;
  state.spreader_rate_kgpm2 = 0.0;
  state.hopper_mass_kg = 1200.0;
  state.slip_angle_rad = 0.0;
  const can::Frame answer = encode(state, kGateway);
  EXPECT_EQ(answer.id, 0x18FF8000U);
  EXPECT_THAT(answer.payload(), ElementsAre(0x01, 0x00, 0x00, 0x00, 0xB0, 0x04, 0x00, 0x7D));
}

TEST(VehicleGolden, EveryParameterIsNotAvailableByDefault) {
  const auto all_ones = [](const can::Frame& frame) {
    EXPECT_THAT(frame.payload(), testing::Each(0xFF)) << std::hex << frame.id;
  };
  all_ones(encode(Ebc1{}, kGateway));
  all_ones(encode(Ebc2{}, kGateway));
  all_ones(encode(Hrw{}, kGateway));
  all_ones(encode(Ccvs1{}, kGateway));
  all_ones(encode(Eec1{}, kGateway));
  all_ones(encode(Eec2{}, kGateway));
  all_ones(encode(Etc1{}, kGateway));
  all_ones(encode(Etc2{}, kGateway));
  all_ones(encode(Eac1{}, kGateway));
  all_ones(encode(Vdc2{}, kGateway));
  all_ones(encode(Esc1{}, kGateway));
  all_ones(encode(GuidanceMachineInfo{}, kGateway));
  all_ones(encode(MachineSelectedSpeed{}, kGateway));
  all_ones(encode(MachineFunctionState{}, kGateway));
}

TEST(VehicleGolden, JoystickHoldsTheSignInItsSwitches) {
  Bjm1 stick;
  const AxisSwitches left = axis_switches(-0.5);
  stick.x_neutral = left.neutral;
  stick.x_negative = left.negative;
  stick.x_positive = left.positive;
  stick.x_share = 0.5;
  stick.button_4 = Switch::on;
  stick.button_1 = Switch::off;
  const can::Frame frame = encode(stick, kController);
  EXPECT_EQ(frame.id, 0x0CFDD627U);
  // x: neutral 00, negative 01, positive 00, then 500 = 01 1111 0100 from bit 7 on.
  EXPECT_THAT(frame.payload(), ElementsAre(0x04, 0x7D, 0xFF, 0xFF, 0xFF, 0x3D, 0xFF, 0xFF));
  const auto back = decode<Bjm1>(frame);
  ASSERT_TRUE(back.ok());
  EXPECT_DOUBLE_EQ(axis_share(back->x_neutral, back->x_negative, back->x_positive, back->x_share),
                   -0.5);
  EXPECT_TRUE(
      std::isnan(axis_share(back->y_neutral, back->y_negative, back->y_positive, back->y_share)));
  EXPECT_EQ(axis_share(Switch::on, Switch::off, Switch::off, kNotAvailable), 0.0);
  EXPECT_TRUE(std::isnan(axis_share(Switch::off, Switch::on, Switch::on, 0.2)));
}

TEST(VehicleGolden, ConditionOfTheMachine) {
  Eflp1 oil;
  oil.oil_pressure_pa = 400e3;
  EXPECT_EQ(encode(oil, kGateway).id, 0x18FEEF00U);
  EXPECT_THAT(encode(oil, kGateway).payload(),
              ElementsAre(0xFF, 0xFF, 0xFF, 0x64, 0xFF, 0xFF, 0xFF, 0xFF));
  VehicleFluids fluids;
  fluids.hydraulic_c = 60.0;
  fluids.filter_restricted = Switch::off;
  fluids.hydraulic_level_share = 0.8;
  EXPECT_EQ(encode(fluids, kGateway).id, 0x18FE6800U);
  EXPECT_THAT(encode(fluids, kGateway).payload(),
              ElementsAre(0x64, 0xFC, 0xC8, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
  const can::Frame hours = encode(Hours{3600.0, 90e3}, kGateway);
  EXPECT_EQ(hours.id, 0x18FEE500U);
  EXPECT_THAT(hours.payload(), ElementsAre(0x14, 0x00, 0x00, 0x00, 0x5A, 0x00, 0x00, 0x00));
  EXPECT_EQ(encode(Et1{}, kGateway).id, 0x18FEEE00U);
  EXPECT_EQ(encode(Dd1{}, kGateway).id, 0x18FEFC00U);
}

TEST(VehicleGolden, PositionOfFortySixNorthSevenEast) {
  const can::Frame frame = encode(VehiclePosition{46.0, 7.0}, kGateway);
  EXPECT_EQ(frame.id, 0x18FEF300U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x00, 0x80, 0x96, 0x98, 0x80, 0x92, 0x57, 0x81));
}

TEST(VehicleGolden, SteeringAngleSensor) {
  Sas sensor;
  sensor.steering_wheel_rad = 0.0;
  sensor.counter = 5;
  const can::Frame frame = encode(sensor, kGateway);
  EXPECT_EQ(frame.id, 0x18F01D00U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x7F, 0x7D, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xF5));
}

TEST(VehicleGolden, ChannelsOfTyreInflation) {
  EXPECT_EQ(encode(Tp1{}, kGateway).id, 0x18FE7800U);
  const can::Frame target = encode(Tp2{kNotAvailable, 250e3, 300e3}, kGateway);
  EXPECT_EQ(target.id, 0x18FE7900U);
  EXPECT_THAT(target.payload(), ElementsAre(0xFF, 0xFF, 0xF4, 0x01, 0x58, 0x02, 0xFF, 0xFF));
  EXPECT_EQ(encode(Tp3{}, kGateway).id, 0x18FE7A00U);
}

// Worked by the formula of SPN 4207 in another language.
TEST(VehicleGolden, TorqueSpeedRequestIsClosedByCounterAndChecksum) {
  const auto closed = [](std::uint32_t id, std::initializer_list<std::uint8_t> bytes,
                         std::uint8_t counter) {
    can::Frame frame;
    frame.id = id;
    frame.extended = true;
    frame.length = 8;
    std::copy(bytes.begin(), bytes.end(), frame.data.begin());
    frame.data[7] = static_cast<std::uint8_t>(0xF0U | counter);
    return torque_speed_checksum(frame);
  };
  EXPECT_EQ(closed(0x0C000011, {0x01, 0x00, 0x4B, 0x7D, 0xFF, 0xFF, 0xFF}, 3), 5);
  EXPECT_EQ(closed(0x0C000003, {0xF1, 0xE0, 0x2E, 0xFF, 0xFF, 0xFF, 0xFF}, 0), 3);
  EXPECT_EQ(closed(0x0C000027, {0x03, 0x80, 0x25, 0xAF, 0xFF, 0xFF, 0xFF}, 7), 1);
}

}  // namespace
}  // namespace rigwire::protocols::vehicle
