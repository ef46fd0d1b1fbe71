// The object dictionary of a two-axis inclinometer: CiA 301's communication objects, CiA 410's
// (device profile for inclinometers) in 16 and 32 bits, and two of the maker's.
//
// Sources: CiA 301 V4.2.0, 7.5 (1000..1FFF); CiA 410 V1.2 (6000..6124); ifm JN2100 and JN2101
// device manuals (2040, 2043, defaults). Device type 1000: profile 410 in the low word, in the high
// word 4, two axes with 32-bit values. Which facts are assumed:
// docs/devices/cia410-inclinometer.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "protocols/can/message.h"
#include "protocols/canopen/communication_objects.h"

namespace rigwire::protocols::canopen {

namespace object {
inline constexpr ObjectAddress kQuadrantCorrection{0x2040, 0};
inline constexpr ObjectAddress kFilterStep{0x2043, 0};
inline constexpr ObjectAddress kSlopeResolution{0x6000, 0};
}  // namespace object

/// Values of object 2040: which angles are distinguished.
struct QuadrantCorrection {
  static constexpr std::int64_t kOff = 0;       ///< -90 .. 90 deg.
  static constexpr std::int64_t kHalfTurn = 1;  ///< -180 .. 180 deg.
  static constexpr std::int64_t kFullTurn = 2;  ///< 0 .. 360 deg.
};

/// Cut-off (-3 dB) of each step of 2043, Hz; 0 is no filter.
inline constexpr std::array<double, 5> kFilterCutOffs_hz{0.0, 10.0, 5.0, 1.0, 0.5};

/// What 6000 may be, thousandths of a degree.
inline constexpr std::array<std::int64_t, 4> kSlopeResolutions_mdeg{1, 10, 100, 1000};
[[nodiscard]] constexpr bool is_slope_resolution(std::int64_t mdeg) {
  return std::ranges::find(kSlopeResolutions_mdeg, mdeg) != kSlopeResolutions_mdeg.end();
}

/// Each slope is five objects in a row, from its value on.
struct SlopeObjects {
  std::uint16_t value = 0;  ///< Index.
  DataType type = DataType::integer16;
  std::uint8_t axis = 0;  ///< 0 longitudinal, 1 lateral.

  [[nodiscard]] constexpr ObjectAddress address(std::uint16_t part) const {
    return {static_cast<std::uint16_t>(value + part), 0};
  }
};
inline constexpr std::uint16_t kSlopeValue = 0;
inline constexpr std::uint16_t kSlopeOperation = 1;
inline constexpr std::uint16_t kSlopePreset = 2;
inline constexpr std::uint16_t kSlopeOffset = 3;
inline constexpr std::uint16_t kSlopeDifferentialOffset = 4;

inline constexpr std::array<SlopeObjects, 4> kSlopes{{{0x6010, DataType::integer16, 0},
                                                      {0x6020, DataType::integer16, 1},
                                                      {0x6110, DataType::integer32, 0},
                                                      {0x6120, DataType::integer32, 1}}};

/// Bits of 6011, 6021, 6111, 6121.
struct SlopeOperation {
  static constexpr std::int64_t kInversion = 1;
  static constexpr std::int64_t kScaling = 2;  ///< Both offsets are added.
};

/// Emergency codes: the slope is not to be relied on.
inline constexpr std::uint16_t kLongitudinalError = 0x5010;
inline constexpr std::uint16_t kLateralError = 0x5020;

/// Sorted by index, then sub-index.
[[nodiscard]] std::span<const ObjectEntry> inclinometer_objects();

/// The two transmit PDOs as they are mapped at delivery, with 6000 as given, heartbeat and
/// emergency of that node.
[[nodiscard]] std::vector<can::OwnedMessage> inclinometer_layouts(std::uint8_t node_id,
                                                                  std::uint16_t resolution_mdeg);

}  // namespace rigwire::protocols::canopen
