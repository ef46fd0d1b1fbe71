// Wires of a rig that collide with no other test and no running rig.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace rigwire::test {

/// Claims `name` for this process among all tests of the host that run at the same time. Returns
/// false where another one has it. The claim ends with the process: it is a socket of that name,
/// without a file.
inline bool claim(const std::string& name) {
  const std::string text = "rigwire-test " + name;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  text.copy(address.sun_path + 1, sizeof(address.sun_path) - 1);  // behind a 0: no file
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), length) == 0) {
    return true;  // stays open
  }
  ::close(descriptor);
  return false;
}

/// Returns a port of loopback that is free, and that no other test takes while this process runs;
/// so is the port behind it. It is outside the range from which the system chooses.
inline std::uint16_t free_port(int type) {
  const auto is_free = [type](std::uint16_t port) {
    const int descriptor = ::socket(AF_INET, type, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool free =
        ::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    ::close(descriptor);
    return free;
  };
  static int attempt = 0;
  for (const int end = attempt + 2000; attempt < end;) {
    ++attempt;
    const auto port =
        static_cast<std::uint16_t>(10'000 + 2 * ((::getpid() * 37 + attempt * 101) % 10'000));
    if (claim("port " + std::to_string(port)) && is_free(port)) {
      return port;
    }
  }
  throw std::runtime_error("no free port");
}

/// Whether somebody listens on that TCP port of loopback.
inline bool port_answers(std::uint16_t port) {
  const int descriptor = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool up =
      ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  ::close(descriptor);
  return up;
}

/// Returns an address of loopback that no other test has while this process runs.
inline std::string own_address() {
  static int attempt = 0;
  for (;;) {
    const int number = (::getpid() * 37 + 101 * attempt++) % 16'000;
    std::string address =
        "127." + std::to_string(64 + number / 250) + "." + std::to_string(1 + number % 250) + ".2";
    if (claim("address " + address)) {
      return address;
    }
  }
}

/// A folder of its own, removed with the object, and the --set arguments that put every wire there.
class PrivateWires {
 public:
  PrivateWires() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::runtime_error("cannot make a folder for the test");
    }
    folder = pattern;
    lidar_port = free_port(SOCK_DGRAM);
    modbus_port = free_port(SOCK_STREAM);
  }
  ~PrivateWires() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  PrivateWires(const PrivateWires&) = delete;
  PrivateWires& operator=(const PrivateWires&) = delete;

  /// Whether somebody listens on the Modbus port: in the rig's order the last wire to be opened.
  [[nodiscard]] bool are_up() const { return port_answers(modbus_port); }

  [[nodiscard]] std::string gnss() const { return (folder / "gnss").string(); }
  [[nodiscard]] std::string can() const { return (folder / "can").string(); }

  /// Settings of a machine that drives: receiver, lidar and a bus; and what the rig of that name
  /// has besides.
  [[nodiscard]] std::vector<std::string> driving_sets(const std::string& rig = "") const {
    std::vector<std::string> sets{"devices.gnss.path=" + gnss(), "buses.can.path=" + can(),
                                  "buses.can.wire=slcan",
                                  "devices.lidar.port=" + std::to_string(lidar_port),
                                  "devices.lidar.position_port=" + std::to_string(lidar_port + 1)};
    if (rig == "gator_campus") {
      sets.push_back("devices.starfire.path=" + (folder / "starfire").string());
    }
    return sets;
  }
  /// Settings of the excavator: also the valve driver.
  [[nodiscard]] std::vector<std::string> sets() const {
    std::vector<std::string> all = driving_sets();
    all.push_back("devices.valves.port=" + std::to_string(modbus_port));
    return all;
  }

  std::filesystem::path folder;
  std::uint16_t lidar_port = 0;
  std::uint16_t modbus_port = 0;
};

}  // namespace rigwire::test
