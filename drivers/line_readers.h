// Who holds a pseudo-terminal open: a serial line has one plug, and several programs that read one
// share its bytes as the kernel deals them out.
//
// Found by what /proc tells of processes. It tells a user of his own ones only, root of all, both
// of those in their PID namespace; a program of another user is not seen. Linux.
#pragma once

#include <sys/types.h>

#include <span>
#include <string>
#include <vector>

namespace rigwire::drivers {

struct LineReader {
  pid_t process = 0;
  std::string program;  ///< As the kernel names it, 15 characters at most.
};

/// The processes but this one that hold each of `terminals` ("/dev/pts/3") open. A process whose
/// ancestor holds it, too, has inherited it and counts with that one. Takes milliseconds, in
/// proportion to the descriptors that all these processes have open.
[[nodiscard]] std::vector<std::vector<LineReader>> readers_of(
    std::span<const std::string> terminals);

}  // namespace rigwire::drivers
