// One contract for every serial line: the same tests over a pseudo-terminal and over its in-memory
// twin.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "drivers/memory_byte_stream.h"
#include "drivers/pty.h"
#include "drivers/serial_port.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct PseudoTerminalLine {
  explicit PseudoTerminalLine(boost::asio::io_context& the_context)
      : context(the_context),
        path(std::filesystem::temp_directory_path() /
             ("rigwire-contract-" + std::to_string(::getpid())) / "line"),
        pty(context, path) {}
  ~PseudoTerminalLine() {
    std::error_code ignored;
    std::filesystem::remove(path.parent_path(), ignored);
  }
  ByteStream& device() { return pty; }
  std::unique_ptr<ByteStream> open_client() {
    return std::make_unique<SerialPort>(context,
                                        SerialPortSettings{.path = path.string(), .baud = 115200});
  }
  boost::asio::io_context& context;
  std::filesystem::path path;
  Pty pty;
};

struct MemoryLine {
  explicit MemoryLine(boost::asio::io_context& context) : line(context) {}
  ByteStream& device() { return line.device(); }
  std::unique_ptr<ByteStream> open_client() { return line.open_client(); }
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

}  // namespace
}  // namespace rigwire::drivers
