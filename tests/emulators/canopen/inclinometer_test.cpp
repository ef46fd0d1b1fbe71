#include "emulators/canopen/inclinometer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "inclinometer_rig.h"
#include "supply_cuts.h"

namespace rigwire::emulators {
namespace {

using protocols::canopen::NetworkCommand;
using protocols::canopen::NodeState;
using protocols::canopen::SdoAbort;
using testing::ElementsAre;

constexpr double kInclinometerNoNumber = std::numeric_limits<double>::quiet_NaN();

std::uint32_t inclinometer_code(SdoAbort abort) {
  return static_cast<std::uint32_t>(abort);
}

TEST(Inclinometer, BootsUpAsNodeTenAndSaysWhatItIs) {
  InclinometerSettings settings;
  EXPECT_EQ(settings.node.node_id, 10);
  test::FrameRecorder output;
  VolatileMemory memory;
  Inclinometer device(settings, memory, output);
  device.advance(kStart + 1s);
  ASSERT_EQ(output.frames.size(), 1U);
  EXPECT_EQ(output.frames[0].first, kStart + 200ms + 200us);
  EXPECT_EQ(output.frames[0].second.id, 0x70AU);
  EXPECT_THAT(output.frames[0].second.payload(), ElementsAre(0x00));
  EXPECT_EQ(device.node().state(), NodeState::pre_operational);

  InclinometerRig rig;
  rig.boot();
  EXPECT_EQ(rig.read(0x1000), 0x0004019AU);
  EXPECT_EQ(rig.read(0x1018, 1), 0x159U);
  EXPECT_EQ(rig.read(0x6000), 10U);
}

TEST(Inclinometer, AbortCodesAreExact) {
  InclinometerRig rig;
  rig.boot();
  EXPECT_EQ(rig.write(0x6010, 0, 1, 2), inclinometer_code(SdoAbort::write_of_read_only));
  EXPECT_EQ(rig.write(0x6015, 0, 1, 2), inclinometer_code(SdoAbort::no_such_object));
  EXPECT_EQ(rig.write(0x2044, 0, 1, 1), inclinometer_code(SdoAbort::no_such_object));
  EXPECT_EQ(rig.write(0x6011, 1, 1, 1), inclinometer_code(SdoAbort::no_such_subindex));
  EXPECT_EQ(rig.write(0x6011, 0, 1, 2), inclinometer_code(SdoAbort::too_long));
  EXPECT_EQ(rig.write(0x6112, 0, 1, 2), inclinometer_code(SdoAbort::too_short));
  EXPECT_EQ(rig.write(0x1010, 1, 0x11111111, 4), inclinometer_code(SdoAbort::cannot_store));
}

/// 12.34 deg is 1234 = 04D2, -12.34 deg is FB2E.
TEST(Inclinometer, PdosCarryTheSlopesAfterEachSync) {
  InclinometerRig rig;
  const double sine = std::sin(12.34 * kDegree);
  rig.force = {kGravity_mps2 * sine, -kGravity_mps2 * sine,
               kGravity_mps2 * std::sqrt(1.0 - 2.0 * sine * sine)};
  rig.start();
  rig.run(1s);
  EXPECT_TRUE(rig.output.with_id(0x1A0).empty());
  rig.receive(0x80, {});
  ASSERT_EQ(rig.output.with_id(0x1A0).size(), 1U);
  EXPECT_EQ(rig.output.with_id(0x1A0)[0].first, rig.now + 200us);
  EXPECT_THAT(rig.output.with_id(0x1A0)[0].second.payload(), ElementsAre(0xD2, 0x04, 0x2E, 0xFB));
  ASSERT_EQ(rig.output.with_id(0x2A0).size(), 1U);
  EXPECT_THAT(rig.output.with_id(0x2A0)[0].second.payload(),
              ElementsAre(0xD2, 0x04, 0, 0, 0x2E, 0xFB, 0xFF, 0xFF));
}

TEST(Inclinometer, PdoOnItsTimerAndOnChange) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.transmission_type = 255;
  settings.event_timer_ms = 20;
  settings.heartbeat_ms = 500;
  InclinometerRig rig(settings);
  EXPECT_DOUBLE_EQ(rig.device.nominal_rate_hz(), 52.0);
  rig.start();
  rig.run(1s);
  EXPECT_EQ(rig.output.with_id(0x1A0).size(), 51U);
  EXPECT_EQ(rig.write(0x1800, 5, 0, 2), 0U);
  EXPECT_EQ(rig.write(0x1800, 2, 254, 1), 0U);
  const std::size_t before = rig.output.with_id(0x1A0).size();
  rig.run(100ms);
  EXPECT_EQ(rig.output.with_id(0x1A0).size(), before);
  rig.tilt(1.0 * kDegree, 0.0);
  rig.run(100ms);
  EXPECT_EQ(rig.output.with_id(0x1A0).size(), before + 1);
  // A write that turns the value is a change, too; the PDO leaves before the answer.
  rig.receive(0x620,
              protocols::canopen::make_download({0x6011, 0}, std::array<std::uint8_t, 1>{1}));
  EXPECT_EQ(rig.output.with_id(0x1A0).size(), before + 2);
  EXPECT_THAT(rig.output.with_id(0x1A0).back().second.payload(), ElementsAre(0x9C, 0xFF, 0, 0));
}

TEST(Inclinometer, FreeFallHoldsTheSlopesAndRaisesBothErrors) {
  InclinometerRig rig;
  rig.boot();
  rig.tilt(7.0 * kDegree, 0.0);
  rig.measure();
  rig.force = {};
  rig.run(100ms);
  EXPECT_EQ(rig.slope16(0x6010), 700);
  EXPECT_EQ(rig.read(0x1001), 1U);
  const auto told = rig.output.with_id(0xA0);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_THAT(told[0].second.payload(), ElementsAre(0x10, 0x50, 0x01, 0, 0, 0, 0, 0));
  EXPECT_THAT(told[1].second.payload(), ElementsAre(0x20, 0x50, 0x01, 0, 0, 0, 0, 0));
  EXPECT_EQ(rig.read(0x1003), 2U);
  EXPECT_EQ(rig.read(0x1003, 1), 0x5020U);
  EXPECT_EQ(rig.read(0x1003, 2), 0x5010U);
  EXPECT_EQ(rig.write(0x6012, 0, 0, 2), inclinometer_code(SdoAbort::not_in_this_state));
  EXPECT_EQ(rig.write(0x6122, 0, 0, 4), inclinometer_code(SdoAbort::not_in_this_state));
  // The slopes follow as soon as there is a direction again; the length does not matter.
  rig.force = {0.0, 0.0, 1.01 * Inclinometer::kLeastForce_mps2};
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), 0);
  EXPECT_EQ(rig.read(0x1001), 0U);
  EXPECT_THAT(rig.output.with_id(0xA0).back().second.payload(),
              ElementsAre(0, 0, 0, 0, 0, 0, 0, 0));
}

TEST(Inclinometer, BeyondItsRangeTheSlopeStaysAtTheLimitAndOneAxisComplains) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.range_rad = 45.0 * kDegree;
  InclinometerRig rig(settings);
  rig.boot();
  rig.tilt(44.9 * kDegree, 0.0);
  rig.measure();
  EXPECT_TRUE(rig.output.with_id(0xA0).empty());
  rig.tilt(-60.0 * kDegree, 0.0);
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), -4500);
  ASSERT_EQ(rig.output.with_id(0xA0).size(), 1U);
  EXPECT_THAT(rig.output.with_id(0xA0)[0].second.payload(),
              ElementsAre(0x10, 0x50, 0x01, 0, 0, 0, 0, 0));
  EXPECT_EQ(rig.write(0x6022, 0, 0, 2), 0U);  // the other axis measures
  // The other axis leaves its range, then the first comes back: the register keeps its bit.
  rig.tilt(0.0, 50.0 * kDegree);
  rig.measure();
  ASSERT_EQ(rig.output.with_id(0xA0).size(), 3U);
  EXPECT_THAT(rig.output.with_id(0xA0)[1].second.payload(),
              ElementsAre(0x20, 0x50, 0x01, 0, 0, 0, 0, 0));
  EXPECT_THAT(rig.output.with_id(0xA0)[2].second.payload(), ElementsAre(0, 0, 0x01, 0, 0, 0, 0, 0));
  EXPECT_EQ(rig.slope16(0x6020), 4500);
}

TEST(Inclinometer, ErrorAtPowerOnIsToldAfterTheBootUp) {
  InclinometerRig rig;
  rig.force = {};
  rig.run(1s);
  ASSERT_EQ(rig.output.frames.size(), 3U);
  EXPECT_EQ(rig.output.frames[0].second.id, 0x720U);
  EXPECT_EQ(rig.output.frames[1].second.id, 0x0A0U);
  rig.command(NetworkCommand::reset_node);
  rig.run(1s);
  ASSERT_EQ(rig.output.frames.size(), 6U);  // told anew
  EXPECT_EQ(rig.read(0x1001), 1U);
}

TEST(Inclinometer, SavedParametersSurviveThePowerCycleOthersDoNot) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.supply.faults = rigwire::test::cuts({2s, 4s});
  InclinometerRig rig(settings);
  rig.boot();
  rig.tilt(10.0 * kDegree, 0.0);
  rig.measure();
  EXPECT_EQ(rig.write(0x6011, 0, 2, 1), 0U);
  EXPECT_EQ(rig.write(0x6012, 0, 0, 2), 0U);
  EXPECT_EQ(rig.write(0x2043, 0, 3, 1), 0U);
  EXPECT_EQ(rig.write(0x1010, 1, 0x65766173, 4), 0U);
  EXPECT_EQ(rig.write(0x6000, 0, 100, 2), 0U);  // not saved
  rig.run(1800ms);                              // off at 2 s
  rig.tilt(15.0 * kDegree, 0.0);
  rig.run(700ms);
  EXPECT_EQ(rig.read(0x6000), 10U);
  EXPECT_EQ(rig.read(0x2043), 3U);
  EXPECT_EQ(rig.slope16(0x6013), -1000);
  EXPECT_EQ(rig.slope16(0x6010), 500);  // the filter knows nothing of before
  EXPECT_EQ(rig.write(0x1011, 1, 0x64616F6C, 4), 0U);
  rig.run(2s);
  EXPECT_EQ(rig.slope16(0x6010), 1500);
  EXPECT_EQ(rig.read(0x2043), 0U);
}

TEST(Inclinometer, SwitchedOffItIsSilentAndTakesNoSample) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.supply.power_on = 100ms;
  settings.supply.faults = rigwire::test::cuts({1s});
  InclinometerRig rig(settings);
  EXPECT_EQ(rig.device.sample_plan().first, kStart + 100ms);
  rig.run(1100ms);
  const std::size_t before = rig.output.frames.size();
  rig.force = {kInclinometerNoNumber, 0.0, 0.0};
  rig.run(300ms);
  EXPECT_EQ(rig.output.frames.size(), before);
}

TEST(InclinometerSettings, RefusedWithTheValueFound) {
  const auto refused = [](auto change) {
    InclinometerSettings settings;
    change(settings);
    EXPECT_THROW(validate(settings), std::invalid_argument);
  };
  EXPECT_NO_THROW(validate(InclinometerSettings{}));
  refused([](auto& s) { s.node.node_id = 0; });
  refused([](auto& s) { s.node.node_id = 128; });
  refused([](auto& s) { s.resolution_mdeg = 20; });
  refused([](auto& s) { s.filter_step = 5; });
  refused([](auto& s) { s.quadrants = 3; });
  refused([](auto& s) { s.range_rad = 0.0; });
  refused([](auto& s) { s.range_rad = 3.15; });
  refused([](auto& s) { s.range_rad = kInclinometerNoNumber; });
  refused([](auto& s) { s.transmission_type = 253; });
  refused([](auto& s) { s.sampling = 0ns; });
  refused([](auto& s) { s.node.boot = -1ns; });
  refused([](auto& s) { s.supply.faults = rigwire::test::cuts({-1s}); });
}

TEST(InclinometerQuantities, AreWhatTheSixteenBitSlopesCarry) {
  const auto upper_deg = [](const InclinometerSettings& settings) {
    test::FrameRecorder output;
    VolatileMemory memory;
    const Inclinometer device(settings, memory, output);
    EXPECT_EQ(device.quantities().size(), 2U);
    return device.quantities()[0].upper / kDegree;
  };
  InclinometerSettings settings;
  EXPECT_NEAR(upper_deg(settings), 90.0, 1e-9);
  settings.quadrants = 1;
  EXPECT_NEAR(upper_deg(settings), 180.0, 1e-9);
  settings.quadrants = 2;
  settings.resolution_mdeg = 100;
  EXPECT_NEAR(upper_deg(settings), 360.0, 1e-9);
  settings.quadrants = 1;
  settings.range_rad = 45.0 * kDegree;
  EXPECT_NEAR(upper_deg(settings), 45.0, 1e-9);
  settings.resolution_mdeg = 1;
  EXPECT_NEAR(upper_deg(settings), 32.767, 1e-9);
}

TEST(InclinometerMessages, CarrySenderAndPeriods) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.event_timer_ms = 50;
  settings.heartbeat_ms = 1000;
  InclinometerRig synchronous(settings);
  EXPECT_EQ(synchronous.device.messages("boom").at(0).period_ms, 0U);
  settings.transmission_type = 254;
  InclinometerRig rig(settings);
  const auto list = rig.device.messages("boom");
  ASSERT_EQ(list.size(), 4U);
  EXPECT_EQ(list[0].sender, "boom");
  EXPECT_EQ(list[0].period_ms, 50U);
  EXPECT_EQ(list[1].period_ms, 0U);
  EXPECT_EQ(list[2].period_ms, 1000U);
}

}  // namespace
}  // namespace rigwire::emulators
