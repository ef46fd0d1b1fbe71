#include "emulators/valve_driver/valve_driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "valve_driver_fixture.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::modbus;
using namespace std::chrono_literals;
namespace reg = valve_registers;
using reg::FaultCode;
using ::testing::DoubleNear;
using ::testing::Each;

constexpr SimTime valve_supervision_at(Duration since_start) {
  return kStart + since_start;
}

TEST_F(ValveDriverTest, TheWatchdogTripsAtItsExactInstant) {
  write(valve_supervision_at(10ms), 0, {1, 500});
  EXPECT_EQ(driver_.next_event(), valve_supervision_at(210ms));
  driver_.advance(valve_supervision_at(210ms) - 1ns);
  EXPECT_DOUBLE_EQ(opening(0), 0.5);
  driver_.advance(valve_supervision_at(500ms));  // late: the instant is still the right one
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
  EXPECT_EQ(driver_.command().time, valve_supervision_at(210ms));
  EXPECT_EQ(driver_.fault(), FaultCode::watchdog);
  EXPECT_EQ(input(valve_supervision_at(500ms), reg::kFaultCode), 1);
  EXPECT_EQ(input(valve_supervision_at(500ms), reg::kStatus),
            reg::kStatusFault | reg::kStatusWatchdogTripped);
  EXPECT_EQ(driver_.next_event(), kNever);
}

TEST_F(ValveDriverTest, ARequestAtTheInstantOfExpiryIsTooLate) {
  write(kStart, 0, {1, 500});
  write(valve_supervision_at(200ms), 1, {600});
  EXPECT_EQ(driver_.fault(), FaultCode::watchdog);
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
}

TEST_F(ValveDriverTest, EveryServedRequestFeedsTheWatchdog) {
  write(kStart, 0, {1, 500});
  input(valve_supervision_at(150ms), reg::kStatus);
  EXPECT_EQ(driver_.next_event(), valve_supervision_at(350ms));
}

TEST_F(ValveDriverTest, WhatIsNotServedDoesNotFeedTheWatchdog) {
  write(kStart, 0, {1, 500});
  ask(valve_supervision_at(50ms), ReadRegisters{RegisterTable::input, 0, 1}, 9);  // another unit
  ask(valve_supervision_at(60ms), ReadRegisters{RegisterTable::input, 500, 1});   // exception 02
  write(valve_supervision_at(70ms), 1, {2000});                                   // exception 03
  server_.receive(valve_supervision_at(80ms), 1, adu_of(Bytes{99}));              // exception 01
  server_.receive(valve_supervision_at(90ms), 1,
                  adu_of(Bytes{4, 0, 0, 0, 1}, 1, 1, 7));  // another protocol
  EXPECT_EQ(driver_.next_event(), valve_supervision_at(200ms));
}

TEST_F(ValveDriverTest, WithHeartbeatSourceOnlyAChangedHeartbeatFeeds) {
  write(kStart, reg::kWatchdogSource, {1});
  write(valve_supervision_at(10ms), 0, {1, 500});
  input(valve_supervision_at(100ms), 0);
  write(valve_supervision_at(110ms), reg::kHeartbeat, {0});  // no change
  EXPECT_EQ(driver_.next_event(), valve_supervision_at(210ms));
  write(valve_supervision_at(120ms), reg::kHeartbeat, {1});
  EXPECT_EQ(driver_.next_event(), valve_supervision_at(320ms));
}

TEST_F(ValveDriverTest, TheWatchdogTakesZeroOr20To5000) {
  for (const int good : {0, 20, 5000}) {
    EXPECT_EQ(write(kStart, reg::kWatchdog, {good}), done(reg::kWatchdog, 1));
  }
  for (const int bad : {1, 19, 5001, 65535}) {
    EXPECT_EQ(write(kStart, reg::kWatchdog, {bad}), refused(ExceptionCode::illegal_data_value));
  }
  write(kStart, reg::kWatchdog, {0});
  write(kStart, 0, {1, 500});
  EXPECT_EQ(driver_.next_event(), kNever);
}

TEST_F(ValveDriverTest, AFaultStaysUntilTheResetEdge) {
  write(kStart, 0, {3, 500});  // the reset bit is set from the start: no later edge
  driver_.advance(valve_supervision_at(200ms));
  ASSERT_EQ(driver_.fault(), FaultCode::watchdog);
  write(valve_supervision_at(300ms), 0, {3, 500});
  EXPECT_EQ(driver_.fault(), FaultCode::watchdog);
  write(valve_supervision_at(310ms), 0, {1, 500});
  EXPECT_EQ(driver_.fault(), FaultCode::watchdog);
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
  write(valve_supervision_at(320ms), 0, {3});
  EXPECT_EQ(driver_.fault(), FaultCode::none);
  EXPECT_TRUE(driver_.enabled());
  EXPECT_DOUBLE_EQ(opening(0), 0.0) << "a command from before the fault came back";
  EXPECT_EQ(driver_.next_event(), valve_supervision_at(520ms));
}

TEST_F(ValveDriverTest, TheHoldReactionKeepsTheOutputUntilTheMasterClearsEnable) {
  write(kStart, reg::kReaction, {1});
  write(kStart, 0, {1, 500});
  driver_.advance(valve_supervision_at(1s));
  EXPECT_EQ(driver_.fault(), FaultCode::watchdog);
  EXPECT_DOUBLE_EQ(opening(0), 0.5);
  write(valve_supervision_at(2s), 1, {100});
  EXPECT_DOUBLE_EQ(opening(0), 0.5);
  write(valve_supervision_at(3s), 0, {0});
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
  write(valve_supervision_at(4s), 0, {1});
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
}

TEST_F(ValveDriverTest, TheFloatReactionFloatsTheFittedSections) {
  write(kStart, reg::kReaction, {2});
  write(kStart, 0, {1, 500});
  driver_.advance(valve_supervision_at(200ms));
  EXPECT_THAT(driver_.command().floating,
              ::testing::ElementsAre(true, true, true, true, false, false, false, false));
  EXPECT_THAT(driver_.command().opening, Each(0.0));
  write(valve_supervision_at(300ms), 0, {2});
  EXPECT_THAT(driver_.command().floating, Each(false));
}

TEST_F(ValveDriverTest, QuickStopBeatsFloatAndCommandsStartFromZeroAfterwards) {
  write(kStart, 0, {1 + 4, 500});
  EXPECT_TRUE(driver_.command().floating[0]);
  write(valve_supervision_at(1ms), 0, {1 + 4 + 8, 500});
  EXPECT_THAT(driver_.command().floating, Each(false));
  EXPECT_THAT(driver_.command().opening, Each(0.0));
  write(valve_supervision_at(2ms), 0, {1});
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
  write(valve_supervision_at(3ms), 1, {300});
  EXPECT_DOUBLE_EQ(opening(0), 0.3);
}

TEST_F(ValveDriverTest, UnknownControlBitsAreRefused) {
  EXPECT_EQ(write(kStart, 0, {16}), refused(ExceptionCode::illegal_data_value));
}

TEST_F(ValveDriverTest, HeartbeatIsEchoedAndSkippedStepsAreCounted) {
  write(kStart, reg::kHeartbeat, {50});  // the first one counts nothing
  write(kStart, reg::kHeartbeat, {51});
  EXPECT_EQ(input(kStart, reg::kMissedCycles), 0);
  write(kStart, reg::kHeartbeat, {54});
  EXPECT_EQ(input(kStart, reg::kHeartbeatEcho), 54);
  EXPECT_EQ(input(kStart, reg::kMissedCycles), 2);
  write(kStart, reg::kHeartbeat, {0});  // the master started anew
  EXPECT_EQ(input(kStart, reg::kMissedCycles), 2);
}

TEST_F(ValveDriverTest, RampsRiseAndFallAtTheirOwnRates) {
  write(kStart, reg::kWatchdog, {0});
  write(kStart, 20, {0, 0, 1000, 100});  // up in 1 s, down in 0.1 s
  write(kStart, 0, {1, 500});
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
  EXPECT_EQ(driver_.next_event(), valve_supervision_at(1ms));
  driver_.advance(valve_supervision_at(250ms));
  EXPECT_THAT(opening(0), DoubleNear(0.25, 1e-9));
  driver_.advance(valve_supervision_at(500ms));
  EXPECT_DOUBLE_EQ(opening(0), 0.5);
  EXPECT_EQ(driver_.next_event(), kNever);
  write(valve_supervision_at(1s), 1, {-500});
  driver_.advance(valve_supervision_at(1040ms));
  EXPECT_THAT(opening(0), DoubleNear(0.1, 1e-9));
  driver_.advance(valve_supervision_at(1s + 50ms + 300ms));
  EXPECT_THAT(opening(0), DoubleNear(-0.3, 1e-9));
}

TEST_F(ValveDriverTest, TheWatchdogGoesPastTheRamp) {
  write(kStart, 20, {0, 0, 0, 5000});
  write(kStart, 0, {1, 1000});
  driver_.advance(valve_supervision_at(200ms));
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
  EXPECT_EQ(driver_.command().time, valve_supervision_at(200ms));
}

TEST_F(ValveDriverTest, DeadBandGainAndPolarityShapeTheSetPoint) {
  write(kStart, 26, {100, 200, 0, 0, 500, -1});  // boom
  write(kStart, 0, {1, 0, 400, 0, 0});
  EXPECT_DOUBLE_EQ(opening(1), -(0.1 + 0.9 * 0.2));
  write(kStart, 2, {-400});
  EXPECT_DOUBLE_EQ(opening(1), 0.2 + 0.8 * 0.2);
  write(kStart, 2, {0});
  EXPECT_DOUBLE_EQ(opening(1), 0.0);
  EXPECT_EQ(write(kStart, 31, {0}), refused(ExceptionCode::illegal_data_value));
  EXPECT_EQ(write(kStart, 26, {501}), refused(ExceptionCode::illegal_data_value));
}

}  // namespace
}  // namespace rigwire::emulators
