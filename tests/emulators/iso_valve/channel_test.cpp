#include "emulators/iso_valve/channel.h"

#include <gtest/gtest.h>

#include <limits>

namespace rigwire::emulators {
namespace {

namespace vehicle = protocols::vehicle;
using namespace protocols::iso11783;
using namespace std::chrono_literals;

constexpr SimTime at(Duration since_start) {
  return kStart + since_start;
}

ValveCommandMembers command(ValveState state, double share,
                            FailSafeMode fail_safe = FailSafeMode::block) {
  ValveCommandMembers members;
  members.flow_share = share;
  members.resolution = 0;
  members.state = static_cast<std::uint8_t>(state);
  members.fail_safe = static_cast<std::uint8_t>(fail_safe);
  return members;
}

TEST(IsoValveChannelTest, FollowsCommandsWhoseStateAndValueAgree) {
  IsoValveChannel channel;
  EXPECT_TRUE(channel.command(at(0ms), 1, command(ValveState::extend, 0.5)));
  EXPECT_DOUBLE_EQ(channel.opening(), 0.5);
  EXPECT_TRUE(channel.command(at(1ms), 1, command(ValveState::retract, 1.0)));
  EXPECT_DOUBLE_EQ(channel.opening(), -1.0);
  EXPECT_TRUE(channel.command(at(2ms), 1, command(ValveState::floating, vehicle::kNotAvailable)));
  EXPECT_TRUE(channel.floating());
  EXPECT_TRUE(channel.command(at(3ms), 1, command(ValveState::neutral, 0.0)));
  EXPECT_DOUBLE_EQ(channel.opening(), 0.0);
}

TEST(IsoValveChannelTest, IgnoresEveryDisagreementAndItFeedsNothing) {
  IsoValveChannel channel;
  channel.command(at(0ms), 1, command(ValveState::extend, 0.5));
  for (const auto& bad :
       {command(ValveState::neutral, 0.1), command(ValveState::floating, 0.5),
        command(ValveState::extend, vehicle::kNotAvailable),
        command(ValveState::retract, vehicle::kError), command(ValveState::extend, 1.004),
        command(ValveState::error, 0.0), command(ValveState::not_available, 0.0),
        command(static_cast<ValveState>(7), 0.2)}) {
    EXPECT_FALSE(channel.command(at(100ms), 1, bad));
    EXPECT_DOUBLE_EQ(channel.opening(), 0.5);
    EXPECT_EQ(channel.exit_reason(), ValveExit::out_of_range);
  }
  EXPECT_EQ(channel.next_event(), at(300ms));
}

TEST(IsoValveChannelTest, TheExtendedFlowCountsWhereTheResolutionSaysSoOrThereIsNoOther) {
  IsoValveChannel channel;
  ValveCommandMembers both = command(ValveState::extend, 0.5);
  both.extended_flow_share = 0.123;
  channel.command(at(0ms), 1, both);
  EXPECT_DOUBLE_EQ(channel.opening(), 0.5);
  both.resolution = 1;
  channel.command(at(1ms), 1, both);
  EXPECT_DOUBLE_EQ(channel.opening(), 0.123);
  both.resolution = 3;
  both.flow_share = vehicle::kNotAvailable;
  channel.command(at(2ms), 1, both);
  EXPECT_DOUBLE_EQ(channel.opening(), 0.123);
}

TEST(IsoValveChannelTest, SilenceEndsInNeutralAtItsExactInstantAndAsksForNeutral) {
  IsoValveChannel channel;
  channel.command(at(10ms), 1, command(ValveState::extend, 0.5));
  channel.advance(at(310ms) - 1ns);
  EXPECT_DOUBLE_EQ(channel.opening(), 0.5);
  channel.command(at(310ms), 1, command(ValveState::extend, 0.6));  // at that very instant: late
  EXPECT_DOUBLE_EQ(channel.opening(), 0.0);
  EXPECT_EQ(channel.exit_reason(), ValveExit::command_timeout);
  channel.command(at(400ms), 1, command(ValveState::neutral, 0.0));
  EXPECT_EQ(channel.exit_reason(), ValveExit::none);
  channel.command(at(450ms), 1, command(ValveState::extend, 0.6));
  EXPECT_DOUBLE_EQ(channel.opening(), 0.6);
}

TEST(IsoValveChannelTest, TheFailSafeModeOfTheLastCommandDecidesWhatSilenceDoes) {
  IsoValveChannel channel;
  channel.command(at(0ms), 1, command(ValveState::extend, 0.5, FailSafeMode::floating));
  channel.advance(at(1s));
  EXPECT_TRUE(channel.floating());
  EXPECT_TRUE(channel.timed_out());
}

TEST(IsoValveChannelTest, TheFirstCommanderKeepsTheValveUntilItIsSilent) {
  IsoValveChannel channel;
  channel.command(at(0ms), 1, command(ValveState::extend, 0.5));
  EXPECT_FALSE(channel.command(at(10ms), 2, command(ValveState::neutral, 0.0)));
  EXPECT_DOUBLE_EQ(channel.opening(), 0.5);
  EXPECT_TRUE(channel.command(at(400ms), 2, command(ValveState::neutral, 0.0)));
}

TEST(IsoValveChannelTest, TheOperatorBeatsTheBusUntilBothWereInNeutral) {
  IsoValveChannel channel;
  channel.command(at(0ms), 1, command(ValveState::extend, 0.5));
  channel.lever(at(0ms), 0.0);
  EXPECT_DOUBLE_EQ(channel.opening(), 0.5);
  channel.lever(at(20ms), -0.3);
  EXPECT_DOUBLE_EQ(channel.opening(), -0.3);
  channel.command(at(40ms), 1, command(ValveState::extend, 0.5));
  EXPECT_DOUBLE_EQ(channel.opening(), -0.3);
  EXPECT_EQ(channel.exit_reason(), ValveExit::operator_override);
  channel.lever(at(60ms), 0.0);
  channel.command(at(70ms), 1, command(ValveState::extend, 0.5));
  EXPECT_DOUBLE_EQ(channel.opening(), 0.0) << "the bus has not been in neutral";
  channel.command(at(80ms), 1, command(ValveState::neutral, 0.0));
  channel.command(at(90ms), 1, command(ValveState::extend, 0.5));
  EXPECT_DOUBLE_EQ(channel.opening(), 0.5);
}

TEST(IsoValveChannelTest, ASilentLeverIsInNeutralAndOneThatWakesUpOffNeutralDoesNothing) {
  IsoValveChannel channel;
  channel.lever(at(0ms), 0.8);
  EXPECT_DOUBLE_EQ(channel.opening(), 0.0);
  channel.lever(at(100ms), 0.0);
  channel.lever(at(200ms), 0.8);
  EXPECT_DOUBLE_EQ(channel.opening(), 0.8);
  channel.lever(at(400ms), std::numeric_limits<double>::quiet_NaN());  // feeds nothing
  channel.advance(at(500ms));
  EXPECT_DOUBLE_EQ(channel.opening(), 0.0);
}

}  // namespace
}  // namespace rigwire::emulators
