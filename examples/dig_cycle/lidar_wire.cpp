#include "dig_cycle/lidar_wire.h"

#include <utility>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"

namespace rigwire::dig_cycle {

namespace velodyne = protocols::velodyne;

LidarWire::LidarWire(Surroundings& surroundings, std::function<ArmShape()> arm,
                     std::function<void()> heard)
    : surroundings_(surroundings), arm_(std::move(arm)), heard_(std::move(heard)) {
  points_.reserve(velodyne::kBlocksPerPacket * velodyne::kChannelsPerBlock);
}

void LidarWire::receive(std::span<const std::uint8_t> datagram) {
  const auto packet = velodyne::decode_data_packet(datagram);
  const velodyne::Model* model = nullptr;
  if (packet.ok()) {
    // Old units send no product id; this machine carries an HDL-32E.
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
    surroundings_.finish_revolution();
  }
  last_azimuth_counts_ = azimuth_counts;

  points_.clear();
  velodyne::append_points(*packet, *model, points_);
  const ArmShape arm = arm_();
  for (const velodyne::Point& point : points_) {
    surroundings_.add({point.x_m, point.y_m, point.z_m}, arm);
  }
  heard_();
}

}  // namespace rigwire::dig_cycle
