// What is drawn for a unit: bytes of shots without a return, and how position packets wait.
#include <set>

#include "velodyne_fixture.h"

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using std::chrono::milliseconds;

class UnitSignature : public VelodyneFixture {
 protected:
  /// Reflectivity bytes of one firing without returns, by laser.
  std::vector<int> no_return_bytes(const std::string& model, std::uint64_t seed,
                                   velodyne::ReturnMode mode = velodyne::ReturnMode::strongest) {
    data.sent.clear();
    position.sent.clear();
    next_firing = 0;
    VelodyneSettings settings;
    settings.model = model;
    settings.seed = seed;
    settings.saved.return_mode = mode;
    VelodyneLidar lidar(settings, calendar, data, position);
    see = [&](LidarFiring& bank) {
      bank.strongest.fill({});
      bank.several = mode == velodyne::ReturnMode::dual;
    };
    fire(lidar, 48);
    std::vector<int> bytes;
    const std::size_t lasers = lidar.pattern().lasers.size();
    const std::size_t channels = std::min<std::size_t>(lasers, 32);
    const std::size_t pair = mode == velodyne::ReturnMode::dual ? 2 : 1;
    for (std::size_t laser = 0; laser < lasers; ++laser) {
      const std::size_t block = laser / 32 * pair;
      for (std::size_t i = 0; i < data.sent.size(); ++i) {
        EXPECT_EQ(packet(i).distance(block, laser % channels), 0);
        EXPECT_EQ(packet(i).reflectivity(block, laser % channels),
                  packet(0).reflectivity(block, laser % channels))
            << "constant over the run";
        EXPECT_EQ(packet(i).reflectivity(block + pair - 1, laser % channels),
                  packet(i).reflectivity(block, laser % channels))
            << "both blocks alike";
      }
      bytes.push_back(packet(0).reflectivity(block, laser % channels));
    }
    return bytes;
  }
};

TEST_F(UnitSignature, ShotsWithoutAReturnHaveBytesAsInTheCaptures) {
  for (const int byte : no_return_bytes("HDL-32E", 1)) {
    EXPECT_EQ(byte, 255);
  }
  for (const std::uint64_t unit : {1U, 2U, 3U}) {
    const std::vector<int> bytes = no_return_bytes("VLP-16", unit);
    for (const int byte : bytes) {
      EXPECT_GE(byte, 3);
      EXPECT_LE(byte, 24);
    }
    EXPECT_GE((std::set<int>(bytes.begin(), bytes.end()).size()), 4U) << "each laser its own";
    EXPECT_EQ(bytes, no_return_bytes("VLP-16", unit));
  }
  EXPECT_NE(no_return_bytes("VLP-16", 1), no_return_bytes("VLP-16", 2));
  for (const char* model : {"VLP-32C", "VLS-128"}) {
    for (const int byte : no_return_bytes(model, 1)) {
      EXPECT_NE(byte, 0) << model;
    }
  }
  for (const int byte : no_return_bytes("HDL-64E S2", 1)) {
    EXPECT_EQ(byte, 0) << "no capture was at hand";
  }
}

TEST_F(UnitSignature, BothBlocksOfAPairAreEqualWhereNothingReturns) {
  (void)no_return_bytes("VLP-16", 1, velodyne::ReturnMode::dual);
  (void)no_return_bytes("VLP-32C", 1, velodyne::ReturnMode::dual);
}

TEST_F(UnitSignature, AFaintReturnKeepsItsByteOfZero) {
  VelodyneLidar lidar({}, calendar, data, position);
  see = [](LidarFiring& bank) { bank.strongest.fill({5.0F, 0.0F}); };
  fire(lidar, 12);
  EXPECT_EQ(packet(0).distance(0, 7), 2500);
  EXPECT_EQ(packet(0).reflectivity(0, 7), 0);
}

TEST_F(UnitSignature, PositionPacketsWaitForTheirPlaceAndTellWhenTheyWereWritten) {
  VelodyneSettings settings;
  settings.model = "VLP-16";
  settings.position_period = std::chrono::microseconds{6900};
  settings.position_wait = milliseconds{4};
  VelodyneLidar lidar(settings, calendar, data, position);
  lidar.advance(kStart + std::chrono::seconds{10});
  ASSERT_GT(position.sent.size(), 1400U);
  double sum_ms = 0.0;
  double least_ms = 1e9;
  double greatest_ms = 0.0;
  for (std::size_t i = 1; i < position.sent.size(); ++i) {
    const double step_ms = to_seconds(position.sent[i].due - position.sent[i - 1].due) * 1e3;
    sum_ms += step_ms;
    least_ms = std::min(least_ms, step_ms);
    greatest_ms = std::max(greatest_ms, step_ms);
    const auto stamped_us = static_cast<std::int64_t>(position_packet(i).timestamp_us) -
                            static_cast<std::int64_t>(position_packet(0).timestamp_us);
    const auto due_us = (position.sent[i].due - position.sent[0].due).count() / 1000;
    EXPECT_NEAR(static_cast<double>(stamped_us), static_cast<double>(due_us), 1.0);
  }
  // The difference of two even draws: 6.9 +- 4 ms. A VLP-16 of 2016: 1.5 to 10.7 ms, mean 6.9 ms.
  EXPECT_GE(least_ms, 2.9);
  EXPECT_LT(least_ms, 3.3);
  EXPECT_LE(greatest_ms, 10.9);
  EXPECT_GT(greatest_ms, 10.5);
  EXPECT_NEAR(sum_ms / static_cast<double>(position.sent.size() - 1), 6.9, 0.01);
}

TEST_F(UnitSignature, APositionPacketThatWouldWaitForTheNextOneIsRefused) {
  VelodyneSettings settings;
  settings.position_period = milliseconds{5};
  settings.position_wait = milliseconds{6};
  EXPECT_THROW(VelodyneLidar(settings, calendar, data, position), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::emulators
