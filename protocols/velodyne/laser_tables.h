// The laser tables of the models. Each row is one laser as its family's documents print it; the
// family's rule for its firing time is beside the rows. Rows are in the order of the lasers'
// numbers, which is their order in the blocks of a packet.
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

}  // namespace rigwire::protocols::velodyne
