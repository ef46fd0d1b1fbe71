#include "protocols/openimu/settings.h"

#include <algorithm>
#include <span>

#include "protocols/j1939/message.h"

namespace rigwire::protocols::openimu {
namespace {

enum class Shape : std::uint8_t { command, byte, byte_pair, word_low_first, word_high_first };

struct Row {
  SettingKind kind;
  std::uint32_t pgn;
  Shape shape;
  std::uint8_t bytes;  // that it has at least
};
constexpr std::array<Row, 7> kRows{{
    {SettingKind::reset_algorithm, kResetAlgorithmPgn, Shape::command, 1 + 1},
    {SettingKind::save_configuration, kSaveConfigurationPgn, Shape::command, 1 + 1},
    {SettingKind::packet_rate, kPacketRatePgn, Shape::byte, 1 + 1},
    {SettingKind::packet_mask, kPacketMaskPgn, Shape::word_low_first, 1 + 2},
    {SettingKind::filters, kFilterPgn, Shape::byte_pair, 1 + 1 + 1},
    {SettingKind::orientation, kOrientationPgn, Shape::word_high_first, 1 + 2},
    {SettingKind::behaviour, kBehaviourPgn, Shape::word_low_first, 1 + 2},
}};

const Row& row_of(SettingKind kind) {
  return kRows[static_cast<std::size_t>(kind)];
}

can::Frame send(std::uint32_t pgn, std::uint8_t source, std::span<const std::uint8_t> payload) {
  return j1939::make_frame({kSettingsPriority, pgn, j1939::kGlobalAddress, source}, payload);
}

can::Frame make(const Row& row, const Setting& setting, std::uint8_t source) {
  const auto low = static_cast<std::uint8_t>(setting.word & 0xFFU);
  const auto high = static_cast<std::uint8_t>(setting.word >> 8U);
  std::array<std::uint8_t, 3> payload{setting.address, 0, 0};
  std::size_t length = 3;
  switch (row.shape) {
    case Shape::command:
      payload = {0, setting.address, 0};
      break;
    case Shape::byte:
      payload[1] = setting.first;
      length = 2;
      break;
    case Shape::byte_pair:
      payload[1] = setting.first;
      payload[2] = setting.second;
      break;
    case Shape::word_low_first:
      payload[1] = low;
      payload[2] = high;
      break;
    case Shape::word_high_first:
      payload[1] = high;
      payload[2] = low;
      break;
  }
  return send(row.pgn, source, std::span(payload).first(length));
}

}  // namespace

bool is_rate_divider(std::uint8_t divider) {
  return std::find(kRateDividers.begin(), kRateDividers.end(), divider) != kRateDividers.end();
}

bool is_cut_off(std::uint8_t cut_off_hz) {
  return std::find(kCutOffs_hz.begin(), kCutOffs_hz.end(), cut_off_hz) != kCutOffs_hz.end();
}

std::optional<SettingKind> setting_kind(std::uint32_t pgn) {
  const auto* row =
      std::find_if(kRows.begin(), kRows.end(), [pgn](const Row& r) { return r.pgn == pgn; });
  return row == kRows.end() ? std::nullopt : std::optional(row->kind);
}

std::uint32_t setting_pgn(SettingKind kind) {
  return row_of(kind).pgn;
}

can::Frame make_setting(const Setting& setting, std::uint8_t source) {
  return make(row_of(setting.kind), setting, source);
}

Decoded<Setting> decode_setting(const can::Frame& frame) {
  const auto identifier = j1939::identify(frame);
  const auto kind = identifier ? setting_kind(identifier->pgn) : std::nullopt;
  if (!kind) {
    return Malformed{"no settings group (FF50, FF51, FF55..FF59, 29-bit data frame)", 0};
  }
  const Row& row = row_of(*kind);
  if (frame.length < row.bytes) {
    return Malformed{"shorter than the setting", frame.length};
  }
  const auto payload = frame.payload();
  Setting setting;
  setting.kind = *kind;
  setting.address = payload[0];
  switch (row.shape) {
    case Shape::command:
      if (payload[0] != 0) {
        return Malformed{"not marked as a request", 0};
      }
      setting.address = payload[1];
      break;
    case Shape::byte:
      setting.first = payload[1];
      break;
    case Shape::byte_pair:
      setting.first = payload[1];
      setting.second = payload[2];
      break;
    case Shape::word_low_first:
      setting.word = static_cast<std::uint16_t>(payload[1] | (payload[2] << 8U));
      break;
    case Shape::word_high_first:
      setting.word = static_cast<std::uint16_t>((payload[1] << 8U) | payload[2]);
      break;
  }
  return {setting, frame.length};
}

can::Frame make_setting_answer(const Setting& setting, std::uint8_t source) {
  Setting answer = setting;
  answer.address = source;
  if (setting.kind == SettingKind::filters) {
    std::swap(answer.first, answer.second);
  }
  return make(row_of(setting.kind), answer, source);
}

can::Frame make_outcome(SettingKind kind, std::uint8_t source, std::uint8_t requester, bool done) {
  const std::array<std::uint8_t, 3> payload{1, requester, static_cast<std::uint8_t>(done ? 1 : 0)};
  return send(setting_pgn(kind), source, payload);
}

}  // namespace rigwire::protocols::openimu
