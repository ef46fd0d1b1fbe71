// Settings that change while the sensor runs, saving, and the reset.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "velodyne_fixture.h"

namespace rigwire::emulators {
namespace {

using protocols::velodyne::PulseState;
using protocols::velodyne::ReturnMode;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

class VelodyneControlTest : public VelodyneFixture {
 protected:
  static VelodyneSettings puck() {
    VelodyneSettings settings;
    settings.model = "VLP-16";
    return settings;
  }
  [[nodiscard]] SimTime now(const VelodyneLidar& lidar) const {
    return lidar.sample_plan().first + (next_firing - 1) * lidar.sample_plan().period;
  }
  template <class Change>
  void change(VelodyneLidar& lidar, Change what) {
    VelodyneLiveSettings settings = lidar.live_settings();
    what(settings);
    lidar.apply(now(lidar), settings);
  }
};

TEST_F(VelodyneControlTest, ReturnModeChangesBetweenPacketsAndNeverWithinOne) {
  VelodyneLidar lidar(puck(), calendar, data, position);
  fire(lidar, 7);
  change(lidar, [](auto& s) { s.return_mode = ReturnMode::dual; });
  EXPECT_TRUE(lidar.command().several_echoes);
  fire(lidar, 17);
  ASSERT_EQ(data.sent.size(), 1U);
  EXPECT_EQ(data.sent[0].bytes[1204], 0x37);
  EXPECT_NE(packet(0).azimuth(0), packet(0).azimuth(1));
  fire(lidar, 12);
  ASSERT_EQ(data.sent.size(), 2U);
  EXPECT_EQ(data.sent[1].bytes[1204], 0x39);
  EXPECT_EQ(packet(1).azimuth(0), packet(1).azimuth(1));
  change(lidar, [](auto& s) { s.return_mode = ReturnMode::last; });
  fire(lidar, 24);
  EXPECT_EQ(data.sent[2].bytes[1204], 0x38);
}

TEST_F(VelodyneControlTest, LaserOffSendsPacketsWithoutReturns) {
  VelodyneLidar lidar(puck(), calendar, data, position);
  fire(lidar, 12);
  change(lidar, [](auto& s) { s.laser_on = false; });
  EXPECT_FALSE(lidar.command().laser_on);
  EXPECT_FALSE(lidar.readings(now(lidar)).laser_on);
  fire(lidar, 12);
  ASSERT_EQ(data.sent.size(), 1U);
  EXPECT_NE(packet(0).distance(5, 31), 0);
  EXPECT_EQ(packet(0).distance(6, 0), 0) << "even though echoes are still on their way";
  EXPECT_GE(packet(0).reflectivity(6, 0), 3) << "as a shot without a return";
  EXPECT_LE(packet(0).reflectivity(6, 0), 24);
}

TEST_F(VelodyneControlTest, SpeedZeroStopsAndTheWindowNarrowsAtOnce) {
  VelodyneLidar lidar(puck(), calendar, data, position);
  change(lidar, [](auto& s) { s.rotor_rpm = 1200; });
  EXPECT_DOUBLE_EQ(lidar.command().rotor_rate_radps, 40.0 * std::numbers::pi);
  change(lidar, [](auto& s) {
    s.rotor_rpm = 0;
    s.view_start_deg = 350;
    s.view_end_deg = 10;
  });
  EXPECT_EQ(lidar.command().rotor_rate_radps, 0.0);
  EXPECT_DOUBLE_EQ(lidar.command().view_start_rad, 350.0 * std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(lidar.command().view_end_rad, 11.0 * std::numbers::pi / 180.0);
}

TEST_F(VelodyneControlTest, HostChangesAreCountedAndOthersAreNot) {
  VelodyneLidar lidar(puck(), calendar, data, position);
  EXPECT_EQ(lidar.data_destination().address, "255.255.255.255");
  EXPECT_EQ(lidar.position_destination().port, 8308);
  EXPECT_EQ(lidar.destination_changes(), 0U);
  change(lidar, [](auto& s) { s.rotor_rpm = 300; });
  EXPECT_EQ(lidar.destination_changes(), 0U);
  change(lidar, [](auto& s) {
    s.host_address = "10.1.2.3";
    s.data_port = 4000;
  });
  EXPECT_EQ(lidar.destination_changes(), 1U);
  EXPECT_EQ(lidar.data_destination().address, "10.1.2.3");
  EXPECT_EQ(lidar.data_destination().port, 4000);
  lidar.reset(now(lidar));
  EXPECT_EQ(lidar.destination_changes(), 2U) << "not saved, so back";
  EXPECT_EQ(lidar.data_destination().port, 2368);
}

TEST_F(VelodyneControlTest, ResetIsSilentForTheStartUpTimeAndSpinsUpFromRest) {
  VelodyneSettings settings = puck();
  settings.start_up = seconds{3};
  settings.time_source = VelodyneTimeSource::none;
  VelodyneLidar lidar(settings, calendar, data, position);
  EXPECT_TRUE(lidar.starting_up(kStart));
  EXPECT_EQ(lidar.command().rotor_rate_radps, 0.0);
  EXPECT_FALSE(lidar.command().laser_on);
  fire_until(lidar, kStart + seconds{3});
  EXPECT_TRUE(data.sent.empty());
  EXPECT_TRUE(position.sent.empty());
  fire_until(lidar, kStart + seconds{4});
  EXPECT_GT(lidar.command().rotor_rate_radps, 0.0);
  EXPECT_GT(data.sent.size(), 750U);
  EXPECT_EQ(packet(0).timestamp_us(), 55'296 * 54'254LL / 1000) << "the counter ran from power-up";

  change(lidar, [](auto& s) { s.rotor_rpm = 1200; });
  lidar.save(now(lidar));
  change(lidar, [](auto& s) { s.rotor_rpm = 300; });
  const std::size_t before = data.sent.size();
  const SimTime reset_at = now(lidar);
  lidar.reset(reset_at);
  EXPECT_EQ(lidar.live_settings().rotor_rpm, 1200);
  fire_until(lidar, reset_at + milliseconds{2999});
  EXPECT_EQ(data.sent.size(), before);
  fire_until(lidar, reset_at + milliseconds{3100});
  EXPECT_GT(data.sent.size(), before);
  EXPECT_LT(packet(before).timestamp_us(), 3'000'100) << "the counter began anew";
  EXPECT_DOUBLE_EQ(lidar.command().rotor_rate_radps, 40.0 * std::numbers::pi);
}

TEST_F(VelodyneControlTest, WarmSensorIsSilentForTenSecondsAfterAReset) {
  VelodyneLidar lidar(puck(), calendar, data, position);
  fire(lidar, 5);
  lidar.reset(now(lidar));
  EXPECT_TRUE(lidar.starting_up(kStart + milliseconds{9999}));
  EXPECT_FALSE(lidar.starting_up(kStart + milliseconds{10001}));
  EXPECT_EQ(lidar.readings(kStart + seconds{1}).pulse_state, PulseState::locked) << "ideal source";
}

TEST_F(VelodyneControlTest, RefusesSettingsByName) {
  const auto refused = [&](auto change, const char* text) {
    VelodyneSettings settings;
    change(settings);
    EXPECT_THAT([&] { VelodyneLidar(settings, calendar, data, position); },
                testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr(text)));
  };
  const auto fault = [&](VelodyneFault f, const char* text, const char* model = "HDL-32E",
                         VelodyneTimeSource source = VelodyneTimeSource::ideal) {
    refused(
        [&](VelodyneSettings& s) {
          s.model = model;
          s.time_source = source;
          s.faults.push_back(f);
        },
        text);
  };
  refused([](auto& s) { s.model = "HDL-65"; }, "allowed: HDL-32E, VLP-16");
  refused([](auto& s) { s.saved.rotor_rpm = 299.0; }, "rotor_rpm is 299");
  refused([](auto& s) { s.saved.rotor_rpm = 600.5; }, "in steps of 1");
  refused([](auto& s) { s.saved.rotor_rpm = std::nan(""); },
          "rate: found nan rpm, allowed 0 .. 1200 rpm");
  refused(
      [](auto& s) {
        s.model = "VLP-16";
        s.saved.rotor_rpm = 601.0;
      },
      "rotor_rpm is 601.000000, allowed: 0 or 300.000000 to 1200.000000 in steps of 60");
  refused(
      [](auto& s) {
        s.model = "HDL-64E S2";
        s.saved.return_mode = ReturnMode::dual;
      },
      "return_mode is dual, which the HDL-64E S2 cannot");
  refused([](auto& s) { s.saved.view_start_deg = 360; },
          "fov.start: found 360 deg, allowed 0 .. 359 deg");
  refused([](auto& s) { s.saved.view_end_deg = -1; }, "fov.end: found -1 deg");
  refused([](auto& s) { s.saved.phase_lock_offset_centideg = 36000; },
          "phase_lock.offset: found 36000");
  refused([](auto& s) { s.maximum_range_m = 140.0; },
          "maximum_range: found 140 m, allowed 0 .. 131.07 m");
  refused([](auto& s) { s.minimum_range_m = 120.0; }, "range limits");
  refused([](auto& s) { s.minimum_range_m = -1.0; }, "minimum_range: found -1 m");
  refused([](auto& s) { s.send_delay = nanoseconds{-1}; }, "send_delay");
  refused([](auto& s) { s.send_delay = milliseconds{1}; },
          "send_delay: found 1 ms, allowed 0 s .. ");
  refused([](auto& s) { s.position_period = nanoseconds{1}; }, "position_period");
  refused([](auto& s) { s.start_up = seconds{601}; }, "start_up");
  refused([](auto& s) { s.clock_drift_ppm = 201.0; }, "clock.drift: found 201 ppm");
  refused([](auto& s) { s.pulse_length = milliseconds{19}; }, "pulse_length");
  refused([](auto& s) { s.sentence_delay = milliseconds{501}; }, "sentence_delay");
  refused(
      [](auto& s) {
        s.inertial_axes[1].gyro = {1, 1, 0};
      },
      "inertial.second: velodyne lidar: gyro");
  fault({.when = {}, .what = LostPacketsFault{.share = 0.0}}, "share: found 0 %, allowed above 0");
  fault({.when = between(seconds{2}, seconds{1}), .what = MotorStallFault{}}, "for: found -1 s");
  fault({.when = {}, .what = DeadLaserFault{.first = 16, .last = 16}},
        "dead_laser first is 16, allowed: 0 to 15", "VLP-16");
  fault({.when = {}, .what = DirtyWindowFault{.to_deg = 0.0}}, "dirt to is where it begins");
  fault({.when = {}, .what = DirtyWindowFault{.to_deg = 90.0, .transmission = 1.1}},
        "transmission: found 110 %");
  fault({.when = {}, .what = PulseLossFault{}}, "needs a pulse", "VLP-16",
        VelodyneTimeSource::none);
  fault({.when = {}, .what = SentenceLossFault{}}, "needs sentences", "VLP-16",
        VelodyneTimeSource::pulse_only);
  fault({.when = {}, .what = ClockOffsetFault{.offset_s = 0.0}}, "offset is 0");
  fault({.when = {}, .what = HourOverrunFault{.overrun_s = 2.0}}, "overrun: found 2 s");
  fault({.when = {}, .what = FactoryBytesFault{}}, "has a status channel", "HDL-64E S3");
}

}  // namespace
}  // namespace rigwire::emulators
