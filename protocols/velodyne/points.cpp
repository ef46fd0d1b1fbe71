#include "protocols/velodyne/points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kAzimuthCount = 0.01 * kDegree;
constexpr double kTurn = 2.0 * std::numbers::pi;

/// Counts turned from one block to the next, 0 when that cannot be a rotor's motion.
double step_counts(const DataPacket& packet, std::size_t from) {
  const int difference = (packet.blocks[from + 1].azimuth_counts + kAzimuthCounts -
                          packet.blocks[from].azimuth_counts) %
                         kAzimuthCounts;
  return difference < kAzimuthCounts / 2 ? difference : 0;
}

}  // namespace

void append_points(const DataPacket& packet, const Model& model, std::vector<Point>& points) {
  const double block_period_ns =
      static_cast<double>(model.firings_per_block) * model.firing_period_ns;
  const std::size_t channels = std::min(
      kChannelsPerBlock, model.lasers.size() * static_cast<std::size_t>(model.firings_per_block));
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    const Block& block = packet.blocks[b];
    const double counts_per_ns =
        step_counts(packet, std::min(b, kBlocksPerPacket - 2)) / block_period_ns;
    for (std::size_t c = 0; c < channels; ++c) {
      const Channel& channel = block.channels[c];
      if (channel.distance_counts == 0) {
        continue;
      }
      const Shot fired = shot(model, b, c);
      const Laser& laser = model.lasers[fired.laser];
      const double range = channel.distance_counts * model.distance_unit_mm * 1e-3;
      const double elevation = laser.elevation_deg * kDegree;
      double azimuth =
          (block.azimuth_counts + counts_per_ns * fired.block_offset_ns) * kAzimuthCount;
      azimuth = azimuth >= kTurn ? azimuth - kTurn : azimuth;
      const double horizontal = range * std::cos(elevation);

      Point& point = points.emplace_back();
      point.x_m = static_cast<float>(horizontal * std::cos(azimuth));
      point.y_m = static_cast<float>(-horizontal * std::sin(azimuth));
      point.z_m = static_cast<float>(range * std::sin(elevation) + laser.vertical_offset_mm * 1e-3);
      point.range_m = static_cast<float>(range);
      point.azimuth_rad = static_cast<float>(azimuth);
      point.elevation_rad = static_cast<float>(elevation);
      point.packet_offset_ns = fired.packet_offset_ns;
      point.laser = static_cast<std::uint8_t>(fired.laser);
      point.reflectivity = channel.reflectivity;
    }
  }
}

}  // namespace rigwire::protocols::velodyne
