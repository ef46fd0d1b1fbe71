// What the sensor's clock shows with every kind of time source, by the packets' own fields.
#include "emulators/velodyne/time_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "velodyne_fixture.h"

namespace rigwire::emulators {
namespace {

using protocols::velodyne::PulseState;
using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::StartsWith;

/// Position packets tell the time as well, and far less often than data packets.
class VelodyneTimeTest : public VelodyneFixture {
 protected:
  static VelodyneSettings with(VelodyneTimeSource source) {
    VelodyneSettings settings;
    settings.model = "VLP-16";
    settings.time_source = source;
    settings.position_period = milliseconds{100};
    return settings;
  }
  static GnssSample fix_at(SimTime time, GnssFix fix = GnssFix::three_d) {
    GnssSample sample;
    sample.time = time;
    sample.fix = fix;
    sample.latitude_deg = 49.5;
    sample.longitude_deg = -7.75;
    return sample;
  }
  /// A receiver that measures once a second from `begin` on.
  static void hear(VelodyneLidar& lidar, int begin_s, int end_s, GnssFix fix = GnssFix::three_d) {
    for (int s = begin_s; s < end_s; ++s) {
      const SimTime time = kStart + seconds{s};
      lidar.advance(time - nanoseconds{1});
      lidar.observe_fix(fix_at(time, fix));
      lidar.advance(time);
    }
  }
  /// The packet that was sent at a time.
  [[nodiscard]] protocols::velodyne::PositionPacket at(Duration time) const {
    return position_packet(static_cast<std::size_t>(time / milliseconds{100}) - 1);
  }
};

TEST_F(VelodyneTimeTest, WithoutReceiverTheCounterRunsFromPowerUpWithTheCrystal) {
  VelodyneSettings settings = with(VelodyneTimeSource::none);
  settings.clock_drift_ppm = 58.0;  // 5 s a day
  VelodyneLidar lidar(settings, calendar, data, position);
  lidar.advance(kStart + seconds{100});
  EXPECT_EQ(at(seconds{1}).timestamp_us, 1'000'058U);
  EXPECT_EQ(at(seconds{100}).timestamp_us, 100'005'800U);
  EXPECT_EQ(at(seconds{100}).pulse_state, PulseState::absent);
  EXPECT_EQ(at(seconds{100}).sentence(), "");
  for (std::size_t i = 202; i < 512; ++i) {
    ASSERT_EQ(position.sent.back().bytes[i], 0) << i;
  }
}

TEST_F(VelodyneTimeTest, PulsesAloneSetTheSubsecondOnceQualified) {
  VelodyneSettings settings = with(VelodyneTimeSource::pulse_only);
  settings.clock_drift_ppm = 150.0;
  settings.start_up = Duration{0};
  Calendar between(parse_utc("2026-06-01T08:59:50.4Z"));
  VelodyneLidar lidar(settings, between, data, position);
  lidar.advance(kStart + seconds{60});
  // Pulses come 0.6 s after whole seconds of the counter; the first one is at 0.6 s.
  EXPECT_EQ(at(milliseconds{500}).pulse_state, PulseState::absent);
  EXPECT_EQ(at(milliseconds{700}).pulse_state, PulseState::synchronizing);
  EXPECT_EQ(at(milliseconds{5500}).pulse_state, PulseState::synchronizing);
  EXPECT_EQ(at(milliseconds{5500}).timestamp_us, 5'500'825U) << "still by itself";
  EXPECT_EQ(at(milliseconds{5600}).pulse_state, PulseState::locked);
  EXPECT_EQ(at(milliseconds{5600}).timestamp_us, 6'000'000U) << "the rising edge";
  // 0.5 s later the crystal has gained 75 us, and every pulse takes it back.
  EXPECT_EQ(at(milliseconds{6100}).timestamp_us, 6'500'075U);
  EXPECT_EQ(at(milliseconds{59600}).timestamp_us, 60'000'000U);
  EXPECT_EQ(at(milliseconds{59600}).sentence(), "");
}

TEST_F(VelodyneTimeTest, SentencesSetMinutesAndSecondsAfterTheQualifier) {
  VelodyneLidar lidar(with(VelodyneTimeSource::receiver), calendar, data, position);
  lidar.advance(kStart + milliseconds{2500});
  EXPECT_EQ(at(milliseconds{2500}).pulse_state, PulseState::absent);
  EXPECT_EQ(at(milliseconds{2500}).timestamp_us, 2'500'000U);
  hear(lidar, 3, 12);
  EXPECT_EQ(at(milliseconds{3200}).sentence(), "") << "before 225 ms after the pulse";
  EXPECT_THAT(std::string(at(milliseconds{3300}).sentence()),
              StartsWith("$GPRMC,085953,A,4930.0000,N,00745.0000,W,"));
  EXPECT_EQ(at(milliseconds{7900}).pulse_state, PulseState::synchronizing);
  EXPECT_EQ(at(milliseconds{7900}).timestamp_us, 7'900'000U);
  EXPECT_EQ(at(milliseconds{8000}).pulse_state, PulseState::locked);
  EXPECT_EQ(at(milliseconds{8000}).timestamp_us, 3'598'000'000U);
  EXPECT_EQ(at(milliseconds{9900}).timestamp_us, 3'599'900'000U);
  EXPECT_EQ(at(milliseconds{10000}).timestamp_us, 0U) << "the hour";
}

TEST_F(VelodyneTimeTest, ReceiverWithoutFixSaysSoAndGivesPulsesOnlyIfToldTo) {
  VelodyneSettings settings = with(VelodyneTimeSource::receiver);
  VelodyneLidar strict(settings, calendar, data, position);
  hear(strict, 0, 12, GnssFix::none);
  EXPECT_EQ(at(seconds{10}).pulse_state, PulseState::absent);
  EXPECT_THAT(std::string(at(seconds{10}).sentence()), HasSubstr(",V,"));
  EXPECT_EQ(at(seconds{10}).timestamp_us, 10'000'000U);
  position.sent.clear();
  settings.pulse_without_fix = true;
  VelodyneLidar pulses(settings, calendar, data, position);
  hear(pulses, 0, 12, GnssFix::none);
  EXPECT_EQ(at(seconds{10}).pulse_state, PulseState::locked);
  EXPECT_EQ(at(milliseconds{10500}).timestamp_us, 10'500'000U) << "a 'V' sets no minutes";
  position.sent.clear();
  settings.sentence_needs_valid = false;
  VelodyneLidar trusting(settings, calendar, data, position);
  hear(trusting, 0, 12, GnssFix::none);
  EXPECT_EQ(at(milliseconds{9900}).timestamp_us, 3'599'900'000U);
  position.sent.clear();
  settings.pulse_needs_valid_receiver = true;
  VelodyneLidar wary(settings, calendar, data, position);
  hear(wary, 0, 12, GnssFix::none);
  EXPECT_EQ(at(seconds{10}).pulse_state, PulseState::synchronizing);
}

TEST_F(VelodyneTimeTest, ReceiverThatFallsSilentLeavesTheClockRunning) {
  VelodyneSettings settings = with(VelodyneTimeSource::receiver);
  settings.clock_drift_ppm = -20.0;
  VelodyneLidar lidar(settings, calendar, data, position);
  hear(lidar, 0, 20);
  lidar.advance(kStart + seconds{120});
  EXPECT_EQ(at(seconds{19}).pulse_state, PulseState::locked);
  EXPECT_EQ(at(seconds{23}).pulse_state, PulseState::absent);
  // Last pulse at 21 s (two seconds without a measurement are forgiven), 11 s past the hour.
  EXPECT_EQ(at(seconds{121 - 1}).timestamp_us, 110'000'000U - 99 * 20);
  hear(lidar, 121, 123);
  lidar.advance(kStart + seconds{123});
  EXPECT_EQ(at(milliseconds{122900}).pulse_state, PulseState::synchronizing);
}

TEST_F(VelodyneTimeTest, PulseLossAndNoiseRunThroughAllFourStates) {
  VelodyneSettings settings = with(VelodyneTimeSource::ideal);
  settings.clock_drift_ppm = 100.0;
  settings.faults.push_back({.when = between(seconds{5}, seconds{15}), .what = PulseLossFault{}});
  settings.faults.push_back({.when = between(seconds{30}, seconds{35}), .what = PulseNoiseFault{}});
  VelodyneLidar lidar(settings, calendar, data, position);
  lidar.advance(kStart + seconds{60});
  EXPECT_EQ(at(milliseconds{5400}).pulse_state, PulseState::locked);
  EXPECT_EQ(at(milliseconds{5600}).pulse_state, PulseState::absent);
  EXPECT_EQ(at(milliseconds{5600}).timestamp_us, 3'595'600'160U) << "by the crystal since 4 s";
  EXPECT_EQ(at(milliseconds{14900}).timestamp_us, 4'900'000U + 1090U);
  EXPECT_THAT(std::string(at(milliseconds{14900}).sentence()), HasSubstr("$GPRMC,090004,"));
  EXPECT_EQ(at(milliseconds{15100}).pulse_state, PulseState::synchronizing);
  EXPECT_EQ(at(milliseconds{20000}).pulse_state, PulseState::locked);
  EXPECT_EQ(at(milliseconds{20000}).timestamp_us, 10'000'000U);
  EXPECT_EQ(at(milliseconds{30100}).pulse_state, PulseState::error);
  EXPECT_EQ(at(milliseconds{34900}).pulse_state, PulseState::error);
  EXPECT_EQ(at(milliseconds{35100}).pulse_state, PulseState::synchronizing);
  EXPECT_EQ(at(milliseconds{40000}).pulse_state, PulseState::locked);
}

TEST_F(VelodyneTimeTest, SentenceLossKeepsTheSecondsOfTheClock) {
  VelodyneSettings settings = with(VelodyneTimeSource::ideal);
  settings.clock_drift_ppm = 100.0;
  settings.faults.push_back(
      {.when = between(seconds{5}, seconds{15}), .what = SentenceLossFault{}});
  VelodyneLidar lidar(settings, calendar, data, position);
  lidar.advance(kStart + seconds{20});
  EXPECT_THAT(std::string(at(milliseconds{14900}).sentence()), HasSubstr("$GPRMC,085954,"));
  EXPECT_EQ(at(milliseconds{14000}).timestamp_us, 4'000'000U);
  EXPECT_EQ(at(milliseconds{14500}).timestamp_us, 4'500'050U);
}

TEST_F(VelodyneTimeTest, LeapSecondIsShownAsASecondZeroThatComesTwice) {
  Calendar leap(parse_utc("2016-12-31T23:59:58Z"));
  VelodyneLidar lidar(with(VelodyneTimeSource::ideal), leap, data, position);
  lidar.advance(kStart + seconds{6});
  EXPECT_EQ(at(milliseconds{1900}).timestamp_us, 3'599'900'000U);
  EXPECT_EQ(at(milliseconds{2500}).timestamp_us, 500'000U) << "23:59:60.5";
  EXPECT_THAT(std::string(at(milliseconds{2500}).sentence()), HasSubstr("$GPRMC,235960,"));
  EXPECT_EQ(at(milliseconds{3500}).timestamp_us, 500'000U) << "00:00:00.5";
  EXPECT_THAT(std::string(at(milliseconds{3500}).sentence()), HasSubstr("$GPRMC,000000,"));
  EXPECT_EQ(at(milliseconds{5500}).timestamp_us, 2'500'000U);
}

TEST_F(VelodyneTimeTest, StaysExactThroughAWeek) {
  VelodyneSettings settings = with(VelodyneTimeSource::ideal);
  settings.position_period = seconds{10};
  settings.clock_drift_ppm = 58.0;
  VelodyneLidar lidar(settings, calendar, data, position);
  constexpr int kWeek_s = 604800;
  lidar.advance(kStart + seconds{kWeek_s});
  ASSERT_EQ(position.sent.size(), static_cast<std::size_t>(kWeek_s / 10));
  for (std::size_t i = 0; i < position.sent.size(); i += 97) {
    const auto expected = (3590 + 10 * (static_cast<std::int64_t>(i) + 1)) % 3600 * 1'000'000;
    ASSERT_EQ(position_packet(i).timestamp_us, expected);
  }
  // Left alone for as long, the crystal is off by what it promises, without a rounding.
  SensorClock clock(58.0);
  clock.power_up(kStart);
  EXPECT_EQ(clock.hour_ns(kStart + seconds{kWeek_s}), 35'078'400'000 % kHour_ns);
}

TEST_F(VelodyneTimeTest, SentencesInTenthsWhenAsked) {
  VelodyneSettings settings = with(VelodyneTimeSource::ideal);
  settings.sentence_tenths = true;
  VelodyneLidar lidar(settings, calendar, data, position);
  lidar.advance(kStart + seconds{2});
  EXPECT_THAT(std::string(at(seconds{1}).sentence()), StartsWith("$GPRMC,085950.0,V,"));
}

TEST_F(VelodyneTimeTest, WrongClocksAreOffAndPassTheHour) {
  VelodyneSettings settings = with(VelodyneTimeSource::ideal);
  settings.faults.push_back(
      {.when = between(seconds{1}, seconds{2}), .what = ClockOffsetFault{.offset_s = -0.25}});
  settings.faults.push_back(
      {.when = between(seconds{9}, seconds{20}), .what = HourOverrunFault{.overrun_s = 0.15}});
  VelodyneLidar lidar(settings, calendar, data, position);
  lidar.advance(kStart + seconds{12});
  EXPECT_EQ(at(milliseconds{900}).timestamp_us, 3'590'900'000U);
  EXPECT_EQ(at(milliseconds{1500}).timestamp_us, 3'591'250'000U);
  EXPECT_EQ(at(milliseconds{9900}).timestamp_us, 3'599'900'000U);
  EXPECT_EQ(at(milliseconds{10100}).timestamp_us, 3'600'100'000U);
  EXPECT_EQ(at(milliseconds{10200}).timestamp_us, 200'000U);
}

TEST_F(VelodyneTimeTest, NoFixOfNumbersThatAreNone) {
  VelodyneLidar lidar(with(VelodyneTimeSource::receiver), calendar, data, position);
  GnssSample sample = fix_at(kStart);
  sample.latitude_deg = std::numeric_limits<double>::quiet_NaN();
  lidar.observe_fix(sample);
  lidar.advance(kStart + seconds{1});
  EXPECT_THAT(std::string(at(seconds{1}).sentence()), HasSubstr(",V,,,,,,,"));
  EXPECT_EQ(lidar.readings(kStart + seconds{1}).gps_position, "");
}

TEST_F(VelodyneTimeTest, PhaseLockNeedsALockedInputAndTellsTheHeadOnce) {
  VelodyneSettings settings = with(VelodyneTimeSource::receiver);
  settings.saved.phase_lock = true;
  settings.saved.phase_lock_offset_centideg = 9000;
  VelodyneLidar lidar(settings, calendar, data, position);
  hear(lidar, 0, 5);
  EXPECT_FALSE(lidar.command().phase_lock.has_value());
  hear(lidar, 5, 8);
  ASSERT_TRUE(lidar.command().phase_lock.has_value());
  const PhaseLock lock = *lidar.command().phase_lock;
  EXPECT_DOUBLE_EQ(lock.azimuth_rad, std::numbers::pi / 2.0);
  EXPECT_EQ(lock.pulse, kStart + seconds{5});
  hear(lidar, 8, 12);
  EXPECT_EQ(*lidar.command().phase_lock, lock) << "a new command every second would be noise";
  lidar.advance(kStart + seconds{20});
  EXPECT_FALSE(lidar.command().phase_lock.has_value()) << "the pulse is gone";
}

TEST_F(VelodyneTimeTest, ReadingsTellThePhaseAtTheTopOfTheSecond) {
  VelodyneSettings settings = with(VelodyneTimeSource::ideal);
  settings.saved.phase_lock = true;
  settings.saved.phase_lock_offset_centideg = 4500;
  VelodyneLidar lidar(settings, calendar, data, position);
  // 600 rpm is ten turns a second, so the phase at the start comes back.
  azimuth_rad = 0.25 * std::numbers::pi;
  fire_until(lidar, kStart + milliseconds{1100});
  const VelodyneReadings in_phase = lidar.readings(kStart + milliseconds{1100});
  EXPECT_NEAR(in_phase.motor_phase_centideg, 4500, 1);
  EXPECT_TRUE(in_phase.motor_locked);
  EXPECT_NEAR(in_phase.motor_rpm, 600.0, 1e-9);
  azimuth_rad += 0.5;
  fire_until(lidar, kStart + milliseconds{2100});
  EXPECT_FALSE(lidar.readings(kStart + milliseconds{2100}).motor_locked);
}

}  // namespace
}  // namespace rigwire::emulators
