// Whether the programs at the far end have taken what they were sent: what still waits for them in
// the kernel of this machine.
//
// It says that they have read, not that they have acted. Where the kernel does not tell, nothing is
// said: TCP acknowledges what nobody has read, SocketCAN has no such count, and of another machine
// nothing is known.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

/// Bytes that wait at the slave of a pseudo-terminal (FIONREAD, tty_ioctl(4)): the master is not
/// told them. 0 when all has been read; else at least as many wait, since some may still be on
/// their way within the kernel. Opens it for a moment. Nothing where it cannot be opened: it is
/// none, or its client has it for itself (TIOCEXCL) and this user is not root.
[[nodiscard]] std::optional<std::size_t> untaken_bytes(const std::filesystem::path& terminal);

/// Bytes, with the kernel's own room for each datagram, that wait at sockets of this machine that
/// are bound to that port, at that address or at every one (/proc/net/udp, proc(5)); also at those
/// of IPv6 that take datagrams of IPv4 (/proc/net/udp6). Nothing where there is no such socket.
[[nodiscard]] std::optional<std::size_t> untaken_datagrams(const IpEnd& destination);

}  // namespace rigwire::drivers
