// The block of each echo, read byte by byte, without the tables of the product.
#include "emulators/velodyne/packet_assembly.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "velodyne_fixture.h"

namespace rigwire::emulators {
namespace {

using protocols::velodyne::ReturnMode;

class PacketAssemblyTest : public VelodyneFixture {
 protected:
  static VelodyneSettings of(const char* model, ReturnMode mode) {
    VelodyneSettings settings;
    settings.model = model;
    settings.saved.return_mode = mode;
    return settings;
  }
  /// Laser n of the head at 10 + n / 10 m (last: 20 + n / 10; second: 15 + n / 10).
  void see_three_echoes() {
    see = [](LidarFiring& bank) {
      bank.several = true;
      for (std::size_t i = 0; i < kBankLasers; ++i) {
        const auto n = static_cast<float>(bank.first_laser + i);
        bank.strongest[i] = {10.0F + n / 10.0F, 0.5F};
        bank.second[i] = {15.0F + n / 10.0F, 0.3F};
        bank.last[i] = {20.0F + n / 10.0F, 0.1F};
      }
    };
  }
};

TEST_F(PacketAssemblyTest, Vlp16PutsTwoFiringsIntoABlockWithTheAzimuthOfTheFirst) {
  VelodyneLidar lidar(of("VLP-16", ReturnMode::strongest), calendar, data, position);
  int firing = 0;
  see = [&](LidarFiring& bank) {
    bank.strongest.fill({1.0F + static_cast<float>(firing), 0.5F});
    ++firing;
  };
  fire(lidar, 24);
  ASSERT_EQ(data.sent.size(), 1U);
  for (std::size_t b = 0; b < 12; ++b) {
    EXPECT_EQ(packet(0).flag(b), 0xEEFF);
    for (std::size_t j = 0; j < 32; ++j) {
      ASSERT_EQ(packet(0).distance(b, j), 500 * (1 + 2 * static_cast<int>(b) + (j < 16 ? 0 : 1)));
    }
    // 600 rpm: 0.199 0656 degrees per firing; block b is firing 2 b + 1 since azimuth 0.
    const double degrees = 0.1990656 * (2.0 * static_cast<double>(b) + 1.0);
    EXPECT_EQ(packet(0).azimuth(b), std::lround(degrees * 100.0));
  }
  EXPECT_EQ(packet(0).bytes[1204], 0x37);
  EXPECT_EQ(packet(0).bytes[1205], 0x22);
}

TEST_F(PacketAssemblyTest, EvenBlockIsLastAndOddBlockStrongestWithTheSameAzimuth) {
  for (const char* model : {"HDL-32E", "VLP-32C", "VLP-16", "Puck Hi-Res"}) {
    data.sent.clear();
    next_firing = 0;
    VelodyneLidar lidar(of(model, ReturnMode::dual), calendar, data, position);
    EXPECT_TRUE(lidar.command().several_echoes);
    see_three_echoes();
    const bool sixteen = lidar.pattern().lasers.size() == 16;
    const int unit_mm = std::string_view(model) == "VLP-32C" ? 4 : 2;
    fire(lidar, sixteen ? 12 : 6);
    ASSERT_EQ(data.sent.size(), 1U) << model;
    for (std::size_t b = 0; b < 12; b += 2) {
      EXPECT_EQ(packet(0).azimuth(b), packet(0).azimuth(b + 1));
      EXPECT_TRUE(b == 0 || packet(0).azimuth(b) > packet(0).azimuth(b - 1));
      for (std::size_t j = 0; j < 32; ++j) {
        const int laser_mm = static_cast<int>(sixteen ? j % 16 : j) * 100;
        ASSERT_EQ(packet(0).distance(b, j), (20000 + laser_mm) / unit_mm) << model;
        ASSERT_EQ(packet(0).distance(b + 1, j), (10000 + laser_mm) / unit_mm) << model;
        ASSERT_EQ(packet(0).reflectivity(b, j), 10);
        ASSERT_EQ(packet(0).reflectivity(b + 1, j), 50);
      }
    }
    EXPECT_EQ(packet(0).bytes[1204], 0x39);
  }
}

TEST_F(PacketAssemblyTest, SecondStrongestTakesThePlaceOfAStrongestThatIsAlsoTheLast) {
  VelodyneLidar lidar(of("HDL-32E", ReturnMode::dual), calendar, data, position);
  see = [](LidarFiring& bank) {
    bank.several = true;
    bank.strongest.fill({30.0F, 0.5F});
    bank.last.fill({30.0F, 0.5F});
    bank.second.fill({12.0F, 0.2F});
  };
  fire(lidar, 6);
  ASSERT_EQ(data.sent.size(), 1U);
  EXPECT_EQ(packet(0).distance(0, 7), 15000);
  EXPECT_EQ(packet(0).distance(1, 7), 6000);
  EXPECT_EQ(packet(0).reflectivity(1, 7), 20);
}

TEST_F(PacketAssemblyTest, OneEchoFillsBothBlocksWithTheSameBytes) {
  for (const char* model : {"HDL-32E", "VLP-16", "VLP-32C", "HDL-64E S3", "VLS-128"}) {
    for (const bool several : {false, true}) {
      data.sent.clear();
      next_firing = 0;
      VelodyneLidar lidar(of(model, ReturnMode::dual), calendar, data, position);
      see = [&](LidarFiring& bank) {
        bank.several = several;
        for (std::size_t i = 0; i < kBankLasers; ++i) {
          bank.strongest[i] = {5.0F + static_cast<float>(i), 0.4F};
          if (several) {
            bank.last[i] = bank.strongest[i];
          }
        }
      };
      fire(lidar, 12);
      ASSERT_FALSE(data.sent.empty()) << model;
      const bool halves = std::string_view(model) == "HDL-64E S3";
      const auto bytes = [&](std::size_t block) {
        const auto begin = data.sent[0].bytes.begin() + static_cast<std::ptrdiff_t>(100 * block);
        return std::vector<std::uint8_t>(begin, begin + 100);
      };
      for (std::size_t b = 0; b < 8; b += halves ? 4 : 2) {
        ASSERT_EQ(bytes(b), bytes(b + (halves ? 2 : 1))) << model << " block " << b;
        ASSERT_NE(packet(0).distance(b, 0), 0);
      }
    }
  }
}

TEST_F(PacketAssemblyTest, Hdl64ePairsItsBanksAndSendsTheStrongestOfBothFirst) {
  VelodyneLidar single(of("HDL-64E S2", ReturnMode::strongest), calendar, data, position);
  see_three_echoes();
  fire(single, 6);
  ASSERT_EQ(data.sent.size(), 1U);
  for (std::size_t b = 0; b < 12; ++b) {
    EXPECT_EQ(packet(0).flag(b), b % 2 == 0 ? 0xEEFF : 0xDDFF);
    EXPECT_EQ(packet(0).azimuth(b), packet(0).azimuth(b - b % 2));
  }
  data.sent.clear();
  next_firing = 0;
  VelodyneLidar dual(of("HDL-64E S3", ReturnMode::dual), calendar, data, position);
  fire(dual, 3);
  ASSERT_EQ(data.sent.size(), 1U);
  for (std::size_t b = 0; b < 12; ++b) {
    EXPECT_EQ(packet(0).flag(b), b % 2 == 0 ? 0xEEFF : 0xDDFF);
    EXPECT_EQ(packet(0).azimuth(b), packet(0).azimuth(b - b % 4));
    EXPECT_EQ(packet(0).distance(b, 0) < 7500, b % 4 < 2) << "strongest is nearer than 15 m";
  }
}

TEST_F(PacketAssemblyTest, Vls128HasFourFlagsAndLeavesFourBlocksEmptyInDualMode) {
  static constexpr int kFlags[] = {0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF};
  VelodyneLidar single(of("VLS-128", ReturnMode::last), calendar, data, position);
  see_three_echoes();
  fire(single, 3);
  ASSERT_EQ(data.sent.size(), 1U);
  for (std::size_t b = 0; b < 12; ++b) {
    EXPECT_EQ(packet(0).flag(b), kFlags[b % 4]);
    EXPECT_EQ(packet(0).distance(b, 1), (20000 + 100 * static_cast<int>(b % 4 * 32 + 1)) / 4);
  }
  EXPECT_EQ(packet(0).bytes[1204], 0x38);
  EXPECT_EQ(packet(0).bytes[1205], 0xA1);
  data.sent.clear();
  next_firing = 0;
  VelodyneLidar dual(of("VLS-128", ReturnMode::dual), calendar, data, position);
  fire(dual, 2);
  ASSERT_EQ(data.sent.size(), 2U) << "one firing fills a packet";
  for (std::size_t b = 0; b < 8; ++b) {
    EXPECT_EQ(packet(0).flag(b), kFlags[b / 2]);
    const int metres = b % 2 == 0 ? 20 : 10;
    EXPECT_EQ(packet(0).distance(b, 0), (metres * 1000 + 100 * static_cast<int>(b / 2 * 32)) / 4);
  }
  for (std::size_t at = 800; at < 1200; ++at) {
    ASSERT_EQ(data.sent[1].bytes[at], 0);
  }
}

TEST_F(PacketAssemblyTest, LastReturnIsTheFarthestAndTheOnlyOneWithoutOthers) {
  VelodyneLidar lidar(of("HDL-32E", ReturnMode::last), calendar, data, position);
  see_three_echoes();
  fire(lidar, 12);
  see = [](LidarFiring& bank) { bank.strongest.fill({10.0F, 0.5F}); };
  fire(lidar, 12);
  EXPECT_EQ(packet(0).distance(0, 0), 10000);
  EXPECT_EQ(packet(1).distance(0, 0), 5000);
  EXPECT_EQ(packet(0).bytes[1204], 0x38);
}

TEST_F(PacketAssemblyTest, DualReturnDoublesTheRateAndKeepsEachFiringInOnePacket) {
  VelodyneLidar single(of("VLP-16", ReturnMode::strongest), calendar, data, position);
  EXPECT_NEAR(single.nominal_rate_hz(), 753.52 + 753.52 / 14, 0.01);
  VelodyneLidar dual(of("VLP-16", ReturnMode::dual), calendar, data, position);
  EXPECT_NEAR(dual.nominal_rate_hz(), 1507.04 + 753.52 / 14, 0.01);
  fire(dual, 12 * 50);
  ASSERT_EQ(data.sent.size(), 50U);
  for (std::size_t i = 1; i < 50; ++i) {
    EXPECT_EQ((data.sent[i].due - data.sent[i - 1].due).count(), 12 * 55296);
  }
}

}  // namespace
}  // namespace rigwire::emulators
