#include "protocols/velodyne/points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "protocols/velodyne/packet_layout.h"

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kCount = 0.01 * std::numbers::pi / 180.0;

/// A packet of the model whose rotor turns by `step` counts with each firing.
DataPacket turning(const Model& model, ReturnMode mode, int start, int step) {
  DataPacket packet;
  packet.return_mode_byte = static_cast<std::uint8_t>(mode);
  packet.product_id = model.product_id;
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    const BlockPlace place = block_place(model, mode, b);
    packet.blocks[b].flag =
        place.echo == BlockEcho::none ? kFlagEmpty : block_flag(place.first_laser);
    packet.blocks[b].azimuth_counts = static_cast<std::uint16_t>(
        (start + step * static_cast<int>(place.first_firing)) % kAzimuthCounts);
  }
  return packet;
}

TEST(VelodynePoints, AzimuthIsInterpolatedAcrossTheWrap) {
  const Model& model = *find_model("HDL-32E");
  DataPacket packet = turning(model, ReturnMode::strongest, 35990, 16);
  packet.blocks[0].channels[31] = {5000, 42};
  packet.blocks[11].channels[15] = {5000, 43};
  std::vector<Point> points;
  PointReader(model).append(packet, points);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_NEAR(points[0].azimuth_rad, (35990 + 16 * 31 * 1152.0 / 46080.0 - 36000) * kCount, 1e-6);
  EXPECT_NEAR(points[0].range_m, 10.0, 1e-6);
  EXPECT_EQ(points[0].reflectivity, 42);
  EXPECT_EQ(points[0].laser, 31);
  const double last = (35990 + 16 * 11 - 36000 + 16 * 15 * 1152.0 / 46080.0) * kCount;
  EXPECT_NEAR(points[1].azimuth_rad, last, 1e-6);
  EXPECT_NEAR(points[1].x_m, 10.0 * std::cos(last), 1e-5);
  EXPECT_NEAR(points[1].y_m, -10.0 * std::sin(last), 1e-5);
  EXPECT_NEAR(points[1].z_m, 0.0, 1e-6);
}

TEST(VelodynePoints, OffsetAzimuthsTurnTheBeamClockwise) {
  const Model& model = *find_model("VLP-32C");
  DataPacket packet = turning(model, ReturnMode::strongest, 0, 20);
  packet.blocks[0].channels[14] = {2500, 1};  // rot_correction -4.2 degrees
  std::vector<Point> points;
  PointReader(model).append(packet, points);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0].azimuth_rad, (420.0 + 20.0 * 7 * 2304 / 55296) * kCount, 1e-6);
  EXPECT_LT(points[0].y_m, 0.0F) << "clockwise is to the right";
  EXPECT_NEAR(points[0].range_m, 10.0, 1e-6);
}

TEST(VelodynePoints, GapOfTheViewWindowIsNotInterpolatedAcross) {
  const Model& model = *find_model("VLP-16");
  DataPacket packet = turning(model, ReturnMode::strongest, 1000, 20);
  for (std::size_t b = 6; b < kBlocksPerPacket; ++b) {
    packet.blocks[b].azimuth_counts = static_cast<std::uint16_t>(30000 + 40 * (b - 6));
  }
  packet.blocks[5].channels[31] = {1000, 1};
  packet.blocks[6].channels[31] = {1000, 1};
  std::vector<Point> points;
  PointReader(model).append(packet, points);
  ASSERT_EQ(points.size(), 2U);
  const double within = 20.0 * (55296 + 15 * 2304) / 55296;
  EXPECT_NEAR(points[0].azimuth_rad, (1200 + within) * kCount, 1e-6);
  EXPECT_NEAR(points[1].azimuth_rad, (30000 + within) * kCount, 1e-6);
}

TEST(VelodynePoints, OneEchoSaidTwiceIsOnePoint) {
  for (const std::string_view name : {"HDL-32E", "VLP-16", "VLP-32C", "HDL-64E S3", "VLS-128"}) {
    const Model& model = *find_model(name);
    DataPacket packet = turning(model, ReturnMode::dual, 0, 20);
    const std::size_t partner = model.status_channel ? 2 : 1;
    const auto last = model.status_channel ? partner : 0;
    const auto strongest = model.status_channel ? 0 : partner;
    packet.blocks[last].channels[3] = {4000, 10};
    packet.blocks[strongest].channels[3] = {2000, 90};
    packet.blocks[0].channels[7] = {3000, 50};
    packet.blocks[partner].channels[7] = {3000, 50};
    std::vector<Point> points;
    PointReader(model).append(packet, points);
    ASSERT_EQ(points.size(), 3U) << name;
    int both = 0;
    for (const Point& point : points) {
      if (point.echo == PointEcho::both) {
        ++both;
        EXPECT_EQ(point.reflectivity, 50);
      } else {
        EXPECT_EQ(point.reflectivity, point.echo == PointEcho::last ? 10 : 90) << name;
      }
    }
    EXPECT_EQ(both, 1) << name;
  }
}

TEST(VelodynePoints, PacketOfOneFiringTakesTheSpeedOfThePacketBefore) {
  const Model& model = *find_model("VLS-128");
  DataPacket packet = turning(model, ReturnMode::dual, 35995, 0);
  packet.timestamp_us = 3'599'999'950U;
  packet.blocks[7].channels[31] = {1000, 1};  // laser 127, 16 groups after the first
  DataPacket next = packet;
  next.timestamp_us = 3U;  // 53 us later, past the hour
  for (Block& block : next.blocks) {
    block.azimuth_counts = 15;
  }
  PointReader reader(model);
  std::vector<Point> points;
  reader.append(packet, points);
  reader.append(next, points);
  ASSERT_EQ(points.size(), 2U);
  const double offset = -635.4;
  EXPECT_NEAR(points[0].azimuth_rad, (35995 + offset) * kCount, 1e-6) << "speed unknown";
  EXPECT_NEAR(points[1].azimuth_rad, (36000 + 15 + offset + 20.0 / 53000 * 16 * 2889) * kCount,
              1e-6);
}

TEST(VelodynePoints, SidewaysExitMovesThePointToTheRight) {
  const Model& model = *find_model("HDL-64E S2");
  DataPacket packet = turning(model, ReturnMode::strongest, 0, 17);
  packet.blocks[0].channels[0] = {5000, 1};  // even laser: exit 26 mm to the left of its beam
  std::vector<Point> points;
  PointReader(model).append(packet, points);
  ASSERT_EQ(points.size(), 1U);
  const Point& point = points[0];
  const double level = 10.0 * std::cos(point.elevation_rad);
  EXPECT_NEAR(point.x_m, level * std::cos(point.azimuth_rad) + 0.026 * std::sin(point.azimuth_rad),
              1e-5);
  EXPECT_NEAR(point.y_m, -level * std::sin(point.azimuth_rad) + 0.026 * std::cos(point.azimuth_rad),
              1e-5);
}

}  // namespace
}  // namespace rigwire::protocols::velodyne
