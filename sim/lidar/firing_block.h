// Up to eight firings that are cast together, so that the rays of one laser make one packet.
//
// The caster of a block (the fast path of spinning_lidar.cpp, or a BeamCaster with its sub-rays)
// goes through BlockCast::packets: for each, fill_packet() makes the rays, and its LaneMap says
// where the result of a lane belongs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/lidar/lidar_sensor.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/lidar/rotor.h"
#include "sim/link_motion.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/time.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

/// One firing of the head: when, and where the rotor was.
struct FiringInstant {
  std::uint32_t number = 0;  ///< Among those of this cast.
  SimTime time{};
  RotorState rotor;
};

/// Firings that follow each other without a gap, within kLongestBlock.
struct FiringBlock {
  std::size_t count = 0;                       ///< 1 .. 8.
  std::array<std::uint32_t, kLanes> firing{};  ///< Each one's number among those of this cast.
  FiringLanes lanes;
  /// The lanes of a block of less than eight firings again, in the orders in which its packets need
  /// them (RingPacket::arrangement).
  std::array<FiringLanes, kLanes - 1> arranged;
};

inline constexpr Duration kLongestBlock = std::chrono::microseconds{500};

/// Makes the block of these firings. Pose and rates are interpolated linearly between its first and
/// its last: wrong by at most 0.4 um and 4e-8 rad, for 10 m/s2 and 1 rad/s, which floats do not
/// hold in the scene's coordinates. Precondition: 1 <= firings.size() <= 8, without gap.
void fill_block(std::span<const FiringInstant> firings, const LinkMotionInterpolation& mount_at,
                SimTime t0, double slice_s, FiringBlock& block);

/// Firing and laser that each lane of a packet carries. Lanes left over repeat rays of the last
/// laser, and write the same results to the same places.
struct LaneMap {
  std::array<std::uint32_t, kLanes> firing{};  ///< Place in the block.
  std::array<std::uint32_t, kLanes> laser{};
};

/// One packet of a block of a certain number of firings.
struct RingPacket {
  LaneMap map;
  std::size_t arrangement = 0;  ///< The packet's index modulo the number of firings.
  LaserLanes lasers;
};

/// The packets into which blocks of 1 to 8 firings fall: rays in order of elevation, then of
/// firing, so that neighbours in a packet are neighbours in space, and only the very last packet of
/// a block may have lanes left over.
class HeadLanes {
 public:
  /// Sub-rays of a beam: a HeadLanes each, of the same pattern with that sub-ray's displacement in
  /// elevation and azimuth added to all lasers. `order_of` keeps their packets in step: lasers are
  /// ordered by its elevations.
  HeadLanes(const LidarPattern& pattern, const LidarPattern& order_of);
  explicit HeadLanes(const LidarPattern& pattern) : HeadLanes(pattern, pattern) {}

  /// Precondition: 1 <= firings <= 8.
  [[nodiscard]] std::span<const RingPacket> packets(std::size_t firings) const {
    return packets_[firings - 1];
  }

 private:
  std::array<std::vector<RingPacket>, kLanes> packets_;
};

/// A block to be cast, and where its results go.
struct BlockCast {
  const Scene& scene;
  const LidarSlice& slice;
  const Weather* weather = nullptr;  ///< Null: clear air.
  const FiringBlock& block;
  std::span<const RingPacket> packets;  ///< Packets of HeadLanes for the block's count.
  RayLimits limits;
  /// Number of this cast's first firing since the plan's first: with the laser, the counter of a
  /// shot's random numbers (shot_number).
  std::uint64_t first_number = 0;
  std::size_t banks = 1;
  std::span<LidarFiring> firings;     ///< All firings of the cast, bank by bank, returns empty.
  std::span<LidarBankTruth> truth{};  ///< Empty: not wanted.
  bool several = false;               ///< Echoes are to be separated.

  /// Where the shot of `laser` in firing `place` of the block belongs: bank and index in it.
  [[nodiscard]] std::size_t bank_of(std::size_t place, std::size_t laser) const {
    return block.firing[place] * banks + laser / kBankLasers;
  }
  [[nodiscard]] std::uint64_t shot_number(std::size_t place, std::size_t laser) const {
    return (first_number + block.firing[place]) * kMaxLasers + laser;
  }
};

/// The rays of a packet of this block.
inline void fill_packet(const FiringBlock& block, const RingPacket& plan, const RayLimits& limits,
                        RTCRayHit8& packet) {
  const bool full = block.count == kLanes;  // lane i is firing i
  fill_rays(full ? block.lanes : block.arranged[plan.arrangement], plan.lasers, limits, packet);
}

}  // namespace rigwire::sim
