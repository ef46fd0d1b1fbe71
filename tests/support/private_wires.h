// Wires of a rig that collide with no other test and no running rig.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace rigwire::test {

/// A port of loopback that was free a moment ago, never the same twice in one test program: who
/// asked for it may open it later. From outside the range of the system's own choices, so that
/// nobody else is given it meanwhile.
inline std::uint16_t free_port(int type) {
  static int attempt = 0;
  for (const int end = attempt + 200; attempt < end;) {
    ++attempt;
    const auto port =
        static_cast<std::uint16_t>(10'000 + (::getpid() * 37 + attempt * 101) % 20'000);
    const int descriptor = ::socket(AF_INET, type, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool free =
        ::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    ::close(descriptor);
    if (free) {
      return port;
    }
  }
  throw std::runtime_error("no free port");
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
  [[nodiscard]] bool are_up() const {
    const int descriptor = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(modbus_port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool up =
        ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    ::close(descriptor);
    return up;
  }

  [[nodiscard]] std::string gnss() const { return (folder / "gnss").string(); }
  [[nodiscard]] std::string can() const { return (folder / "can").string(); }

  /// Of a machine that drives: receiver, lidar and a bus; and what the rig of that name has
  /// besides.
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
  /// Of the excavator: also the valve driver.
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
