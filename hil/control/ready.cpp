#include "hil/control/ready.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "drivers/endpoints.h"

namespace rigwire::hil {
namespace {

std::array<int, 2> opened_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw drivers::EndpointError(std::string("pipe: ") + std::strerror(errno));
  }
  return ends;
}

}  // namespace

bool can_be_written(int descriptor) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
}

bool others_can_read(int descriptor) {
  struct stat file {};
  return ::fstat(descriptor, &file) == 0 && S_ISREG(file.st_mode) &&
         (file.st_mode & (S_IRGRP | S_IROTH)) != 0;
}

void tell_ready(int descriptor, const std::string& line) {
  const drivers::Descriptor owned(descriptor);
  const std::string text = line + "\n";
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t count = ::write(descriptor, text.data() + written, text.size() - written);
    if (count <= 0) {
      return;
    }
    written += static_cast<std::size_t>(count);
  }
}

ReadyPipe::ReadyPipe() : ReadyPipe(opened_pipe()) {}

ReadyPipe::ReadyPipe(std::array<int, 2> ends) : heard_(ends[0]), written_(std::in_place, ends[1]) {}

std::optional<std::string> ReadyPipe::hear() {
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(descriptor(), bytes.data(), bytes.size());
  if (count <= 0) {
    throw drivers::EndpointError("the run ended before it was ready");
  }
  line_.append(bytes.data(), static_cast<std::size_t>(count));
  const std::size_t end = line_.find('\n');
  return end == std::string::npos ? std::nullopt : std::optional(line_.substr(0, end));
}

void notify_service_manager() {
  const char* name = std::getenv("NOTIFY_SOCKET");
  const std::string_view path = name == nullptr ? "" : name;
  sockaddr_un address{};
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    return;
  }
  address.sun_family = AF_UNIX;
  std::ranges::copy(path, address.sun_path);
  if (path[0] == '@') {
    address.sun_path[0] = '\0';  // an abstract name
  }
  const drivers::Descriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  constexpr std::string_view kReady = "READY=1";
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  (void)::sendto(socket.get(), kReady.data(), kReady.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                 reinterpret_cast<const sockaddr*>(&address), length);
}

}  // namespace rigwire::hil
