// The object dictionary of an absolute rotary encoder: CiA 301's communication objects and CiA
// 406's (device profile for encoders) in one table.
//
// Sources: CiA 301 V4.2.0, 7.5 (1000..1FFF); CiA 406 V3.2 (6000..650B). Device type 1000: profile
// 406 in the low word, in the high word 1 single-turn, 2 multi-turn.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocols/can/message.h"
#include "protocols/canopen/communication_objects.h"

namespace rigwire::protocols::canopen {

/// Objects that the encoder itself acts upon.
namespace object {
inline constexpr ObjectAddress kOperatingParameters{0x6000, 0};
inline constexpr ObjectAddress kUnitsPerRevolution{0x6001, 0};
inline constexpr ObjectAddress kTotalRange{0x6002, 0};
inline constexpr ObjectAddress kPreset{0x6003, 0};
inline constexpr ObjectAddress kPosition{0x6004, 0};
inline constexpr ObjectAddress kSpeed{0x6030, 1};
inline constexpr ObjectAddress kCyclicTimer{0x6200, 0};
inline constexpr ObjectAddress kOperatingStatus{0x6500, 0};
inline constexpr ObjectAddress kSingleTurnResolution{0x6501, 0};
inline constexpr ObjectAddress kRevolutions{0x6502, 0};
inline constexpr ObjectAddress kAlarms{0x6503, 0};
inline constexpr ObjectAddress kOperatingTime{0x6508, 0};
inline constexpr ObjectAddress kOffset{0x6509, 0};
inline constexpr ObjectAddress kEncoderSerial{0x650B, 0};
}  // namespace object

/// Bits of 6000 and 6500.
struct EncoderOperation {
  static constexpr std::int64_t kCounterClockwise = 1;  ///< Code rises counter-clockwise.
  static constexpr std::int64_t kScaling = 4;           ///< 6001 and 6002 are in force.
};
/// Bits of 6503 and 6504.
struct EncoderAlarm {
  static constexpr std::int64_t kPosition = 1;  ///< The position is not valid.
};

/// Sorted by index, then sub-index.
[[nodiscard]] std::span<const ObjectEntry> rotary_encoder_objects();

/// The two transmit PDOs as they are mapped at delivery, heartbeat and emergency of that node.
[[nodiscard]] std::vector<can::OwnedMessage> rotary_encoder_layouts(std::uint8_t node_id);

}  // namespace rigwire::protocols::canopen
