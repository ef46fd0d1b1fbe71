#include "sim/lidar/firing_block.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fields/constants.h"

namespace rigwire::sim {
namespace {

/// Quantities that change linearly over a block: R_WS, position, velocity, angular velocity.
constexpr std::size_t kMountColumns = 18;
using MountColumns = std::array<double, kMountColumns>;

MountColumns columns_of(const LinkMotion& mount) {
  MountColumns columns;
  Eigen::Map<Eigen::Matrix3d> R(columns.data());
  R = mount.X_WL.linear();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    columns[9 + i] = mount.X_WL.translation()(row);
    columns[12 + i] = mount.v_WL_W(row);
    columns[15 + i] = mount.w_WL_W(row);
  }
  return columns;
}

struct MountRamp {
  std::array<float, kMountColumns> first;
  std::array<float, kMountColumns> change;  ///< To the last firing.
};

/// Lane quantities of the rotor, relative to the block's first firing.
struct RotorLanes {
  float cos_first = 1.0F;
  float sin_first = 0.0F;
  LaneArray turned_rad;
  LaneArray rate_radps;
};

RIGWIRE_WIDE_VECTORS void fill_lanes(const MountRamp& mount, const RotorLanes& rotor,
                                     float share_of_first, float share_step, float lane_step,
                                     FiringLanes& lanes) {
  LaneArray place;
  for (std::size_t i = 0; i < kLanes; ++i) {
    place[i] = static_cast<float>(i);
  }
  for (std::size_t c = 0; c < kMountColumns; ++c) {
    float* const column = lanes.data() + c * kLanes;
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      // Linear over the block, pose and rates alike.
      column[i] = mount.first[c] + lane_step * place[i] * mount.change[c];
    }
  }
  float* const cosine = lanes.data() + 18 * kLanes;
  float* const sine = cosine + kLanes;
  float* const rate = sine + kLanes;
  float* const time = rate + kLanes;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Taylor's series: 1e-8 for the quarter of a radian that no rotor exceeds within a block.
    const float a = rotor.turned_rad[i];
    const float a2 = a * a;
    const float c = 1.0F - a2 * (0.5F - a2 * (1.0F / 24.0F - a2 * (1.0F / 720.0F)));
    const float s = a * (1.0F - a2 * (1.0F / 6.0F - a2 * (1.0F / 120.0F - a2 * (1.0F / 5040.0F))));
    cosine[i] = rotor.cos_first * c - rotor.sin_first * s;
    sine[i] = rotor.sin_first * c + rotor.cos_first * s;
    rate[i] = rotor.rate_radps[i];
    time[i] = share_of_first + share_step * place[i];
  }
}

void pick_lanes(const FiringLanes& firings, const std::array<std::uint32_t, kLanes>& from,
                FiringLanes& to) {
  for (std::size_t column = 0; column < FiringLanes::kFloats; column += kLanes) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      to.data()[column + i] = firings.data()[column + from[i]];
    }
  }
}

}  // namespace

void fill_block(std::span<const FiringInstant> firings, const LinkMotionInterpolation& mount_at,
                SimTime t0, double slice_s, FiringBlock& block) {
  const FiringInstant& first = firings.front();
  const FiringInstant& last = firings.back();
  block.count = firings.size();
  const double steps = static_cast<double>(std::max<std::size_t>(block.count - 1, 1));

  MountRamp ramp;
  const MountColumns start = columns_of(mount_at(first.time));
  const MountColumns end = block.count > 1 ? columns_of(mount_at(last.time)) : start;
  for (std::size_t c = 0; c < kMountColumns; ++c) {
    ramp.first[c] = static_cast<float>(start[c]);
    ramp.change[c] = static_cast<float>(end[c] - start[c]);
  }
  RotorLanes rotor;
  rotor.cos_first = static_cast<float>(std::cos(first.rotor.azimuth_rad));
  rotor.sin_first = static_cast<float>(std::sin(first.rotor.azimuth_rad));
  for (std::size_t i = 0; i < kLanes; ++i) {
    const FiringInstant& firing = firings[std::min(i, block.count - 1)];
    block.firing[i] = firing.number;
    const double turned = firing.rotor.azimuth_rad - first.rotor.azimuth_rad;
    const double wrapped = turned < -0.5 * kTurn  ? turned + kTurn
                           : turned > 0.5 * kTurn ? turned - kTurn
                                                  : turned;
    rotor.turned_rad[i] = static_cast<float>(wrapped);
    rotor.rate_radps[i] = static_cast<float>(firing.rotor.rate_radps);
  }
  fill_lanes(ramp, rotor, static_cast<float>(to_seconds(first.time - t0) / slice_s),
             static_cast<float>(to_seconds(last.time - first.time) / steps / slice_s),
             static_cast<float>(1.0 / steps), block.lanes);
  if (block.count < kLanes) {
    for (std::size_t a = 0; a < block.count; ++a) {
      std::array<std::uint32_t, kLanes> from;
      for (std::size_t i = 0; i < kLanes; ++i) {
        from[i] = static_cast<std::uint32_t>((a * kLanes + i) % block.count);
      }
      pick_lanes(block.lanes, from, block.arranged[a]);
    }
  }
}

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
    for (std::size_t k = 0; k < packets.size(); ++k) {
      packets[k].arrangement = k % count;
    }
    for (std::size_t ray = 0; ray < packets.size() * kLanes; ++ray) {
      RingPacket& packet = packets[ray / kLanes];
      const std::size_t lane = ray % kLanes;
      // Lanes left over fire the last laser again, each with the firing that its lane carries.
      const std::uint32_t number = by_elevation[std::min(ray / count, laser_count - 1)];
      packet.map.firing[lane] = static_cast<std::uint32_t>(ray % count);
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
