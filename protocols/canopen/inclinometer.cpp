#include "protocols/canopen/inclinometer.h"

#include <limits>
#include <string>
#include <utility>

namespace rigwire::protocols::canopen {
namespace {

using enum DataType;

constexpr std::uint8_t kMap = EntryFlag::kMappable;
constexpr std::int64_t kLeast16 = std::numeric_limits<std::int16_t>::min();
constexpr std::int64_t kMost16 = std::numeric_limits<std::int16_t>::max();
constexpr std::int64_t kLeast32 = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kMost32 = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kOperation = SlopeOperation::kInversion | SlopeOperation::kScaling;

constexpr PdoDefaults kSlopes16{1, 0, {0x60100010, 0x60200010}};
constexpr PdoDefaults kSlopes32{1, 0, {0x61100020, 0x61200020}};

constexpr std::array kProfileObjects{
    setting_entry(0x2040, 0, "quadrant correction", unsigned8, 0, 0, QuadrantCorrection::kFullTurn),
    setting_entry(0x2043, 0, "filter step", unsigned8, 0, 0, kFilterCutOffs_hz.size() - 1),
    setting_entry(0x6000, 0, "resolution", unsigned16, kSlopeResolutions_mdeg[1],
                  kSlopeResolutions_mdeg.front(), kSlopeResolutions_mdeg.back(), EntryFlag::kStored,
                  "0.001 deg"),
    live_entry(0x6010, 0, "slope long16", integer16, "counts", kMap),
    setting_entry(0x6011, 0, "slope long16 operating parameter", unsigned8, 0, 0, kOperation),
    setting_entry(0x6012, 0, "slope long16 preset value", integer16, 0, kLeast16, kMost16),
    setting_entry(0x6013, 0, "slope long16 offset", integer16, 0, kLeast16, kMost16),
    setting_entry(0x6014, 0, "differential slope long16 offset", integer16, 0, kLeast16, kMost16),
    live_entry(0x6020, 0, "slope lateral16", integer16, "counts", kMap),
    setting_entry(0x6021, 0, "slope lateral16 operating parameter", unsigned8, 0, 0, kOperation),
    setting_entry(0x6022, 0, "slope lateral16 preset value", integer16, 0, kLeast16, kMost16),
    setting_entry(0x6023, 0, "slope lateral16 offset", integer16, 0, kLeast16, kMost16),
    setting_entry(0x6024, 0, "differential slope lateral16 offset", integer16, 0, kLeast16,
                  kMost16),
    live_entry(0x6110, 0, "slope long32", integer32, "counts", kMap),
    setting_entry(0x6111, 0, "slope long32 operating parameter", unsigned8, 0, 0, kOperation),
    setting_entry(0x6112, 0, "slope long32 preset value", integer32, 0, kLeast32, kMost32),
    setting_entry(0x6113, 0, "slope long32 offset", integer32, 0, kLeast32, kMost32),
    setting_entry(0x6114, 0, "differential slope long32 offset", integer32, 0, kLeast32, kMost32),
    live_entry(0x6120, 0, "slope lateral32", integer32, "counts", kMap),
    setting_entry(0x6121, 0, "slope lateral32 operating parameter", unsigned8, 0, 0, kOperation),
    setting_entry(0x6122, 0, "slope lateral32 preset value", integer32, 0, kLeast32, kMost32),
    setting_entry(0x6123, 0, "slope lateral32 offset", integer32, 0, kLeast32, kMost32),
    setting_entry(0x6124, 0, "differential slope lateral32 offset", integer32, 0, kLeast32,
                  kMost32),
};

constexpr auto kObjects = joined(communication_objects(kSlopes16, kSlopes32), kProfileObjects);
static_assert(is_sorted(kObjects));

}  // namespace

std::span<const ObjectEntry> inclinometer_objects() {
  return kObjects;
}

std::vector<can::OwnedMessage> inclinometer_layouts(std::uint8_t node_id,
                                                    std::uint16_t resolution_mdeg) {
  const auto slope = [resolution_mdeg](const char* name, const SlopeObjects& objects,
                                       std::uint16_t bit) {
    can::OwnedSignal field =
        make_signal(name, *find(kObjects, objects.address(kSlopeValue)), bit, "CiA 410");
    field.scale = 1e-3 * resolution_mdeg;
    field.unit = "deg";
    return can::unlimited(std::move(field));
  };
  std::vector<can::OwnedMessage> list{
      make_layout("inclinometer_slopes", kTransmitPdo1Base, node_id, 4, "TPDO1, 16-bit slopes"),
      make_layout("inclinometer_slopes_32", kTransmitPdo1Base + 0x100, node_id, 8,
                  "TPDO2, 32-bit slopes, after SYNC"),
      make_heartbeat_layout("inclinometer", node_id),
      make_emergency_layout("inclinometer", node_id)};
  list[0].signals = {slope("slope_longitudinal", kSlopes[0], 0),
                     slope("slope_lateral", kSlopes[1], 16)};
  list[1].signals = {slope("slope_longitudinal", kSlopes[2], 0),
                     slope("slope_lateral", kSlopes[3], 32)};
  return list;
}

}  // namespace rigwire::protocols::canopen
