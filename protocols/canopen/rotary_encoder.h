// The object dictionary of an absolute rotary encoder: CiA 301's communication objects and CiA
// 406's (device profile for encoders) in one table.
//
// Sources: CiA 301 V4.2.0, 7.5 (1000..1FFF); CiA 406 V3.2 (6000..650B). Device type 1000: profile
// 406 in the low word, in the high word 1 single-turn, 2 multi-turn.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocols/can/message_layout.h"
#include "protocols/canopen/object_entry.h"

namespace rigwire::protocols::canopen {

/// Objects that the encoder itself acts upon.
namespace object {
inline constexpr ObjectAddress kDeviceType{0x1000, 0};
inline constexpr ObjectAddress kErrorRegister{0x1001, 0};
inline constexpr std::uint16_t kErrorField = 0x1003;
inline constexpr ObjectAddress kSynchronisationId{0x1005, 0};
inline constexpr ObjectAddress kDeviceName{0x1008, 0};
inline constexpr ObjectAddress kHardwareVersion{0x1009, 0};
inline constexpr ObjectAddress kSoftwareVersion{0x100A, 0};
inline constexpr std::uint16_t kStore = 0x1010;
inline constexpr std::uint16_t kRestore = 0x1011;
inline constexpr ObjectAddress kEmergencyId{0x1014, 0};
inline constexpr ObjectAddress kHeartbeatTime{0x1017, 0};
inline constexpr ObjectAddress kSerialNumber{0x1018, 4};
inline constexpr std::uint16_t kTransmitPdo = 0x1800;      ///< Communication of the first.
inline constexpr std::uint16_t kTransmitMapping = 0x1A00;  ///< Mapping of the first.
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

/// Signatures of 1010 and 1011: the words "save" and "load", first letter first.
inline constexpr std::int64_t kSaveSignature = 0x65766173;
inline constexpr std::int64_t kLoadSignature = 0x64616F6C;

/// Bits of 6000 and 6500.
struct EncoderOperation {
  static constexpr std::int64_t kCounterClockwise = 1;  ///< Code rises counter-clockwise.
  static constexpr std::int64_t kScaling = 4;           ///< 6001 and 6002 are in force.
};
/// Bits of 6503 and 6504.
struct EncoderAlarm {
  static constexpr std::int64_t kPosition = 1;  ///< The position is not valid.
};

inline constexpr unsigned kTransmitPdos = 2;
inline constexpr unsigned kMappingEntries = 4;
inline constexpr unsigned kErrorFieldEntries = 4;
/// Sub-indices of a communication parameter.
inline constexpr std::uint8_t kPdoId = 1;
inline constexpr std::uint8_t kPdoType = 2;
inline constexpr std::uint8_t kPdoInhibit_100us = 3;
inline constexpr std::uint8_t kPdoEventTimer_ms = 5;
/// Transmission types that are no number of SYNCs.
inline constexpr std::int64_t kAcyclicSynchronous = 0;
inline constexpr std::int64_t kGreatestSynchronous = 240;
inline constexpr std::int64_t kOnChange = 254;  ///< And when the event timer elapses.
inline constexpr std::int64_t kOnTimer = 255;

/// Sorted by index, then sub-index.
[[nodiscard]] std::span<const ObjectEntry> rotary_encoder_objects();

/// The row of an address; null when there is none.
[[nodiscard]] const ObjectEntry* find(std::span<const ObjectEntry> table, ObjectAddress address);
/// Whether any sub-index of the object exists.
[[nodiscard]] bool has_object(std::span<const ObjectEntry> table, std::uint16_t index);

/// The two transmit PDOs as they are mapped at delivery, heartbeat and emergency of that node.
[[nodiscard]] std::vector<can::MessageLayout> rotary_encoder_layouts(std::uint8_t node_id);

}  // namespace rigwire::protocols::canopen
