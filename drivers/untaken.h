// Whether the programs at the far end have read what they were sent: counts what still waits for
// them in the kernel of this machine.
//
// It shows that they have read, not that they have acted. Where the kernel does not know, the
// result is empty: TCP acknowledges bytes before a program reads them, SocketCAN has no such count,
// and nothing is known of another machine.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

/// Returns the bytes that wait at the slave of a pseudo-terminal (FIONREAD, tty_ioctl(4)), which
/// the master cannot query. 0 when all has been read; else at least as many wait, since some may
/// still be on their way within the kernel. Opens the slave for a moment. Nothing where it cannot
/// be opened: it is no terminal, or its client has it for itself (TIOCEXCL) and this user is not
/// root.
[[nodiscard]] std::optional<std::size_t> untaken_bytes(const std::filesystem::path& terminal);

/// Bytes, with the kernel's own room for each datagram, that wait at sockets of this machine that
/// are bound to that port, at that address or at every one (/proc/net/udp, proc(5)); also at those
/// of IPv6 that take datagrams of IPv4 (/proc/net/udp6). Nothing where there is no such socket.
[[nodiscard]] std::optional<std::size_t> untaken_datagrams(const IpEnd& destination);

}  // namespace rigwire::drivers
