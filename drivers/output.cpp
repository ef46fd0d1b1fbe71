#include "drivers/output.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <system_error>
#include <thread>

#include "drivers/endpoints.h"

namespace rigwire::drivers {
namespace {

/// Where poll() promises room for one byte only.
constexpr std::size_t kTerminalPiece = 64;
constexpr std::chrono::milliseconds kReaderPoll{10};

/// For poll(): whole milliseconds, rounded up, so that the caller does not spin before the
/// deadline.
int milliseconds_until(Output::Deadline until) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 3'600'000));
}

}  // namespace

Interrupt::Interrupt() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!event_.open()) {
    throw EndpointError("output: cannot create an event: " +
                        std::generic_category().message(errno) + "; raise the limit of open files");
  }
}

void Interrupt::raise() const {
  const std::uint64_t one = 1;
  // Fails only when it is raised already.
  static_cast<void>(!::write(event_.get(), &one, sizeof one));
}

Output::Output(int descriptor)
    : Output(descriptor, [descriptor] {
        struct stat about {};
        if (::fstat(descriptor, &about) != 0) {
          return Kind::unready;
        }
        if (S_ISSOCK(about.st_mode)) {
          return Kind::socket;
        }
        if (S_ISFIFO(about.st_mode)) {
          return Kind::pipe;
        }
        return ::isatty(descriptor) == 1 ? Kind::terminal : Kind::plain;
      }()) {}

Output::Output(int descriptor, Kind kind)
    : kind_(kind), descriptor_([&] {
        if (kind == Kind::pipe || kind == Kind::terminal) {
          const std::string self = "/proc/self/fd/" + std::to_string(descriptor);
          const int opened = ::open(self.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
          if (opened >= 0) {
            own_ = true;
            return opened;
          }
        }
        return kind == Kind::unready ? -1 : ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
      }()) {}

std::size_t Output::piece(std::size_t left) const {
  switch (kind_) {
    case Kind::terminal:
      return own_ ? left : std::min(left, kTerminalPiece);
    case Kind::pipe:
      return std::min<std::size_t>(left, PIPE_BUF);
    case Kind::unready:
    case Kind::plain:
    case Kind::socket:
      break;
  }
  return left;
}

std::ptrdiff_t Output::put(std::string_view bytes) const {
  if (kind_ == Kind::socket) {
    return ::send(descriptor_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  }
  if ((kind_ == Kind::pipe || kind_ == Kind::terminal) && !own_) {
    pollfd ready{descriptor_.get(), POLLOUT, 0};
    if (::poll(&ready, 1, 0) == 0) {
      errno = EAGAIN;
      return -1;
    }
  }
  return ::write(descriptor_.get(), bytes.data(), bytes.size());
}

Written Output::write(std::string_view bytes, Deadline until, const Interrupt* interrupt) const {
  Written written;
  const auto ended = [&written](WriteEnd end, int error = 0) {
    written.end = end;
    written.error = error;
    return written;
  };
  if (!descriptor_.open()) {
    return ended(WriteEnd::failed, EBADF);
  }
  while (written.bytes < bytes.size()) {
    const std::string_view rest = bytes.substr(written.bytes);
    const std::ptrdiff_t count = put(rest.substr(0, piece(rest.size())));
    if (count > 0) {
      written.bytes += static_cast<std::size_t>(count);
      continue;
    }
    if (count == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
      const int error = count == 0 ? EIO : errno;
      return error == EPIPE || error == ECONNRESET ? ended(WriteEnd::closed)
                                                   : ended(WriteEnd::failed, error);
    }
    std::array<pollfd, 2> wait{{{descriptor_.get(), POLLOUT, 0},
                                {interrupt != nullptr ? interrupt->descriptor() : -1, POLLIN, 0}}};
    const int left_ms = milliseconds_until(until);
    if (::poll(wait.data(), wait.size(), left_ms) == 0 && left_ms == 0) {
      return ended(WriteEnd::late);
    }
    if ((wait[1].revents & POLLIN) != 0) {
      return ended(WriteEnd::interrupted);
    }
    // An empty slot of a pipe shared with another writer may be gone again: the next look decides.
    if (wait[0].revents == 0 && std::chrono::steady_clock::now() >= until) {
      return ended(WriteEnd::late);
    }
  }
  return ended(WriteEnd::whole);
}

int open_for_reader(const std::string& path, Output::Deadline until) {
  while (true) {
    const int opened = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (opened >= 0 || errno != ENXIO || std::chrono::steady_clock::now() >= until) {
      return opened;
    }
    std::this_thread::sleep_for(kReaderPoll);
  }
}

}  // namespace rigwire::drivers
