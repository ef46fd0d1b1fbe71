#include "hil/record/lidar_clouds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "protocols/bytes.h"
#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/model.h"
#include "protocols/velodyne/packet_layout.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
namespace velodyne = protocols::velodyne;

constexpr std::int64_t kStart_unix_ns = 1'780'300'800'000'000'000;

const velodyne::Model& kModel = *velodyne::find_model("HDL-32E");

/// An HDL-32E at ten turns a second: each channel at 10 m.
class Head {
 public:
  explicit Head(std::uint32_t begin_us = 0) : timestamp_us_(begin_us) {}

  std::array<std::uint8_t, velodyne::kDataPacketSize> next() {
    velodyne::DataPacket packet;
    for (velodyne::Block& block : packet.blocks) {
      block.azimuth_counts = static_cast<std::uint16_t>(azimuth_counts_);
      azimuth_counts_ = (azimuth_counts_ + 17) % 36'000;
      block.channels.fill({5000, 7});
    }
    timestamp_us_ = (timestamp_us_ + 553) % 3'600'000'000U;
    packet.timestamp_us = timestamp_us_;
    packet.return_mode_byte = 0x37;
    packet.product_id = 0x21;
    std::array<std::uint8_t, velodyne::kDataPacketSize> bytes{};
    encode(packet, bytes);
    return bytes;
  }

 private:
  std::uint32_t azimuth_counts_ = 9'000;
  std::uint32_t timestamp_us_;
};

std::string from_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  for (std::size_t i = 0; i + 4 <= text.size(); i += 4) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      group = group << 6U |
              (text[i + k] == '=' ? 0U : static_cast<std::uint32_t>(letters.find(text[i + k])));
    }
    for (std::size_t k = 0; k < 3 && text[i + k + 1] != '='; ++k) {
      bytes += static_cast<char>(group >> (16U - 8U * k) & 0xFFU);
    }
  }
  return bytes;
}

TEST(LidarClouds, AreWholeTurnsOneInEveryPeriod) {
  LidarClouds clouds({"lidar", "upper", Eigen::Isometry3d::Identity(), &kModel}, 1s);
  Head head;
  std::vector<double> ends;
  std::optional<nlohmann::json> last;
  std::string bytes_of_last;
  for (SimTime at = kStart; at < kStart + 3s; at += 553us) {
    if (const auto cloud = clouds.take(at, head.next())) {
      ends.push_back(to_seconds(at));
      last = nlohmann::json::parse(json_message(*cloud, kStart_unix_ns));
      bytes_of_last = cdr_message(*cloud, kStart_unix_ns);
    }
  }
  // The first turn that is whole, and one after each second.
  ASSERT_EQ(ends.size(), 3U);
  EXPECT_NEAR(ends[0], 0.18, 0.02);
  EXPECT_NEAR(ends[1] - ends[0], 1.0, 0.11);
  EXPECT_NEAR(ends[2] - ends[1], 1.0, 0.11);
  EXPECT_EQ((*last)["frame_id"], "upper");
  EXPECT_EQ((*last)["fields"][0]["type"], 7);
  const std::string data = from_base64((*last)["data"].get<std::string>());
  const std::size_t stride = (*last)["point_stride"].get<std::size_t>();
  ASSERT_EQ(data.size() % stride, 0U);
  // A stream's message has the same points, at its end.
  EXPECT_TRUE(bytes_of_last.ends_with(data));
  EXPECT_LT(bytes_of_last.size() - data.size(), 256U);
  // A turn of 36000 counts in steps of 17, each of 32 channels.
  EXPECT_NEAR(static_cast<double>(data.size() / stride), 32.0 * 36'000 / 17, 32.0 * 12);
  const auto bytes = std::span(reinterpret_cast<const std::uint8_t*>(data.data()), data.size());
  for (std::size_t at = 0; at < data.size(); at += 100 * stride) {
    double square = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      square += std::pow(
          std::bit_cast<float>(protocols::load_little<std::uint32_t>(bytes, at + 4 * k)), 2);
    }
    EXPECT_NEAR(std::sqrt(square), 10.0, 0.2);
    EXPECT_EQ(bytes[at + 16], 7);
    EXPECT_LT(bytes[at + 17], 32);
  }
}

TEST(LidarClouds, TimesOfPointsRiseAcrossTheFullHour) {
  for (const std::uint32_t begin_us : {0U, 3'600'000'000U - 200'000U}) {
    LidarClouds clouds({"lidar", "upper", Eigen::Isometry3d::Identity(), &kModel}, 0s);
    Head head(begin_us);
    int whole = 0;
    for (SimTime at = kStart; whole < 3; at += 553us) {
      ASSERT_LT(at, kStart + 3s);
      const auto cloud = clouds.take(at, head.next());
      if (!cloud) {
        continue;
      }
      ++whole;
      ASSERT_EQ(cloud->times_s.size(), cloud->points.size());
      EXPECT_NEAR(cloud->times_s.front(), 0.0F, 1e-4F);
      EXPECT_TRUE(std::ranges::is_sorted(cloud->times_s));
      // 36000 counts, 12 blocks of 17 in each 553 us.
      EXPECT_NEAR(cloud->times_s.back(), 36'000.0 / (12 * 17) * 553e-6, 1e-3);
    }
  }
}

TEST(LidarClouds, OfAnHdl64eAreAfterItsCalibration) {
  const velodyne::Model& model = *velodyne::find_model("HDL-64E S3");
  velodyne::Hdl64eCalibration calibration = velodyne::nominal_calibration(model);
  for (velodyne::Hdl64eLaser& laser : calibration.lasers) {
    laser.dist_correction_m = laser.dist_correction_x_m = laser.dist_correction_y_m = 1.25;
  }
  LidarClouds clouds({"lidar", "upper", Eigen::Isometry3d::Identity(), &model, calibration}, 0s);
  velodyne::DataPacket packet;
  std::optional<std::string> told;
  for (std::uint32_t firing = 0; !told; firing += 6) {
    ASSERT_LT(firing, 5000U);
    for (std::size_t b = 0; b < packet.blocks.size(); ++b) {
      packet.blocks[b].flag = velodyne::block_flag(b % 2 * 32);
      packet.blocks[b].azimuth_counts = static_cast<std::uint16_t>((firing + b / 2) * 17 % 36'000);
      packet.blocks[b].channels.fill({4000, 7});  // 8 m
    }
    std::array<std::uint8_t, velodyne::kDataPacketSize> bytes{};
    encode(packet, bytes);
    if (const auto cloud = clouds.take(kStart, bytes)) {
      EXPECT_NEAR(static_cast<double>(cloud->points.size()), 64.0 * 36'000 / 17, 64.0 * 12);
      for (const velodyne::Point& point : cloud->points) {
        ASSERT_NEAR(point.range_m, 9.25, 1e-5);
      }
      told = cdr_message(*cloud, kStart_unix_ns);
    }
  }
}

TEST(LidarClouds, OfWhatIsNoDataPacketAreNone) {
  LidarClouds clouds({"lidar", "upper", Eigen::Isometry3d::Identity(), &kModel}, 1s);
  const std::array<std::uint8_t, 512> position{};
  EXPECT_FALSE(clouds.take(kStart, position));
  const std::array<std::uint8_t, velodyne::kDataPacketSize> zeros{};
  EXPECT_FALSE(clouds.take(kStart, zeros));
}

}  // namespace
}  // namespace rigwire::hil
