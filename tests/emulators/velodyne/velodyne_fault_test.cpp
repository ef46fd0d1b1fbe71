// Faults: each acts for its time, as strongly as it says, and the same way for the same seed.
#include "emulators/velodyne/velodyne_fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "velodyne_fixture.h"

namespace rigwire::emulators {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class VelodyneFaultTest : public VelodyneFixture {
 protected:
  static VelodyneSettings with(const VelodyneFault& fault, std::uint64_t seed = 1) {
    VelodyneSettings settings;
    settings.faults.push_back(fault);
    settings.seed = seed;
    return settings;
  }
  /// Number of the packet by its timestamp, from 0.
  [[nodiscard]] std::vector<std::int64_t> numbers() const {
    std::vector<std::int64_t> all;
    for (std::size_t p = 0; p < data.sent.size(); ++p) {
      const auto since_us = static_cast<double>(packet(p).timestamp_us() - 3590'000'046);
      all.push_back(std::lround(since_us / 552.96));
    }
    return all;
  }
};

TEST_F(VelodyneFaultTest, LostPacketsAreAsManyAsTheProbabilitySaysAndOnlyInTime) {
  VelodyneLidar lidar(
      with({.when = between(seconds{1}, seconds{4}), .what = LostPacketsFault{.share = 0.25}}),
      calendar, data, position);
  fire_until(lidar, kStart + seconds{5});
  std::size_t before = 0;
  std::size_t during = 0;
  for (const auto& sent : data.sent) {
    before += sent.due < kStart + seconds{1} ? 1 : 0;
    during += sent.due >= kStart + seconds{1} && sent.due < kStart + seconds{4} ? 1 : 0;
  }
  EXPECT_EQ(before, 1808U);
  const double expected = 3.0 * 1808.45 * 0.75;
  EXPECT_NEAR(static_cast<double>(during), expected, 4.0 * std::sqrt(expected * 0.25));
  EXPECT_GT(lidar.packets_lost(), 3.0 * 1808.45 * 0.2);
}

TEST_F(VelodyneFaultTest, SwappedPacketsChangePlacesInPairsAndNoneIsLost) {
  VelodyneLidar lidar(with({.when = between(milliseconds{0}, seconds{10}),
                            .what = SwappedPacketsFault{.share = 1.0}}),
                      calendar, data, position);
  fire(lidar, 12 * 10);
  const std::vector<std::int64_t> order = numbers();
  EXPECT_THAT(order, testing::ElementsAre(1, 0, 3, 2, 5, 4, 7, 6, 9, 8));
}

TEST_F(VelodyneFaultTest, DuplicatedPacketsAreEqualAndComeAtOnce) {
  VelodyneLidar lidar(with({.when = between(milliseconds{0}, seconds{10}),
                            .what = DuplicatedPacketsFault{.share = 1.0}}),
                      calendar, data, position);
  fire(lidar, 12 * 20);
  ASSERT_EQ(data.sent.size(), 40U);
  for (std::size_t p = 0; p < 40; p += 2) {
    EXPECT_EQ(data.sent[p].bytes, data.sent[p + 1].bytes);
    EXPECT_EQ(data.sent[p].due, data.sent[p + 1].due);
  }
  EXPECT_EQ(position.sent.size(), 2U) << "the other port's packets as well";
}

TEST_F(VelodyneFaultTest, WithoutSupplyNothingIsSentAndAfterItTheSensorStartsWithWhatItHasSaved) {
  VelodyneSettings settings;
  settings.start_up = seconds{2};
  settings.supply_faults = {{between(seconds{4}, seconds{6}), NoSupplyFault{}}};
  VelodyneLidar lidar(settings, calendar, data, position);
  fire_until(lidar, kStart + seconds{3});
  VelodyneLiveSettings told = lidar.live_settings();
  told.rotor_rpm = 300.0;
  lidar.apply(kStart + seconds{3}, told);
  fire_until(lidar, kStart + seconds{4});
  lidar.advance(kStart + seconds{4});
  EXPECT_TRUE(lidar.starting_up(kStart + seconds{5})) << "its web interface is silent";
  EXPECT_EQ(lidar.command().rotor_rate_radps, 0.0);
  EXPECT_FALSE(lidar.command().laser_on);
  const std::size_t before = data.sent.size();
  const std::size_t positions = position.sent.size();
  EXPECT_GT(before, 0U);
  fire_until(lidar, kStart + seconds{8});
  EXPECT_EQ(data.sent.size(), before);
  EXPECT_EQ(position.sent.size(), positions);
  EXPECT_EQ(lidar.live_settings().rotor_rpm, settings.saved.rotor_rpm) << "it was not saved";
  fire_until(lidar, kStart + seconds{9});
  EXPECT_GE(data.sent.at(before).due, kStart + seconds{8}) << "it starts up";
  EXPECT_GT(data.sent.size(), before + 1800);
  EXPECT_GT(position.sent.size(), positions);
}

TEST_F(VelodyneFaultTest, SameSeedSameLossesAnotherSeedOthers) {
  const auto kept = [&](std::uint64_t seed) {
    data.sent.clear();
    position.sent.clear();
    next_firing = 0;
    VelodyneLidar lidar(with({.when = between(milliseconds{0}, seconds{10}),
                              .what = LostPacketsFault{.share = 0.5}},
                             seed),
                        calendar, data, position);
    fire(lidar, 12 * 64);
    return numbers();
  };
  const auto first = kept(7);
  EXPECT_EQ(kept(7), first);
  EXPECT_NE(kept(8), first);
}

TEST_F(VelodyneFaultTest, DeadLasersSeeNothingInAnyReturnMode) {
  for (const auto mode :
       {protocols::velodyne::ReturnMode::strongest, protocols::velodyne::ReturnMode::dual}) {
    data.sent.clear();
    position.sent.clear();
    next_firing = 0;
    VelodyneSettings settings = with({.when = between(Duration{0}, seconds{1}),
                                      .what = DeadLaserFault{.first = 34, .last = 35}});
    settings.model = "VLS-128";
    settings.saved.return_mode = mode;
    VelodyneLidar lidar(settings, calendar, data, position);
    see = [](LidarFiring& bank) {
      bank.several = true;
      bank.strongest.fill({10.0F, 0.5F});
      bank.last.fill({20.0F, 0.5F});
    };
    fire(lidar, 3);
    const bool dual = mode == protocols::velodyne::ReturnMode::dual;
    for (std::size_t b = 0; b < (dual ? 8U : 12U); ++b) {
      const bool second_bank = packet(0).flag(b) == 0xDDFF;
      EXPECT_EQ(packet(0).distance(b, 2) == 0, second_bank);
      EXPECT_EQ(packet(0).distance(b, 3) == 0, second_bank);
      EXPECT_NE(packet(0).distance(b, 1), 0);
      EXPECT_NE(packet(0).distance(b, 4), 0);
    }
  }
}

TEST_F(VelodyneFaultTest, DirtTakesTheFarAndDullAndDimsTheRest) {
  // T = 0.7: reaches 100 m sqrt(rho / 0.9) 0.7, so 52 m of a surface of 50 %.
  VelodyneSettings settings =
      with({.when = between(Duration{0}, seconds{1}),
            .what = DirtyWindowFault{.from_deg = 350.0, .to_deg = 20.0, .transmission = 0.7}});
  settings.saved.rotor_rpm = 0.0;
  VelodyneLidar lidar(settings, calendar, data, position);
  see = [](LidarFiring& bank) {
    bank.strongest.fill({50.0F, 0.5F});
    bank.strongest[1] = {54.0F, 0.5F};
    bank.strongest[2] = {10.0F, 0.02F};
    bank.strongest[3] = {12.0F, 0.02F};
    bank.strongest[4] = {30.0F, 2.0F};
  };
  const double reach_m = 100.0 * std::sqrt(0.5 / 0.9) * 0.7;
  ASSERT_GT(reach_m, 50.0);
  ASSERT_LT(reach_m, 54.0);
  fire(lidar, 12);
  azimuth_rad = 19.9 * std::numbers::pi / 180.0;
  fire(lidar, 12);
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_EQ(packet(p).distance(0, 0), 25000);
    EXPECT_EQ(packet(p).reflectivity(0, 0), 25) << "50 % times 0.49";
    EXPECT_EQ(packet(p).distance(0, 1), 0);
    EXPECT_NE(packet(p).distance(0, 2), 0);
    EXPECT_EQ(packet(p).distance(0, 3), 0);
    EXPECT_EQ(packet(p).reflectivity(0, 4), 176) << "101 + 154 * 0.49";
  }
  azimuth_rad = 20.1 * std::numbers::pi / 180.0;
  fire(lidar, 12);
  EXPECT_EQ(packet(2).distance(0, 1), 27000);
  EXPECT_EQ(packet(2).reflectivity(0, 0), 50);
}

TEST_F(VelodyneFaultTest, StallStopsTheRotorAndTheSettingStands) {
  VelodyneLidar lidar(
      with({.when = between(milliseconds{500}, milliseconds{1500}), .what = MotorStallFault{}}),
      calendar, data, position);
  EXPECT_LE(lidar.next_event(), kStart + milliseconds{500});
  fire_until(lidar, kStart + milliseconds{500});
  EXPECT_GT(lidar.command().rotor_rate_radps, 0.0);
  lidar.advance(kStart + milliseconds{500});
  EXPECT_EQ(lidar.command().rotor_rate_radps, 0.0);
  EXPECT_EQ(lidar.live_settings().rotor_rpm, 600);
  EXPECT_TRUE(lidar.readings(kStart + milliseconds{600}).motor_on);
  fire_until(lidar, kStart + seconds{1});
  EXPECT_EQ(lidar.readings(kStart + seconds{1}).motor_rpm, 0.0);
  lidar.advance(kStart + milliseconds{1500});
  EXPECT_GT(lidar.command().rotor_rate_radps, 0.0);
}

TEST_F(VelodyneFaultTest, WrongFactoryBytesForTheirTime) {
  VelodyneLidar lidar(with({.when = between(milliseconds{1}, milliseconds{2}),
                            .what = FactoryBytesFault{.return_mode = 0x42, .product = 0x99}}),
                      calendar, data, position);
  fire(lidar, 12 * 6);
  EXPECT_EQ(data.sent[0].bytes[1204], 0x37);
  EXPECT_EQ(data.sent[2].bytes[1204], 0x42);
  EXPECT_EQ(data.sent[2].bytes[1205], 0x99);
  EXPECT_EQ(data.sent[5].bytes[1205], 0x21);
}

TEST_F(VelodyneFaultTest, ReflectivityScalesOfOldAndLargeModels) {
  const auto bytes = [&](const char* model, VelodyneReflectivity scale) {
    data.sent.clear();
    position.sent.clear();
    next_firing = 0;
    VelodyneSettings settings;
    settings.model = model;
    settings.reflectivity = scale;
    VelodyneLidar lidar(settings, calendar, data, position);
    see = [](LidarFiring& bank) {
      bank.strongest[0] = {10.0F, 0.5F};
      bank.strongest[1] = {10.0F, 1.0F};
      bank.strongest[2] = {10.0F, 1.001F};
      bank.strongest[3] = {10.0F, 1.5F};
      bank.strongest[4] = {10.0F, 2.0F};
    };
    fire(lidar, 12);
    std::vector<int> read;
    for (std::size_t j = 0; j < 5; ++j) {
      read.push_back(packet(0).reflectivity(0, j));
    }
    return read;
  };
  using testing::ElementsAre;
  EXPECT_THAT(bytes("HDL-32E", VelodyneReflectivity::model), ElementsAre(50, 100, 101, 178, 255));
  EXPECT_THAT(bytes("HDL-32E", VelodyneReflectivity::full), ElementsAre(128, 255, 255, 255, 255));
  EXPECT_THAT(bytes("VLS-128", VelodyneReflectivity::model), ElementsAre(55, 110, 111, 183, 255));
  EXPECT_THAT(bytes("VLS-128", VelodyneReflectivity::to_100), ElementsAre(50, 100, 101, 178, 255));
}

TEST_F(VelodyneFaultTest, InertialWordsFollowTheirAxesAndAreZeroWithoutInput) {
  VelodyneSettings settings;
  settings.inertial_axes[2].gyro = {0, 0, -1};
  VelodyneLidar lidar(settings, calendar, data, position);
  lidar.advance(kStart + milliseconds{10});
  for (std::size_t i = 14; i < 38; ++i) {
    ASSERT_EQ(position.sent[0].bytes[i], 0);
  }
  ImuSample motion;
  motion.specific_force_mps2 = {0.0, 1.0, 9.80665};
  motion.angular_rate_radps = {0.1, -0.2, 0.3};
  motion.temperature_c = 40.0;
  lidar.observe_motion(motion);
  lidar.advance(kStart + milliseconds{20});
  const auto read = position_packet(1).inertial;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  EXPECT_EQ(read[0].gyro, std::lround(0.1 * kDegrees / 0.09766));
  EXPECT_EQ(read[1].gyro, std::lround(-0.2 * kDegrees / 0.09766));
  EXPECT_EQ(read[2].gyro, std::lround(-0.3 * kDegrees / 0.09766)) << "as the settings turn it";
  EXPECT_EQ(read[0].acceleration_y, std::lround(1.0 / 0.001221)) << "z of the sensor";
  EXPECT_EQ(read[1].acceleration_x, std::lround(1.0 / 0.001221));
  EXPECT_EQ(read[2].acceleration_y, std::lround(1.0 / 9.80665 / 0.001221)) << "y of the sensor";
  EXPECT_EQ(read[0].temperature, std::lround(15.0 / 0.1453));
}

}  // namespace
}  // namespace rigwire::emulators
