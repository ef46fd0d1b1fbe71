#include "hil/outlet.h"

#include <gtest/gtest.h>

#include <vector>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

class HalfDeafLine final : public drivers::ByteStream {
 public:
  void start(Receiver) override {}
  std::size_t write(std::span<const std::uint8_t> bytes) override { return bytes.size() / 2; }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {"line", true}; }
};

class RecordingBus final : public drivers::CanBus {
 public:
  void start(Receiver) override {}
  bool send(const protocols::can::Frame& frame) override {
    frames.push_back(frame);
    return true;
  }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {"bus", true}; }
  std::vector<protocols::can::Frame> frames;
};

class RecordingServer final : public drivers::StreamServer {
 public:
  void start(Handler) override {}
  bool send(ConnectionId connection, std::span<const std::uint8_t> bytes) override {
    sent.emplace_back(connection, Bytes(bytes.begin(), bytes.end()));
    return true;
  }
  void close(ConnectionId connection) override { closed.push_back(connection); }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {"server", true}; }
  std::vector<std::pair<ConnectionId, Bytes>> sent;
  std::vector<ConnectionId> closed;
};

TEST(StreamOutlet, AUnitThatTheLineTakesInPartIsLostAndCounted) {
  HalfDeafLine line;
  WireStatistics statistics;
  StreamOutlet outlet(line, statistics);
  outlet.send(kStart + 1ms, Bytes{1, 2, 3, 4});
  EXPECT_EQ(outlet.next_due(), kStart + 1ms);
  outlet.transmit_front(25us);
  EXPECT_EQ(statistics.dropped, 1U);
  EXPECT_EQ(statistics.units, 0U);
  EXPECT_EQ(statistics.lateness.max(), 25us);
  EXPECT_EQ(outlet.next_due(), kNever);
}

TEST(FrameOutlet, EveryShapeOfFrameArrivesAsItWasSent) {
  RecordingBus bus;
  WireStatistics first;
  WireStatistics second;
  FrameOutlet outlet(bus);
  const std::vector<protocols::can::Frame> frames{
      {0x0CF02980, true, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}},
      {0x123, false, false, 0, {}},
      {0x7FF, false, true, 3, {}},
  };
  outlet.send(kStart, first, frames[0]);
  outlet.send(kStart, second, frames[1]);
  outlet.send(kStart, second, frames[2]);
  while (outlet.next_due() != kNever) {
    outlet.transmit_front(std::nullopt);
  }
  EXPECT_EQ(bus.frames, frames);
  EXPECT_EQ(first.units, 1U);
  EXPECT_EQ(second.units, 2U);
  EXPECT_EQ(first.bytes, 14U);
}

TEST(ServerOutlet, ClosesAfterWhatWasSentBefore) {
  RecordingServer server;
  WireStatistics statistics;
  ServerOutlet outlet(server, statistics);
  outlet.send(7, kStart, Bytes{9});
  outlet.close(7, kStart);
  outlet.transmit_front(std::nullopt);
  EXPECT_TRUE(server.closed.empty());
  outlet.transmit_front(std::nullopt);
  EXPECT_EQ(server.sent.size(), 1U);
  EXPECT_EQ(server.closed, std::vector<drivers::StreamServer::ConnectionId>{7});
}

}  // namespace
}  // namespace rigwire::hil
