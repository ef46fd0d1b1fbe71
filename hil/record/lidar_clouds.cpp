#include "hil/record/lidar_clouds.h"

#include <fmt/format.h>

#include <bit>
#include <iterator>
#include <nlohmann/json.hpp>

#include "hil/record/base64.h"
#include "protocols/bytes.h"
#include "protocols/velodyne/packet_layout.h"

namespace rigwire::hil {
namespace {

namespace velodyne = protocols::velodyne;

// A point as it lies in `data`, little-endian: x, y, z in m, reflectivity, laser.
constexpr std::size_t kPointSize = 3 * 4  // x, y, z
                                   + 1    // reflectivity
                                   + 1;   // laser
// foxglove.NumericType.
constexpr int kUint8 = 1;
constexpr int kFloat32 = 7;

}  // namespace

const std::string* LidarClouds::take(SimTime at, std::span<const std::uint8_t> datagram,
                                     std::int64_t start_unix_ns) {
  if (datagram.size() != velodyne::kDataPacketSize) {
    return nullptr;  // a position packet
  }
  const auto packet = velodyne::decode_data_packet(datagram);
  if (!packet.ok()) {
    return nullptr;
  }
  const auto* const model = velodyne::recognize(*packet).model;
  if (model == nullptr) {
    return nullptr;
  }
  if (model != model_) {
    model_ = model;
    reader_.emplace(*model);
    begun_.reset();
  }
  const std::uint16_t azimuth = packet->blocks.front().azimuth_counts;
  const bool turned = azimuth_counts_ && azimuth < *azimuth_counts_;
  azimuth_counts_ = azimuth;
  const bool whole = turned && begun_;
  if (whole) {
    lay_out(start_unix_ns);
    begun_.reset();
  }
  if (turned && at >= next_) {
    begun_ = at;
    next_ = std::max(next_ + every_, at);
    points_.clear();
  }
  if (begun_) {
    reader_->append(*packet, points_);
  }
  return whole ? &text_ : nullptr;
}

void LidarClouds::lay_out(std::int64_t start_unix_ns) {
  data_.resize(points_.size() * kPointSize);
  std::size_t at = 0;
  for (const velodyne::Point& point : points_) {
    for (const float value : {point.x_m, point.y_m, point.z_m}) {
      protocols::store_little(std::span(data_), at, std::bit_cast<std::uint32_t>(value));
      at += 4;
    }
    data_[at++] = point.reflectivity;
    data_[at++] = point.laser;
  }
  const std::int64_t ns = start_unix_ns + begun_->time_since_epoch().count();
  const Eigen::Vector3d p = lidar_.X_LS.translation();
  const Eigen::Quaterniond q(lidar_.X_LS.linear());
  text_.clear();
  fmt::format_to(
      std::back_inserter(text_),
      R"({{"timestamp":{{"sec":{},"nsec":{}}},"frame_id":{},"pose":{{)"
      R"("position":{{"x":{:.12g},"y":{:.12g},"z":{:.12g}}},)"
      R"("orientation":{{"x":{:.12g},"y":{:.12g},"z":{:.12g},"w":{:.12g}}}}},"point_stride":{},)",
      ns / 1'000'000'000, ns % 1'000'000'000, nlohmann::json(lidar_.link).dump(), p.x(), p.y(),
      p.z(), q.x(), q.y(), q.z(), q.w(), kPointSize);
  fmt::format_to(std::back_inserter(text_),
                 R"("fields":[{{"name":"x","offset":0,"type":{0}}},)"
                 R"({{"name":"y","offset":4,"type":{0}}},{{"name":"z","offset":8,"type":{0}}},)"
                 R"({{"name":"reflectivity","offset":12,"type":{1}}},)"
                 R"({{"name":"laser","offset":13,"type":{1}}}],"data":")",
                 kFloat32, kUint8);
  append_base64(text_, data_);
  text_ += "\"}";
}

}  // namespace rigwire::hil
