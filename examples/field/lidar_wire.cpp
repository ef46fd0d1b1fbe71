#include "field/lidar_wire.h"

#include <cmath>
#include <utility>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"

namespace rigwire::field {

namespace velodyne = protocols::velodyne;

LidarPoint LidarMount::to_body(const LidarPoint& point) const {
  const double ahead_m = point.x_m * std::cos(pitch_rad) - point.z_m * std::sin(pitch_rad);
  return {x_m + ahead_m * std::cos(yaw_rad) - point.y_m * std::sin(yaw_rad),
          y_m + ahead_m * std::sin(yaw_rad) + point.y_m * std::cos(yaw_rad),
          z_m + point.x_m * std::sin(pitch_rad) + point.z_m * std::cos(pitch_rad)};
}

LidarWire::LidarWire(Listener listener) : listener_(std::move(listener)) {
  points_.reserve(velodyne::kBlocksPerPacket * velodyne::kChannelsPerBlock);
}

void LidarWire::receive(std::span<const std::uint8_t> datagram) {
  const auto packet = velodyne::decode_data_packet(datagram);
  const velodyne::Model* model = nullptr;
  if (packet.ok()) {
    // Old units send no product id; these machines carry an HDL-32E.
    model = packet->product_id == 0 ? velodyne::find_model("HDL-32E")
                                    : velodyne::find_model(packet->product_id);
  }
  if (model == nullptr) {
    ++rejected_;
    return;
  }
  ++packets_;
  time_of_hour_us_ = packet->timestamp_us;
  const std::uint16_t azimuth_counts = packet->blocks.front().azimuth_counts;
  if (azimuth_counts < last_azimuth_counts_) {
    listener_.revolution();
  }
  last_azimuth_counts_ = azimuth_counts;

  points_.clear();
  if (model != model_) {
    model_ = model;
    reader_.emplace(*model);
  }
  reader_->append(*packet, points_);
  listener_.points(points_);
  listener_.heard();
}

}  // namespace rigwire::field
