#include "sim/joystick/lever_script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

LeverKeyframe keyframe(Duration time, double left_x, unsigned buttons = 0) {
  LeverKeyframe keyframe;
  keyframe.time = time;
  keyframe.axes[0] = left_x;
  keyframe.buttons = buttons;
  return keyframe;
}

double left_x(const LeverScript& script, Duration time) {
  return script.at(kStart + time).axis(JoystickAxis::left_x);
}

TEST(LeverScript, LeversMoveLinearlyAndHoldTheEnds) {
  const LeverScript script({keyframe(1s, 0.0), keyframe(3s, 1.0), keyframe(4s, -1.0)}, false);
  EXPECT_DOUBLE_EQ(left_x(script, 0s), 0.0);
  EXPECT_DOUBLE_EQ(left_x(script, 1500ms), 0.25);
  EXPECT_DOUBLE_EQ(left_x(script, 3s), 1.0);
  EXPECT_DOUBLE_EQ(left_x(script, 3500ms), 0.0);
  EXPECT_DOUBLE_EQ(left_x(script, 100s), -1.0);
}

TEST(LeverScript, ButtonsChangeAtTheirKeyframe) {
  const LeverScript script({keyframe(0s, 0, 1), keyframe(1s, 0, 2)}, false);
  EXPECT_EQ(script.at(kStart + 999ms).buttons, 1U);
  EXPECT_EQ(script.at(kStart + 1s).buttons, 2U);
}

TEST(LeverScript, ARepeatingScriptStartsAgain) {
  const LeverScript script({keyframe(0s, 0.0), keyframe(2s, 1.0)}, true);
  EXPECT_DOUBLE_EQ(left_x(script, 2s), 0.0);
  EXPECT_DOUBLE_EQ(left_x(script, 21s), 0.5);
}

TEST(LeverScript, WithoutKeyframesTheLeversStandStill) {
  EXPECT_DOUBLE_EQ(left_x(LeverScript({}, false), 5s), 0.0);
}

TEST(LeverScript, WhatCannotBeIsRefused) {
  EXPECT_THROW(LeverScript({keyframe(1s, 0), keyframe(1s, 0)}, false), std::invalid_argument);
  EXPECT_THROW(LeverScript({keyframe(0s, 1.01)}, false), std::invalid_argument);
  EXPECT_THROW(LeverScript({keyframe(0s, 0)}, true), std::invalid_argument);
  LeverKeyframe dial = keyframe(0s, 0);
  dial.axes[static_cast<std::size_t>(JoystickAxis::dial)] = -0.1;
  EXPECT_THROW(LeverScript({dial}, false), std::invalid_argument);
}

TEST(LeversOf, TheIsoPatternGivesEachSectionItsLever) {
  ValveCommand command;
  command.opening = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
  const JoystickSample levers = levers_of(command, kStart);
  EXPECT_THAT(levers.axes, ::testing::ElementsAre(-0.1, 0.3, -0.4, 0.2, 0.5, 0.6, 0.0));
  command.floating[1] = true;
  EXPECT_EQ(levers_of(command, kStart).axis(JoystickAxis::right_y), 0.0);
}

}  // namespace
}  // namespace rigwire::sim
