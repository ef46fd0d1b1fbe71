#include "emulators/xsens/mti_600.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "fields/constants.h"
#include "recorder.h"
#include "supply_cuts.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::xsens::MessageId;
using protocols::xsens::StatusBit;
using testing::ElementsAre;
namespace xsens = protocols::xsens;

constexpr double kGravity = 9.80665;

std::vector<xsens::Reading> readings(const test::FrameRecorder& output, MessageId id) {
  std::vector<xsens::Reading> result;
  for (const auto& [due, frame] : output.with_id(static_cast<std::uint32_t>(id))) {
    const auto reading = xsens::decode(frame);
    EXPECT_TRUE(reading.ok());
    result.push_back(*reading);
  }
  return result;
}

ImuSample level() {
  return {kStart, {0.0, 0.0, kGravity}, {0.0, 0.0, 0.0}, 31.5};
}

MtiSettings with(std::initializer_list<std::pair<MessageId, std::uint16_t>> changes) {
  MtiSettings settings;
  for (const auto& [id, divider] : changes) {
    for (MtiOutput& output : settings.outputs) {
      output.divider = output.id == id ? divider : output.divider;
    }
  }
  return settings;
}

struct MtiRig {
  explicit MtiRig(const MtiSettings& settings = {}) : mti(settings, calendar, output) {}
  void run(Duration span, ImuSample sample = level()) {
    for (const SimTime end = now + span; now < end; now += Mti600::kTick) {
      sample.time = now;
      mti.update(sample);
    }
  }
  Calendar calendar{UtcTime{2026, 6, 1, 8, 30, 59, 0}};
  test::FrameRecorder output;
  SimTime now = kStart;
  Mti600 mti;
};

TEST(Mti600, SixMessagesAt100HzInTheirOrder) {
  MtiRig rig;
  rig.run(1s);
  ASSERT_EQ(rig.output.frames.size(), 600U);
  EXPECT_EQ(rig.mti.nominal_rate_hz(), 600.0);
  std::vector<std::uint32_t> ids;
  for (std::size_t i = 6; i < 12; ++i) {
    ids.push_back(rig.output.frames[i].second.id);
    EXPECT_EQ(rig.output.frames[i].first, kStart + 10ms + 2ms);
  }
  EXPECT_THAT(ids, ElementsAre(0x05, 0x06, 0x11, 0x21, 0x32, 0x34));
}

TEST(Mti600, EachMessageHasItsOwnRate) {
  MtiRig rig(with({{MessageId::acceleration, 1},
                   {MessageId::quaternion, 0},
                   {MessageId::temperature, 400},
                   {MessageId::utc, 40}}));
  rig.run(2s);
  EXPECT_EQ(readings(rig.output, MessageId::acceleration).size(), 800U);
  EXPECT_EQ(readings(rig.output, MessageId::quaternion).size(), 0U);
  EXPECT_EQ(readings(rig.output, MessageId::temperature).size(), 2U);
  EXPECT_EQ(readings(rig.output, MessageId::temperature)[0].values[0], 31.5);
  EXPECT_EQ(readings(rig.output, MessageId::utc).size(), 20U);
}

TEST(Mti600, TimesOfASample) {
  MtiRig rig(with({{MessageId::utc, 4}}));
  rig.run(1500ms);
  const auto times = readings(rig.output, MessageId::sample_time);
  EXPECT_EQ(times[0].values[0], 0.0);
  EXPECT_EQ(times[1].values[0], 100.0);
  EXPECT_EQ(times[150 - 1].values[0], 14'900.0);
  EXPECT_EQ(readings(rig.output, MessageId::group_counter)[149].values[0], 149.0);
  const auto utc = readings(rig.output, MessageId::utc)[101].values;  // 1.01 s later
  EXPECT_THAT(std::vector(utc.begin(), utc.begin() + 6), ElementsAre(26, 6, 1, 8, 31, 0));
  EXPECT_NEAR(utc[6], 0.01, 1e-12);
}

TEST(Mti600, SampleTimeCountsTicksOf100MicrosecondsUnlessTheUnitIsOld) {
  const auto layout_of = [](const MtiRig& rig) {
    for (auto& layout : rig.mti.messages("mti")) {
      if (layout.name == "sample_time") {
        return layout.signals[0];
      }
    }
    return protocols::can::OwnedSignal{};
  };
  MtiRig today(with({}));
  today.run(1s);
  // 0.99 s after the first sample.
  EXPECT_EQ(readings(today.output, MessageId::sample_time)[99].values[0], 9'900.0);
  EXPECT_EQ(layout_of(today).scale, 100e-6);
  EXPECT_EQ(layout_of(today).unit, "s");
  MtiSettings settings;
  settings.sample_time = MtiSampleTime::microseconds;
  MtiRig old(settings);
  old.run(1s);
  EXPECT_EQ(readings(old.output, MessageId::sample_time)[99].values[0], 990'000.0);
  EXPECT_EQ(layout_of(old).scale, 1e-6);
  // What a client computes with the DBC of either is the same time.
  EXPECT_NEAR(9'900.0 * layout_of(today).scale, 990'000.0 * layout_of(old).scale, 1e-12);
}

TEST(Mti600Signs, NoseUpRightDownClockwise) {
  MtiRig rig(with({{MessageId::euler_angles, 4}}));
  ImuSample sample = level();
  const double pitch = 20.0 * kDegree;
  const double roll = 10.0 * kDegree;
  // Nose up, right side down: what gravity is on x forward, y left, z up.
  sample.specific_force_mps2 = {kGravity * std::sin(pitch),
                                kGravity * std::cos(pitch) * std::sin(roll),
                                kGravity * std::cos(pitch) * std::cos(roll)};
  rig.run(2s, sample);
  const auto angles = readings(rig.output, MessageId::euler_angles).back().values;
  EXPECT_NEAR(angles[0], 10.0, 0.01);   // right side down is positive
  EXPECT_NEAR(angles[1], -20.0, 0.01);  // nose up is negative
  // Clockwise from above is negative about z up.
  MtiRig turning(with({{MessageId::euler_angles, 4}}));
  ImuSample turn = level();
  turn.angular_rate_radps = {0.0, 0.0, -10.0 * kDegree};
  turning.run(3s, turn);
  EXPECT_NEAR(readings(turning.output, MessageId::euler_angles).back().values[2], -30.0, 0.2);
  EXPECT_NEAR(readings(turning.output, MessageId::rate_of_turn).back().values[2], -10.0 * kDegree,
              1.0 / 1024.0);
  EXPECT_NEAR(readings(turning.output, MessageId::acceleration).back().values[2], kGravity,
              1.0 / 512.0);
}

TEST(Mti600, FreeAccelerationIsWithoutGravityInTheLocalFrame) {
  MtiSettings settings = with({{MessageId::free_acceleration, 4}});
  settings.heading_rad = std::numbers::pi / 2.0;  // x points north
  MtiRig rig(settings);
  rig.run(3s);
  ImuSample push = level();
  push.specific_force_mps2.x = 4.0;
  rig.run(10ms, push);
  const auto free = readings(rig.output, MessageId::free_acceleration).back().values;
  EXPECT_NEAR(free[0], 0.0, 0.02);
  EXPECT_NEAR(free[1], 4.0, 0.02);
  EXPECT_NEAR(free[2], 0.0, 0.02);
}

TEST(Mti600, IncrementsSumUpBetweenMessages) {
  MtiRig rig(with({{MessageId::velocity_increment, 8}, {MessageId::orientation_increment, 8}}));
  ImuSample turn = level();
  turn.angular_rate_radps = {0.0, 0.0, 1.0};
  rig.run(1s, turn);
  const auto increment = readings(rig.output, MessageId::velocity_increment).back().values;
  EXPECT_NEAR(std::ldexp(increment[2], -static_cast<int>(increment[3])), 0.02 * kGravity, 1e-5);
  EXPECT_NEAR(readings(rig.output, MessageId::orientation_increment).back().values[3],
              std::sin(0.01), 1.0 / 32767.0);
}

TEST(Mti600, StatusWordTellsFilterAndClipping) {
  MtiRig rig;
  rig.run(500ms);
  EXPECT_EQ(readings(rig.output, MessageId::status_word).back().values[0],
            1.0);  // filter not yet valid
  rig.run(1s);
  EXPECT_EQ(readings(rig.output, MessageId::status_word).back().values[0], 3.0);
  ImuSample hit = level();
  hit.specific_force_mps2.y = -500.0;
  rig.run(10ms, hit);
  EXPECT_EQ(
      static_cast<std::uint32_t>(readings(rig.output, MessageId::status_word).back().values[0]),
      StatusBit::kSelfTest | StatusBit::kFilterValid | StatusBit::kClipping |
          (StatusBit::kClipAccelerationX << 1U));
  EXPECT_NEAR(readings(rig.output, MessageId::acceleration).back().values[1], -10.0 * kGravity,
              0.01);
}

TEST(Mti600, FailedElementsAreSilentAndSaidSo) {
  MtiRig rig;
  rig.run(2s);
  const std::size_t before = readings(rig.output, MessageId::acceleration).size();
  ImuSample broken = level();
  broken.angular_rate_radps.y = std::numeric_limits<double>::quiet_NaN();
  rig.run(1s, broken);
  EXPECT_EQ(readings(rig.output, MessageId::acceleration).size(), before);
  EXPECT_EQ(readings(rig.output, MessageId::status_word).back().values[0], 0.0);
  rig.run(10ms);
  EXPECT_EQ(readings(rig.output, MessageId::acceleration).size(), before + 1);
}

TEST(Mti600, MagneticFieldOnlyWithAMagnetometer) {
  MtiRig rig(with({{MessageId::magnetic_field, 4}}));
  rig.run(100ms);
  EXPECT_TRUE(readings(rig.output, MessageId::magnetic_field).empty());
  ImuSample sample = level();
  sample.magnetic_field_t = {48.7e-6, 0.0, -24.35e-6};
  rig.run(10ms, sample);
  const auto field = readings(rig.output, MessageId::magnetic_field).back().values;
  EXPECT_EQ(field[0], 1.0);
  EXPECT_EQ(field[2], -0.5);
}

TEST(Mti600, OverflowIsReportedOnce) {
  MtiRig rig;
  rig.run(100ms);
  protocols::can::ControllerReport report;
  rig.mti.controller(rig.now, report);
  report.transmit_overflow = true;
  rig.mti.controller(rig.now, report);
  rig.run(100ms);
  ASSERT_EQ(readings(rig.output, MessageId::error).size(), 1U);
  EXPECT_EQ(readings(rig.output, MessageId::error)[0].values[0], 1.0);
}

TEST(Mti600, PowerCycleStartsTimeAndHeadingAgain) {
  MtiSettings settings;
  settings.supply.faults = rigwire::test::cuts({1s});
  MtiRig rig(settings);
  rig.run(1400ms);
  EXPECT_EQ(readings(rig.output, MessageId::sample_time).size(), 100U);
  rig.run(200ms);
  EXPECT_EQ(readings(rig.output, MessageId::sample_time)[100].values[0], 0.0);
  EXPECT_EQ(readings(rig.output, MessageId::group_counter)[100].values[0], 0.0);
}

TEST(Mti600, HearsNothing) {
  MtiRig rig;
  for (unsigned length = 0; length <= 255; ++length) {
    protocols::can::Frame frame;
    frame.length = static_cast<std::uint8_t>(length);
    rig.mti.receive(kStart, frame);
  }
  EXPECT_EQ(rig.mti.received().ignored, 9U);
  EXPECT_EQ(rig.mti.received().malformed, 247U);
}

TEST(Mti600Settings, EveryDivisorOf400AndNoOtherIsARate) {
  for (std::uint16_t divider = 1; divider <= 401; ++divider) {
    MtiSettings settings;
    settings.outputs[0].divider = divider;
    if (kMtiSamplesPerSecond % divider == 0) {
      EXPECT_NO_THROW(validate(settings)) << divider;
    } else {
      EXPECT_THROW(validate(settings), std::invalid_argument) << divider;
    }
  }
}

TEST(Mti600Settings, RefusedWithTheValueFound) {
  const auto refused = [](auto change) {
    MtiSettings settings;
    change(settings);
    EXPECT_THROW(validate(settings), std::invalid_argument);
  };
  EXPECT_NO_THROW(validate(MtiSettings{}));
  refused([](auto& s) { s.outputs[0].divider = 3; });
  refused([](auto& s) { std::swap(s.outputs[0], s.outputs[1]); });
  refused([](auto& s) { s.rate_range_radps = 0.0; });
  refused([](auto& s) { s.pressure_pa = 200000.0; });
  refused([](auto& s) { s.heading_rad = std::numeric_limits<double>::quiet_NaN(); });
  refused([](auto& s) { s.processing_delay = -1ns; });
}

TEST(Mti600Messages, CarrySenderAndPeriods) {
  MtiRig rig(with({{MessageId::utc, 400}}));
  const auto list = rig.mti.messages("imu");
  EXPECT_EQ(list.size(), kMtiOutputs.size());
  for (const auto& layout : list) {
    EXPECT_EQ(layout.sender, "imu");
    if (layout.id == 0x34) {
      EXPECT_EQ(layout.period_ms, 10U);
    } else if (layout.id == 0x07) {
      EXPECT_EQ(layout.period_ms, 1000U);
    }
  }
}

}  // namespace
}  // namespace rigwire::emulators
