#include "protocols/canopen/rotary_encoder.h"

#include <array>

#include "protocols/canopen/identifiers.h"

namespace rigwire::protocols::canopen {
namespace {

using enum DataType;

constexpr std::uint8_t kEncoderMap = EntryFlag::kMappable;
constexpr std::int64_t kWord = 0xFFFF;
constexpr std::int64_t kLong = 0xFFFFFFFF;

constexpr std::int64_t kPositionMapping = 0x60040020;  // 6004:0, 32 bits
constexpr PdoDefaults kOnItsTimer{kOnTimer, 20, {kPositionMapping}};
constexpr PdoDefaults kAfterEachSync{1, 0, {kPositionMapping}};

constexpr std::array kEncoderProfileObjects{
    setting_entry(0x6000, 0, "operating parameters", unsigned16, 0, 0,
                  EncoderOperation::kCounterClockwise | EncoderOperation::kScaling),
    setting_entry(0x6001, 0, "measuring units per revolution", unsigned32, 1, 1, kLong),
    setting_entry(0x6002, 0, "total measuring range", unsigned32, 1, 1, kLong),
    setting_entry(0x6003, 0, "preset value", unsigned32, 0, 0, kLong),
    live_entry(0x6004, 0, "position value", unsigned32, "units", kEncoderMap),
    constant_entry(0x6030, 0, "highest sub-index", unsigned8, 1),
    live_entry(0x6030, 1, "speed value", integer16, "units/s", kEncoderMap),
    setting_entry(0x6200, 0, "cyclic timer", unsigned16, 20, 0, kWord, 0, "ms"),
    live_entry(0x6500, 0, "operating status", unsigned16, "", kEncoderMap),
    live_entry(0x6501, 0, "single-turn resolution", unsigned32, "steps"),
    live_entry(0x6502, 0, "number of distinguishable revolutions", unsigned16),
    live_entry(0x6503, 0, "alarms", unsigned16, "", kEncoderMap),
    constant_entry(0x6504, 0, "supported alarms", unsigned16, EncoderAlarm::kPosition),
    constant_entry(0x6505, 0, "warnings", unsigned16, 0, kEncoderMap),
    constant_entry(0x6506, 0, "supported warnings", unsigned16, 0),
    constant_entry(0x6507, 0, "profile and software version", unsigned32, 0x01000302),
    live_entry(0x6508, 0, "operating time", unsigned32, "0.1 h"),
    live_entry(0x6509, 0, "offset value", integer32, "units", EntryFlag::kStored),
    live_entry(0x650B, 0, "serial number", unsigned32),
};

constexpr auto kEncoderObjects =
    joined(communication_objects(kOnItsTimer, kAfterEachSync), kEncoderProfileObjects);
static_assert(is_sorted(kEncoderObjects));

}  // namespace

std::span<const ObjectEntry> rotary_encoder_objects() {
  return kEncoderObjects;
}

std::vector<can::OwnedMessage> rotary_encoder_layouts(std::uint8_t node_id) {
  const can::OwnedSignal position =
      make_signal("position", *find(kEncoderObjects, object::kPosition), 0, "CiA 406");
  std::vector<can::OwnedMessage> list{
      make_layout("encoder_position", kTransmitPdo1Base, node_id, 4, "TPDO1, on the event timer"),
      make_layout("encoder_position_synchronous", kTransmitPdo1Base + 0x100, node_id, 4,
                  "TPDO2, after SYNC"),
      make_heartbeat_layout("encoder", node_id), make_emergency_layout("encoder", node_id)};
  list[0].signals = {position};
  list[1].signals = {position};
  return list;
}

}  // namespace rigwire::protocols::canopen
