#include "emulators/engine_controller/engine_controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocols/j1939/message.h"
#include "protocols/j1939/transport.h"
#include "protocols/vehicle/condition.h"
#include "protocols/vehicle/engine_configuration.h"
#include "protocols/vehicle/identification.h"
#include "protocols/vehicle/machine.h"
#include "recorder.h"

namespace rigwire::emulators {
namespace {

namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using namespace std::chrono_literals;
using protocols::can::Frame;

constexpr double kRevolution = vehicle::kRevolutionPerMinute_radps;
constexpr std::uint8_t kField = 0x27;

class EngineControllerTest : public testing::Test {
 protected:
  EngineControllerTest() : engine_(settings(), bus_) { run(300ms); }

  /// Idle 900 rpm, full load up to 2050 rpm, 700 Nm in the cylinders at most.
  static EngineControllerSettings settings() {
    EngineControllerSettings settings;
    settings.engine.full_load = {{{900 * kRevolution, 480.0, 40.0},
                                  {1200 * kRevolution, 630.0, 45.0},
                                  {1500 * kRevolution, 655.0, 45.0},
                                  {1750 * kRevolution, 620.0, 48.0},
                                  {2050 * kRevolution, 530.0, 52.0}}};
    settings.engine.reference_torque_nm = 700.0;
    settings.engine.high_idle_radps = 2250 * kRevolution;
    settings.engine.governor_nmsprad = 60.0;
    settings.engine.inertia_kgm2 = 1.8;
    return settings;
  }

  /// 400 Nm at 1900 rpm against 50 Nm friction, 580 Nm possible there.
  static PowerUnitSample working() {
    PowerUnitSample sample;
    sample.engine.speed_radps = 1900 * kRevolution;
    sample.engine.torque_nm = 400.0;
    sample.engine.friction_nm = 50.0;
    sample.engine.full_load_nm = 580.0;
    sample.engine.desired_radps = 1900 * kRevolution;
    sample.engine.coolant_c = 88.0;
    sample.engine.fuel_level_share = 0.6;
    sample.engine.fuel_rate_m3ps = 20.0 * vehicle::kLitrePerHour_m3ps;
    sample.engine.battery_v = 28.2;
    sample.dial_radps = 1900 * kRevolution;
    sample.dial_share = 0.87;
    sample.pump_pressure_pa = 25e6;
    return sample;
  }
  void run(Duration span) {
    for (const SimTime end = now_ + span; now_ < end; now_ += 10ms) {
      PowerUnitSample sample = working();
      sample.time = now_;
      engine_.update(sample);
    }
    engine_.advance(now_ - 1ns);
  }
  template <class Message>
  Message latest() {
    return bus_.latest<Message>();
  }
  /// With counter and checksum unless `counter` is 15.
  void ask(const vehicle::Tsc1& request, unsigned counter = 15, unsigned wrong = 0,
           std::uint8_t source = kField) {
    Frame frame = vehicle::encode(request, source);
    if (counter != 15) {
      frame.data[7] = static_cast<std::uint8_t>(0xF0U | counter);
      frame.data[7] = static_cast<std::uint8_t>(
          counter | ((vehicle::torque_speed_checksum(frame) ^ wrong) << 4U));
    }
    engine_.receive(now_, frame);
  }
  static vehicle::Tsc1 speed(double rpm, std::uint8_t priority = 2) {
    vehicle::Tsc1 request;
    request.override_mode = 1;
    request.priority = priority;
    request.speed_radps = rpm * kRevolution;
    return request;
  }
  double asked_rpm() const { return engine_.command().speed_radps.value_or(0.0) / kRevolution; }
  std::string text(std::uint32_t pgn) {
    bus_.frames.clear();
    engine_.receive(now_, j1939::make_request(kField, j1939::kGlobalAddress, pgn));
    run(1s);
    std::string bytes;
    for (const Frame& frame : bus_.of(pgn)) {
      bytes.append(frame.data.begin(), frame.data.begin() + frame.length);
    }
    for (const Frame& frame : bus_.of(j1939::kTransportDataPgn)) {
      bytes.append(frame.data.begin() + 1, frame.data.end());
    }
    return bytes;
  }
  vehicle::TroubleCodes troubles() {
    return *vehicle::decode_trouble_report(bus_.of(vehicle::kDm1Pgn).back().payload());
  }

  test::FrameRecorder bus_;
  EngineController engine_;
  SimTime now_ = kStart;
};

TEST_F(EngineControllerTest, ReportsTheEngineAtItsPeriods) {
  bus_.frames.clear();
  run(1s);
  EXPECT_EQ(bus_.of(61444).size(), 50U);
  EXPECT_EQ(bus_.of(61443).size(), 20U);
  EXPECT_EQ(bus_.of(61448).size(), 20U);
  EXPECT_EQ(bus_.of(vehicle::Lfe1::kGroup.pgn).size(), 10U);
  EXPECT_EQ(bus_.of(vehicle::Eec3::kGroup.pgn).size(), 4U);
  EXPECT_EQ(bus_.of(vehicle::Eflp1::kGroup.pgn).size(), 2U);
  EXPECT_EQ(bus_.of(vehicle::Et1::kGroup.pgn).size(), 1U);
  EXPECT_EQ(bus_.of(vehicle::kDm1Pgn).size(), 1U);
  EXPECT_DOUBLE_EQ(engine_.nominal_rate_hz(), 50 + 20 + 20 + 10 + 4 + 2 + 3 + 1);
  const auto eec1 = latest<vehicle::Eec1>();
  EXPECT_NEAR(eec1.speed_radps, 1900 * kRevolution, 0.07 * kRevolution);
  EXPECT_NEAR(eec1.actual_torque_share, 450.0 / 700.0, 0.005);
  EXPECT_NEAR(latest<vehicle::Eec2>().load_share, 450.0 / 630.0, 0.005);
  EXPECT_NEAR(latest<vehicle::Hpg>().pressure_pa, 25e6, 1000.0);
  EXPECT_NEAR(latest<vehicle::Eec3>().friction_torque_share, 50.0 / 700.0, 0.005);
  EXPECT_NEAR(latest<vehicle::Et1>().coolant_c, 88.0, 0.5);
  EXPECT_TRUE(std::isnan(latest<vehicle::Et1>().oil_c)) << "no sensor says it";
  EXPECT_NEAR(latest<vehicle::Dd1>().fuel_level_share, 0.6, 0.002);
  EXPECT_NEAR(latest<vehicle::Lfe1>().fuel_rate_m3ps, 20.0 * vehicle::kLitrePerHour_m3ps, 1e-8);
  EXPECT_NEAR(latest<vehicle::Vep1>().battery_v, 28.2, 0.025);
}

TEST_F(EngineControllerTest, ConfigurationComesEveryFiveSecondsByTransport) {
  bus_.frames.clear();
  run(5s);
  const auto announced = bus_.of(j1939::kTransportManagementPgn);
  ASSERT_EQ(announced.size(), 1U);
  EXPECT_EQ(announced[0].data[0], 32) << "to everybody";
  EXPECT_EQ(announced[0].data[1], vehicle::kEngineConfigurationBytes);
  std::vector<std::uint8_t> payload;
  for (const Frame& frame : bus_.of(j1939::kTransportDataPgn)) {
    payload.insert(payload.end(), frame.data.begin() + 1, frame.data.end());
  }
  payload.resize(vehicle::kEngineConfigurationBytes);
  const auto configuration = vehicle::decode_engine_configuration(payload);
  ASSERT_TRUE(configuration.ok());
  EXPECT_NEAR(configuration->speed_radps[0], 900 * kRevolution, 0.07 * kRevolution);
  EXPECT_NEAR(configuration->speed_radps[1], 2050 * kRevolution, 0.07 * kRevolution);
  EXPECT_NEAR(configuration->torque_share[0], 520.0 / 700.0, 0.005);
  EXPECT_NEAR(configuration->reference_torque_nm, 700.0, 0.5);
  EXPECT_NEAR(configuration->high_idle_radps, 2250 * kRevolution, 0.07 * kRevolution);
}

TEST_F(EngineControllerTest, ObeysASpeedRequestAndLetsGoWithoutIt) {
  ask(speed(1200));
  EXPECT_NEAR(asked_rpm(), 1200.0, 0.1);
  run(50ms);
  EXPECT_EQ(latest<vehicle::Eec1>().controlling_address, kField);
  run(100ms);
  EXPECT_EQ(engine_.command(), PowerUnitCommand{}) << "100 ms without a request";
  run(2s);
  EXPECT_EQ(troubles().count, 1U);
  EXPECT_EQ(troubles().codes[0].failure_mode, 9);
}

/// And the code of a request that was lost is one that was.
TEST_F(EngineControllerTest, WithoutSupplyItIsSilentAndTheEngineIsTheDials) {
  ask(speed(1200));
  const SimTime cut = now_ + 15ms;
  engine_.supply().begin({{cut - kStart, 500ms}, NoSupplyFault{}});
  run(100ms);
  EXPECT_EQ(engine_.command(), PowerUnitCommand{});
  bus_.frames.clear();
  ask(speed(1300));
  engine_.receive(now_, j1939::make_request(kField, j1939::kGlobalAddress,
                                            vehicle::kSoftwareIdentificationPgn));
  run(300ms);
  EXPECT_TRUE(bus_.frames.empty());
  EXPECT_EQ(engine_.command(), PowerUnitCommand{}) << "it has heard nothing";
  run(1s);
  ASSERT_FALSE(bus_.frames.empty());
  EXPECT_EQ(j1939::identify(bus_.frames.front().second)->pgn, j1939::kAddressClaimedPgn);
  EXPECT_GE(bus_.frames.front().first, cut + 500ms);
  EXPECT_NEAR(latest<vehicle::Eec1>().speed_radps, 1900 * kRevolution, 0.07 * kRevolution);
  // Half a millisecond behind the samples, as ever.
  for (const SimTime due : bus_.times(61444)) {
    EXPECT_EQ((due - kStart) % 10ms, 1ms);
  }
  ask(speed(1300));
  EXPECT_NEAR(asked_rpm(), 1300.0, 0.1);
}

TEST_F(EngineControllerTest, HigherPriorityCounts) {
  ask(speed(1200, 2));
  ask(speed(1500, 2), 15, 0, 0x30);
  EXPECT_NEAR(asked_rpm(), 1200.0, 0.1) << "equal: the first";
  ask(speed(1700, 1), 15, 0, 0x30);
  EXPECT_NEAR(asked_rpm(), 1700.0, 0.1);
}

TEST_F(EngineControllerTest, CounterAndChecksumMustBeRight) {
  ask(speed(1200), 0);
  EXPECT_NEAR(asked_rpm(), 1200.0, 0.1);
  ask(speed(1300), 1, 1);
  EXPECT_NEAR(asked_rpm(), 1200.0, 0.1) << "wrong checksum";
  ask(speed(1300), 1);
  EXPECT_NEAR(asked_rpm(), 1200.0, 0.1) << "the counter stands still";
  ask(speed(1300), 2);
  EXPECT_NEAR(asked_rpm(), 1300.0, 0.1);
  ask(speed(1400), 2);
  EXPECT_NEAR(asked_rpm(), 1300.0, 0.1) << "the counter stands still";
  run(2s);
  // In error, and then silent: two codes are longer than a frame and are broadcast.
  const auto data = bus_.of(j1939::kTransportDataPgn);
  ASSERT_GE(data.size(), 2U);
  const Frame& first = data[data.size() - 2];
  std::vector<std::uint8_t> report(first.data.begin() + 1, first.data.end());
  report.insert(report.end(), data.back().data.begin() + 1, data.back().data.begin() + 4);
  const auto codes = vehicle::decode_trouble_report(report);
  ASSERT_TRUE(codes.ok());
  ASSERT_EQ(codes->count, 2U);
  EXPECT_EQ(codes->codes[0].failure_mode, 9);
  EXPECT_EQ(codes->codes[1].failure_mode, 19);
  EXPECT_TRUE(codes->lamps.amber_warning);
}

TEST_F(EngineControllerTest, RequestWithoutItsNumberDoesNothing) {
  vehicle::Tsc1 request;
  request.override_mode = 1;
  ask(request);
  EXPECT_EQ(engine_.command(), PowerUnitCommand{});
  run(2s);
  EXPECT_EQ(latest<vehicle::Eec1>().torque_mode, 3) << "its own governor";
  EXPECT_EQ(troubles().count, 0U);
}

TEST_F(EngineControllerTest, LimitsHoldAgainstTheDial) {
  vehicle::Tsc1 limit;
  limit.override_mode = 3;
  limit.speed_radps = 1600 * kRevolution;
  limit.torque_share = 0.5;
  ask(limit);
  EXPECT_NEAR(asked_rpm(), 1600.0, 0.1);
  EXPECT_NEAR(engine_.command().torque_limit_share, 0.5, 0.005);
  limit.speed_radps = 2500 * kRevolution;
  ask(limit);
  EXPECT_NEAR(asked_rpm(), 1900.0, 0.1) << "the dial's";
}

TEST_F(EngineControllerTest, ClearingMendsNothingAndForgetsWhatWas) {
  ask(speed(1200));
  run(1500ms);
  ask(speed(1200));
  run(1500ms);
  ASSERT_EQ(troubles().count, 1U);
  EXPECT_EQ(troubles().codes[0].occurrences, 2);
  bus_.frames.clear();
  engine_.receive(now_, j1939::make_request(kField, 0x00, vehicle::kDm11Pgn));
  EXPECT_EQ(bus_.of(j1939::kAcknowledgementPgn).size(), 1U);
  run(2s);
  ASSERT_EQ(troubles().count, 1U) << "nobody asks yet";
  EXPECT_EQ(troubles().codes[0].occurrences, 1);
  vehicle::Tsc1 released;
  ask(speed(1200));
  ask(released);
  run(2s);
  EXPECT_EQ(troubles().count, 0U);
  bus_.frames.clear();
  engine_.receive(now_, j1939::make_request(kField, 0x00, vehicle::kDm2Pgn));
  run(10ms);
  EXPECT_EQ(vehicle::decode_trouble_report(bus_.of(vehicle::kDm2Pgn).back().payload())->count, 1U);
  engine_.receive(now_, j1939::make_request(kField, 0x00, vehicle::kDm3Pgn));
  bus_.frames.clear();
  engine_.receive(now_, j1939::make_request(kField, 0x00, vehicle::kDm2Pgn));
  run(10ms);
  EXPECT_EQ(vehicle::decode_trouble_report(bus_.of(vehicle::kDm2Pgn).back().payload())->count, 0U);
}

TEST_F(EngineControllerTest, SaysWhoItIs) {
  EXPECT_THAT(text(65260), testing::StartsWith("RGWRE0EX000000001*"));
  EXPECT_THAT(text(65259), testing::StartsWith("Rigwire*engine controller*1*"));
  EXPECT_THAT(text(65242), testing::StartsWith("\x01"
                                               "1.0*"));
  EXPECT_THAT(text(64965), testing::StartsWith("*1**engine*Rigwire**"));
  EXPECT_EQ(text(65253).size(), 8U);
}

}  // namespace
}  // namespace rigwire::emulators
