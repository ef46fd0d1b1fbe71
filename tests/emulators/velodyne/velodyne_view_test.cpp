// The view window, the rotor's standstill and firings that do not follow each other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "velodyne_fixture.h"

namespace rigwire::emulators {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

class VelodyneViewTest : public VelodyneFixture {
 protected:
  static VelodyneSettings view(int start_deg, int end_deg, const char* model = "HDL-32E") {
    VelodyneSettings settings;
    settings.model = model;
    settings.saved.view_start_deg = start_deg;
    settings.saved.view_end_deg = end_deg;
    return settings;
  }
  /// Azimuths of all blocks sent, in counts.
  [[nodiscard]] std::vector<int> azimuths() const {
    std::vector<int> all;
    for (std::size_t p = 0; p < data.sent.size(); ++p) {
      for (std::size_t b = 0; b < 12; ++b) {
        all.push_back(packet(p).azimuth(b));
      }
    }
    return all;
  }
};

TEST_F(VelodyneViewTest, OnlyBlocksOfTheWindowAreSentAndPacketsFillAcrossTheGap) {
  VelodyneLidar lidar(view(45, 134), calendar, data, position);
  fire_until(lidar, kStart + seconds{1});
  // Ten turns of a quarter each, 0.165 888 degrees apart.
  EXPECT_NEAR(static_cast<double>(data.sent.size()), 10.0 * 90.0 / 0.165888 / 12.0, 2.0);
  int jumps = 0;
  const std::vector<int> all = azimuths();
  for (std::size_t i = 1; i < all.size(); ++i) {
    ASSERT_GE(all[i], 4500);
    ASSERT_LT(all[i], 13501);
    jumps += all[i] < all[i - 1] ? 1 : 0;
  }
  EXPECT_EQ(jumps, 9);
}

TEST_F(VelodyneViewTest, TimestampIsThatOfTheFirstFiringInThePacket) {
  VelodyneLidar lidar(view(0, 0), calendar, data, position);
  EXPECT_NEAR(lidar.command().view_end_rad, std::numbers::pi / 180.0, 1e-12) << "one degree";
  // A firing within the first degree happens six times a turn: two turns a packet.
  std::vector<SimTime> within;
  see = [&](LidarFiring& bank) {
    bank.strongest.fill({10.0F, 0.5F});
    if (bank.rotor_azimuth_rad < std::numbers::pi / 180.0) {
      within.push_back(bank.time);
    }
  };
  fire_until(lidar, kStart + seconds{2});
  ASSERT_GT(data.sent.size(), 8U);
  for (std::size_t p = 0; p < data.sent.size(); ++p) {
    const auto since = within[12 * p] - kStart;
    EXPECT_EQ(packet(p).timestamp_us(), 3590'000'000 + since / std::chrono::microseconds{1});
    EXPECT_EQ(data.sent[p].due, within[12 * p + 11] + nanoseconds{31 * 1152 + 5000});
  }
}

TEST_F(VelodyneViewTest, WindowMayContainZero) {
  VelodyneLidar lidar(view(350, 9), calendar, data, position);
  fire_until(lidar, kStart + seconds{1});
  ASSERT_FALSE(data.sent.empty());
  bool above = false;
  bool below = false;
  for (const int azimuth : azimuths()) {
    ASSERT_TRUE(azimuth >= 35000 || azimuth < 1001) << azimuth;
    above = above || azimuth < 1000;
    below = below || azimuth >= 35000;
  }
  EXPECT_TRUE(above && below);
}

TEST_F(VelodyneViewTest, EndJustBeforeTheStartIsAllRound) {
  for (const auto& [start, end] : {std::pair{0, 359}, std::pair{90, 89}}) {
    VelodyneLidar lidar(view(start, end), calendar, data, position);
    EXPECT_EQ(lidar.command().view_start_rad, lidar.command().view_end_rad);
  }
}

TEST_F(VelodyneViewTest, Vlp16KeepsTheSecondFiringOfABlockAtTheEdge) {
  VelodyneLidar lidar(view(10, 19, "VLP-16"), calendar, data, position);
  std::vector<double> in_view_deg;
  see = [&](LidarFiring& bank) {
    const double degrees = bank.rotor_azimuth_rad * 180.0 / std::numbers::pi;
    bank.strongest.fill({degrees >= 10.0 && degrees < 20.0 ? 10.0F : 0.0F, 0.5F});
  };
  fire_until(lidar, kStart + seconds{1});
  ASSERT_FALSE(data.sent.empty());
  for (std::size_t p = 0; p < data.sent.size(); ++p) {
    for (std::size_t b = 0; b < 12; ++b) {
      ASSERT_NE(packet(p).distance(b, 0), 0) << "the first firing is within";
    }
  }
}

TEST_F(VelodyneViewTest, StandingRotorRepeatsItsAzimuthAndPacketsGoOn) {
  VelodyneSettings settings;
  settings.saved.rotor_rpm = 0.0;
  VelodyneLidar lidar(settings, calendar, data, position);
  EXPECT_EQ(lidar.command().rotor_rate_radps, 0.0);
  azimuth_rad = 1.0;
  fire(lidar, 24);
  ASSERT_EQ(data.sent.size(), 2U);
  for (const int azimuth : azimuths()) {
    EXPECT_EQ(azimuth, 5730);
  }
  EXPECT_FALSE(lidar.readings(data.sent.back().due).motor_on);
}

TEST_F(VelodyneViewTest, AzimuthThatTrembledIsHeldInsteadOfTurnedBack) {
  VelodyneLidar lidar({}, calendar, data, position);
  int firing = 0;
  see = [&](LidarFiring& bank) {
    const double tremble_deg = firing % 5 == 4 ? -0.4 : 0.0;
    bank.rotor_azimuth_rad += tremble_deg * std::numbers::pi / 180.0;
    ++firing;
  };
  fire_until(lidar, kStart + milliseconds{500});
  const std::vector<int> all = azimuths();
  for (std::size_t i = 1; i < all.size(); ++i) {
    ASSERT_LT((all[i] - all[i - 1] + 36000) % 36000, 18000);
  }
}

TEST_F(VelodyneViewTest, AzimuthOfNearlyATurnIsZero) {
  VelodyneSettings settings;
  settings.saved.rotor_rpm = 0.0;
  VelodyneLidar lidar(settings, calendar, data, position);
  for (const double degrees : {359.996, 360.0, 720.004, -0.004, 359.994}) {
    see = [&](LidarFiring& bank) { bank.rotor_azimuth_rad = degrees * std::numbers::pi / 180.0; };
    skip_to(lidar, kStart + nanoseconds{46080 * (next_firing + 3)});
    fire(lidar, 12);
    EXPECT_EQ(packet(data.sent.size() - 1).azimuth(0), degrees == 359.994 ? 35999 : 0) << degrees;
  }
}

TEST_F(VelodyneViewTest, NumbersThatAreNoneLeaveNoTrace) {
  VelodyneLidar lidar({}, calendar, data, position);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  fire(lidar, 6);
  see = [&](LidarFiring& bank) { bank.rotor_azimuth_rad = nan; };
  fire(lidar, 1);
  see = [&](LidarFiring& bank) {
    bank.rotor_rate_radps = nan;
    bank.strongest.fill({std::numeric_limits<float>::infinity(), 0.5F});
    bank.strongest[1] = {-5.0F, 0.5F};
    bank.strongest[2] = {5.0F, std::numeric_limits<float>::quiet_NaN()};
    bank.strongest[3] = {5.0F, std::numeric_limits<float>::infinity()};
    bank.strongest[4] = {5.0F, -1.0F};
  };
  fire(lidar, 12);
  ASSERT_EQ(data.sent.size(), 1U) << "the packet with the hole was dropped";
  EXPECT_EQ(packet(0).distance(0, 0), 0);
  EXPECT_EQ(packet(0).distance(0, 1), 0);
  EXPECT_EQ(packet(0).distance(0, 2), 2500);
  EXPECT_EQ(packet(0).reflectivity(0, 2), 0);
  EXPECT_EQ(packet(0).reflectivity(0, 3), 255);
  EXPECT_EQ(packet(0).reflectivity(0, 4), 0);
  EXPECT_EQ(lidar.readings(kStart + seconds{1}).motor_rpm, 0.0);
  ImuSample motion;
  motion.angular_rate_radps = {nan, nan, nan};
  lidar.observe_motion(motion);
  lidar.advance(kStart + seconds{1});
}

TEST_F(VelodyneViewTest, BankOutOfTurnDropsThePacketAndTheNextFiringBeginsAnother) {
  VelodyneSettings settings;
  settings.model = "VLS-128";
  VelodyneLidar lidar(settings, calendar, data, position);
  fire(lidar, 1);
  see = [](LidarFiring& bank) {
    bank.first_laser = bank.first_laser == 64 ? 96 : bank.first_laser;  // 64 got lost
  };
  fire(lidar, 1);
  see = [](LidarFiring&) {};
  fire(lidar, 4);
  ASSERT_EQ(data.sent.size(), 1U);
  EXPECT_EQ(packet(0).timestamp_us(), 3590'000'000 + (3 * 57780 + 8700) / 1000);
}

TEST_F(VelodyneViewTest, PacketCompletesNoEarlierThanAnnounced) {
  for (const char* model : {"HDL-32E", "VLP-16", "VLS-128"}) {
    data.sent.clear();
    position.sent.clear();
    next_firing = 0;
    VelodyneLidar lidar(view(300, 20, model), calendar, data, position);
    EXPECT_EQ(lidar.packet_complete_at(),
              kStart + lidar.sample_plan().period * (std::string_view(model) == "VLP-16"    ? 24
                                                     : std::string_view(model) == "HDL-32E" ? 12
                                                                                            : 3));
    std::size_t sent = 0;
    SimTime announced{};
    while (sent < 20) {
      fire(lidar);
      const SimTime fired =
          lidar.sample_plan().first + (next_firing - 1) * lidar.sample_plan().period;
      if (data.sent.size() > sent) {
        ASSERT_GE(fired, announced);
        sent = data.sent.size();
      }
      announced = lidar.packet_complete_at();
      ASSERT_GT(announced, fired) << "the executive must not wake up in vain for ever";
    }
  }
}

TEST_F(VelodyneViewTest, SensorThatGetsNoFiringsDoesNotAskForTheSameInstantForEver) {
  VelodyneSettings settings;
  settings.model = "HDL-64E S2";
  settings.start_up = seconds{1};
  VelodyneLidar lidar(settings, calendar, data, position);
  for (int i = 0; i < 100; ++i) {
    const SimTime wanted = lidar.packet_complete_at();
    lidar.advance(wanted);
    ASSERT_GT(lidar.packet_complete_at(), wanted);
    ASSERT_LE(lidar.packet_complete_at(), wanted + nanoseconds{288'000});
  }
}

}  // namespace
}  // namespace rigwire::emulators
