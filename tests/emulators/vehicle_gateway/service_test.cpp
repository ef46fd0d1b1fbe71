// What the gateway tells on request: identification, trouble codes that were, hours, tyre channels;
// and its position, when a receiver is wired to it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocols/iso11783/functionalities.h"
#include "protocols/j1939/transport.h"
#include "protocols/vehicle/engine_configuration.h"
#include "protocols/vehicle/identification.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using testing::ElementsAre;
namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;

struct VehicleService : testing::Test {
  void start(const VehicleGatewaySettings& settings = {}) {
    rig.emplace(settings);
    rig->run(300ms);
    rig->output.frames.clear();
  }
  void request(std::uint32_t pgn, std::uint8_t destination = 0x00) {
    rig->receive(j1939::make_request(kController, destination, pgn));
  }
  /// The payload of group `pgn` that the gateway sends to the controller, whose part is played
  /// here.
  std::vector<std::uint8_t> read(std::uint32_t pgn) {
    rig->output.frames.clear();
    request(pgn);
    const auto asked = rig->output.of(j1939::kTransportManagementPgn);
    if (asked.size() != 1) {
      const auto frames = rig->output.of(pgn);
      if (frames.size() != 1) {
        ADD_FAILURE() << pgn << " is not answered";
        return {};
      }
      return {frames[0].payload().begin(), frames[0].payload().end()};
    }
    const auto management = j1939::decode_transport_management(asked[0].payload());
    EXPECT_EQ(management->control, j1939::TransportControl::request_to_send);
    EXPECT_EQ(j1939::identify(asked[0])->destination, kController);
    EXPECT_EQ(management->pgn, pgn);
    j1939::TransportManagement clear;
    clear.control = j1939::TransportControl::clear_to_send;
    clear.packets = management->packets;
    clear.next = 1;
    clear.pgn = pgn;
    rig->receive(j1939::make_transport_management(kController, 0x00, clear));
    rig->run(10ms * management->packets + 10ms);
    std::vector<std::uint8_t> bytes;
    for (const Frame& frame : rig->output.of(j1939::kTransportDataPgn)) {
      bytes.insert(bytes.end(), frame.data.begin() + 1, frame.data.end());
    }
    bytes.resize(management->size);
    j1939::TransportManagement end = *management;
    end.control = j1939::TransportControl::end_of_message;
    rig->receive(j1939::make_transport_management(kController, 0x00, end));
    return bytes;
  }
  std::string text(std::uint32_t pgn) {
    const auto bytes = read(pgn);
    return {bytes.begin(), bytes.end()};
  }
  void fail(const auto& message) {
    rig->ask(message);
    rig->run(600ms);
  }
  static vehicle::Xbr brake() {
    vehicle::Xbr request;
    request.acceleration_mps2 = -1.0;
    request.control_mode = static_cast<std::uint8_t>(vehicle::BrakeControlMode::maximum);
    return request;
  }
  [[nodiscard]] vehicle::TroubleCodes codes(std::uint32_t pgn) {
    const auto decoded = vehicle::decode_trouble_report(read(pgn));
    EXPECT_TRUE(decoded.ok());
    return decoded.ok() ? *decoded : vehicle::TroubleCodes{};
  }

  std::optional<VehicleRig> rig;
};

TEST_F(VehicleService, SaysWhoItIs) {
  VehicleGatewaySettings settings;
  settings.identification.make = "ETH";
  settings.identification.model = "Unimog U 423";
  settings.serial = 12345;
  settings.identification.unit_number = "7";
  settings.identification.software = "2.1";
  start(settings);
  EXPECT_EQ(text(vehicle::kComponentIdentificationPgn), "ETH*Unimog U 423*12345*7*");
  EXPECT_EQ(text(vehicle::kSoftwareIdentificationPgn).substr(0, 5),
            "\x01"
            "2.1*");
  EXPECT_EQ(text(vehicle::kEcuIdentificationPgn), "*12345**tractor ECU*ETH**");
}

TEST_F(VehicleService, EverybodyAskingIsAnsweredByABroadcast) {
  start();
  request(vehicle::kComponentIdentificationPgn, j1939::kGlobalAddress);
  const auto announced = rig->output.of(j1939::kTransportManagementPgn);
  ASSERT_EQ(announced.size(), 1U);
  EXPECT_EQ(announced[0].data[0], 32);
  // While it is on its way trouble codes of more than one frame wait; those of one do not.
  rig->output.frames.clear();
  rig->run(1s);
  EXPECT_EQ(rig->output.of(vehicle::kDm1Pgn).size(), 1U);
}

TEST_F(VehicleService, WhatWasWrongIsRememberedUntilItIsCleared) {
  start();
  EXPECT_EQ(codes(vehicle::kDm2Pgn).count, 0U);
  fail(brake());
  EXPECT_EQ(codes(vehicle::kDm1Pgn).count, 1U);
  EXPECT_EQ(codes(vehicle::kDm2Pgn).count, 0U);
  rig->ask(vehicle::Xbr{});  // ended properly
  EXPECT_EQ(codes(vehicle::kDm1Pgn).count, 0U);
  const auto previous = codes(vehicle::kDm2Pgn);
  ASSERT_EQ(previous.count, 1U);
  EXPECT_EQ(previous.codes[0], (vehicle::TroubleCode{2920, 9, 1}));

  rig->output.frames.clear();
  request(vehicle::kDm3Pgn);
  const auto answer =
      j1939::decode_acknowledgement(rig->output.of(j1939::kAcknowledgementPgn).at(0));
  EXPECT_EQ(answer->control, j1939::Acknowledge::positive);
  EXPECT_EQ(answer->pgn, vehicle::kDm3Pgn);
  EXPECT_EQ(codes(vehicle::kDm2Pgn).count, 0U);
}

TEST_F(VehicleService, ClearingDoesNotMendWhatIsStillWrong) {
  start();
  fail(brake());
  rig->ask(brake());
  fail(brake());
  EXPECT_EQ(codes(vehicle::kDm1Pgn).codes[0], (vehicle::TroubleCode{2920, 9, 2}));
  rig->output.frames.clear();
  request(vehicle::kDm11Pgn, j1939::kGlobalAddress);
  EXPECT_TRUE(rig->output.of(j1939::kAcknowledgementPgn).empty());
  EXPECT_EQ(codes(vehicle::kDm1Pgn).codes[0], (vehicle::TroubleCode{2920, 9, 1}));
  EXPECT_TRUE(rig->gateway.control().stopping());
}

TEST_F(VehicleService, HoursCountWhileTheEngineRuns) {
  VehicleGatewaySettings settings;
  settings.engine_hours = 100h;
  start(settings);
  VehicleSample off = standing();
  off.engine.speed_radps = 0.0;
  rig->run(600s, off);
  VehicleSample on = standing();
  on.engine.speed_radps = 1000.0 * kRpm;
  rig->run(3600s, on);
  request(vehicle::Hours::kGroup.pgn);
  const auto hours = rig->output.latest<vehicle::Hours>();
  EXPECT_NEAR(hours.operation_s, 101 * 3600.0, 180.0);
  EXPECT_NEAR(hours.revolutions, 60e3, 1000.0);
}

TEST_F(VehicleService, SetPointIsAnsweredAtOnce) {
  start();
  rig->ask(vehicle::Tprs{0x10, 200e3});
  const auto answers = rig->output.of(vehicle::Tpri::kGroup.pgn);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_THAT(answers[0].payload().first(2), ElementsAre(0x10, 25));
  request(vehicle::Tire2::kGroup.pgn);
  EXPECT_THAT(rig->output.of(vehicle::Tire2::kGroup.pgn).at(2).payload().subspan(3, 2),
              ElementsAre(200, 0));
}

TEST_F(VehicleService, ChannelsOfTyreInflation) {
  start();
  VehicleSample sample = standing();
  sample.tyre_pressure_pa = {300e3, 302e3, 250e3, 250e3};
  sample.tyre_pressure_target_pa = {350e3, 350e3, 200e3, 200e3};
  rig->run(100ms, sample);
  request(vehicle::Tp1::kGroup.pgn);
  request(vehicle::Tp2::kGroup.pgn);
  request(vehicle::Tp3::kGroup.pgn);
  const auto modes = rig->output.latest<vehicle::Tp1>();
  EXPECT_EQ(modes.steer_mode, 1);
  EXPECT_EQ(modes.drive_mode, 2);
  EXPECT_EQ(modes.trailer_mode, 0xF);
  EXPECT_EQ(rig->output.latest<vehicle::Tp2>().steer_pa, 350e3);
  EXPECT_EQ(rig->output.latest<vehicle::Tp3>().steer_pa, 301e3);
  EXPECT_EQ(rig->output.latest<vehicle::Tp3>().drive_pa, 250e3);
}

TEST_F(VehicleService, NamesWhoseRequestIsInForce) {
  start();
  vehicle::Tsc1 request;
  request.override_mode = static_cast<std::uint8_t>(vehicle::OverrideMode::torque);
  request.torque_share = 0.5;
  rig->ask(request);
  rig->run(50ms);
  EXPECT_EQ(rig->output.latest<vehicle::Eec1>().controlling_address, kController);
  rig->run(200ms);
  EXPECT_EQ(rig->output.latest<vehicle::Eec1>().controlling_address, 0xFF);
}

TEST_F(VehicleService, PositionIsSentOnlyWithAReceiver) {
  start();
  rig->run(6s);
  EXPECT_TRUE(rig->output.of(vehicle::VehiclePosition::kGroup.pgn).empty());
  rig->output.frames.clear();
  request(vehicle::VehiclePosition::kGroup.pgn);
  EXPECT_EQ(rig->output.of(j1939::kAcknowledgementPgn).size(), 1U);

  VehicleGatewaySettings settings;
  settings.has_position = true;
  start(settings);
  rig->run(1s);
  EXPECT_THAT(rig->output.of(vehicle::VehiclePosition::kGroup.pgn).at(0).payload(),
              testing::Each(0xFF));
  VehicleSample reversing = standing();
  reversing.odometry.speed_mps = -2.0;
  for (int i = 0; i < 20; ++i) {
    GnssSample fix;
    fix.time = rig->now;
    fix.fix = GnssFix::three_d;
    fix.latitude_deg = 46.0;
    fix.longitude_deg = 7.0;
    fix.velocity_ned_mps = {0.0, 2.0, 0.0};
    rig->gateway.observe_fix(fix);
    rig->run(100ms, reversing);
  }
  EXPECT_THAT(rig->output.of(vehicle::VehiclePosition::kGroup.pgn).back().payload(),
              ElementsAre(0x00, 0x80, 0x96, 0x98, 0x80, 0x92, 0x57, 0x81));
  EXPECT_NEAR(rig->output.latest<vehicle::VehicleDirectionSpeed>().bearing_rad, std::acos(0.0),
              1e-3);
}

TEST_F(VehicleService, GroundBasedSpeedIsTheRadarsAndTheDirectionTheWheels) {
  VehicleGatewaySettings settings;
  settings.has_ground_radar = true;
  start(settings);
  VehicleSample reversing = standing();
  reversing.odometry.speed_mps = -2.5;  // the wheels slip
  reversing.ground_speed_mps = 2.0;
  rig->run(2s, reversing);
  const auto ground = rig->output.latest<vehicle::GroundBasedSpeed>();
  EXPECT_NEAR(ground.speed_mps, 2.0, 1e-3);
  EXPECT_EQ(ground.forward, vehicle::Switch::off);
  EXPECT_NEAR(ground.distance_m, 4.0, 0.25);
  VehicleSample parked = standing();
  parked.ground_speed_mps = 0.0;
  rig->run(1s, parked);
  const double before_m = rig->output.latest<vehicle::GroundBasedSpeed>().distance_m;
  rig->run(40s, parked);
  EXPECT_EQ(rig->output.latest<vehicle::GroundBasedSpeed>().speed_mps, 0.0);
  EXPECT_EQ(rig->output.latest<vehicle::GroundBasedSpeed>().distance_m, before_m);
}

TEST_F(VehicleService, WithoutARadarThereIsNoGroundBasedSpeed) {
  start();
  rig->run(1s);
  EXPECT_TRUE(rig->output.of(vehicle::GroundBasedSpeed::kGroup.pgn).empty());
  request(vehicle::GroundBasedSpeed::kGroup.pgn);
  EXPECT_EQ(rig->output.of(j1939::kAcknowledgementPgn).size(), 1U);
}

/// An engine of 1000 Nm.
VehicleGatewaySettings with_engine() {
  VehicleGatewaySettings settings;
  settings.engine.reference_torque_nm = 1000.0;
  for (std::size_t i = 0; i < EngineData::kPoints; ++i) {
    settings.engine.full_load[i] = {(800.0 + 300.0 * static_cast<double>(i)) * kRpm,
                                    900.0 - 50.0 * static_cast<double>(i), 100.0};
  }
  settings.engine.high_idle_radps = 2300.0 * kRpm;
  settings.engine.governor_nmsprad = 180.0;
  settings.engine.inertia_kgm2 = 1.3;
  return settings;
}

TEST_F(VehicleService, ScanToolReadsTheEnginesConfiguration) {
  start(with_engine());
  const auto bytes = read(vehicle::kEngineConfigurationPgn);
  const auto configuration = vehicle::decode_engine_configuration(bytes);
  ASSERT_TRUE(configuration.ok());
  EXPECT_EQ(bytes.size(), 40U);
  // Idle, the end of full load, and three between.
  EXPECT_NEAR(configuration->speed_radps[0], 800.0 * kRpm, 0.07 * kRpm);
  EXPECT_NEAR(configuration->torque_share[0], 1.0, 0.005);
  EXPECT_NEAR(configuration->speed_radps[1], 2000.0 * kRpm, 0.07 * kRpm);
  EXPECT_NEAR(configuration->torque_share[1], 0.8, 0.005);
  EXPECT_NEAR(configuration->speed_radps[2], 1100.0 * kRpm, 0.07 * kRpm);
  EXPECT_NEAR(configuration->reference_torque_nm, 1000.0, 0.5);
  EXPECT_NEAR(configuration->governor_gain_prad, 0.18, 1e-4);
  EXPECT_NEAR(configuration->inertia_kgm2, 1.3, 0.002);
  EXPECT_EQ(bytes[0], 0x00);  // 800 rpm are 6400 counts, 1900 hex
  EXPECT_EQ(bytes[1], 0x19);
  EXPECT_EQ(bytes[19], 1000 % 256);
  EXPECT_EQ(bytes[20], 1000 / 256);
}

TEST_F(VehicleService, EnginesConfigurationIsBroadcastEveryFiveSeconds) {
  start(with_engine());
  rig->output.frames.clear();
  rig->run(10s);
  std::size_t announced = 0;
  for (const auto& frame : rig->output.of(j1939::kTransportManagementPgn)) {
    announced += frame.data[0] == 32 && frame.data[5] == 0xE3 && frame.data[6] == 0xFE ? 1 : 0;
  }
  EXPECT_EQ(announced, 2U);
}

TEST_F(VehicleService, ScanToolReadsTheVin) {
  VehicleGatewaySettings settings;
  settings.identification.vehicle_identification_number = "W09XYZ12345678901";
  start(settings);
  EXPECT_EQ(text(vehicle::kVehicleIdentificationPgn), "W09XYZ12345678901*");
  settings.identification.vehicle_identification_number.clear();
  start(settings);
  request(vehicle::kVehicleIdentificationPgn);
  EXPECT_EQ(rig->output.of(j1939::kAcknowledgementPgn).size(), 1U);
}

TEST_F(VehicleService, VinOfOtherLettersIsRefused) {
  for (const char* wrong : {"W09XYZ1234567890", "W09XYZ1234567890I", "w09xyz12345678901"}) {
    VehicleGatewaySettings settings;
    settings.identification.vehicle_identification_number = wrong;
    EXPECT_THROW(start(settings), std::invalid_argument) << wrong;
  }
}

TEST_F(VehicleService, IdlingEngineHasTorqueAndLoad) {
  start(with_engine());
  VehicleSample idling = standing();
  idling.engine.torque_nm = 0.0;
  idling.engine.friction_nm = 90.0;
  idling.engine.full_load_nm = 810.0;
  idling.engine.desired_radps = 800.0 * kRpm;
  idling.engine.coolant_c = 85.0;
  idling.engine.coolant_level_share = 1.0;
  idling.engine.oil_level_share = 0.9;
  idling.engine.fuel_level_share = 0.8;
  idling.engine.battery_v = 28.2;
  idling.engine.fuel_rate_m3ps = 1.5 * vehicle::kLitrePerHour_m3ps;
  rig->run(1100ms, idling);
  EXPECT_NEAR(rig->output.latest<vehicle::Eec1>().actual_torque_share, 0.09, 0.005);
  EXPECT_NEAR(rig->output.latest<vehicle::Eec2>().load_share, 0.1, 0.005);
  EXPECT_NEAR(rig->output.latest<vehicle::Eec3>().friction_torque_share, 0.09, 0.005);
  EXPECT_NEAR(rig->output.latest<vehicle::Eec3>().desired_speed_radps, 800.0 * kRpm, 0.07 * kRpm);
  EXPECT_NEAR(rig->output.latest<vehicle::Et1>().coolant_c, 85.0, 0.5);
  EXPECT_NEAR(rig->output.latest<vehicle::Eflp1>().coolant_level_share, 1.0, 0.003);
  EXPECT_NEAR(rig->output.latest<vehicle::Eflp1>().oil_level_share, 0.9, 0.003);
  EXPECT_NEAR(rig->output.latest<vehicle::Dd1>().fuel_level_share, 0.8, 0.003);
  EXPECT_NEAR(rig->output.latest<vehicle::Vep1>().battery_v, 28.2, 0.03);
  EXPECT_NEAR(rig->output.latest<vehicle::Lfe1>().fuel_rate_m3ps, 1.5 * vehicle::kLitrePerHour_m3ps,
              0.03 * vehicle::kLitrePerHour_m3ps);
}

TEST_F(VehicleService, SaysWhatItIsGoodFor) {
  VehicleGatewaySettings settings;
  settings.has_hitch = {true, true};
  settings.has_power_take_off = {false, true};
  settings.has_position = true;
  start(settings);
  // FF, two functionalities: minimum control function, tractor server with class 1, navigation,
  // front hitch, guidance.
  EXPECT_THAT(read(protocols::iso11783::kFunctionalitiesPgn),
              ElementsAre(0xFF, 2, 0, 1, 1, 0x00, 13, 1, 1, 0x39));
  start();
  EXPECT_THAT(read(protocols::iso11783::kFunctionalitiesPgn),
              ElementsAre(0xFF, 2, 0, 1, 1, 0x00, 13, 1, 1, 0x20));
}

TEST_F(VehicleService, LanguageOfATerminalIsKept) {
  start();
  request(vehicle::LanguageCommand::kGroup.pgn);
  EXPECT_EQ(rig->output.latest<vehicle::LanguageCommand>().language_first, 'e');
  vehicle::LanguageCommand french;
  french.language_first = 'f';
  french.language_second = 'r';
  french.decimal_symbol = 0;
  rig->ask(french);
  request(vehicle::LanguageCommand::kGroup.pgn);
  EXPECT_EQ(rig->output.latest<vehicle::LanguageCommand>(), french);
}

TEST_F(VehicleService, SteeringSensorCountsItsMessages) {
  start();
  VehicleSample sample = standing();
  sample.front_steer_rad = 0.5;  // times 20: 1.59 turns
  rig->run(200ms, sample);
  const auto frames = rig->output.of(vehicle::Sas::kGroup.pgn);
  ASSERT_EQ(frames.size(), 20U);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].data[7] & 0xF, ((frames[i - 1].data[7] & 0xF) + 1) % 16);
  }
  EXPECT_EQ(rig->output.latest<vehicle::Sas>().range_counter, 33);
  EXPECT_EQ(rig->output.latest<vehicle::Vdc2>().turn_counter, 33);
}

}  // namespace
}  // namespace rigwire::emulators
