#include "protocols/openimu/command_map.h"

#include <algorithm>

namespace rigwire::protocols::openimu {
namespace {

using enum Command;

constexpr std::array k300Bank0{reset_algorithm, save_configuration, master_status,
                               magnetic_alignment};
constexpr std::array kBank1{packet_rate, packet_mask, filters, orientation, behaviour};
constexpr std::array k335Bank0{reset_algorithm, save_configuration, hardware_status,
                               software_status, master_status,      fine_rate};
/// The bytes before it move aiding messages, which are not there.
constexpr std::size_t k335Bank2Skipped = 2;
constexpr std::array k335Bank2{trouble_code};

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

}  // namespace rigwire::protocols::openimu
