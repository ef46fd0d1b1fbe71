#include "protocols/canopen/rotary_encoder.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "protocols/canopen/identifiers.h"

namespace rigwire::protocols::canopen {
namespace {

using enum DataType;

constexpr std::uint8_t kMap = EntryFlag::kMappable;
constexpr std::uint8_t kNode = EntryFlag::kAddNodeId;
constexpr std::uint8_t kKeep = EntryFlag::kStored;
constexpr std::int64_t kByte = 0xFF;
constexpr std::int64_t kWord = 0xFFFF;
constexpr std::int64_t kLong = 0xFFFFFFFF;

constexpr ObjectEntry fixed(std::uint16_t index, std::uint8_t sub, std::string_view name,
                            DataType type, std::int64_t value, std::uint8_t flags = 0) {
  return {{index, sub}, name, type, Access::constant, value, value, value, flags, ""};
}
constexpr ObjectEntry live(std::uint16_t index, std::uint8_t sub, std::string_view name,
                           DataType type, std::string_view unit = "", std::uint8_t flags = 0) {
  return {{index, sub}, name, type, Access::read_only, 0, 0, 0, flags, unit};
}
constexpr ObjectEntry setting(std::uint16_t index, std::uint8_t sub, std::string_view name,
                              DataType type, std::int64_t initial, std::int64_t lower,
                              std::int64_t upper, std::uint8_t flags = kKeep,
                              std::string_view unit = "") {
  return {{index, sub}, name, type, Access::read_write, initial, lower, upper, flags, unit};
}

constexpr std::int64_t kPositionMapping = 0x60040020;  // 6004:0, 32 bits
constexpr std::int64_t kNoRemote = kCobNoRemote;
/// PDO bits that a client may write: no 29-bit identifiers.
constexpr std::int64_t kPdoIdUpper = kLong;

constexpr std::array kObjects{
    live(0x1000, 0, "device type", unsigned32),
    live(0x1001, 0, "error register", unsigned8, "", kMap),
    setting(0x1003, 0, "number of errors", unsigned8, 0, 0, 0, 0),
    live(0x1003, 1, "latest error", unsigned32),
    live(0x1003, 2, "error before", unsigned32),
    live(0x1003, 3, "error before", unsigned32),
    live(0x1003, 4, "error before", unsigned32),
    setting(0x1005, 0, "COB-ID SYNC", unsigned32, kSynchronisationId, 1, kCobIdentifierMask),
    live(0x1008, 0, "manufacturer device name", visible_string),
    live(0x1009, 0, "manufacturer hardware version", visible_string),
    live(0x100A, 0, "manufacturer software version", visible_string),
    fixed(0x1010, 0, "highest sub-index", unsigned8, 1),
    setting(0x1010, 1, "save all parameters", unsigned32, 1, 0, kLong, 0),
    fixed(0x1011, 0, "highest sub-index", unsigned8, 1),
    setting(0x1011, 1, "restore all default parameters", unsigned32, 1, 0, kLong, 0),
    setting(0x1014, 0, "COB-ID EMCY", unsigned32, kEmergencyBase, 1, kLong, kKeep | kNode),
    setting(0x1017, 0, "producer heartbeat time", unsigned16, 0, 0, kWord, kKeep, "ms"),
    fixed(0x1018, 0, "highest sub-index", unsigned8, 4),
    live(0x1018, 1, "vendor ID", unsigned32),
    live(0x1018, 2, "product code", unsigned32),
    live(0x1018, 3, "revision number", unsigned32),
    live(0x1018, 4, "serial number", unsigned32),
    fixed(0x1200, 0, "highest sub-index", unsigned8, 2),
    fixed(0x1200, 1, "COB-ID client to server", unsigned32, kSdoRequestBase, kNode),
    fixed(0x1200, 2, "COB-ID server to client", unsigned32, kSdoAnswerBase, kNode),
    fixed(0x1800, 0, "highest sub-index", unsigned8, 5),
    setting(0x1800, 1, "COB-ID TPDO1", unsigned32, kNoRemote | kTransmitPdo1Base, 1, kPdoIdUpper,
            kKeep | kNode),
    setting(0x1800, 2, "transmission type", unsigned8, kOnTimer, 0, kByte),
    setting(0x1800, 3, "inhibit time", unsigned16, 0, 0, kWord, kKeep, "100 us"),
    setting(0x1800, 5, "event timer", unsigned16, 20, 0, kWord, kKeep, "ms"),
    fixed(0x1801, 0, "highest sub-index", unsigned8, 5),
    setting(0x1801, 1, "COB-ID TPDO2", unsigned32, kNoRemote | (kTransmitPdo1Base + 0x100), 1,
            kPdoIdUpper, kKeep | kNode),
    setting(0x1801, 2, "transmission type", unsigned8, 1, 0, kByte),
    setting(0x1801, 3, "inhibit time", unsigned16, 0, 0, kWord, kKeep, "100 us"),
    setting(0x1801, 5, "event timer", unsigned16, 0, 0, kWord, kKeep, "ms"),
    setting(0x1A00, 0, "mapped objects in TPDO1", unsigned8, 1, 0, kMappingEntries),
    setting(0x1A00, 1, "first object", unsigned32, kPositionMapping, 0, kLong),
    setting(0x1A00, 2, "second object", unsigned32, 0, 0, kLong),
    setting(0x1A00, 3, "third object", unsigned32, 0, 0, kLong),
    setting(0x1A00, 4, "fourth object", unsigned32, 0, 0, kLong),
    setting(0x1A01, 0, "mapped objects in TPDO2", unsigned8, 1, 0, kMappingEntries),
    setting(0x1A01, 1, "first object", unsigned32, kPositionMapping, 0, kLong),
    setting(0x1A01, 2, "second object", unsigned32, 0, 0, kLong),
    setting(0x1A01, 3, "third object", unsigned32, 0, 0, kLong),
    setting(0x1A01, 4, "fourth object", unsigned32, 0, 0, kLong),
    setting(0x6000, 0, "operating parameters", unsigned16, 0, 0,
            EncoderOperation::kCounterClockwise | EncoderOperation::kScaling),
    setting(0x6001, 0, "measuring units per revolution", unsigned32, 1, 1, kLong),
    setting(0x6002, 0, "total measuring range", unsigned32, 1, 1, kLong),
    setting(0x6003, 0, "preset value", unsigned32, 0, 0, kLong, kKeep),
    live(0x6004, 0, "position value", unsigned32, "units", kMap),
    fixed(0x6030, 0, "highest sub-index", unsigned8, 1),
    live(0x6030, 1, "speed value", integer16, "units/s", kMap),
    setting(0x6200, 0, "cyclic timer", unsigned16, 20, 0, kWord, 0, "ms"),
    live(0x6500, 0, "operating status", unsigned16, "", kMap),
    live(0x6501, 0, "single-turn resolution", unsigned32, "steps"),
    live(0x6502, 0, "number of distinguishable revolutions", unsigned16),
    live(0x6503, 0, "alarms", unsigned16, "", kMap),
    fixed(0x6504, 0, "supported alarms", unsigned16, EncoderAlarm::kPosition),
    fixed(0x6505, 0, "warnings", unsigned16, 0, kMap),
    fixed(0x6506, 0, "supported warnings", unsigned16, 0),
    fixed(0x6507, 0, "profile and software version", unsigned32, 0x01000302),
    live(0x6508, 0, "operating time", unsigned32, "0.1 h"),
    ObjectEntry{{0x6509, 0}, "offset value", integer32, Access::read_only, 0, 0, 0, kKeep, "units"},
    live(0x650B, 0, "serial number", unsigned32),
};

constexpr bool before(const ObjectEntry& a, const ObjectEntry& b) {
  return a.address.index != b.address.index ? a.address.index < b.address.index
                                            : a.address.sub < b.address.sub;
}
constexpr bool sorted() {
  for (std::size_t i = 1; i < kObjects.size(); ++i) {
    if (!before(kObjects[i - 1], kObjects[i])) {
      return false;
    }
  }
  return true;
}
static_assert(sorted());

}  // namespace

std::span<const ObjectEntry> rotary_encoder_objects() {
  return kObjects;
}

const ObjectEntry* find(std::span<const ObjectEntry> table, ObjectAddress address) {
  const auto found = std::lower_bound(table.begin(), table.end(), address,
                                      [](const ObjectEntry& entry, ObjectAddress wanted) {
                                        return before(entry, ObjectEntry{wanted});
                                      });
  return found != table.end() && found->address == address ? &*found : nullptr;
}

bool has_object(std::span<const ObjectEntry> table, std::uint16_t index) {
  const auto found = std::lower_bound(table.begin(), table.end(), ObjectAddress{index, 0},
                                      [](const ObjectEntry& entry, ObjectAddress wanted) {
                                        return before(entry, ObjectEntry{wanted});
                                      });
  return found != table.end() && found->address.index == index;
}

std::vector<can::MessageLayout> rotary_encoder_layouts(std::uint8_t node_id) {
  const auto message = [node_id](const char* name, std::uint32_t base, std::uint8_t length,
                                 const char* text) {
    can::MessageLayout layout;
    layout.name = name;
    layout.id = base + node_id;
    layout.length = length;
    layout.text = text;
    return layout;
  };
  const auto signal = [](const char* name, const ObjectEntry& entry) {
    const auto bits = static_cast<std::uint16_t>(8 * size_of(entry.type));
    can::SignalLayout field;
    field.name = name;
    field.width = bits;
    field.is_signed = is_signed(entry.type);
    field.upper = static_cast<double>((std::uint64_t{1} << bits) - 1U);
    field.unit = entry.unit;
    field.text = "CiA 406: " + std::string(entry.name);
    return field;
  };
  const auto number = [](const char* name, std::uint16_t bit, std::uint16_t width) {
    can::SignalLayout field;
    field.name = name;
    field.bit = bit;
    field.width = width;
    field.upper = static_cast<double>((std::uint64_t{1} << width) - 1U);
    return field;
  };
  const ObjectEntry& position = *find(kObjects, object::kPosition);
  std::vector<can::MessageLayout> list{
      message("encoder_position", kTransmitPdo1Base, 4, "TPDO1, on the event timer"),
      message("encoder_position_synchronous", kTransmitPdo1Base + 0x100, 4, "TPDO2, after SYNC"),
      message("encoder_heartbeat", kHeartbeatBase, 1, "Boot-up and heartbeat, CiA 301"),
      message("encoder_emergency", kEmergencyBase, 8, "Emergency, CiA 301")};
  list[0].fields = {signal("position", position)};
  list[1].fields = {signal("position", position)};
  list[2].fields = {number("node_state", 0, 8)};
  list[2].fields[0].values = {
      {0, "boot-up"}, {4, "stopped"}, {5, "operational"}, {127, "pre-operational"}};
  list[3].fields = {number("error_code", 0, 16), number("error_register", 16, 8),
                    number("detail", 24, 8)};
  return list;
}

}  // namespace rigwire::protocols::canopen
