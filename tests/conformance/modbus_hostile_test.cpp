// Clients that a Modbus TCP server meets and must outlive: thousands that come and go, one that
// writes byte by byte, thirty-two at once and one more.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "child_process.h"
#include "drivers/descriptor.h"
#include "modbus_rig.h"
#include "sanitized.h"

namespace rigwire::conformance {
namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes kRequest{0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 1};

std::size_t open_descriptors() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    ++count;
  }
  return count;
}

/// Resident memory of this process, in pages.
std::size_t resident_pages() {
  std::ifstream file("/proc/self/statm");
  std::size_t total = 0;
  std::size_t resident = 0;
  file >> total >> resident;
  return resident;
}

class Connection {
 public:
  explicit Connection(std::uint16_t port)
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
    const timeval limit{120, 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  }
  void write(std::span<const std::uint8_t> bytes) const {
    EXPECT_EQ(::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  /// Bytes of one answer; 0 when the server has closed.
  [[nodiscard]] ssize_t read() const {
    std::array<std::uint8_t, 260> answer{};
    return ::recv(socket_.get(), answer.data(), answer.size(), 0);
  }
  /// The next close() resets, so that no port waits for its end.
  void reset_on_close() const {
    const linger at_once{1, 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  }

 private:
  drivers::Descriptor socket_;
};

TEST(ModbusHostile, TenThousandReconnectsLeaveDescriptorsAndMemoryFlat) {
  ModbusRig rig;
  const auto come_and_go = [&](int times) {
    for (int i = 0; i < times; ++i) {
      const Connection client(rig.port());
      client.reset_on_close();
      if (i % 3 == 0) {
        client.write(kRequest);
        ASSERT_EQ(client.read(), 11);
      } else if (i % 3 == 1) {
        client.write(std::span(kRequest).first(5));  // half a request dies with its connection
      }
    }
  };
  const auto settled = [&] { EXPECT_TRUE(test::eventually([&] { return rig.clients() == 0; })); };
  come_and_go(500);
  settled();
  rig.forget_segments();
  const std::size_t descriptors = open_descriptors();
  const std::size_t pages = resident_pages();
  for (int round = 0; round < 10; ++round) {
    come_and_go(1000);
    rig.forget_segments();
  }
  settled();
  EXPECT_EQ(open_descriptors(), descriptors);
  // What a sanitizer keeps for its reports grows.
  if (!kSanitized) {
    EXPECT_LE(resident_pages(), pages + 512) << "2 MiB";
  }
}

TEST(ModbusHostile, TheThirtyThirdClientTakesThePlaceOfTheOneSilentLongest) {
  const ModbusRig rig;
  std::vector<std::unique_ptr<Connection>> clients;
  for (int i = 0; i < 32; ++i) {
    clients.push_back(std::make_unique<Connection>(rig.port()));
    clients.back()->write(kRequest);
    ASSERT_EQ(clients.back()->read(), 11) << i;
  }
  clients[0]->write(kRequest);  // the first one has just spoken: the second is the oldest
  ASSERT_EQ(clients[0]->read(), 11);
  const Connection late(rig.port());
  late.write(kRequest);
  EXPECT_EQ(late.read(), 11);
  EXPECT_LE(clients[1]->read(), 0);
  clients[0]->write(kRequest);
  EXPECT_EQ(clients[0]->read(), 11);
}

TEST(ModbusHostile, ImpossibleLengthsCloseAfterTheAnswersStillDue) {
  const ModbusRig rig;
  for (const std::uint16_t length : std::vector<std::uint16_t>{0, 1, 255, 65535}) {
    const Connection client(rig.port());
    Bytes bytes = kRequest;
    bytes.insert(bytes.end(), {0, 2, 0, 0, static_cast<std::uint8_t>(length >> 8U),
                               static_cast<std::uint8_t>(length), 1, 3});
    client.write(bytes);
    EXPECT_EQ(client.read(), 11) << length;
    EXPECT_LE(client.read(), 0) << length;
  }
}

}  // namespace
}  // namespace rigwire::conformance
