// The laser tables of the models, one file per family: lasers_<family>.cpp. Each row is one laser
// as the family's documents print it; when it fires is the family's rule and stands in the same
// file. In the order of the lasers' numbers, which is their order in the blocks of a packet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "protocols/velodyne/model.h"

namespace rigwire::protocols::velodyne {

extern const std::array<Laser, 32> kHdl32eLasers;
extern const std::array<Laser, 16> kVlp16Lasers;
extern const std::array<Laser, 16> kPuckHiResLasers;
extern const std::array<Laser, 32> kVlp32cLasers;
extern const std::array<Laser, 64> kHdl64eS2Lasers;
extern const std::array<Laser, 64> kHdl64eS3Lasers;
extern const std::array<Laser, 128> kVls128Lasers;          ///< Firmware since 5.2.3.0.
extern const std::array<Laser, 128> kVls128LasersUntil517;  ///< Firmware up to 5.1.7.1.

/// Groups of eight of a VLS-128 follow each other so fast, by firmware.
inline constexpr std::int32_t kVls128Group_ns = 2889;
inline constexpr std::int32_t kVls128GroupUntil517_ns = 2665;

/// The rows with the time of each laser filled in: `fires_at_ns(laser)`, after the first laser.
template <std::size_t Count, class FiresAt>
constexpr std::array<Laser, Count> timed(std::array<Laser, Count> rows, FiresAt fires_at_ns) {
  for (std::size_t laser = 0; laser < Count; ++laser) {
    rows[laser].time_offset_ns = fires_at_ns(static_cast<std::int32_t>(laser));
  }
  return rows;
}

}  // namespace rigwire::protocols::velodyne
