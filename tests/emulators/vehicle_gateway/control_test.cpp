// What requests do, and what becomes of the machine when they stop coming.
#include "emulators/vehicle_gateway/control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "protocols/j1939/message.h"
#include "protocols/j1939/transport.h"
#include "requests.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace vehicle = protocols::vehicle;
using vehicle::ExitReason;
using vehicle::LimitStatus;
using vehicle::Switch;

TEST(VehicleControl, StandsParkedUntilAskedOtherwise) {
  VehicleRig rig;
  rig.run(1s);
  EXPECT_EQ(rig.command(), VehicleCommand{});
  EXPECT_FALSE(rig.gateway.control().stopping());
}

TEST(VehicleControl, CommandCarriesTheInstantOfItsChange) {
  VehicleRig rig;
  rig.run(123ms);
  rig.ask(torque(0.5));
  EXPECT_EQ(rig.command().time, kStart + 123ms);
  rig.run(20ms);
  rig.ask(torque(0.5));
  EXPECT_EQ(rig.command().time, kStart + 123ms);  // the same again is no change
  rig.run(99ms);
  EXPECT_EQ(rig.command().engine_torque_share, 0.5);
  rig.run(2ms);
  EXPECT_EQ(rig.command().engine_torque_share, 0.0);
  EXPECT_EQ(rig.command().time, kStart + 243ms);  // when it timed out
}

TEST(VehicleControl, EngineRequestWithAWrongChecksumIsIgnoredAndSaid) {
  VehicleRig rig;
  rig.run(50ms);
  vehicle::Tsc1 request = torque(0.5);
  request.counter = 1;
  request.checksum = 0;
  const auto right =
      vehicle::torque_speed_checksum(vehicle::encode(request, kController, rig.gateway.address()));
  request.checksum = static_cast<std::uint8_t>(right ^ 1U);
  rig.ask(request);
  EXPECT_EQ(rig.command().engine_torque_share, 0.0);
  const auto troubles = rig.gateway.control().troubles().active();
  ASSERT_EQ(troubles.count, 1U);
  EXPECT_EQ(troubles.codes[0], (vehicle::TroubleCode{695, 19, 1}));
  request.checksum = right;
  rig.ask(request);
  EXPECT_EQ(rig.command().engine_torque_share, 0.0) << "the same counter again";
  request.counter = 2;
  request.checksum =
      vehicle::torque_speed_checksum(vehicle::encode(request, kController, rig.gateway.address()));
  rig.ask(request);
  EXPECT_EQ(rig.command().engine_torque_share, 0.5);
  EXPECT_EQ(rig.gateway.control().troubles().active().count, 0U);
}

TEST(VehicleControl, EngineBySpeedOrTorque) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(engine_speed(1500.0 * kRpm));
  EXPECT_EQ(rig.command().engine_control, EngineControl::speed);
  EXPECT_NEAR(rig.command().engine_speed_radps, 1500.0 * kRpm, 0.07 * kRpm);
  rig.ask(torque(1.25));
  EXPECT_EQ(rig.command().engine_control, EngineControl::torque);
  EXPECT_EQ(rig.command().engine_torque_share, 1.0);
  rig.ask(torque(-0.5));
  EXPECT_EQ(rig.command().engine_torque_share, 0.0);
  rig.ask(torque(0.7));
  rig.ask(vehicle::Tsc1{});  // disabled
  EXPECT_EQ(rig.command().engine_torque_share, 0.0);
  rig.run(1s);
  EXPECT_EQ(rig.gateway.control().troubles().active().count, 0U);  // ended, not lost
}

TEST(VehicleControl, GearsAndParkAndLocks) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(parking(false));
  rig.ask(gear(-2));
  EXPECT_EQ(rig.command().gear, -2);
  EXPECT_FALSE(rig.command().parking_brake);
  vehicle::Tc1 locks = gear(3);
  locks.disengage_front_lock_1 = Switch::off;
  locks.disengage_rear_lock_1 = Switch::off;
  rig.ask(locks);
  EXPECT_EQ(rig.command().lock, (std::array{true, false, true}));
  locks = {};
  locks.disengage_front_lock_1 = Switch::on;
  rig.ask(locks);
  EXPECT_EQ(rig.command().lock, (std::array{false, false, true}));
  EXPECT_EQ(rig.command().gear, 3);
  locks.requested_gear = vehicle::kGearPark;
  rig.ask(locks);
  EXPECT_EQ(rig.command().gear, 0);
  EXPECT_TRUE(rig.command().parking_brake);
}

TEST(VehicleControl, GearThatDoesNotExistIsRefusedWithATroubleCode) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(gear(4));
  rig.ask(gear(9));
  EXPECT_EQ(rig.command().gear, 4);
  const auto faults = rig.gateway.control().troubles().active();
  ASSERT_EQ(faults.count, 1U);
  EXPECT_EQ(faults.codes[0], (vehicle::TroubleCode{525, 19, 1}));
  rig.ask(gear(-7));
  EXPECT_EQ(rig.gateway.control().troubles().active().codes[0].occurrences,
            1);  // still the same one
  rig.ask(gear(8));
  EXPECT_EQ(rig.gateway.control().troubles().active().count, 0U);
  EXPECT_EQ(rig.command().gear, 8);
}

TEST(VehicleControl, GearStaysWhenItsRequestsStop) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(gear(3));
  rig.run(2s);
  EXPECT_EQ(rig.command().gear, 3);
  EXPECT_FALSE(rig.gateway.control().stopping());
  EXPECT_EQ(rig.gateway.control().troubles().active().count, 1U);
}

TEST(VehicleControl, BrakeFollowsTheDemandedDeceleration) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(brake(-3.0));
  EXPECT_NEAR(rig.command().brake_share, 0.5, 1e-4);
  rig.ask(brake(-15.0));
  EXPECT_EQ(rig.command().brake_share, 1.0);
  rig.ask(brake(2.0));
  EXPECT_EQ(rig.command().brake_share, 0.0);
  rig.ask(brake(-3.0));
  rig.ask(vehicle::Xbr{});  // disabled
  EXPECT_EQ(rig.command().brake_share, 0.0);
}

TEST(VehicleControl, BrakeIsReleasedWhenOnlyItsRequestsStop) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(brake(-3.0));
  for (int i = 0; i < 5; ++i) {
    rig.ask(torque(0.1));
    rig.run(50ms);
  }
  EXPECT_EQ(rig.command().brake_share, 0.0);
  EXPECT_NEAR(rig.command().engine_torque_share, 0.1, 1e-9);
  EXPECT_EQ(rig.gateway.control().troubles().active().codes[0].spn, 2920U);
}

TEST(VehicleControl, TravelSpeedWithItsLimits) {
  VehicleGatewaySettings settings = roller();
  settings.maximum_speed_mps = 3.0;
  settings.maximum_reverse_speed_mps = 2.0;
  VehicleRig rig(settings);
  rig.run(300ms);
  rig.ask(parking(false));
  rig.ask(travel(1.5));
  EXPECT_NEAR(rig.command().travel_speed_mps.value(), 1.5, 5e-4);
  rig.ask(travel(5.0));
  EXPECT_EQ(rig.command().travel_speed_mps, 3.0);
  EXPECT_EQ(rig.gateway.control().speed_limit(), LimitStatus::limited_high);
  rig.ask(travel(-5.0));
  EXPECT_EQ(rig.command().travel_speed_mps, -2.0);
  rig.ask(vehicle::MachineSelectedSpeedCommand{2.5, 1.0, Switch::on});
  EXPECT_NEAR(rig.command().travel_speed_mps.value(), 1.0, 5e-4);
  rig.ask(vehicle::MachineSelectedSpeedCommand{0.5, vehicle::kNotAvailable, Switch::error});
  EXPECT_NEAR(rig.command().travel_speed_mps.value(), 1.0, 5e-4);  // without a direction it is none
}

TEST(VehicleControl, TravelSpeedIsZeroWhenItsRequestsStop) {
  VehicleRig rig(roller());
  rig.run(50ms);
  rig.ask(travel(1.5));
  for (int i = 0; i < 6; ++i) {
    rig.ask(curvature(0.0));
    rig.run(50ms);
  }
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
  rig.run(100ms);
  EXPECT_EQ(rig.output.latest<vehicle::MachineSelectedSpeed>().exit_reason,
            static_cast<std::uint8_t>(ExitReason::command_timeout));
}

TEST(VehicleControl, SilenceOfEverybodyStopsAndParksTheMachine) {
  VehicleGatewaySettings settings;
  VehicleRig rig(settings);
  rig.run(300ms);
  rig.ask(parking(false));
  rig.ask(gear(2));
  rig.ask(torque(0.5));
  rig.run(50ms, rolling(3.0));
  EXPECT_EQ(rig.command().brake_share, 0.0);
  rig.run(600ms, rolling(3.0));
  EXPECT_TRUE(rig.gateway.control().stopping());
  EXPECT_EQ(rig.command().engine_torque_share, 0.0);
  EXPECT_EQ(rig.command().brake_share, settings.stop_brake_share);
  EXPECT_EQ(rig.command().gear, 2);
  EXPECT_FALSE(rig.command().parking_brake);  // it still rolls
  rig.run(400ms, rolling(0.0));
  EXPECT_FALSE(rig.command().parking_brake);
  rig.run(200ms, rolling(0.0));
  EXPECT_TRUE(rig.command().parking_brake);
  EXPECT_EQ(rig.command().gear, 0);

  rig.ask(torque(0.3));  // somebody is back
  EXPECT_FALSE(rig.gateway.control().stopping());
  EXPECT_EQ(rig.command().brake_share, 0.0);
  EXPECT_TRUE(rig.command().parking_brake);  // until asked otherwise
  rig.ask(parking(false));
  EXPECT_FALSE(rig.command().parking_brake);
}

TEST(VehicleFunctions, RollerFunctionsAndWhatIsLeftAlone) {
  VehicleRig rig(roller());
  rig.run(50ms);
  vehicle::MachineFunctionCommand request;
  request.vibration_rear = Switch::on;
  request.edge_cutter_share = 1.0;
  request.spreader_rate_kgpm2 = 4.0;
  rig.ask(request);
  EXPECT_EQ(rig.command().vibration, (std::array{false, true}));
  EXPECT_EQ(rig.command().edge_cutter_share, 1.0);
  EXPECT_NEAR(rig.command().spreader_rate_kgpm2, 4.0, 5e-4);
  EXPECT_TRUE(rig.command().parking_brake);
  rig.ask(parking(false));
  EXPECT_EQ(rig.command().edge_cutter_share, 1.0);
  request = {};
  request.crawler_group = Switch::on;
  rig.ask(request);
  EXPECT_TRUE(rig.command().crawler_group);
}

TEST(VehicleFunctions, TyrePressureBySetPoint) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(vehicle::Tprs{0x10, 160e3});
  EXPECT_EQ(rig.command().tyre_pressure_pa, (std::array{0.0, 0.0, 160e3, 0.0}));
}

TEST(VehicleTroubleCodes, OneLateCommandIsOneFrameAtOnce) {
  VehicleRig rig;
  rig.run(1s);
  rig.output.frames.clear();
  rig.ask(brake(-1.0));
  rig.run(220ms);
  const auto reports = rig.output.of(vehicle::kDm1Pgn);
  ASSERT_EQ(reports.size(), 1U);
  const auto codes = vehicle::decode_trouble_report(reports[0].payload());
  ASSERT_TRUE(codes.ok());
  EXPECT_EQ(codes->count, 1U);
  EXPECT_EQ(codes->codes[0], (vehicle::TroubleCode{2920, 9, 1}));
  EXPECT_TRUE(codes->lamps.amber_warning);
  EXPECT_TRUE(codes->lamps.red_stop);
}

TEST(VehicleTroubleCodes, SeveralAreBroadcastInPackets) {
  VehicleRig rig;
  rig.run(1s);
  rig.ask(brake(-1.0));
  rig.ask(torque(0.1));
  rig.ask(curvature(0.0));
  rig.run(500ms);
  rig.output.frames.clear();
  rig.run(1s);
  EXPECT_TRUE(rig.output.of(vehicle::kDm1Pgn).empty());
  const auto announced = rig.output.of(protocols::j1939::kTransportManagementPgn);
  const auto times = rig.output.times(protocols::j1939::kTransportDataPgn);
  ASSERT_EQ(announced.size(), 1U);
  EXPECT_EQ(announced[0].data[1], 2 + 3 * 4);
  ASSERT_EQ(times.size(), 2U);
  EXPECT_EQ(times[1] - times[0], 50ms);
}

/// After half a second the parking brake is released.
void get_ready(VehicleRig& rig) {
  rig.run(500ms);
  rig.ask(parking(false));
}

/// What the selected speed says of the command.
std::pair<LimitStatus, ExitReason> verdict(VehicleRig& rig, const VehicleSample& sample) {
  rig.ask(vehicle::Tsc1{});  // nothing but time
  rig.run(100ms, sample);
  const auto state = rig.output.latest<vehicle::MachineSelectedSpeed>();
  return {static_cast<LimitStatus>(state.limit_status), static_cast<ExitReason>(state.exit_reason)};
}

TEST(SpeedCommand, ZeroIsACommandAndNotItsAbsence) {
  VehicleRig rig;
  get_ready(rig);
  EXPECT_FALSE(rig.command().travel_speed_mps.has_value());
  rig.ask(travel(0.0));
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
  EXPECT_TRUE(rig.command().automatic_gear);
}

TEST(SpeedCommand, TimeOutHoldsTheMachineUntilSomebodyTakesOver) {
  VehicleRig rig;
  get_ready(rig);
  rig.ask(travel(2.0));
  for (int i = 0; i < 10; ++i) {
    rig.ask(torque(0.4));  // competes, and has no say
    rig.run(40ms, rolling(2.0));
  }
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
  EXPECT_EQ(rig.gateway.control().speed_exit(), ExitReason::command_timeout);
  EXPECT_EQ(rig.gateway.control().troubles().active().codes[0].spn, 4310U);
  rig.ask(torque(0.4));  // it was in force all the time: still held
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
  rig.ask(vehicle::Tsc1{});
  rig.ask(torque(0.4));  // begins anew
  EXPECT_FALSE(rig.command().travel_speed_mps.has_value());
}

TEST(SpeedCommand, EngineRequestsDoNotOverrideItButLimitIt) {
  VehicleRig rig;
  get_ready(rig);
  rig.ask(travel(2.0));
  rig.ask(torque(1.0));
  EXPECT_NEAR(rig.command().travel_speed_mps.value(), 2.0, 1e-3);
  rig.run(20ms, rolling(1.0));
  // The torque mode of EEC1 says what controls the engine.
  EXPECT_EQ(rig.output.latest<vehicle::Eec1>().torque_mode, 2);
  vehicle::Tsc1 limit;
  limit.override_mode = static_cast<std::uint8_t>(vehicle::OverrideMode::limit);
  limit.speed_radps = 1500.0 * kRpm;
  limit.torque_share = 0.5;
  rig.ask(limit);
  EXPECT_NEAR(rig.command().engine_speed_limit_radps, 1500.0 * kRpm, 0.1);
  EXPECT_NEAR(rig.command().engine_torque_limit_share, 0.5, 0.01);
  rig.ask(vehicle::Tsc1{});
  EXPECT_EQ(rig.command().engine_torque_limit_share, 1.0);
}

TEST(SpeedCommand, GearThatIsHeldRefusesTheOtherDirection) {
  VehicleRig rig;
  get_ready(rig);
  rig.ask(gear(2));
  rig.ask(travel(-1.0));
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
  EXPECT_FALSE(rig.command().automatic_gear);
  EXPECT_EQ(verdict(rig, standing()), std::pair(LimitStatus::operator_limited, ExitReason::gear));
  rig.ask(gear(2));
  rig.ask(travel(1.0));
  EXPECT_NEAR(rig.command().travel_speed_mps.value(), 1.0, 1e-3);
  EXPECT_EQ(rig.command().gear, 2);
  EXPECT_EQ(verdict(rig, standing()), std::pair(LimitStatus::not_limited, ExitReason::none));
}

TEST(SpeedCommand, ParkingBrakeRefusesIt) {
  VehicleRig rig;
  rig.run(500ms);
  rig.ask(travel(1.0));
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
  EXPECT_EQ(verdict(rig, standing()), std::pair(LimitStatus::operator_limited, ExitReason::gear));
}

TEST(SpeedCommand, MachineThatCannotFollowSaysSo) {
  VehicleRig rig;
  get_ready(rig);
  VehicleSample climbing = rolling(1.0);
  climbing.travel_limit = TravelLimit::power;
  rig.ask(travel(3.0));
  EXPECT_EQ(verdict(rig, climbing).first, LimitStatus::limited_high);
  climbing.travel_limit = TravelLimit::braking;
  rig.ask(travel(3.0));
  EXPECT_EQ(verdict(rig, climbing).first, LimitStatus::limited_low);
}

TEST(SpeedCommand, MachineWithoutADriveRefusesIt) {
  VehicleRig rig;
  get_ready(rig);
  VehicleSample fixed = standing();
  fixed.drives = false;
  rig.run(100ms, fixed);
  rig.ask(travel(1.0));
  EXPECT_FALSE(rig.command().travel_speed_mps.has_value());
  EXPECT_EQ(verdict(rig, fixed),
            std::pair(LimitStatus::not_recoverable, ExitReason::function_fault));
}

TEST(SpeedCommand, NotAvailableAndErrorAreNoCommands) {
  VehicleRig rig;
  get_ready(rig);
  rig.ask(travel(1.0));
  rig.ask(vehicle::MachineSelectedSpeedCommand{vehicle::kNotAvailable, vehicle::kNotAvailable,
                                               Switch::on});
  EXPECT_NEAR(rig.command().travel_speed_mps.value(), 1.0, 1e-3);
  rig.ask(
      vehicle::MachineSelectedSpeedCommand{vehicle::kError, vehicle::kNotAvailable, Switch::on});
  EXPECT_EQ(rig.gateway.control().speed_exit(), ExitReason::out_of_range);
  for (int i = 0; i < 8; ++i) {  // they keep nothing in force
    rig.ask(vehicle::MachineSelectedSpeedCommand{vehicle::kNotAvailable, vehicle::kNotAvailable,
                                                 Switch::on});
    rig.run(50ms, rolling(1.0));
  }
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
}

TEST(SpeedCommand, ReleasedItIsNoFaultAndTheMachineStaysHeld) {
  VehicleRig rig;
  get_ready(rig);
  rig.ask(travel(1.0));
  rig.ask(vehicle::MachineSelectedSpeedCommand{});
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
  EXPECT_EQ(rig.gateway.control().speed_exit(), ExitReason::released);
  rig.run(1s);
  EXPECT_EQ(rig.gateway.control().troubles().active().count, 0U);
}

VehicleGatewaySettings tractor() {
  VehicleGatewaySettings settings;
  settings.has_hitch = {true, true};
  settings.has_power_take_off = {true, true};
  return settings;
}

VehicleSample working() {
  VehicleSample sample = standing();
  sample.hitch[0] = {true, 0.8};
  sample.hitch[1] = {true, 0.2};
  sample.power_take_off[0] = {true, false, 0.0};
  sample.power_take_off[1] = {true, true, 540.0 * kRpm};
  return sample;
}

TEST(VehicleImplements, HitchesAndShaftsAreReportedAndCommanded) {
  VehicleRig rig(tractor());
  rig.run(1s, working());
  EXPECT_NEAR(rig.output.latest<vehicle::FrontHitchStatus>().position_share, 0.8, 0.003);
  EXPECT_EQ(rig.output.latest<vehicle::FrontHitchStatus>().in_work, Switch::off);
  EXPECT_NEAR(rig.output.latest<vehicle::RearHitchStatus>().position_share, 0.2, 0.003);
  EXPECT_EQ(rig.output.latest<vehicle::RearHitchStatus>().in_work, Switch::on);
  // Every 100 ms while it is engaged, else on request.
  EXPECT_GE(rig.output.of(vehicle::RearPowerTakeOffStatus::kGroup.pgn).size(), 7U);
  EXPECT_TRUE(rig.output.of(vehicle::FrontPowerTakeOffStatus::kGroup.pgn).empty());
  const auto shaft = rig.output.latest<vehicle::RearPowerTakeOffStatus>();
  EXPECT_NEAR(shaft.speed_radps, 540.0 * kRpm, 0.07 * kRpm);
  EXPECT_EQ(shaft.engaged, Switch::on);

  vehicle::HitchPowerTakeOffCommand command;
  command.rear_hitch_share = 0.6;
  command.front_engage = Switch::on;
  command.front_speed_radps = 1000.0 * kRpm;
  command.front_mode = Switch::on;
  rig.ask(command);
  EXPECT_NEAR(rig.command().hitch_share[1].value(), 0.6, 0.003);
  EXPECT_FALSE(rig.command().hitch_share[0].has_value());
  EXPECT_TRUE(rig.command().power_take_off[0].engaged);
  EXPECT_NEAR(rig.command().power_take_off[0].speed_radps.value(), 1000.0 * kRpm, 0.07 * kRpm);
  EXPECT_TRUE(rig.gateway.control().mode_refused(ImplementEnd::front));

  rig.run(500ms, working());  // silence: hitches stay, shafts are let go, nothing stops
  EXPECT_FALSE(rig.command().hitch_share[1].has_value());
  EXPECT_FALSE(rig.command().power_take_off[0].engaged);
  EXPECT_FALSE(rig.gateway.control().stopping());
  EXPECT_EQ(rig.output.latest<vehicle::RearHitchStatus>().exit_reason, 5);
}

TEST(VehicleImplements, WhatIsNotFittedIsNeitherSentNorTaken) {
  VehicleRig rig;
  rig.run(1s, working());
  EXPECT_TRUE(rig.output.of(vehicle::RearHitchStatus::kGroup.pgn).empty());
  vehicle::HitchPowerTakeOffCommand command;
  command.rear_hitch_share = 0.6;
  rig.ask(command);
  EXPECT_FALSE(rig.command().hitch_share[1].has_value());
}

TEST(VehiclePower, KeyOffStopsTheMachineAndPowerLastsAsLongAsImplementsAsk) {
  VehicleGatewaySettings settings;
  settings.key_off = 2s;
  settings.maximum_power_time = 10s;
  VehicleRig rig(settings);
  rig.run(1500ms);
  EXPECT_EQ(rig.output.latest<vehicle::WheelBasedSpeed>().key_switch, Switch::on);
  rig.run(1500ms);
  EXPECT_EQ(rig.output.latest<vehicle::WheelBasedSpeed>().key_switch, Switch::off);
  EXPECT_FALSE(rig.command().ignition);
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
  vehicle::MaintainPower maintain;
  maintain.ecu_power = Switch::on;
  for (int i = 0; i < 30; ++i) {  // asked for ever, power ends 10 s after the key
    rig.ask(maintain);
    rig.run(500ms);
  }
  const SimTime last = rig.output.frames.back().first;
  EXPECT_LE(last, kStart + 12s + 10ms);
  EXPECT_GE(last, kStart + 11900ms);
  EXPECT_TRUE(rig.command().parking_brake);
}

/// Unlike at the key nobody is asked: what is held by springs engages at once.
TEST(VehiclePower, WithoutSupplyItBrakesAndIsSilentAndClaimsAgain) {
  VehicleGatewaySettings settings;
  settings.sensor_start_up = 100ms;
  VehicleRig rig(settings);
  rig.run(500ms);
  rig.ask(torque(0.5));
  rig.run(10ms);
  EXPECT_EQ(rig.command().engine_torque_share, 0.5);
  rig.gateway.supply().begin({{515ms, 500ms}, NoSupplyFault{}});
  rig.run(10ms);
  EXPECT_EQ(rig.command().engine_torque_share, 0.0);
  EXPECT_TRUE(rig.command().parking_brake);
  EXPECT_EQ(rig.command().time, kStart + 515ms);
  rig.output.frames.clear();
  rig.ask(torque(0.5));
  rig.run(480ms);
  EXPECT_TRUE(rig.output.frames.empty());
  EXPECT_EQ(rig.command().engine_torque_share, 0.0);
  rig.run(100ms);
  ASSERT_FALSE(rig.output.frames.empty());
  EXPECT_EQ(protocols::j1939::identify(rig.output.frames.front().second)->pgn,
            protocols::j1939::kAddressClaimedPgn);
  EXPECT_TRUE(std::isnan(rig.output.latest<vehicle::Eec1>().speed_radps)) << "sensors start, too";
  rig.run(500ms);
  EXPECT_FALSE(std::isnan(rig.output.latest<vehicle::Eec1>().speed_radps));
  EXPECT_EQ(rig.gateway.control().troubles().active().count, 0U);
  rig.ask(torque(0.25));
  EXPECT_EQ(rig.command().engine_torque_share, 0.25);
}

TEST(VehiclePower, NobodyAskingItLastsTwoSeconds) {
  VehicleGatewaySettings settings;
  settings.key_off = 1s;
  VehicleRig rig(settings);
  rig.run(900ms);
  EXPECT_NEAR(rig.output.latest<vehicle::WheelBasedSpeed>().power_time_s, 180.0, 1e-9);
  rig.run(5s);
  EXPECT_LE(rig.output.frames.back().first, kStart + 3010ms);
  EXPECT_GE(rig.output.frames.back().first, kStart + 2900ms);
}

}  // namespace
}  // namespace rigwire::emulators
