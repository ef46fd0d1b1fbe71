// Debian's python-can, unmodified, as a client of our socketcand on a loopback port.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "child_process.h"
#include "drivers/socketcand_server.h"
#include "drivers/tcp_server.h"

namespace rigwire::drivers {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;

/// Runs a Python script against the server until it ends. Every frame that it sends goes out a
/// millisecond after the one before.
class SocketcandWithPythonCan : public testing::Test {
 protected:
  SocketcandWithPythonCan() {
    daemon_.start([this](const Frame& frame) {
      received_.push_back(frame);
      unsettled_.push_back(frame);
    });
  }
  ~SocketcandWithPythonCan() override { std::filesystem::remove(script_); }

  /// What the script printed. It must end well.
  std::string run(const std::string& script, const std::function<void()>& meanwhile = {}) {
    std::ofstream(script_) << "import sys, can\n"
                              "def connect(channel='can'):\n"
                              "    return can.interface.Bus(interface='socketcand', "
                              "host='127.0.0.1', port=int(sys.argv[1]), channel=channel)\n"
                           << script;
    // Debian's interpreter by its path: python-can belongs to it.
    const std::string command =
        "/usr/bin/python3 " + script_.string() + " " + std::to_string(tcp_.port()) + " 2>&1";
    std::FILE* client = ::popen(command.c_str(), "r");
    if (client == nullptr) {
      return "no interpreter";
    }
    ::fcntl(::fileno(client), F_SETFL, O_NONBLOCK);
    std::string output;
    bool ended = false;
    const auto end = std::chrono::steady_clock::now() + test::kPatience;
    while (!ended && std::chrono::steady_clock::now() < end) {
      context_.run_for(1ms);
      context_.restart();
      now_ += 1ms;
      if (!unsettled_.empty()) {
        unsettled_.erase(unsettled_.begin());
        daemon_.confirm(true, now_);
      }
      if (meanwhile) {
        meanwhile();
      }
      char buffer[512];
      const ssize_t size = ::read(::fileno(client), buffer, sizeof buffer);
      ended = size == 0;
      output.append(buffer, size > 0 ? static_cast<std::size_t>(size) : 0);
    }
    EXPECT_TRUE(ended) << "the client did not end";
    EXPECT_EQ(::pclose(client), 0) << output << "(package python3-can is in packages.txt)";
    return output;
  }

  std::filesystem::path script_ = std::filesystem::temp_directory_path() /
                                  ("rigwire_socketcand_" + std::to_string(::getpid()) + ".py");
  boost::asio::io_context context_;
  TcpServer tcp_{context_, {.port = 0}};
  SocketcandServer daemon_{
      context_, tcp_, {.buses = {"can"}, .epoch = std::chrono::seconds(1'780'000'000)}};
  CanBus::Stamp now_{0};
  std::vector<Frame> received_;
  std::vector<Frame> unsettled_;
};

TEST_F(SocketcandWithPythonCan, SendsFramesOfBothLengthsOfIdentifier) {
  EXPECT_EQ(run(R"(
bus = connect()
bus.send(can.Message(arbitration_id=0x18EAFFFE, is_extended_id=True, data=[0x00, 0xEE, 0x00]))
bus.send(can.Message(arbitration_id=0x0CF00400, is_extended_id=True, data=[1, 2, 3, 4, 5, 6, 7, 8]))
bus.send(can.Message(arbitration_id=0x123, is_extended_id=False, data=[]))
bus.shutdown()
)"),
            "");
  const std::vector<Frame> expected = {{0x18EAFFFE, true, false, 3, {0x00, 0xEE, 0x00}},
                                       {0x0CF00400, true, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}},
                                       {0x123, false, false, 0, {}}};
  EXPECT_EQ(received_, expected);
}

// A bus that is busy while the client opens it does not come between its "< ok >".
TEST_F(SocketcandWithPythonCan, HearsABusyBusFromTheStartWithoutALoss) {
  std::uint8_t count = 0;
  std::string output = run(R"(
for i in range(5):
    bus = connect()
    first = bus.recv(200)
    last = first.data[0]
    for j in range(100):
        message = bus.recv(200)
        assert message.arbitration_id == 0x0CF02980, message
        assert message.data[0] == (last + 1) % 256, (message, last)
        last = message.data[0]
    bus.shutdown()
print(int(first.timestamp) // 1000)
)",
                           [&] {
                             daemon_.deliver({0x0CF02980, true, false, 2, {count++, 7}}, now_);
                           });
  EXPECT_EQ(output, "1780000\n");
}

TEST_F(SocketcandWithPythonCan, ClientsHearEachOtherButNotThemselves) {
  EXPECT_EQ(run(R"(
one, other = connect(), connect()
one.send(can.Message(arbitration_id=0x111, is_extended_id=False, data=[1]))
message = other.recv(200)
print('%X %s' % (message.arbitration_id, message.data.hex()))
print(one.recv(0.3))
)"),
            "111 01\nNone\n");
}

TEST_F(SocketcandWithPythonCan, ABusThatIsNotThereIsAnError) {
  EXPECT_EQ(run(R"(
try:
    connect('can7')
except can.CanError as error:
    print(error)
)"),
            "< ok > message expected!\n");
}

}  // namespace
}  // namespace rigwire::drivers
