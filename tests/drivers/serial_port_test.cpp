#include "drivers/serial_port.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/pty.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class SerialPortTest : public ::testing::Test {
 protected:
  void TearDown() override { fs::remove_all(link.parent_path()); }

  boost::asio::io_context context;
  fs::path link =
      fs::temp_directory_path() / ("rigwire-serial-test-" + std::to_string(::getpid())) / "port";
  Bytes received;
  ByteStream::Receiver sink = [this](std::span<const std::uint8_t> bytes) {
    received.insert(received.end(), bytes.begin(), bytes.end());
  };
};

TEST_F(SerialPortTest, RefusesAMissingPathAndNamesIt) {
  try {
    const SerialPort port(context, {.path = link.string()});
    FAIL() << "opened";
  } catch (const EndpointError& error) {
    EXPECT_THAT(error.what(), HasSubstr(link.string() + ": No such file or directory"));
  }
}

TEST_F(SerialPortTest, RefusesWhatIsNoTerminal) {
  try {
    const SerialPort port(context, {.path = "/dev/null"});
    FAIL() << "opened";
  } catch (const EndpointError& error) {
    EXPECT_THAT(error.what(), HasSubstr("it is not a terminal"));
  }
}

TEST_F(SerialPortTest, RefusesSettingsThatMakeNoSense) {
  EXPECT_THROW(SerialPort(context, {.path = ""}), std::invalid_argument);
  EXPECT_THROW(SerialPort(context, {.path = "/dev/null", .baud = 0}), std::invalid_argument);
  EXPECT_THROW(SerialPort(context, {.path = "/dev/null", .reopen_period = 0ms}),
               std::invalid_argument);
}

TEST_F(SerialPortTest, WaitsForADeviceThatComesLater) {
  SerialPort port(context, {.path = link.string(), .wait_for_device = true, .reopen_period = 10ms});
  port.start(sink);
  EXPECT_FALSE(port.status().client_present);
  run_for(context, 30ms);
  Pty device(context, link);
  device.start([](std::span<const std::uint8_t>) {});
  ASSERT_TRUE(run_until(context, [&] { return port.status().client_present; }));
  device.write(Bytes{1, 2, 3});
  EXPECT_TRUE(run_until(context, [&] { return received == Bytes{1, 2, 3}; }));
}

TEST_F(SerialPortTest, OpensAgainAfterTheOtherSideWasRestarted) {
  auto device = std::make_unique<Pty>(context, link);
  SerialPort port(context, {.path = link.string(), .reopen_period = 10ms});
  port.start(sink);
  for (std::uint8_t round = 1; round <= 3; ++round) {
    device.reset();
    ASSERT_TRUE(run_until(context, [&] { return !port.status().client_present; }));
    EXPECT_EQ(port.write(Bytes(10, 0)), 10U) << "a line with nothing plugged in takes all";
    device = std::make_unique<Pty>(context, link);
    ASSERT_TRUE(run_until(context, [&] { return port.status().client_present; }));
    received.clear();
    device->write(Bytes{round});
    ASSERT_TRUE(run_until(context, [&] { return received == Bytes{round}; }));
  }
}

}  // namespace
}  // namespace rigwire::drivers
