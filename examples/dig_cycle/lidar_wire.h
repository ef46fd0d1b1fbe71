// The lidar's UDP port: Velodyne data packets in, points into Surroundings, and the field's clock:
// microseconds past the hour.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "dig_cycle/machine.h"
#include "dig_cycle/surroundings.h"
#include "protocols/velodyne/points.h"

namespace rigwire::dig_cycle {

class LidarWire {
 public:
  /// `heard` is called for every sound data packet, `arm` asked once per packet.
  LidarWire(Surroundings& surroundings, std::function<ArmShape()> arm, std::function<void()> heard);

  void receive(std::span<const std::uint8_t> datagram);

  /// Timestamp of the newest packet.
  [[nodiscard]] std::optional<std::uint32_t> time_of_hour_us() const { return time_of_hour_us_; }
  [[nodiscard]] std::uint64_t packets() const { return packets_; }
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }

 private:
  Surroundings& surroundings_;
  std::function<ArmShape()> arm_;
  std::function<void()> heard_;
  std::vector<protocols::velodyne::Point> points_;
  std::optional<std::uint32_t> time_of_hour_us_;
  std::uint16_t last_azimuth_counts_ = 0;
  std::uint64_t packets_ = 0;
  std::uint64_t rejected_ = 0;
};

}  // namespace rigwire::dig_cycle
