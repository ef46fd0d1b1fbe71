#include "emulators/canopen/rotary_encoder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "encoder_rig.h"
#include "fields/constants.h"
#include "supply_cuts.h"

namespace rigwire::emulators {
namespace {

using protocols::canopen::SdoAbort;
using testing::ElementsAre;

TEST(RotaryEncoder, IdentityOfSingleAndMultiTurn) {
  EncoderRig single;
  single.boot();
  EXPECT_EQ(single.read(0x1000), 0x00010196U);
  EXPECT_EQ(single.read(0x6501), 8192U);
  EXPECT_EQ(single.read(0x6502), 1U);
  EXPECT_EQ(single.read(0x6001), 8192U);
  EXPECT_EQ(single.read(0x6002), 8192U);
  RotaryEncoderSettings settings = EncoderRig::settings();
  settings.revolutions = 4096;
  settings.resolution_bits = 16;
  EncoderRig multi(settings);
  multi.boot();
  EXPECT_EQ(multi.read(0x1000), 0x00020196U);
  EXPECT_EQ(multi.read(0x6002), 65536U * 4096U);
}

TEST(RotaryEncoder, PositionIsTheNearestStepOverTheWholeTurn) {
  for (std::uint8_t bits = 13; bits <= 16; ++bits) {
    RotaryEncoderSettings settings = EncoderRig::settings();
    settings.resolution_bits = bits;
    EncoderRig rig(settings);
    rig.boot();
    const double steps = std::ldexp(1.0, bits);
    for (int i = -200; i <= 200; ++i) {
      rig.angle_rad = 0.0317 * i;
      rig.run(2ms);
      const double read = rig.encoder.position() / steps * kTurn;
      const double error = std::remainder(read - rig.angle_rad, kTurn);
      EXPECT_LE(std::abs(error), 0.5 * kTurn / steps * (1 + 1e-9)) << i;
    }
  }
}

TEST(RotaryEncoder, CodeRisesWithTheDirectionBit) {
  EncoderRig rig;
  rig.boot();
  rig.angle_rad = kTurn / 4;
  rig.rate_radps = kTurn / 8;
  rig.run(2ms);
  EXPECT_EQ(rig.read(0x6004), 2048U);
  EXPECT_EQ(static_cast<std::int16_t>(rig.read(0x6030, 1)), 1024);
  EXPECT_EQ(rig.write(0x6000, 0, 0, 2), 0U);
  EXPECT_EQ(rig.read(0x6004), 6144U);
  EXPECT_EQ(static_cast<std::int16_t>(rig.read(0x6030, 1) & 0xFFFF), -1024);
  EXPECT_EQ(rig.read(0x6500), 0U);
}

TEST(RotaryEncoder, SpeedSaturates) {
  EncoderRig rig;
  rig.boot();
  rig.rate_radps = 100.0 * kTurn;
  rig.run(2ms);
  EXPECT_EQ(rig.read(0x6030, 1), 32767U);
}

TEST(RotaryEncoder, ScalingCountsDegrees) {
  EncoderRig rig;
  rig.boot();
  EXPECT_EQ(rig.write(0x6001, 0, 3600, 4), 0U);
  EXPECT_EQ(rig.write(0x6002, 0, 3600, 4), 0U);
  rig.angle_rad = kTurn / 4;
  rig.run(2ms);
  EXPECT_EQ(rig.read(0x6004), 2048U);  // not in force yet
  EXPECT_EQ(rig.write(0x6000, 0, 5, 2), 0U);
  EXPECT_EQ(rig.read(0x6004), 900U);
  EXPECT_EQ(rig.write(0x6001, 0, 8193, 4), static_cast<std::uint32_t>(SdoAbort::value_too_high));
}

TEST(RotaryEncoder, PresetMovesThePositionAndIsSavedWithTheRest) {
  EncoderRig rig;
  rig.boot();
  rig.angle_rad = kTurn / 4;
  rig.run(2ms);
  EXPECT_EQ(rig.write(0x6003, 0, 8192, 4), static_cast<std::uint32_t>(SdoAbort::value_too_high));
  EXPECT_EQ(rig.write(0x6003, 0, 100, 4), 0U);
  EXPECT_EQ(rig.read(0x6004), 100U);
  EXPECT_EQ(static_cast<std::int32_t>(rig.read(0x6509)), 100 - 2048);
  EXPECT_EQ(rig.write(0x1010, 1, 0x65766173, 4), 0U);
  rig.angle_rad = 0.0;
  rig.run(2ms);
  EXPECT_EQ(rig.read(0x6004), 8192U + 100U - 2048U);
  rig.command(protocols::canopen::NetworkCommand::reset_node);
  rig.run(300ms);
  EXPECT_EQ(rig.read(0x6004), 8192U + 100U - 2048U);
}

TEST(RotaryEncoder, CyclicTimerIsTheEventTimerOfTheFirstPdo) {
  EncoderRig rig;
  rig.start();
  EXPECT_EQ(rig.write(0x6200, 0, 10, 2), 0U);
  EXPECT_EQ(rig.read(0x1800, 5), 10U);
  const std::size_t before = rig.output.with_id(0x1A0).size();
  rig.run(1s);
  EXPECT_EQ(rig.output.with_id(0x1A0).size() - before, 100U);
  EXPECT_EQ(rig.write(0x1800, 5, 25, 2), 0U);
  EXPECT_EQ(rig.read(0x6200), 25U);
}

TEST(RotaryEncoder, PdoCarriesThePosition) {
  EncoderRig rig;
  rig.angle_rad = kTurn * 0x1234 / 8192.0;
  rig.start();
  rig.run(20ms);
  EXPECT_THAT(rig.output.with_id(0x1A0).back().second.payload(), ElementsAre(0x34, 0x12, 0, 0));
}

TEST(RotaryEncoder, ReadingThatIsNoNumberRaisesAnEmergency) {
  EncoderRig rig;
  rig.angle_rad = 1.0;
  rig.boot();
  const std::uint32_t held = rig.read(0x6004);
  rig.angle_rad = std::numeric_limits<double>::quiet_NaN();
  rig.run(4ms);
  ASSERT_EQ(rig.output.with_id(0xA0).size(), 1U);
  EXPECT_THAT(rig.output.with_id(0xA0)[0].second.payload(),
              ElementsAre(0x00, 0x50, 0x81, 0, 0, 0, 0, 0));
  EXPECT_EQ(rig.read(0x6503), 1U);
  EXPECT_EQ(rig.read(0x1001), 0x81U);
  EXPECT_EQ(rig.read(0x1003, 1), 0x5000U);
  EXPECT_EQ(rig.read(0x6004), held);
  rig.angle_rad = 1.0;
  rig.run(4ms);
  EXPECT_THAT(rig.output.with_id(0xA0).back().second.payload(),
              ElementsAre(0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_EQ(rig.read(0x6503), 0U);
  EXPECT_EQ(rig.write(0x1003, 0, 0, 1), 0U);
  EXPECT_EQ(rig.read(0x1003), 0U);
}

TEST(RotaryEncoderSettings, RefusedWithTheValueFound) {
  const auto refused = [](auto change) {
    RotaryEncoderSettings settings;
    change(settings);
    EXPECT_THROW(validate(settings), std::invalid_argument);
  };
  EXPECT_NO_THROW(validate(RotaryEncoderSettings{}));
  refused([](auto& s) { s.node.node_id = 0; });
  refused([](auto& s) { s.node.node_id = 128; });
  refused([](auto& s) { s.resolution_bits = 12; });
  refused([](auto& s) { s.resolution_bits = 17; });
  refused([](auto& s) { s.revolutions = 0; });
  refused([](auto& s) { s.transmission_type = 253; });
  refused([](auto& s) { s.offset_rad = std::numeric_limits<double>::infinity(); });
  refused([](auto& s) { s.sampling = 0ns; });
  refused([](auto& s) { s.supply.faults = rigwire::test::cuts({-1s}); });
}

TEST(RotaryEncoderMessages, CarrySenderAndPeriods) {
  EncoderRig rig;
  const auto list = rig.encoder.messages("swing");
  ASSERT_EQ(list.size(), 4U);
  EXPECT_EQ(list[0].sender, "swing");
  EXPECT_EQ(list[0].period_ms, 20U);
  EXPECT_EQ(list[2].period_ms, 0U);
}

TEST(RotaryEncoder, ErrorThatIsThereAtBootIsToldAfterwards) {
  EncoderRig rig;
  rig.angle_rad = std::numeric_limits<double>::quiet_NaN();
  rig.run(300ms);
  const auto told = rig.output.with_id(0xA0);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_GE(told[0].first, rig.output.with_id(0x720)[0].first);
  EXPECT_EQ(rig.read(0x1001), 0x81U);
  EXPECT_EQ(rig.read(0x1003, 1) & 0xFFFFU, 0x5000U);
  rig.command(protocols::canopen::NetworkCommand::reset_node);
  rig.run(300ms);
  EXPECT_EQ(rig.output.with_id(0xA0).size(), 2U) << "told again after a reset";
}

TEST(RotaryEncoder, PositionFollowsAScalingThatAClientSetsAtOnce) {
  EncoderRig rig;
  rig.angle_rad = 1.0;
  rig.start();
  EXPECT_EQ(rig.write(0x1800, 2, 254, 1), 0U);
  EXPECT_EQ(rig.write(0x6001, 0, 360, 4), 0U);
  rig.output.frames.clear();
  EXPECT_EQ(rig.write(0x6000, 0, 5, 2), 0U);  // scaling on, still counter-clockwise
  ASSERT_EQ(rig.output.frames.size(), 2U);
  EXPECT_EQ(protocols::load_little<std::uint32_t>(rig.output.frames[1].second.data, 0), 57U);
}

}  // namespace
}  // namespace rigwire::emulators
