// Debian's python-can, unmodified, opens our slcan adapter on a pseudo-terminal, sends frames of
// every shape, and reads a device's message.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "drivers/pty.h"
#include "drivers/slcan_adapter.h"

namespace rigwire::drivers {
namespace {

using protocols::can::Frame;

constexpr const char* kScript = R"(
import sys, can
bus = can.interface.Bus(bustype='slcan', channel=sys.argv[1], bitrate=250000)
bus.send(can.Message(arbitration_id=0x18EAFFFE, is_extended_id=True, data=[0x00, 0xEE, 0x00]))
bus.send(can.Message(arbitration_id=0x123, is_extended_id=False, data=[1, 2]))
bus.send(can.Message(arbitration_id=0x123, is_extended_id=False, is_remote_frame=True, dlc=4))
message = bus.recv(10)
print('%08X %s %s' % (message.arbitration_id, message.is_extended_id, message.data.hex()))
bus.shutdown()
)";

TEST(SlcanWithPythonCan, OpensSendsAndReceives) {
  const std::filesystem::path directory =
      std::filesystem::temp_directory_path() / ("rigwire_slcan_" + std::to_string(::getpid()));
  std::filesystem::create_directories(directory);
  const std::string script = (directory / "client.py").string();
  if (std::FILE* file = std::fopen(script.c_str(), "w"); file != nullptr) {
    std::fputs(kScript, file);
    std::fclose(file);
  }

  boost::asio::io_context context;
  Pty line(context, directory / "can");
  SlcanAdapter adapter(line, 250'000);
  std::vector<Frame> received;
  adapter.start([&](const Frame& frame) {
    received.push_back(frame);
    if (frame.remote) {
      EXPECT_TRUE(adapter.send({0x0CF02980, true, false, 8, {0, 0, 0x7D, 0, 0, 0x7D, 0xCC, 0}}));
    }
  });

  // Debian's interpreter by its path: python-can belongs to it.
  const std::string command =
      "/usr/bin/python3 " + script + " " + (directory / "can").string() + " 2>&1";
  std::FILE* client = ::popen(command.c_str(), "r");
  ASSERT_NE(client, nullptr);
  ::fcntl(::fileno(client), F_SETFL, O_NONBLOCK);
  std::string output;
  bool ended = false;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!ended && std::chrono::steady_clock::now() < end) {
    context.run_for(std::chrono::milliseconds(5));
    context.restart();
    char buffer[512];
    const ssize_t size = ::read(::fileno(client), buffer, sizeof buffer);
    ended = size == 0;
    output.append(buffer, size > 0 ? static_cast<std::size_t>(size) : 0);
  }
  ASSERT_TRUE(ended) << "the client did not end within 30 s; it said: " << output;
  EXPECT_EQ(::pclose(client), 0) << output << "(package python3-can is in packages.txt)";
  context.poll();

  EXPECT_EQ(output, "0CF02980 True 00007d00007dcc00\n");
  const std::vector<Frame> expected = {{0x18EAFFFE, true, false, 3, {0x00, 0xEE, 0x00}},
                                       {0x123, false, false, 2, {1, 2}},
                                       {0x123, false, true, 4, {}}};
  EXPECT_EQ(received, expected);
  EXPECT_EQ(adapter.counters().refused_commands, 0U);
  std::filesystem::remove_all(directory);
}

}  // namespace
}  // namespace rigwire::drivers
