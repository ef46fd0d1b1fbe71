#include "emulators/velodyne/velodyne_lidar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "recorder.h"

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using testing::HasSubstr;
using testing::ThrowsMessage;

class VelodyneLidarTest : public testing::Test {
 protected:
  Calendar calendar{parse_utc("2026-06-01T08:59:59.9Z")};
  test::ByteRecorder data;
  test::ByteRecorder position;

  static LidarFiring firing(const VelodyneLidar& lidar, std::int64_t number, float range,
                            float reflectivity = 0.5F) {
    LidarFiring result;
    result.time = lidar.sample_plan().first + number * lidar.sample_plan().period;
    result.rotor_azimuth_rad = std::fmod(lidar.command().rotor_rate_radps * to_seconds(result.time),
                                         2.0 * std::numbers::pi);
    result.rotor_rate_radps = lidar.command().rotor_rate_radps;
    result.strongest.fill({range, reflectivity});
    return result;
  }

  static void fire(VelodyneLidar& lidar, std::int64_t count, float range = 10.0F) {
    for (std::int64_t i = 0; i < count; ++i) {
      lidar.update(firing(lidar, i, range));
    }
  }

  static velodyne::DataPacket packet(const test::ByteRecorder::Sent& sent) {
    const auto decoded = velodyne::decode_data_packet(sent.bytes);
    EXPECT_TRUE(decoded.ok());
    return *decoded;
  }
};

TEST_F(VelodyneLidarTest, PacketsAreDueAfterTheirLastShotEvery552960Nanoseconds) {
  VelodyneLidar lidar({}, calendar, data, position);
  fire(lidar, 12 * 2000);
  ASSERT_EQ(data.sent.size(), 2000U);
  const SimTime first_shot = kStart + nanoseconds{46080};
  EXPECT_EQ(data.sent[0].due, first_shot + nanoseconds{11 * 46080 + 31 * 1152} + microseconds{5});
  for (std::size_t i = 1; i < data.sent.size(); ++i) {
    ASSERT_EQ(data.sent[i].due - data.sent[i - 1].due, nanoseconds{552960});
  }
}

TEST_F(VelodyneLidarTest, TimeOfHourWrapsAtTheFullHour) {
  VelodyneLidar lidar({}, calendar, data, position);
  fire(lidar, 12 * 400);
  const std::uint32_t first = packet(data.sent[0]).timestamp_us;
  EXPECT_EQ(first, 3599900046U);
  bool wrapped = false;
  for (std::size_t i = 1; i < data.sent.size(); ++i) {
    const auto stamp = packet(data.sent[i]).timestamp_us;
    const auto truth =
        (3599900000000LL + 46080 + static_cast<long long>(i) * 552960) % 3600000000000LL / 1000;
    ASSERT_EQ(stamp, truth);
    wrapped = wrapped || stamp < 1000;
  }
  EXPECT_TRUE(wrapped);
}

TEST_F(VelodyneLidarTest, AzimuthNeverReaches36000AndNeverTurnsBack) {
  VelodyneLidar lidar({}, calendar, data, position);
  LidarFiring last = firing(lidar, 0, 5.0F);
  last.rotor_azimuth_rad = 359.996 * std::numbers::pi / 180.0;
  lidar.update(last);
  for (std::int64_t i = 1; i < 12 * 800; ++i) {
    lidar.update(firing(lidar, i, 5.0F));
  }
  EXPECT_EQ(packet(data.sent[0]).blocks[0].azimuth_counts, 0);
  int before = packet(data.sent[0]).blocks[1].azimuth_counts;
  for (std::size_t i = 1; i < data.sent.size(); ++i) {
    for (const auto& block : packet(data.sent[i]).blocks) {
      const int step = (block.azimuth_counts - before + 36000) % 36000;
      ASSERT_GT(step, 0);
      ASSERT_LT(step, 36000 / 2);
      before = block.azimuth_counts;
    }
  }
}

TEST_F(VelodyneLidarTest, RangesAreRoundedToTwoMillimetresAndNoneIsZero) {
  VelodyneLidar lidar({}, calendar, data, position);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::int64_t i = 0; i < 12; ++i) {
    LidarFiring shot = firing(lidar, i, 0.0F);
    shot.strongest[0] = {12.3449F, 0.499F};
    shot.strongest[1] = {12.3451F, 2.0F};
    shot.strongest[2] = {0.1F, 0.5F};     // nearer than the minimum
    shot.strongest[3] = {100.01F, 0.5F};  // farther than the maximum
    shot.strongest[4] = {nan, nan};
    shot.strongest[5] = {1.0F, 0.0F};
    lidar.update(shot);
  }
  ASSERT_EQ(data.sent.size(), 1U);
  const auto channels = packet(data.sent[0]).blocks[3].channels;
  EXPECT_EQ(channels[0], (velodyne::Channel{6172, 50}));
  EXPECT_EQ(channels[1], (velodyne::Channel{6173, 255})) << "an ideal retro-reflector";
  EXPECT_EQ(channels[2], (velodyne::Channel{0, 255})) << "as in a capture of a real one";
  EXPECT_EQ(channels[3], (velodyne::Channel{0, 255}));
  EXPECT_EQ(channels[4], (velodyne::Channel{0, 255}));
  EXPECT_EQ(channels[5], (velodyne::Channel{500, 0})) << "black but there";
}

TEST_F(VelodyneLidarTest, FactoryBytesFollowTheFirmware) {
  VelodyneLidar modern({}, calendar, data, position);
  fire(modern, 12);
  EXPECT_EQ(data.sent[0].bytes[1204], 0x37);
  EXPECT_EQ(data.sent[0].bytes[1205], 0x21);
  VelodyneSettings old;
  old.legacy_factory_bytes = true;
  VelodyneLidar legacy(old, calendar, data, position);
  fire(legacy, 12);
  EXPECT_EQ(data.sent[1].bytes[1204], 0x00);
  EXPECT_EQ(data.sent[1].bytes[1205], 0x00);
}

TEST_F(VelodyneLidarTest, GapInTheFiringsBeginsANewPacket) {
  VelodyneLidar lidar({}, calendar, data, position);
  fire(lidar, 5);
  for (std::int64_t i = 100; i < 112; ++i) {
    lidar.update(firing(lidar, i, 10.0F));
  }
  ASSERT_EQ(data.sent.size(), 1U);
  EXPECT_EQ(packet(data.sent[0]).timestamp_us, 3599900000U + 101U * 46080U / 1000U);
}

TEST_F(VelodyneLidarTest, PositionPacketsCarryTheSecondBeforeAndTheFix) {
  VelodyneLidar lidar({}, calendar, data, position);
  lidar.advance(kStart + nanoseconds{14 * 552960 - 1});
  EXPECT_TRUE(position.sent.empty());
  lidar.advance(kStart + milliseconds{100});
  GnssSample fix;
  fix.fix = GnssFix::three_d;
  fix.latitude_deg = 49.5;
  fix.longitude_deg = 7.75;
  lidar.observe_fix(fix);
  lidar.advance(kStart + milliseconds{400});
  ASSERT_EQ(position.sent.size(), 51U);
  const auto early = velodyne::decode_position_packet(position.sent[0].bytes);
  ASSERT_TRUE(early.ok());
  EXPECT_EQ(early->pulse_state, velodyne::PulseState::locked);
  EXPECT_EQ(early->timestamp_us, 3599907741U);
  EXPECT_THAT(std::string(early->sentence()), HasSubstr("$GPRMC,085959,V,,,,,,,010626"));
  // The sentence of 09:00:00 comes 225 ms after its pulse: 0.325 s after this start.
  const auto at = [&](int ms) {
    for (const test::ByteRecorder::Sent& sent : position.sent) {
      if (sent.due >= kStart + milliseconds{ms}) {
        return std::string(velodyne::decode_position_packet(sent.bytes)->sentence());
      }
    }
    return std::string();
  };
  EXPECT_THAT(at(310), HasSubstr("$GPRMC,085959,V"));
  EXPECT_THAT(at(330), HasSubstr("$GPRMC,090000,A,4930.0000,N,00745.0000,E"));
  EXPECT_EQ(lidar.readings(kStart + milliseconds{400}).gps_position, "49 30.0000N 007 45.0000E");
}

}  // namespace
}  // namespace rigwire::emulators
