#include "protocols/openimu/settings.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>

#include "protocols/bytes.h"
#include "protocols/j1939/message.h"

namespace rigwire::protocols::openimu {

using enum Command;

namespace {

constexpr std::array k300Bank0{reset_algorithm, save_configuration, master_status,
                               magnetic_alignment};
constexpr std::array kBank1{packet_rate, packet_mask, filters, orientation, behaviour};
constexpr std::array k335Bank0{reset_algorithm, save_configuration, hardware_status,
                               software_status, master_status,      fine_rate};
/// The bytes before it move aiding messages, which are not there.
constexpr std::size_t k335Bank2Skipped = 2;
constexpr std::array k335Bank2{trouble_code};

enum class Shape : std::uint8_t {
  command,
  byte,
  byte_pair,
  mask,
  word_high_first,
  behaviour,
  bytes
};

struct Row {
  Command kind;
  Shape shape;
  std::uint8_t least_bytes;
};
constexpr std::array<Row, 9> kRows{{
    {Command::reset_algorithm, Shape::command, 1 + 1},
    {Command::save_configuration, Shape::command, 1 + 1},
    {Command::packet_rate, Shape::byte, 1 + 1},
    {Command::packet_mask, Shape::mask, 1 + 2},
    {Command::filters, Shape::byte_pair, 1 + 1 + 1},
    {Command::orientation, Shape::word_high_first, 1 + 2},
    {Command::behaviour, Shape::behaviour, 1 + 2},
    {Command::trouble_code, Shape::bytes, 1 + 7},
    {Command::magnetic_alignment, Shape::byte, 1 + 1},
}};
constexpr std::size_t kMaskWithPriorities = 1 + 2 + 1 + 1;    // address, mask, values, which
constexpr std::size_t kBehaviourWithAddress = 1 + 2 + 2 + 1;  // address, set, clear, new address
constexpr std::uint8_t kFiller = 0xAA;
constexpr std::uint8_t kRequest = 0;
constexpr std::uint8_t kRequestAndRestart = 2;

const Row* row_of(Command kind) {
  const auto* row =
      std::find_if(kRows.begin(), kRows.end(), [kind](const Row& r) { return r.kind == kind; });
  return row == kRows.end() ? nullptr : row;
}

can::Frame send(std::uint32_t pgn, std::uint8_t source, std::span<const std::uint8_t> payload) {
  return j1939::make_frame({kSettingsPriority, pgn, j1939::kGlobalAddress, source}, payload);
}

/// Encodes a settings message of the given shape. Words are little-endian except in
/// `word_high_first`; optional bytes of `mask` and `behaviour` are left out when not set (zero).
can::Frame make(std::uint32_t pgn, Shape shape, const Setting& setting, std::uint8_t source) {
  std::array<std::uint8_t, 8> payload{setting.address};
  std::size_t length = 3;
  switch (shape) {
    case Shape::command:
      payload = {setting.first, setting.address, 0};
      break;
    case Shape::byte:
      payload[1] = setting.first;
      length = 2;
      break;
    case Shape::byte_pair:
      payload[1] = setting.first;
      payload[2] = setting.second;
      break;
    case Shape::mask:
      store_little<std::uint16_t>(payload, 1, setting.word);
      if (setting.second != 0) {
        payload[3] = setting.first;
        payload[4] = setting.second;
        length = kMaskWithPriorities;
      }
      break;
    case Shape::word_high_first:
      store_big<std::uint16_t>(payload, 1, setting.word);
      break;
    case Shape::behaviour:
      store_little<std::uint16_t>(payload, 1, setting.word);
      if (setting.more[0] != 0 || setting.more[1] != 0 || setting.more[2] != 0) {
        std::copy_n(setting.more.begin(), 3, payload.begin() + 3);
        length = kBehaviourWithAddress;
      }
      break;
    case Shape::bytes:
      std::copy(setting.more.begin(), setting.more.end(), payload.begin() + 1);
      length = payload.size();
      break;
  }
  return send(pgn, source, std::span(payload).first(length));
}

}  // namespace

std::optional<Command> command_of(const CommandMap& map, std::uint32_t pgn) {
  if ((pgn & ~0xFFU) != 0xFF00U) {
    return std::nullopt;
  }
  const auto found = std::find(map.begin(), map.end(), static_cast<std::uint8_t>(pgn & 0xFFU));
  return found == map.end() ? std::nullopt
                            : std::optional(static_cast<Command>(found - map.begin()));
}

std::span<const Command> bank_commands(std::uint32_t pgn, bool is_300) {
  switch (pgn) {
    case kBank0Pgn:
      return is_300 ? std::span<const Command>(k300Bank0) : std::span<const Command>(k335Bank0);
    case kBank1Pgn:
      return kBank1;
    case kBank2Pgn:
      return is_300 ? std::span<const Command>{} : std::span<const Command>(k335Bank2);
    default:
      return {};
  }
}

bool apply_bank(CommandMap& map, std::uint32_t pgn, std::span<const std::uint8_t> bytes,
                bool is_300) {
  const auto commands = bank_commands(pgn, is_300);
  const std::size_t first = pgn == kBank2Pgn ? k335Bank2Skipped : 0;
  const std::uint8_t highest = is_300 ? kHighestSpecific300 : kHighestSpecific335;
  const auto legal = [highest](std::uint8_t byte) {
    return byte >= kLowestSpecific && byte <= highest;
  };
  if (is_300 && !std::all_of(bytes.begin(), bytes.end(),
                             [&](std::uint8_t byte) { return byte == 0 || legal(byte); })) {
    return false;
  }
  bool taken = false;
  for (std::size_t i = 0; i < commands.size() && first + i < bytes.size(); ++i) {
    const std::uint8_t byte = bytes[first + i];
    const auto index = static_cast<std::size_t>(commands[i]);
    if (legal(byte)) {
      map[index] = byte;
      taken = true;
    } else if (is_300) {
      map[index] = kDeliveredCommands[index];
      taken = true;
    }
  }
  return taken;
}

bool is_rate_divider(std::uint8_t divider) {
  return std::find(kRateDividers.begin(), kRateDividers.end(), divider) != kRateDividers.end();
}

bool is_cut_off(std::uint8_t cut_off_hz) {
  return std::find(kCutOffs_hz.begin(), kCutOffs_hz.end(), cut_off_hz) != kCutOffs_hz.end();
}

std::optional<SettingKind> setting_kind(std::uint32_t pgn, const CommandMap& map) {
  const auto command = command_of(map, pgn);
  return command && row_of(*command) != nullptr ? command : std::nullopt;
}

std::uint32_t setting_pgn(SettingKind kind, const CommandMap& map) {
  return pgn_of(map, kind);
}

can::Frame make_setting(const Setting& setting, std::uint8_t source, const CommandMap& map) {
  assert(row_of(setting.kind) != nullptr);
  return make(pgn_of(map, setting.kind), row_of(setting.kind)->shape, setting, source);
}

Decoded<Setting> decode_setting(const can::Frame& frame, const CommandMap& map) {
  const auto identifier = j1939::identify(frame);
  const auto kind = identifier ? setting_kind(identifier->pgn, map) : std::nullopt;
  if (!kind) {
    return Malformed{"no settings group (FF50 .. FF5E, 29-bit data frame)", 0};
  }
  const Row& row = *row_of(*kind);
  if (frame.length < row.least_bytes) {
    return Malformed{"shorter than the setting", frame.length};
  }
  const auto payload = frame.payload();
  Setting setting;
  setting.kind = *kind;
  setting.address = payload[0];
  switch (row.shape) {
    case Shape::command:
      if (payload[0] != kRequest && payload[0] != kRequestAndRestart) {
        return Malformed{"not marked as a request", 0};
      }
      setting.first = payload[0];
      setting.address = payload[1];
      break;
    case Shape::byte:
      setting.first = payload[1];
      break;
    case Shape::byte_pair:
      setting.first = payload[1];
      setting.second = payload[2];
      break;
    case Shape::mask:
      setting.word = load_little<std::uint16_t>(payload, 1);
      if (payload.size() >= kMaskWithPriorities) {
        setting.first = payload[3];
        setting.second = payload[4];
      }
      break;
    case Shape::word_high_first:
      setting.word = load_big<std::uint16_t>(payload, 1);
      break;
    case Shape::behaviour:
      setting.word = load_little<std::uint16_t>(payload, 1);
      if (payload.size() >= kBehaviourWithAddress) {
        std::copy_n(payload.begin() + 3, 3, setting.more.begin());
      }
      break;
    case Shape::bytes:
      std::copy(payload.begin() + 1, payload.end(), setting.more.begin());
      break;
  }
  return {setting, frame.length};
}

can::Frame make_setting_answer_300(const Setting& setting, std::uint8_t source,
                                   const CommandMap& map) {
  Setting answer = setting;
  answer.address = source;
  if (setting.kind == Command::filters) {
    std::swap(answer.first, answer.second);
  }
  return make_setting(answer, source, map);
}

can::Frame make_setting_answer_335(const Setting& setting, std::uint8_t source,
                                   std::uint8_t requester, const CommandMap& map) {
  Setting answer = setting;
  answer.address = requester;
  can::Frame frame = make_setting(answer, source, map);
  if (setting.kind == Command::packet_mask) {
    frame.data[3] = setting.first;
    frame.length = 1 + 2 + 1;
  }
  return filled_up(frame);
}

can::Frame make_outcome(SettingKind kind, std::uint8_t source, std::uint8_t requester, bool done,
                        const CommandMap& map) {
  const std::array<std::uint8_t, 3> payload{1, requester, static_cast<std::uint8_t>(done ? 1 : 0)};
  return send(pgn_of(map, kind), source, payload);
}

can::Frame make_alignment_answer(const MagneticAlignment& alignment, std::uint8_t source,
                                 const CommandMap& map) {
  const auto counts = [](double value, double scale, unsigned bits) {
    const auto mask = (std::uint64_t{1} << bits) - 1U;
    return static_cast<std::uint64_t>(std::max(0.0, value * scale)) & mask;
  };
  constexpr double kAngleScale = 2048.0 / std::numbers::pi;
  std::array<std::uint8_t, 8> payload{alignment.command, alignment.state};
  const std::uint64_t values =
      counts(alignment.hard_iron_x_gauss + 8.0, 256.0, 12) |
      (counts(alignment.hard_iron_y_gauss + 8.0, 256.0, 12) << 12U) |
      (counts(alignment.soft_iron_ratio, 1024.0, 10) << 24U) |
      (counts(alignment.soft_iron_angle_rad + std::numbers::pi, kAngleScale, 14) << 34U);
  for (std::size_t i = 0; i < 6; ++i) {
    payload[2 + i] = static_cast<std::uint8_t>((values >> (8 * i)) & 0xFFU);
  }
  return send(pgn_of(map, Command::magnetic_alignment), source, payload);
}

can::Frame filled_up(can::Frame frame) {
  std::fill(frame.data.begin() + frame.length, frame.data.end(), kFiller);
  frame.length = static_cast<std::uint8_t>(frame.data.size());
  return frame;
}

}  // namespace rigwire::protocols::openimu
