#include "drivers/serial_splitter.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

#include "memory_byte_stream.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Passes on to a stream that somebody else owns.
class Borrowed final : public ByteStream {
 public:
  explicit Borrowed(ByteStream& stream) : stream_(stream) {}
  void start(Receiver receiver) override { stream_.start(std::move(receiver)); }
  void on_client(ClientWatcher watcher) override { stream_.on_client(std::move(watcher)); }
  std::size_t write(std::span<const std::uint8_t> bytes) override { return stream_.write(bytes); }
  [[nodiscard]] EndpointStatus status() const override { return stream_.status(); }

 private:
  ByteStream& stream_;
};

class SerialSplitterTest : public ::testing::Test {
 protected:
  SerialSplitterTest() {
    std::vector<std::unique_ptr<ByteStream>> ports;
    ports.push_back(std::make_unique<Borrowed>(first_.device()));
    ports.push_back(std::make_unique<Borrowed>(second_.device()));
    splitter_ = std::make_unique<SerialSplitter>(std::move(ports));
    splitter_->on_client([this](const LineClient& client) { client_ = client; });
    splitter_->start([this](std::span<const std::uint8_t> bytes) {
      heard_.insert(heard_.end(), bytes.begin(), bytes.end());
    });
  }
  std::unique_ptr<ByteStream> open(MemorySerialLine& line, Bytes& into) {
    auto client = line.open_client();
    client->start([&into](std::span<const std::uint8_t> bytes) {
      into.insert(into.end(), bytes.begin(), bytes.end());
    });
    context_.poll();
    context_.restart();
    return client;
  }
  void settle() {
    context_.restart();
    context_.poll();
  }

  boost::asio::io_context context_;
  MemorySerialLine first_{context_, "line", 115200};
  MemorySerialLine second_{context_, "line.1", 115200};
  std::unique_ptr<SerialSplitter> splitter_;
  Bytes heard_;
  LineClient client_;
};

TEST_F(SerialSplitterTest, EveryPortHearsTheDevice) {
  Bytes one;
  Bytes two;
  const auto a = open(first_, one);
  const auto b = open(second_, two);
  EXPECT_EQ(splitter_->write(Bytes{1, 2, 3}), 3U);
  settle();
  EXPECT_EQ(one, (Bytes{1, 2, 3}));
  EXPECT_EQ(two, one);
}

TEST_F(SerialSplitterTest, TheDeviceHearsTheFirstPortOnly) {
  Bytes waste;
  const auto a = open(first_, waste);
  const auto b = open(second_, waste);
  b->write(Bytes{9});
  a->write(Bytes{7, 8});
  settle();
  EXPECT_EQ(heard_, (Bytes{7, 8}));
}

TEST_F(SerialSplitterTest, TheFirstPortsClientIsTheLines) {
  Bytes waste;
  const auto b = open(second_, waste);
  second_.set_client_baud(4800);
  settle();
  EXPECT_EQ(client_, LineClient{});
  EXPECT_TRUE(splitter_->status().client_present) << "but somebody is there";
  const auto a = open(first_, waste);
  settle();
  EXPECT_EQ(client_, (LineClient{true, 115200}));
}

TEST_F(SerialSplitterTest, AClientThatDoesNotReadHoldsUpNobodyAndItsLossIsSeen) {
  Bytes one;
  const auto a = open(first_, one);
  const auto silent = second_.open_client();  // takes nothing from its line
  const Bytes block(1000, 5);
  std::size_t least = block.size();
  std::size_t offered = 0;
  for (int i = 0; i < 40; ++i) {
    least = std::min(least, splitter_->write(block));
    offered += block.size();
    settle();
  }
  EXPECT_EQ(one.size(), offered);
  EXPECT_LT(least, block.size());
}

TEST_F(SerialSplitterTest, ItsStatusIsTheFirstPortsAndCountsTheOthers) {
  EXPECT_EQ(splitter_->status().address, first_.device().status().address);
  EXPECT_EQ(splitter_->status().further_ports, 1U);
  EXPECT_FALSE(splitter_->status().client_present);
}

TEST(SerialSplitter, WithoutPortsThereIsNone) {
  EXPECT_THROW(SerialSplitter({}), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::drivers
