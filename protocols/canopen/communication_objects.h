// The part of an object dictionary that every node here has, whatever its device profile, and how
// its messages are laid out.
//
// Source: CiA 301 V4.2.0, 7.5 (1000..1FFF).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "protocols/can/message.h"
#include "protocols/canopen/identifiers.h"
#include "protocols/canopen/object_entry.h"

namespace rigwire::protocols::canopen {

/// Objects that a node itself acts upon.
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
inline constexpr ObjectAddress kVendor{0x1018, 1};
inline constexpr ObjectAddress kProductCode{0x1018, 2};
inline constexpr ObjectAddress kRevisionNumber{0x1018, 3};
inline constexpr ObjectAddress kSerialNumber{0x1018, 4};
inline constexpr ObjectAddress kElectronicDataSheet{0x1021, 0};
inline constexpr std::uint16_t kTransmitPdo = 0x1800;      ///< Communication of the first.
inline constexpr std::uint16_t kTransmitMapping = 0x1A00;  ///< Mapping of the first.
}  // namespace object

/// Signatures of 1010 and 1011: the words "save" and "load", first letter first.
inline constexpr std::int64_t kSaveSignature = 0x65766173;
inline constexpr std::int64_t kLoadSignature = 0x64616F6C;

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

/// A transmit PDO at delivery.
struct PdoDefaults {
  std::int64_t type = kOnTimer;
  std::int64_t event_timer_ms = 0;
  /// Words of mapping_of(); 0 where nothing more is mapped.
  std::array<std::int64_t, kMappingEntries> mapping{};
};

/// 1000..1A01, sorted.
[[nodiscard]] constexpr auto communication_objects(const PdoDefaults& first,
                                                   const PdoDefaults& second) {
  using enum DataType;
  constexpr std::uint8_t kMap = EntryFlag::kMappable;
  constexpr std::uint8_t kNode = EntryFlag::kAddNodeId;
  constexpr std::uint8_t kKeep = EntryFlag::kStored;
  constexpr std::int64_t kByte = 0xFF;
  constexpr std::int64_t kWord = 0xFFFF;
  constexpr std::int64_t kLong = 0xFFFFFFFF;
  constexpr std::int64_t kNoRemote = kCobNoRemote;
  const auto mapped = [](const PdoDefaults& pdo) {
    std::int64_t count = 0;
    for (const std::int64_t word : pdo.mapping) {
      count += word != 0 ? 1 : 0;
    }
    return count;
  };
  return std::array{
      live_entry(0x1000, 0, "device type", unsigned32),
      live_entry(0x1001, 0, "error register", unsigned8, "", kMap),
      setting_entry(0x1003, 0, "number of errors", unsigned8, 0, 0, 0, 0),
      live_entry(0x1003, 1, "latest error", unsigned32),
      live_entry(0x1003, 2, "error before", unsigned32),
      live_entry(0x1003, 3, "error before", unsigned32),
      live_entry(0x1003, 4, "error before", unsigned32),
      setting_entry(0x1005, 0, "COB-ID SYNC", unsigned32, kSynchronisationId, 1,
                    kCobIdentifierMask),
      live_entry(0x1008, 0, "manufacturer device name", visible_string),
      live_entry(0x1009, 0, "manufacturer hardware version", visible_string),
      live_entry(0x100A, 0, "manufacturer software version", visible_string),
      constant_entry(0x1010, 0, "highest sub-index", unsigned8, 1),
      setting_entry(0x1010, 1, "save all parameters", unsigned32, 1, 0, kLong, 0),
      constant_entry(0x1011, 0, "highest sub-index", unsigned8, 1),
      setting_entry(0x1011, 1, "restore all default parameters", unsigned32, 1, 0, kLong, 0),
      setting_entry(0x1014, 0, "COB-ID EMCY", unsigned32, kEmergencyBase, 1, kLong, kKeep | kNode),
      setting_entry(0x1017, 0, "producer heartbeat time", unsigned16, 0, 0, kWord, kKeep, "ms"),
      constant_entry(0x1018, 0, "highest sub-index", unsigned8, 4),
      live_entry(0x1018, 1, "vendor ID", unsigned32),
      live_entry(0x1018, 2, "product code", unsigned32),
      live_entry(0x1018, 3, "revision number", unsigned32),
      live_entry(0x1018, 4, "serial number", unsigned32),
      live_entry(0x1021, 0, "store EDS", domain),
      constant_entry(0x1022, 0, "store format", unsigned16, 0),
      constant_entry(0x1200, 0, "highest sub-index", unsigned8, 2),
      constant_entry(0x1200, 1, "COB-ID client to server", unsigned32, kSdoRequestBase, kNode),
      constant_entry(0x1200, 2, "COB-ID server to client", unsigned32, kSdoAnswerBase, kNode),
      constant_entry(0x1800, 0, "highest sub-index", unsigned8, 5),
      setting_entry(0x1800, 1, "COB-ID TPDO1", unsigned32, kNoRemote | kTransmitPdo1Base, 1, kLong,
                    kKeep | kNode),
      setting_entry(0x1800, 2, "transmission type", unsigned8, first.type, 0, kByte),
      setting_entry(0x1800, 3, "inhibit time", unsigned16, 0, 0, kWord, kKeep, "100 us"),
      setting_entry(0x1800, 5, "event timer", unsigned16, first.event_timer_ms, 0, kWord, kKeep,
                    "ms"),
      constant_entry(0x1801, 0, "highest sub-index", unsigned8, 5),
      setting_entry(0x1801, 1, "COB-ID TPDO2", unsigned32, kNoRemote | (kTransmitPdo1Base + 0x100),
                    1, kLong, kKeep | kNode),
      setting_entry(0x1801, 2, "transmission type", unsigned8, second.type, 0, kByte),
      setting_entry(0x1801, 3, "inhibit time", unsigned16, 0, 0, kWord, kKeep, "100 us"),
      setting_entry(0x1801, 5, "event timer", unsigned16, second.event_timer_ms, 0, kWord, kKeep,
                    "ms"),
      setting_entry(0x1A00, 0, "mapped objects in TPDO1", unsigned8, mapped(first), 0,
                    kMappingEntries),
      setting_entry(0x1A00, 1, "first object", unsigned32, first.mapping[0], 0, kLong),
      setting_entry(0x1A00, 2, "second object", unsigned32, first.mapping[1], 0, kLong),
      setting_entry(0x1A00, 3, "third object", unsigned32, first.mapping[2], 0, kLong),
      setting_entry(0x1A00, 4, "fourth object", unsigned32, first.mapping[3], 0, kLong),
      setting_entry(0x1A01, 0, "mapped objects in TPDO2", unsigned8, mapped(second), 0,
                    kMappingEntries),
      setting_entry(0x1A01, 1, "first object", unsigned32, second.mapping[0], 0, kLong),
      setting_entry(0x1A01, 2, "second object", unsigned32, second.mapping[1], 0, kLong),
      setting_entry(0x1A01, 3, "third object", unsigned32, second.mapping[2], 0, kLong),
      setting_entry(0x1A01, 4, "fourth object", unsigned32, second.mapping[3], 0, kLong),
  };
}

/// One table of two: the communication objects and the profile's.
template <std::size_t N, std::size_t M>
[[nodiscard]] constexpr std::array<ObjectEntry, N + M> joined(
    const std::array<ObjectEntry, N>& first, const std::array<ObjectEntry, M>& second) {
  std::array<ObjectEntry, N + M> all{};
  for (std::size_t i = 0; i < N; ++i) {
    all[i] = first[i];
  }
  for (std::size_t i = 0; i < M; ++i) {
    all[N + i] = second[i];
  }
  return all;
}

/// A message of that node without fields.
[[nodiscard]] can::OwnedMessage make_layout(std::string name, std::uint32_t base,
                                            std::uint8_t node_id, std::uint8_t length,
                                            std::string text);
/// A number of the dictionary in a PDO, as raw counts of the whole width of its type; `profile` is
/// the document that defines it.
[[nodiscard]] can::OwnedSignal make_signal(std::string name, const ObjectEntry& entry,
                                           std::uint16_t bit, std::string_view profile);
/// Heartbeat and emergency; the names begin with `device`.
[[nodiscard]] can::OwnedMessage make_heartbeat_layout(const std::string& device,
                                                      std::uint8_t node_id);
[[nodiscard]] can::OwnedMessage make_emergency_layout(const std::string& device,
                                                      std::uint8_t node_id);

}  // namespace rigwire::protocols::canopen
