// Point clouds for viewers, decoded from the packets that a lidar sent: one turn of the head every
// so often, as foxglove.PointCloud.
//
// A cloud begins and ends where the azimuth passes from 360 to 0 degrees, and is told when its turn
// is over. Its points are in the sensor's frame, `pose` places that in the link that carries it; a
// turn takes a tenth of a second, and what the link moves by meanwhile is not taken out. What a
// packet alone does not name (HDL-64E, packets of old firmware) makes no cloud.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocols/velodyne/points.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// A lidar whose packets pass on the wire of its name.
struct RecordedLidar {
  std::string name;
  std::string link;
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();
};

struct CloudSettings {
  Duration every{0};  ///< From a cloud's beginning to the next one's at least; 0: none.
  std::vector<RecordedLidar> lidars;
};

class LidarClouds {
 public:
  /// Of the lidar on one wire.
  LidarClouds(RecordedLidar lidar, Duration every) : lidar_(std::move(lidar)), every_(every) {}

  /// The next datagram of the lidar, which left at that instant. When a cloud is whole its message;
  /// `start_unix_ns` is that of the run. Valid until the next call.
  [[nodiscard]] const std::string* take(SimTime at, std::span<const std::uint8_t> datagram,
                                        std::int64_t start_unix_ns);

 private:
  void lay_out(std::int64_t start_unix_ns);

  RecordedLidar lidar_;
  Duration every_;
  const protocols::velodyne::Model* model_ = nullptr;
  std::optional<protocols::velodyne::PointReader> reader_;
  std::vector<protocols::velodyne::Point> points_;
  std::optional<SimTime> begun_;  ///< The cloud that is on its way.
  SimTime next_ = kStart;
  std::optional<std::uint16_t> azimuth_counts_;
  std::vector<std::uint8_t> data_;
  std::string text_;
};

}  // namespace rigwire::hil
