// Under which groups an OpenIMU hears its commands and sends its proprietary messages: all are
// FFxx, and a client may move xx (groups FFF0, FFF1, FFF2) to keep out of somebody else's way.
//
// Source: openIMU300-lib and openIMU335RI-lib (open firmware), "bank" messages: byte 1 the device,
// then one byte per command, in an order that differs between the two devices.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace rigwire::protocols::openimu {

/// What has a group that can be moved.
enum class Command : std::uint8_t {
  reset_algorithm,
  save_configuration,
  hardware_status,  ///< 335RI, as the next.
  software_status,
  master_status,
  packet_rate,
  packet_mask,
  filters,
  orientation,
  behaviour,
  trouble_code,        ///< 335RI: what DM1 says.
  magnetic_alignment,  ///< 300RI.
  fine_rate,           ///< 335RI: a data message.
};
inline constexpr std::size_t kCommands = 13;

inline constexpr std::uint32_t kBank0Pgn = 0xFFF0;
inline constexpr std::uint32_t kBank1Pgn = 0xFFF1;
inline constexpr std::uint32_t kBank2Pgn = 0xFFF2;  ///< 335RI.

inline constexpr std::uint8_t kLowestSpecific = 0x40;
inline constexpr std::uint8_t kHighestSpecific300 = 0x6A;
inline constexpr std::uint8_t kHighestSpecific335 = 0x6C;

/// The low byte of each command's group.
using CommandMap = std::array<std::uint8_t, kCommands>;
inline constexpr CommandMap kDeliveredCommands{0x50, 0x51, 0x52, 0x53, 0x54, 0x55, 0x56,
                                               0x57, 0x58, 0x59, 0x5A, 0x5E, 0x6B};

[[nodiscard]] constexpr std::uint32_t pgn_of(const CommandMap& map, Command command) {
  return 0xFF00U | map[static_cast<std::size_t>(command)];
}
/// The command of a group; nothing when there is none.
[[nodiscard]] std::optional<Command> command_of(const CommandMap& map, std::uint32_t pgn);

/// Which commands the bytes after the address of a bank message move, in their order; bytes beyond
/// have no meaning. Empty when the device has no such bank.
[[nodiscard]] std::span<const Command> bank_commands(std::uint32_t pgn, bool is_300);

/// Takes a bank message's bytes (those after the address). The 300RI refuses all of them when one
/// is neither 0 (back to delivery) nor 0x40..0x6A; the 335RI takes each that is 0x40..0x6C. Returns
/// whether anything was taken.
bool apply_bank(CommandMap& map, std::uint32_t pgn, std::span<const std::uint8_t> bytes,
                bool is_300);

}  // namespace rigwire::protocols::openimu
