#include "protocols/iso11783/auxiliary_valve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rigwire::protocols::iso11783 {
namespace {

using can::Frame;
using ::testing::ElementsAreArray;

std::array<std::uint8_t, 8> bytes_of(const Frame& frame) {
  return frame.data;
}

TEST(AuxiliaryValveCommandTest, IsTheFrameThatWasWorkedByHand) {
  AuxiliaryValveCommand command;
  command.flow_share = 0.5;  // 125 counts of 0.4 %
  command.state = static_cast<std::uint8_t>(ValveState::extend);
  command.fail_safe = static_cast<std::uint8_t>(FailSafeMode::block);
  const Frame frame = encode(2, command, 0x26);
  EXPECT_EQ(frame.id, 0x0CFE3226U);
  EXPECT_TRUE(frame.extended);
  // State 1 in the low nibble, reserved bits ones, fail-safe 0 in the top two bits.
  EXPECT_THAT(bytes_of(frame), ElementsAreArray({0x7D, 0xFF, 0x31, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}));
}

TEST(AuxiliaryValveCommandTest, TheExtendedFlowHas16BitsOfTheSamePercent) {
  AuxiliaryValveCommand command;
  command.resolution = 1;
  command.state = static_cast<std::uint8_t>(ValveState::retract);
  command.fail_safe = static_cast<std::uint8_t>(FailSafeMode::floating);
  command.extended_flow_share = 0.25;  // 16000 counts
  EXPECT_THAT(bytes_of(encode(15, command, 0)),
              ElementsAreArray({0xFF, 0xFD, 0x72, 0x80, 0x3E, 0xFF, 0xFF, 0xFF}));
}

TEST(AuxiliaryValveFlow, SharesAndPressuresLandOnTheirBytes) {
  AuxiliaryValveMeasuredFlow flow;
  flow.extend_share = 0.5;
  flow.retract_share = -0.5;
  flow.extend_pressure_pa = 10e6;    // 2000 counts
  flow.retract_pressure_pa = 0.5e6;  // 100
  flow.return_pressure_pa = 320e3;   // 20
  flow.limit = 1;
  const Frame frame = encode(9, flow, 0x80);
  EXPECT_EQ(frame.id, 0x0CFE2980U);
  EXPECT_THAT(bytes_of(frame), ElementsAreArray({0xAF, 0x4B, 0xD0, 0x07, 0x64, 0x00, 0x14, 0x3F}));
}

TEST(AuxiliaryValveEstimateTest, NamesStateLimitAndReason) {
  AuxiliaryValveEstimate estimate;
  estimate.extend_share = 0.0;
  estimate.retract_share = 1.0;
  estimate.state = 2;
  estimate.fail_safe = 0;
  estimate.limit = 0;
  estimate.exit_reason = 5;
  EXPECT_THAT(bytes_of(encode(0, estimate, 0x80)),
              ElementsAreArray({0x00, 0xFA, 0x32, 0x1F, 0xC5, 0xFF, 0xFF, 0xFF}));
}

TEST(AuxiliaryValvePosition, NeutralIsTheMiddleOfBothFields) {
  AuxiliaryValveMeasuredPosition position;
  position.position_share = 0.0;
  position.position_m = 0.0;
  position.state = 0;
  EXPECT_THAT(bytes_of(encode(1, position, 0x80)),
              ElementsAreArray({0x00, 0x7D, 0xF0, 0x00, 0x7D, 0xFF, 0xFF, 0xFF}));
}

TEST(AuxiliaryValves, EveryValveHasItsOwnGroupAndNoOtherTakesIt) {
  for (unsigned valve = 0; valve < kAuxiliaryValves; ++valve) {
    AuxiliaryValveCommand command;
    command.flow_share = 0.2;
    const Frame frame = encode(valve, command, 3);
    EXPECT_EQ(valve_of<AuxiliaryValveCommand>(65072 + valve), valve);
    const auto decoded = decode<AuxiliaryValveCommand>(valve, frame);
    ASSERT_TRUE(decoded.ok());
    EXPECT_NEAR(decoded->flow_share, 0.2, 0.002);
    EXPECT_FALSE(decode<AuxiliaryValveCommand>((valve + 1) % kAuxiliaryValves, frame).ok());
  }
  EXPECT_FALSE(valve_of<AuxiliaryValveCommand>(65071));
  EXPECT_FALSE(valve_of<AuxiliaryValveCommand>(65088));
}

TEST(AuxiliaryValves, EveryByteOfACommandDecodesAndEncodesToTheSame) {
  for (unsigned raw = 0; raw <= 0xFF; ++raw) {
    Frame frame = encode(4, AuxiliaryValveCommand{}, 7);
    frame.data[0] = static_cast<std::uint8_t>(raw);
    const auto decoded = decode<AuxiliaryValveCommand>(4, frame);
    ASSERT_TRUE(decoded.ok());
    EXPECT_EQ(std::isfinite(decoded->flow_share), raw <= 250);
    if (raw <= 250) {
      EXPECT_EQ(encode(4, *decoded, 7).data, frame.data);
    }
  }
}

TEST(AuxiliaryValveLayouts, CarryTheParameterNumbersThatAreListedForThem) {
  const auto layouts = message_layouts(0, kAuxiliaryValves, 0x80, "valves");
  const auto spn = [&](const char* message, const char* field) {
    const auto layout = std::ranges::find(layouts, message, &can::OwnedMessage::name);
    EXPECT_NE(layout, layouts.end()) << message;
    const auto signal = std::ranges::find(layout->signals, field, &can::OwnedSignal::name);
    EXPECT_NE(signal, layout->signals.end()) << field;
    return signal->text;
  };
  EXPECT_EQ(spn("av00c", "port_flow"), "SPN 1907");
  EXPECT_EQ(spn("av07c", "port_flow"), "SPN 1991");
  EXPECT_EQ(spn("av12c", "state"), "SPN 2308");
  EXPECT_EQ(spn("av14c", "resolution_mode"), "SPN 7886");
  EXPECT_EQ(spn("av09mf", "extend_port_flow"), "SPN 2263");
  EXPECT_EQ(spn("av09mf", "return_port_pressure"), "SPN 2270");
  EXPECT_EQ(spn("av09mf", "limit_status"), "SPN 5178");
}

}  // namespace
}  // namespace rigwire::protocols::iso11783
