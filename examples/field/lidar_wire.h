// The lidar's UDP port: Velodyne data packets in, points and the field's clock (microseconds past
// the hour) out.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "protocols/velodyne/points.h"

namespace rigwire::field {

/// One return, in the sensor's frame or a body's: x ahead, y left, z up.
struct LidarPoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
};

/// Where the lidar sits: its frame in the body's.
struct LidarMount {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double yaw_rad = 0.0;    ///< Left positive.
  double pitch_rad = 0.0;  ///< Nose up positive, after the yaw.

  /// From the sensor's frame to the body's.
  [[nodiscard]] LidarPoint to_body(const LidarPoint& point) const;
};

class LidarWire {
 public:
  /// Callbacks for a sound data packet, in this order.
  struct Listener {
    std::function<void()> revolution;  ///< The rotor has passed its zero: what was is a revolution.
    std::function<void(std::span<const protocols::velodyne::Point>)> points;
    std::function<void()> heard;
  };

  explicit LidarWire(Listener listener);

  void receive(std::span<const std::uint8_t> datagram);

  /// Timestamp of the newest packet.
  [[nodiscard]] std::optional<std::uint32_t> time_of_hour_us() const { return time_of_hour_us_; }
  [[nodiscard]] std::uint64_t packets() const { return packets_; }
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }

 private:
  Listener listener_;
  const protocols::velodyne::Model* model_ = nullptr;  ///< Model of the last packets.
  std::optional<protocols::velodyne::PointReader> reader_;
  std::vector<protocols::velodyne::Point> points_;
  std::optional<std::uint32_t> time_of_hour_us_;
  std::uint16_t last_azimuth_counts_ = 0;
  std::uint64_t packets_ = 0;
  std::uint64_t rejected_ = 0;
};

}  // namespace rigwire::field
