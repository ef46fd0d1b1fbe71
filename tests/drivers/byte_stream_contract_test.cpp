// One contract for every serial line: the same tests over a pseudo-terminal and over its in-memory
// twin.
#include <asm/termbits.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "drivers/pty.h"
#include "drivers/serial_port.h"
#include "memory_byte_stream.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kDeviceBaud = 57600;

struct PseudoTerminalLine {
  explicit PseudoTerminalLine(boost::asio::io_context& the_context)
      : context(the_context),
        path(std::filesystem::temp_directory_path() /
             ("rigwire-contract-" + std::to_string(::getpid())) / "line"),
        pty(context, path, kDeviceBaud) {}
  ~PseudoTerminalLine() {
    std::error_code ignored;
    std::filesystem::remove(path.parent_path(), ignored);
  }
  ByteStream& device() { return pty; }
  std::unique_ptr<ByteStream> open_client() {
    return std::make_unique<SerialPort>(context,
                                        SerialPortSettings{.path = path.string(), .baud = 115200});
  }
  /// Opens the line as cat does, without setting anything; closed by the deleter.
  std::shared_ptr<void> open_plain() {
    const int slave = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    return {nullptr, [slave](void*) { ::close(slave); }};
  }
  void set_client_baud(std::uint32_t baud) {
    const int slave = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    termios2 settings{};
    ::ioctl(slave, TCGETS2, &settings);
    settings.c_cflag = (settings.c_cflag & ~static_cast<tcflag_t>(CBAUD)) | BOTHER;
    settings.c_ospeed = settings.c_ispeed = baud;
    ::ioctl(slave, TCSETS2, &settings);
    ::close(slave);
  }
  boost::asio::io_context& context;
  std::filesystem::path path;
  Pty pty;
};

struct MemoryLine {
  explicit MemoryLine(boost::asio::io_context& context) : line(context, "memory", kDeviceBaud) {}
  ByteStream& device() { return line.device(); }
  std::unique_ptr<ByteStream> open_client() {
    auto client = line.open_client();
    line.set_client_baud(115200);
    return client;
  }
  std::shared_ptr<void> open_plain() { return std::shared_ptr<ByteStream>(line.open_client()); }
  void set_client_baud(std::uint32_t baud) { line.set_client_baud(baud); }
  MemorySerialLine line;
};

ByteStream::Receiver into(Bytes& sink) {
  return [&sink](std::span<const std::uint8_t> bytes) {
    sink.insert(sink.end(), bytes.begin(), bytes.end());
  };
}

template <class Line>
class ByteStreamContract : public ::testing::Test {
 protected:
  boost::asio::io_context context;
  Line line{context};
  Bytes at_device;
  Bytes at_client;

  std::unique_ptr<ByteStream> connect() {
    auto client = line.open_client();
    client->start(into(at_client));
    EXPECT_TRUE(run_until(context, [&] { return line.device().status().client_present; }));
    return client;
  }
  void expect_client_gets(const Bytes& expected) {
    EXPECT_TRUE(run_until(context, [&] { return at_client.size() >= expected.size(); }));
    EXPECT_EQ(at_client, expected);
  }
  void expect_gone() {
    EXPECT_TRUE(run_until(context, [&] { return !line.device().status().client_present; }));
  }
};

using Lines = ::testing::Types<PseudoTerminalLine, MemoryLine>;
TYPED_TEST_SUITE(ByteStreamContract, Lines);

TYPED_TEST(ByteStreamContract, EveryByteValuePassesBothWaysUnchanged) {
  this->line.device().start(into(this->at_device));
  const auto client = this->connect();
  Bytes all(256);
  std::iota(all.begin(), all.end(), std::uint8_t{0});
  EXPECT_EQ(this->line.device().write(all), all.size());
  EXPECT_EQ(client->write(all), all.size());
  this->expect_client_gets(all);
  EXPECT_TRUE(run_until(this->context, [&] { return this->at_device.size() >= all.size(); }));
  EXPECT_EQ(this->at_device, all);
}

TYPED_TEST(ByteStreamContract, DeviceDoesNotHearItsOwnBytes) {
  this->line.device().start(into(this->at_device));
  const auto client = this->connect();
  const Bytes sentence{'$', 'G', 'P', '\r', '\n'};
  EXPECT_EQ(this->line.device().write(sentence), sentence.size());
  this->expect_client_gets(sentence);
  run_for(this->context, std::chrono::milliseconds(30));
  EXPECT_TRUE(this->at_device.empty());
}

TYPED_TEST(ByteStreamContract, WithoutAClientBytesAreTakenAndForgotten) {
  this->line.device().start(into(this->at_device));
  EXPECT_FALSE(this->line.device().status().client_present);
  const Bytes stale(1000, 0x55);
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(this->line.device().write(stale), stale.size());
  }
  const auto client = this->connect();
  const Bytes fresh{1, 2, 3};
  this->line.device().write(fresh);
  this->expect_client_gets(fresh);
}

TYPED_TEST(ByteStreamContract, NextClientGetsNothingOfWhatTheLastOneLeftUnread) {
  this->line.device().start(into(this->at_device));
  {
    const auto lazy = this->line.open_client();  // opened, never read
    ASSERT_TRUE(
        run_until(this->context, [&] { return this->line.device().status().client_present; }));
    this->line.device().write(Bytes(5000, 0xAA));
  }
  this->expect_gone();
  this->line.device().write(Bytes(100, 0xBB));
  const auto client = this->connect();
  const Bytes fresh{9, 8, 7};
  this->line.device().write(fresh);
  this->expect_client_gets(fresh);
}

TYPED_TEST(ByteStreamContract, ClientOpensClosesAndReopensManyTimes) {
  this->line.device().start(into(this->at_device));
  for (std::uint8_t round = 0; round < 10; ++round) {
    this->at_client.clear();
    this->at_device.clear();
    auto client = this->connect();
    this->line.device().write(Bytes{round});
    this->expect_client_gets(Bytes{round});
    client->write(Bytes{round, round});
    ASSERT_TRUE(run_until(this->context, [&] { return this->at_device.size() == 2; }));
    client.reset();
    this->expect_gone();
  }
}

TYPED_TEST(ByteStreamContract, ClientThatDoesNotReadMakesWritesFallShortAndNeverBlocks) {
  this->line.device().start(into(this->at_device));
  const auto lazy = this->line.open_client();
  ASSERT_TRUE(
      run_until(this->context, [&] { return this->line.device().status().client_present; }));
  const Bytes chunk(1024, 0x11);
  std::size_t taken = 0;
  std::size_t offered = 0;
  for (int i = 0; i < 256; ++i) {
    taken += this->line.device().write(chunk);
    offered += chunk.size();
  }
  EXPECT_GE(taken, 4096U);
  EXPECT_LT(taken, offered);
}

TYPED_TEST(ByteStreamContract, TwoReadersTogetherGetEveryByteOnce) {
  this->line.device().start(into(this->at_device));
  const auto first = this->connect();
  Bytes at_second;
  const auto second = this->line.open_client();
  second->start(into(at_second));
  Bytes sent;
  for (int i = 0; i < 50; ++i) {
    const Bytes part(20, static_cast<std::uint8_t>(i));
    sent.insert(sent.end(), part.begin(), part.end());
    ASSERT_EQ(this->line.device().write(part), part.size());
    run_for(this->context, std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(run_until(this->context,
                        [&] { return this->at_client.size() + at_second.size() >= sent.size(); }));
  Bytes together = this->at_client;
  together.insert(together.end(), at_second.begin(), at_second.end());
  EXPECT_THAT(together, ::testing::UnorderedElementsAreArray(sent));
}

TYPED_TEST(ByteStreamContract, WhatAClientWroteBeforeItLeftStillArrives) {
  this->line.device().start(into(this->at_device));
  auto client = this->connect();
  client->write(Bytes{0xB5, 0x62, 0x06});
  client.reset();
  EXPECT_TRUE(run_until(this->context, [&] { return this->at_device.size() == 3; }));
  EXPECT_EQ(this->at_device, (Bytes{0xB5, 0x62, 0x06}));
}

TYPED_TEST(ByteStreamContract, BytesThatCameBeforeStartAreDeliveredAfterIt) {
  const auto client = this->line.open_client();
  client->write(Bytes{1, 2});
  this->line.device().start(into(this->at_device));
  EXPECT_TRUE(run_until(this->context, [&] { return this->at_device.size() == 2; }));
}

TYPED_TEST(ByteStreamContract, ReceiverMayWriteBack) {
  this->line.device().start(
      [this](std::span<const std::uint8_t> bytes) { this->line.device().write(bytes); });
  const auto client = this->connect();
  client->write(Bytes{4, 5, 6});
  this->expect_client_gets(Bytes{4, 5, 6});
}

template <class Line>
class ClientWatchContract : public ByteStreamContract<Line> {
 protected:
  void watch() {
    this->line.device().on_client([this](const LineClient& client) { news.push_back(client); });
    this->line.device().start(into(this->at_device));
  }
  void expect_last(const LineClient& expected) {
    EXPECT_TRUE(run_until(this->context, [&] { return !news.empty() && news.back() == expected; }))
        << "told " << news.size() << " times";
  }
  std::vector<LineClient> news;
};
TYPED_TEST_SUITE(ClientWatchContract, Lines);

TYPED_TEST(ClientWatchContract, ClientThatSetsNoSpeedHasTheDevices) {
  this->watch();
  const auto client = this->line.open_plain();
  this->expect_last({true, kDeviceBaud});
}

TYPED_TEST(ClientWatchContract, NothingIsToldWithoutAClient) {
  this->watch();
  run_for(this->context, std::chrono::milliseconds(40));
  EXPECT_TRUE(this->news.empty());
}

TYPED_TEST(ClientWatchContract, ArrivalSpeedAndDepartureAreTold) {
  this->watch();
  auto client = this->line.open_client();
  this->expect_last({true, 115200});
  this->line.set_client_baud(250000);  // none of POSIX's
  this->expect_last({true, 250000});
  client.reset();
  this->expect_last({false, 0});
}

TYPED_TEST(ClientWatchContract, SpeedStaysForTheNextClient) {
  this->watch();
  auto client = this->line.open_plain();
  this->line.set_client_baud(4800);
  this->expect_last({true, 4800});
  client.reset();
  this->expect_last({false, 0});
  client = this->line.open_plain();
  this->expect_last({true, 4800});
}

TYPED_TEST(ClientWatchContract, DepartureIsToldOnlyWhenTheLastClientLeaves) {
  this->watch();
  auto first = this->line.open_client();
  const auto second = this->line.open_plain();
  this->expect_last({true, 115200});
  first.reset();
  run_for(this->context, std::chrono::milliseconds(40));
  this->expect_last({true, 115200});
}

TYPED_TEST(ClientWatchContract, BytesComeAfterTheSpeedThatTheyWereSentAt) {
  LineClient at_arrival;
  std::size_t received = 0;
  this->line.device().on_client([this](const LineClient& client) { this->news.push_back(client); });
  this->line.device().start([&](std::span<const std::uint8_t> bytes) {
    received += bytes.size();
    at_arrival = this->news.empty() ? LineClient{} : this->news.back();
  });
  {
    const auto client = this->line.open_client();
    client->write(Bytes{1, 2, 3});
  }  // gone before the device had a look
  EXPECT_TRUE(run_until(this->context, [&] { return received == 3; }));
  EXPECT_EQ(at_arrival, (LineClient{true, 115200}));
  this->expect_last({false, 0});
}

TYPED_TEST(ClientWatchContract, LineWorksAgainWhenALazyClientReads) {
  this->watch();
  const auto client = this->line.open_client();
  this->expect_last({true, 115200});
  while (this->line.device().write(Bytes(1024, 0x11)) == 1024U) {
  }
  client->start(into(this->at_client));
  EXPECT_TRUE(run_until(this->context, [&] { return this->at_client.size() >= 4096U; }));
  run_for(this->context, std::chrono::milliseconds(40));
  this->at_client.clear();
  const Bytes fresh{7, 7, 7};
  EXPECT_EQ(this->line.device().write(fresh), fresh.size());
  this->expect_client_gets(fresh);
}

}  // namespace
}  // namespace rigwire::drivers
