#include "hil/record/lidar_clouds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <nlohmann/json.hpp>

#include "hil/record/base64.h"
#include "protocols/bytes.h"
#include "protocols/foxglove/cdr_messages.h"

namespace rigwire::hil {
namespace {

namespace foxglove = protocols::foxglove;
namespace velodyne = protocols::velodyne;

// A point as it lies in `data`, little-endian: x, y, z in m, time in s, reflectivity, laser.
constexpr std::size_t kPointSize = 3 * 4  // x, y, z
                                   + 4    // time
                                   + 1    // reflectivity
                                   + 1;   // laser
constexpr std::array<foxglove::PackedField, 6> kFields{
    {{"x", 0, foxglove::NumericType::float32},
     {"y", 4, foxglove::NumericType::float32},
     {"z", 8, foxglove::NumericType::float32},
     {"time", 12, foxglove::NumericType::float32},
     {"reflectivity", 16, foxglove::NumericType::uint8},
     {"laser", 17, foxglove::NumericType::uint8}}};

constexpr std::uint32_t kHour_us = 3'600'000'000U;

template <class Bytes>
void append_data(Bytes& bytes, const LidarCloud& cloud) {
  std::array<std::uint8_t, kPointSize> one{};
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const velodyne::Point& point = cloud.points[i];
    std::size_t at = 0;
    for (const float value : {point.x_m, point.y_m, point.z_m, cloud.times_s[i]}) {
      protocols::store_little(std::span(one), at, std::bit_cast<std::uint32_t>(value));
      at += 4;
    }
    one[at] = point.reflectivity;
    one[at + 1] = point.laser;
    bytes.insert(bytes.end(), one.begin(), one.end());
  }
}

std::int64_t begun_unix_ns(const LidarCloud& cloud, std::int64_t start_unix_ns) {
  return start_unix_ns + cloud.begun.time_since_epoch().count();
}

}  // namespace

std::optional<LidarCloud> LidarClouds::take(SimTime at, std::span<const std::uint8_t> datagram) {
  if (datagram.size() != velodyne::kDataPacketSize) {
    return std::nullopt;  // a position packet
  }
  const auto packet = velodyne::decode_data_packet(datagram);
  if (!packet.ok()) {
    return std::nullopt;
  }
  const std::uint16_t azimuth = packet->blocks.front().azimuth_counts;
  const bool turned = azimuth_counts_ && azimuth < *azimuth_counts_;
  azimuth_counts_ = azimuth;
  std::optional<LidarCloud> cloud;
  if (turned && begun_) {
    std::swap(whole_, turn_);
    cloud.emplace(LidarCloud{*begun_, lidar_, whole_.points, whole_.times_s});
    begun_.reset();
  }
  if (turned && at >= next_) {
    begun_ = at;
    begun_us_ = packet->timestamp_us;
    next_ = std::max(next_ + every_, at);
    turn_.points.clear();
    turn_.times_s.clear();
  }
  if (begun_) {
    const std::size_t before = turn_.points.size();
    reader_.append(*packet, turn_.points);
    // Time stamps begin anew with each hour.
    const double packet_s =
        1e-6 * ((packet->timestamp_us % kHour_us + kHour_us - begun_us_ % kHour_us) % kHour_us);
    for (const velodyne::Point& point : std::span(turn_.points).subspan(before)) {
      turn_.times_s.push_back(static_cast<float>(packet_s + 1e-9 * point.packet_offset_ns));
    }
  }
  return cloud;
}

std::string json_message(const LidarCloud& cloud, std::int64_t start_unix_ns) {
  const std::int64_t ns = begun_unix_ns(cloud, start_unix_ns);
  const Eigen::Vector3d p = cloud.lidar.X_LS.translation();
  const Eigen::Quaterniond q(cloud.lidar.X_LS.linear());
  std::string text = fmt::format(
      R"({{"timestamp":{{"sec":{},"nsec":{}}},"frame_id":{},"pose":{{)"
      R"("position":{{"x":{:.12g},"y":{:.12g},"z":{:.12g}}},)"
      R"("orientation":{{"x":{:.12g},"y":{:.12g},"z":{:.12g},"w":{:.12g}}}}},"point_stride":{},)"
      R"("fields":[)",
      ns / 1'000'000'000, ns % 1'000'000'000, nlohmann::json(cloud.lidar.link).dump(), p.x(), p.y(),
      p.z(), q.x(), q.y(), q.z(), q.w(), kPointSize);
  for (const foxglove::PackedField& field : kFields) {
    fmt::format_to(std::back_inserter(text), R"({}{{"name":"{}","offset":{},"type":{}}})",
                   field.offset == 0 ? "" : ",", field.name, field.offset,
                   static_cast<int>(field.type));
  }
  text += R"(],"data":")";
  std::vector<std::uint8_t> data;
  data.reserve(cloud.points.size() * kPointSize);
  append_data(data, cloud);
  append_base64(text, data);
  text += "\"}";
  return text;
}

std::string cdr_message(const LidarCloud& cloud, std::int64_t start_unix_ns) {
  const Eigen::Vector3d p = cloud.lidar.X_LS.translation();
  const Eigen::Quaterniond q(cloud.lidar.X_LS.linear());
  std::string bytes = foxglove::begin_point_cloud({.unix_ns = begun_unix_ns(cloud, start_unix_ns),
                                                   .frame_id = cloud.lidar.link,
                                                   .position_m = {p.x(), p.y(), p.z()},
                                                   .orientation = {q.x(), q.y(), q.z(), q.w()},
                                                   .point_stride = kPointSize,
                                                   .fields = kFields},
                                                  cloud.points.size() * kPointSize);
  append_data(bytes, cloud);
  return bytes;
}

}  // namespace rigwire::hil
