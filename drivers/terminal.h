// Line settings of a terminal, by its file descriptor; on the master of a pseudo-terminal these are
// the settings of its slave. Uses the kernel's termios2, which carries any speed, not only the
// POSIX constants.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace rigwire::drivers {

/// Makes the terminal transparent: no echo, no line editing, no translation, eight bits, one stop
/// bit, modem lines ignored; a read returns what is there. Keeps the speed unless one is given
/// (bit/s). Writes nothing when the terminal is already so. False with errno set when the system
/// refuses.
[[nodiscard]] bool make_terminal_raw(int descriptor, std::optional<std::uint32_t> baud = {});

/// The output speed in bit/s; empty when the descriptor is no terminal.
[[nodiscard]] std::optional<std::uint32_t> terminal_baud(int descriptor);

/// Throws away what has arrived and was not read.
void discard_terminal_input(int descriptor);

/// Whether the kernel's slcan driver is attached to this terminal, as slcand attaches it. False
/// when the terminal cannot be opened.
[[nodiscard]] bool slcan_attached(const std::string& terminal);

}  // namespace rigwire::drivers
