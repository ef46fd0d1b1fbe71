// The gateway as a node: start-up, schedule, requests, bad input, settings.
#include "emulators/vehicle_gateway/vehicle_gateway.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "emulators/can/can_bus.h"
#include "protocols/j1939/name.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using testing::Each;
using testing::ElementsAre;
namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;

TEST(VehicleGateway, ClaimsBeforeItSaysAnythingElse) {
  VehicleGatewaySettings settings;
  settings.supply.power_on = 100ms;
  settings.serial = 0x12345;
  VehicleRig rig(settings);
  rig.run(200ms);
  ASSERT_FALSE(rig.output.frames.empty());
  const auto& [due, claim] = rig.output.frames.front();
  EXPECT_EQ(due, kStart + 100ms + 500us);
  EXPECT_EQ(claim.id, 0x18EEFF00U);
  EXPECT_THAT(claim.payload(), ElementsAre(0x45, 0x23, 0x01, 0x00, 0x00, 0x86, 0x00, 0x20));
  EXPECT_EQ(rig.output.of(j1939::kAddressClaimedPgn).size(), 1U);
}

TEST(VehicleGateway, PartnerThatLooksForATractorEcuFindsIt) {
  test::FrameRecorder output;
  const VehicleGateway gateway(VehicleGatewaySettings{}, output);
  const j1939::Name name = j1939::unpack_name(gateway.name());
  EXPECT_EQ(name.industry_group, 2);
  EXPECT_EQ(name.vehicle_system, 0);  // in class 1 function 134 is a centre hitch
  EXPECT_EQ(name.function, 134);
}

TEST(VehicleGateway, EveryPartOfTheNameIsAKey) {
  VehicleGatewaySettings settings;
  settings.name = {.manufacturer = 1234,
                   .function = 30,
                   .function_instance = 3,
                   .device_class = 16,
                   .industry_group = 3};
  test::FrameRecorder output;
  const VehicleGateway gateway(settings, output);
  const j1939::Name name = j1939::unpack_name(gateway.name());
  EXPECT_EQ(name.manufacturer, 1234);
  EXPECT_EQ(name.function, 30);
  EXPECT_EQ(name.function_instance, 3);
  EXPECT_EQ(name.vehicle_system, 16);
  EXPECT_EQ(name.industry_group, 3);
}

TEST(VehicleGateway, EverythingIsNotAvailableUntilTheFirstSample) {
  VehicleRig rig;
  rig.run(190ms);
  for (const std::uint32_t pgn :
       {vehicle::Etc1::kGroup.pgn, vehicle::Hrw::kGroup.pgn, vehicle::Eec1::kGroup.pgn,
        vehicle::Ebc2::kGroup.pgn, vehicle::Ccvs1::kGroup.pgn}) {
    ASSERT_FALSE(rig.output.of(pgn).empty());
    for (const Frame& frame : rig.output.of(pgn)) {
      EXPECT_THAT(frame.payload(), Each(0xFF));
    }
  }
  rig.run(100ms);
  EXPECT_NEAR(rig.output.latest<vehicle::Eec1>().speed_radps, 800.0 * kRpm, 0.01);
}

TEST(VehicleGateway, SamplesThatStopComingAreNotAvailableAgain) {
  VehicleRig rig;
  rig.run(500ms);
  rig.gateway.advance(kStart + 1s);
  EXPECT_THAT(rig.output.of(vehicle::Eec1::kGroup.pgn).back().payload(), Each(0xFF));
}

TEST(VehicleGateway, EveryMessageKeepsItsPeriod) {
  VehicleGatewaySettings settings;
  settings.has_ground_radar = true;
  settings.has_hitch = {true, true};
  VehicleRig rig(settings);
  rig.run(30s);
  const VehicleReport report(settings);
  for (const VehicleReport::Entry& entry : VehicleReport::schedule()) {
    const auto times = rig.output.times(entry.group.pgn);
    if (entry.group.period.count() == 0 || !report.sends(entry)) {
      EXPECT_TRUE(times.empty()) << entry.group.name;
      continue;
    }
    const bool per_tyre = entry.group.period == 10s;
    ASSERT_EQ(times.size(), 30s / entry.group.period * (per_tyre ? kWheels : 1))
        << entry.group.name;
    const std::size_t group = per_tyre ? kWheels : 1;
    for (std::size_t i = group; i < times.size(); i += group) {
      ASSERT_EQ(times[i] - times[i - group], Duration{entry.group.period}) << entry.group.name;
    }
  }
  EXPECT_EQ(rig.output.of(vehicle::kDm1Pgn).size(), 30U);
}

TEST(VehicleGateway, SampleIsOnTheWireAMillisecondLater) {
  VehicleRig rig;
  rig.run(200ms);
  rig.output.frames.clear();
  VehicleSample sample = standing();
  sample.output_shaft_radps = 1000.0 * kRpm;
  rig.run(5ms, sample);
  ASSERT_EQ(rig.output.of(vehicle::Etc1::kGroup.pgn).size(), 1U);
  EXPECT_NEAR(rig.output.latest<vehicle::Etc1>().output_shaft_radps, 1000.0 * kRpm, 0.01);
  EXPECT_EQ(rig.output.times(vehicle::Etc1::kGroup.pgn).front(), kStart + 201ms);
}

TEST(VehicleGateway, NominalRateIsWhatItSends) {
  for (const SteeringLayout layout : {SteeringLayout::front_only, SteeringLayout::crab}) {
    VehicleGatewaySettings settings;
    settings.steering = layout;
    VehicleRig rig(settings);
    rig.run(20s);
    const auto claims = rig.output.of(j1939::kAddressClaimedPgn).size();
    EXPECT_NEAR(static_cast<double>(rig.output.frames.size() - claims) / 20.0,
                rig.gateway.nominal_rate_hz(), 0.2);
  }
}

TEST(VehicleGateway, TakesLessThanHalfOfTheBus) {
  test::FrameRecorder outside;
  CanBusModel bus(CanBusSettings{});
  FrameOutput& output = bus.add_node(outside);
  VehicleGatewaySettings settings;
  settings.steering = SteeringLayout::crab;
  VehicleGateway gateway(settings, output);
  bus.attach(output, gateway);
  SimTime now = kStart;
  for (; now < kStart + 2s; now += VehicleGateway::kTick) {
    bus.advance(now);
    VehicleSample sample = standing();
    sample.time = now;
    gateway.update(sample);
  }
  bus.advance(now);
  EXPECT_GT(bus.load(now), 0.2);
  EXPECT_LT(bus.load(now), 0.4);
  EXPECT_EQ(bus.counters(output).overflowed, 0U);
}

TEST(VehicleGatewayRequests, PeriodicMessagesComeOnDemandToo) {
  VehicleGatewaySettings settings;
  settings.has_ground_radar = true;
  settings.has_hitch = {true, true};
  settings.has_power_take_off = {true, true};
  VehicleRig rig(settings);
  rig.run(300ms);
  for (const VehicleReport::Entry& entry : VehicleReport::schedule()) {
    const std::size_t before = rig.output.of(entry.group.pgn).size();
    rig.receive(j1939::make_request(kController, rig.gateway.address(), entry.group.pgn));
    EXPECT_GT(rig.output.of(entry.group.pgn).size(), before) << entry.group.name;
  }
  EXPECT_TRUE(rig.output.of(j1939::kAcknowledgementPgn).empty());
}

TEST(VehicleGatewayRequests, UnknownGroupIsRefusedWhenAddressedAndIgnoredWhenGlobal) {
  VehicleRig rig;
  rig.run(100ms);
  constexpr std::uint32_t kTachograph = 65132;
  rig.receive(j1939::make_request(kController, j1939::kGlobalAddress, kTachograph));
  EXPECT_TRUE(rig.output.of(j1939::kAcknowledgementPgn).empty());
  rig.receive(j1939::make_request(kController, 0x55, kTachograph));
  EXPECT_TRUE(rig.output.of(j1939::kAcknowledgementPgn).empty());
  rig.receive(j1939::make_request(kController, rig.gateway.address(), kTachograph));
  ASSERT_EQ(rig.output.of(j1939::kAcknowledgementPgn).size(), 1U);
  const auto refusal = j1939::decode_acknowledgement(rig.output.frames.back().second);
  ASSERT_TRUE(refusal.ok());
  EXPECT_EQ(refusal->control, j1939::Acknowledge::negative);
  EXPECT_EQ(refusal->address, kController);
  EXPECT_EQ(refusal->pgn, kTachograph);
}

TEST(VehicleGatewayRequests, RequiredPressureIsAnsweredForEveryTyre) {
  VehicleRig rig;
  VehicleSample sample = standing();
  sample.tyre_pressure_target_pa = {0.0, 240e3, 160e3, 160e3};
  rig.run(300ms, sample);
  rig.receive(j1939::make_request(kController, 0x00, vehicle::Tpri::kGroup.pgn));
  const auto answers = rig.output.of(vehicle::Tpri::kGroup.pgn);
  ASSERT_EQ(answers.size(), kWheels);
  EXPECT_THAT(answers[0].payload().first(2), ElementsAre(0x00, 0xFF));
  EXPECT_THAT(answers[1].payload().first(2), ElementsAre(0x01, 30));
  EXPECT_THAT(answers[2].payload().first(2), ElementsAre(0x10, 20));
  EXPECT_THAT(answers[3].payload().first(2), ElementsAre(0x11, 20));
}

TEST(VehicleGatewayRequests, TroubleCodesComeAtOnce) {
  VehicleRig rig;
  rig.run(100ms);
  EXPECT_TRUE(rig.output.of(vehicle::kDm1Pgn).empty());
  rig.receive(j1939::make_request(kController, 0x00, vehicle::kDm1Pgn));
  rig.run(10ms);
  EXPECT_EQ(rig.output.of(vehicle::kDm1Pgn).size(), 1U);
}

TEST(VehicleGatewayRequests, RefusesWhatTheMachineCannotDo) {
  VehicleRig rig;
  rig.run(100ms);
  rig.ask(vehicle::Tprs{0x00, 1e6});
  rig.ask(vehicle::Tprs{0x22, 200e3});
  vehicle::MachineFunctionCommand crab;
  crab.steering_mode = static_cast<std::uint8_t>(vehicle::SteeringMode::crab);
  rig.ask(crab);
  EXPECT_EQ(rig.output.of(j1939::kAcknowledgementPgn).size(), 3U);
  EXPECT_EQ(rig.command(), VehicleCommand{});
}

TEST(VehicleGatewayHostile, EveryShapeOfForeignFrameIsCountedAndHarmless) {
  VehicleRig rig;
  rig.run(300ms);
  const std::size_t sent = rig.output.frames.size();
  std::uint64_t fed = 0;
  for (const std::uint32_t pgn :
       {j1939::kAddressClaimedPgn, j1939::kRequestPgn, j1939::kAcknowledgementPgn,
        vehicle::Tsc1::kGroup.pgn, vehicle::Tc1::kGroup.pgn, vehicle::Xbr::kGroup.pgn,
        vehicle::GuidanceCommand::kGroup.pgn, vehicle::MachineSelectedSpeedCommand::kGroup.pgn,
        vehicle::Tprs::kGroup.pgn, vehicle::MachineFunctionCommand::kGroup.pgn,
        vehicle::Eec1::kGroup.pgn}) {
    for (unsigned length = 0; length <= 255; ++length) {
      for (const bool extended : {false, true}) {
        for (const bool remote : {false, true}) {
          Frame frame;
          frame.id = j1939::pack(j1939::Identifier{6, pgn, 0x00, kController});
          frame.extended = extended;
          frame.remote = remote;
          frame.length = static_cast<std::uint8_t>(length);
          frame.data.fill(0xFF);  // nothing is asked for
          rig.receive(frame);
          ++fed;
        }
      }
    }
  }
  const ReceiveCounters counters = rig.gateway.received();
  EXPECT_EQ(counters.accepted + counters.ignored + counters.malformed, fed);
  EXPECT_EQ(rig.command(), VehicleCommand{});
  EXPECT_LE(rig.output.frames.size(), sent + 2);  // refusals: a request and a tyre of no place
}

TEST(VehicleGatewayHostile, CommandsForOthersDoNothing) {
  VehicleRig rig;
  rig.run(100ms);
  vehicle::Tc1 request;
  request.requested_gear = vehicle::gear_code(3);
  rig.receive(vehicle::encode(request, kController, 0x03));
  EXPECT_EQ(rig.command().gear, 0);
  rig.receive(vehicle::encode(request, kController, 0x00));
  EXPECT_EQ(rig.command().gear, 3);
}

TEST(VehicleGatewayHostile, SampleThatIsNoNumberIsSentAsError) {
  VehicleRig rig;
  VehicleSample broken = standing();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  broken.engine.speed_radps = kNan;
  broken.wheel_rate_radps.fill(kNan);
  broken.odometry = {kNan, kNan, kNan};
  rig.run(500ms, broken);
  EXPECT_EQ(rig.output.latest<vehicle::Eec1>().speed_radps, vehicle::kError);
  EXPECT_EQ(rig.output.latest<vehicle::Hrw>().front_left_mps, vehicle::kError);
  EXPECT_EQ(rig.output.latest<vehicle::Ebc2>().rear_1_left_mps, vehicle::kError);
  EXPECT_EQ(rig.output.latest<vehicle::GuidanceMachineInfo>().curvature_1pm, vehicle::kError);
  EXPECT_EQ(rig.output.latest<vehicle::MachineSelectedSpeed>().forward, vehicle::Switch::error);
  EXPECT_EQ(rig.output.latest<vehicle::MachineSelectedSpeed>().distance_m, 0.0);
}

TEST(VehicleGatewaySettings, RefusedWithTheValueFound) {
  const auto refused = [](auto change, const std::string& key) {
    VehicleGatewaySettings settings;
    change(settings);
    test::FrameRecorder output;
    try {
      VehicleGateway gateway(settings, output);
      ADD_FAILURE() << key << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(key));
      EXPECT_THAT(error.what(), testing::HasSubstr("allowed "));
    }
  };
  EXPECT_NO_THROW(validate(VehicleGatewaySettings{}));
  refused([](auto& s) { s.source_address = 254; }, "source_address: found 254, allowed 0 .. 253");
  refused([](auto& s) { s.serial = 0; }, "serial: found 0");
  refused([](auto& s) { s.name.manufacturer = 2048; }, "manufacturer");
  refused([](auto& s) { s.supply.power_on = -1ns; }, "power_on");
  refused([](auto& s) { s.processing_delay = 6ms; }, "processing_delay");
  refused([](auto& s) { s.gears_forward = 126; }, "gears_forward");
  refused([](auto& s) { s.gears_reverse = -1; }, "gears_reverse");
  refused([](auto& s) { s.wheelbase_m = 0.0; }, "wheelbase");
  refused([](auto& s) { s.wheelbase_m = std::numeric_limits<double>::quiet_NaN(); }, "wheelbase");
  refused([](auto& s) { s.maximum_front_steer_rad = 1.6; }, "maximum_front_steer");
  refused([](auto& s) { s.maximum_speed_mps = 65.0; }, "maximum_speed");
  refused([](auto& s) { s.full_brake_deceleration_mps2 = 0.0; }, "full_brake_deceleration");
  refused([](auto& s) { s.maximum_tyre_pressure_pa = 1e3; }, "maximum_tyre_pressure");
  refused([](auto& s) { s.stop_brake_share = 1.1; }, "stop_brake_share");
  refused([](auto& s) { s.timeouts.guidance = 0s; }, "timeouts.guidance");
}

}  // namespace
}  // namespace rigwire::emulators
