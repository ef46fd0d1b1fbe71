// Debian's python-can, unmodified, on our slcan adapter at the end of a pseudo-terminal.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "child_process.h"
#include "drivers/pty.h"
#include "drivers/slcan_adapter.h"

namespace rigwire::drivers {
namespace {

using protocols::can::Frame;

/// Runs a Python script against an adapter on a pseudo-terminal until it ends.
class SlcanWithPythonCan : public testing::Test {
 protected:
  SlcanWithPythonCan() { std::filesystem::create_directories(directory_); }
  ~SlcanWithPythonCan() override { std::filesystem::remove_all(directory_); }

  void start(SlcanAdapterSettings settings) {
    adapter_ = std::make_unique<SlcanAdapter>(line_, std::move(settings));
    adapter_->start([this](const Frame& frame) {
      received_.push_back(frame);
      if (on_frame_) {
        on_frame_(frame);
      }
    });
  }

  /// What the script printed. It must end well.
  std::string run(const std::string& script) {
    const std::string file = (directory_ / "client.py").string();
    std::ofstream(file) << "import sys, can\n" << script;
    // Debian's interpreter by its path: python-can belongs to it.
    const std::string command =
        "/usr/bin/python3 " + file + " " + (directory_ / "can").string() + " 2>&1";
    std::FILE* client = ::popen(command.c_str(), "r");
    if (client == nullptr) {
      return "no interpreter";
    }
    ::fcntl(::fileno(client), F_SETFL, O_NONBLOCK);
    std::string output;
    bool ended = false;
    const auto end = std::chrono::steady_clock::now() + test::kPatience;
    while (!ended && std::chrono::steady_clock::now() < end) {
      context_.run_for(std::chrono::milliseconds(5));
      context_.restart();
      char buffer[512];
      const ssize_t size = ::read(::fileno(client), buffer, sizeof buffer);
      ended = size == 0;
      output.append(buffer, size > 0 ? static_cast<std::size_t>(size) : 0);
    }
    EXPECT_TRUE(ended) << "the client did not end";
    EXPECT_EQ(::pclose(client), 0) << output << "(package python3-can is in packages.txt)";
    context_.poll();
    return output;
  }

  std::filesystem::path directory_ =
      std::filesystem::temp_directory_path() / ("rigwire_slcan_" + std::to_string(::getpid()));
  boost::asio::io_context context_;
  Pty line_{context_, directory_ / "can"};
  std::unique_ptr<SlcanAdapter> adapter_;
  std::vector<Frame> received_;
  std::function<void(const Frame&)> on_frame_;
};

const Frame kSlope{0x0CF02980, true, false, 8, {0, 0, 0x7D, 0, 0, 0x7D, 0xCC, 0}};

TEST_F(SlcanWithPythonCan, OpensSendsAndReceives) {
  start({});
  on_frame_ = [this](const Frame& frame) {
    if (frame.remote) {
      EXPECT_TRUE(adapter_->send(kSlope));
    }
  };
  const std::string output = run(R"(
bus = can.interface.Bus(bustype='slcan', channel=sys.argv[1], bitrate=250000, sleep_after_open=0)
bus.send(can.Message(arbitration_id=0x18EAFFFE, is_extended_id=True, data=[0x00, 0xEE, 0x00]))
bus.send(can.Message(arbitration_id=0x123, is_extended_id=False, data=[1, 2]))
bus.send(can.Message(arbitration_id=0x123, is_extended_id=False, is_remote_frame=True, dlc=4))
message = bus.recv(200)
print('%08X %s %s' % (message.arbitration_id, message.is_extended_id, message.data.hex()))
bus.shutdown()
)");
  EXPECT_EQ(output, "0CF02980 True 00007d00007dcc00\n");
  const std::vector<Frame> expected = {{0x18EAFFFE, true, false, 3, {0x00, 0xEE, 0x00}},
                                       {0x123, false, false, 2, {1, 2}},
                                       {0x123, false, true, 4, {}}};
  EXPECT_EQ(received_, expected);
  EXPECT_EQ(adapter_->counters().refused_commands, 0U);
}

// State lines, error lines, a refused frame and time stamps between its frames do not disturb it;
// registers set the rate, and the adapter's version is read.
TEST_F(SlcanWithPythonCan, IsNotDisturbedByWhatItDoesNotKnow) {
  start({.dialect = SlcanDialect::kernel, .transmit_queue_frames = 3});
  on_frame_ = [this](const Frame& frame) {
    protocols::can::ControllerReport passive;
    passive.state = protocols::can::ErrorState::passive;
    passive.state_changed = true;
    passive.error = protocols::can::BusError::stuff;
    passive.transmit_errors = 128;
    EXPECT_TRUE(adapter_->report(passive, std::chrono::milliseconds(received_.size())));
    EXPECT_TRUE(adapter_->deliver(frame, std::chrono::milliseconds(59'999)));
  };
  const std::string output = run(R"(
bus = can.interface.Bus(bustype='slcan', channel=sys.argv[1], btr='011C', sleep_after_open=0)
print(bus.get_version(200))
bus._write('Z1')
for i in range(5):
    bus.send(can.Message(arbitration_id=0x100 + i, is_extended_id=False, data=[i] * i))
while True:
    message = bus.recv(200)
    print('%03X %s' % (message.arbitration_id, message.data.hex()))
    if message.arbitration_id == 0x102:
        break
bus.shutdown()
)");
  EXPECT_EQ(output, "(10, 13)\n100 \n101 01\n102 0202\n");
  EXPECT_EQ(received_.size(), 3U) << "nobody confirms: two did not fit";
  EXPECT_EQ(adapter_->counters().queue_full, 2U);
}

}  // namespace
}  // namespace rigwire::drivers
