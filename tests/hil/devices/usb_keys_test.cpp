// What hangs on USB, and what moves the levers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "findings_of.h"
#include "hil/configuration/outline.h"
#include "hil/devices/device_types.h"
#include "hil/devices/ublox.h"
#include "hil/devices/usb_joystick.h"

namespace rigwire::hil {
namespace {

using ::testing::HasSubstr;

TEST(UsbKeys, AScriptBecomesKeyframes) {
  UsbJoystickConfiguration levers;
  EXPECT_EQ(
      findings_of("repeat: true\n"
                  "script:\n"
                  "  - {at: 0 s}\n"
                  "  - {at: 2 s, left_x: 1, right_pedal: -0.5, dial: 0.25, buttons: [1, 16]}\n",
                  levers),
      "");
  const JoystickSample sample = lever_script(levers).at(kStart + std::chrono::seconds(1));
  EXPECT_DOUBLE_EQ(sample.axis(JoystickAxis::left_x), 0.5);
  EXPECT_DOUBLE_EQ(sample.axis(JoystickAxis::right_pedal), -0.25);
  EXPECT_DOUBLE_EQ(sample.axis(JoystickAxis::dial), 0.125);
  EXPECT_EQ(levers.script[1].buttons.size(), 2U);
}

TEST(UsbKeys, WhatNoLeverCanDoIsRefused) {
  const auto findings = [](const std::string& yaml) {
    UsbJoystickConfiguration levers;
    return findings_of(yaml, levers);
  };
  EXPECT_THAT(findings("script: [{at: 0 s, left_x: 1.5}]\n"), HasSubstr("left_x"));
  EXPECT_THAT(findings("script: [{at: 0 s, buttons: [17]}]\n"), HasSubstr("buttons"));
  EXPECT_THAT(findings("script: [{at: 0 s, buttons: [1.5]}]\n"), HasSubstr("whole numbers"));
  EXPECT_THAT(findings("script: [{left_x: 1}]\n"), HasSubstr("at"));
  EXPECT_THAT(findings("script: [{at: 1 s}, {at: 1 s}]\n"), HasSubstr("keyframe 1"));
  EXPECT_THAT(findings("repeat: true\n"), HasSubstr("repeats"));
  EXPECT_THAT(findings("source: autopilot\n"), HasSubstr("commands"));
}

TEST(UsbKeys, AReceiverOnUsbHasAPlugToPull) {
  UbloxConfiguration receiver;
  EXPECT_EQ(findings_of("wire: usb\nfaults: [{type: unplugged, at: 5 s, for: 2 s}]\n", receiver),
            "");
  EXPECT_EQ(receiver.faults.at(0).when.length, std::chrono::seconds(2));
}

}  // namespace
}  // namespace rigwire::hil
