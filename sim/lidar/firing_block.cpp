#include "sim/lidar/firing_block.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rigwire::sim {

HeadLanes::HeadLanes(const LidarPattern& pattern, const LidarPattern& order_of) {
  const std::size_t laser_count = pattern.lasers.size();
  std::vector<std::uint32_t> by_elevation(laser_count);
  std::iota(by_elevation.begin(), by_elevation.end(), 0U);
  std::ranges::stable_sort(by_elevation, {},
                           [&](std::uint32_t i) { return order_of.lasers[i].elevation_rad; });
  for (std::size_t count = 1; count <= kLanes; ++count) {
    const std::size_t rays = count * laser_count;
    auto& packets = packets_[count - 1];
    packets.resize((rays + kLanes - 1) / kLanes);
    for (std::size_t ray = 0; ray < packets.size() * kLanes; ++ray) {
      RingPacket& packet = packets[ray / kLanes];
      const std::size_t lane = ray % kLanes;
      const std::size_t carried = std::min(ray, rays - 1);
      const std::uint32_t number = by_elevation[carried / count];
      packet.map.firing[lane] = static_cast<std::uint32_t>(carried % count);
      packet.map.laser[lane] = number;
      const LaserGeometry& laser = pattern.lasers[number];
      const auto i = static_cast<Eigen::Index>(lane);
      packet.lasers.cos_elevation()(i) = static_cast<float>(std::cos(laser.elevation_rad));
      packet.lasers.sin_elevation()(i) = static_cast<float>(std::sin(laser.elevation_rad));
      packet.lasers.cos_offset()(i) = static_cast<float>(std::cos(laser.azimuth_offset_rad));
      packet.lasers.sin_offset()(i) = static_cast<float>(std::sin(laser.azimuth_offset_rad));
      packet.lasers.up_m()(i) = static_cast<float>(laser.vertical_offset_m);
      packet.lasers.right_m()(i) = static_cast<float>(laser.horizontal_offset_m);
      packet.lasers.delay_s()(i) = static_cast<float>(to_seconds(laser.time_offset));
    }
  }
}

}  // namespace rigwire::sim
