#include "hil/wires/outlets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
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
  bool deliver(const protocols::can::Frame& frame, Stamp stamp) override {
    events.push_back("frame " + std::to_string(stamp / 1us));
    return send(frame);
  }
  void confirm(bool sent, Stamp stamp) override {
    events.push_back((sent ? "sent " : "unsent ") + std::to_string(stamp / 1us));
  }
  bool report(const protocols::can::ControllerReport& report, Stamp stamp) override {
    events.push_back("report " + std::to_string(stamp / 1us));
    reports.push_back(report);
    return true;
  }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {"bus", true}; }
  std::vector<protocols::can::Frame> frames;
  std::vector<protocols::can::ControllerReport> reports;
  std::vector<std::string> events;
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

class RecordingPort final : public drivers::DatagramPort {
 public:
  struct Sent {
    Peer to;
    Bytes bytes;
    bool whole = false;
    friend bool operator==(const Sent&, const Sent&) = default;
  };
  void start(Receiver) override {}
  bool send(const Peer& to, std::span<const std::uint8_t> datagram, bool whole) override {
    sent.push_back({to, {datagram.begin(), datagram.end()}, whole});
    return sent.size() != 3;
  }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {"port", true}; }
  std::vector<Sent> sent;
};

TEST(AddressedOutlet, EachDatagramGoesWhereItSays) {
  RecordingPort port;
  RecordingPort moved;
  WireStatistics statistics;
  AddressedOutlet outlet(port, statistics, 8, 4096);
  outlet.send(kStart, {0x7F00'0001, 40000}, Bytes{1}, true);
  outlet.send(kStart, {0xFFFF'FFFF, 65535}, Bytes{2, 3}, false);
  outlet.transmit_front(std::nullopt);
  outlet.lead_to(moved);
  outlet.transmit_front(std::nullopt);
  ASSERT_EQ(port.sent.size(), 1U);
  ASSERT_EQ(moved.sent.size(), 1U);
  EXPECT_EQ(port.sent[0], (RecordingPort::Sent{{0x7F00'0001, 40000}, {1}, true}));
  EXPECT_EQ(moved.sent[0], (RecordingPort::Sent{{0xFFFF'FFFF, 65535}, {2, 3}, false}));
}

TEST(AddressedOutlet, WhatIsLateIsCaughtUpWithAtTwiceTheSpeedNotInAHeap) {
  RecordingPort port;
  WireStatistics statistics;
  AddressedOutlet outlet(port, statistics, 16, 4096);
  for (int i = 0; i < 8; ++i) {
    outlet.send(kStart + i * 100us, {0x7F00'0001, 40000}, Bytes{1}, true);
  }
  // The loop was away for 400 us, and is back for good.
  SimTime now = kStart + 400us;
  std::vector<SimTime> left;
  while (outlet.next_due() != kNever) {
    now = std::max(now, outlet.next_due());
    outlet.transmit_front(now - outlet.next_due());
    left.push_back(now);
  }
  ASSERT_EQ(left.size(), 8U);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(left[static_cast<std::size_t>(i)], kStart + 400us + i * 50us) << i;
  }
  EXPECT_EQ(statistics.lateness.max(), 400us);
  EXPECT_EQ(statistics.dropped, 1U);
  // Free-running nothing is late.
  for (int i = 0; i < 3; ++i) {
    outlet.send(kStart + 2ms + i * 1us, {0x7F00'0001, 40000}, Bytes{1}, true);
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(outlet.next_due(), kStart + 2ms + i * 1us);
    outlet.transmit_front(std::nullopt);
  }
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

TEST(FrameOutlet, NewsOfTheControllerKeepTheirPlaceAmongTheFrames) {
  RecordingBus bus;
  WireStatistics statistics;
  FrameOutlet outlet(bus);
  protocols::can::ControllerReport passive;
  passive.state = protocols::can::ErrorState::passive;
  passive.transmit_errors = 128;
  passive.bit = 77;
  outlet.send(kStart + 1ms, statistics, {0x100, false, false, 0, {}});
  outlet.confirm(kStart + 2ms, true);
  outlet.report(kStart + 2ms, passive);
  outlet.confirm(kStart + 3ms, false);
  outlet.send(kStart + 4ms, statistics, {0x101, false, false, 0, {}});
  while (outlet.next_due() != kNever) {
    outlet.transmit_front(25us);
  }
  EXPECT_EQ(bus.events, (std::vector<std::string>{"frame 1000", "sent 2000", "report 2000",
                                                  "unsent 3000", "frame 4000"}));
  EXPECT_EQ(bus.reports, std::vector{passive});
  EXPECT_EQ(statistics.units, 2U) << "devices are charged with their frames only";
  EXPECT_EQ(outlet.controller_statistics().units, 3U);
}

TEST(FrameOutlet, ConfirmationsFindRoomWhenFramesAndReportsFillTheirs) {
  RecordingBus bus;
  WireStatistics statistics;
  FrameOutlet outlet(bus, 10);
  for (int i = 0; i < 5000; ++i) {
    outlet.send(kStart, statistics, {0x1FFFFFFF, true, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}});
    outlet.report(kStart, {});
  }
  for (int i = 0; i < 10; ++i) {
    outlet.confirm(kStart, true);
  }
  EXPECT_GT(statistics.dropped, 0U);
  EXPECT_GT(outlet.controller_statistics().dropped, 0U);
  while (outlet.next_due() != kNever) {
    outlet.transmit_front({});
  }
  EXPECT_EQ(std::count(bus.events.begin(), bus.events.end(), "sent 0"), 10);
  EXPECT_EQ(statistics.units + statistics.dropped, 5000U);
}

/// What was told, a line each.
class Listener final : public WireTap {
 public:
  void sent(SimTime at, const WirePiece& piece) override { add("sent", at, piece); }
  void carried(SimTime at, const WirePiece& piece) override { add("carried", at, piece); }
  void received(const WirePiece& piece) override { add("received", kStart, piece); }
  void lost(SimTime at) override { told.push_back("lost " + std::to_string((at - kStart) / 1us)); }
  std::vector<std::string> told;

 private:
  void add(const std::string& how, SimTime at, const WirePiece& piece) {
    std::string text = how + " " + std::to_string((at - kStart) / 1us);
    if (const auto* serial = std::get_if<SerialPiece>(&piece)) {
      text += " " + std::to_string(serial->bytes.size()) + " bytes";
    } else if (const auto* datagram = std::get_if<DatagramPiece>(&piece)) {
      text +=
          " " + std::to_string(datagram->device.port) + " " + std::to_string(datagram->client.port);
    } else if (const auto* stream = std::get_if<StreamPiece>(&piece)) {
      text += " " + std::to_string(stream->connection) + " " +
              std::to_string(static_cast<int>(stream->what)) + " " +
              std::to_string(stream->bytes.size());
    } else if (const auto* frame = std::get_if<protocols::can::Frame>(&piece)) {
      text += " id " + std::to_string(frame->id);
    } else {
      text += " error";
    }
    told.push_back(text);
  }
};

TEST(WireTap, WhatTheLineTookIsSentAndWhatItDidNotIsLost) {
  class Line final : public drivers::ByteStream {
   public:
    void start(Receiver given) override { receiver = std::move(given); }
    std::size_t write(std::span<const std::uint8_t> bytes) override {
      return full ? 0 : bytes.size();
    }
    [[nodiscard]] drivers::EndpointStatus status() const override { return {"line", true}; }
    Receiver receiver;
    bool full = false;
  } line;
  WireStatistics statistics;
  StreamOutlet outlet(line, statistics);
  Listener listener;
  outlet.tell(listener);
  std::size_t heard = 0;
  outlet.start([&](std::span<const std::uint8_t> bytes) { heard += bytes.size(); });
  outlet.send(kStart + 1ms, Bytes(3));
  outlet.transmit_front(std::nullopt);
  line.receiver(Bytes(5));
  line.full = true;
  outlet.send(kStart + 2ms, Bytes(3));
  outlet.transmit_front(std::nullopt);
  outlet.send(kStart + 3ms, Bytes(1'000'000));  // more than the queue holds
  EXPECT_EQ(heard, 5U);
  EXPECT_EQ(statistics.dropped, 2U);
  EXPECT_EQ(listener.told, (std::vector<std::string>{"sent 1000 3 bytes", "received 0 5 bytes",
                                                     "lost 2000", "lost 3000"}));
}

TEST(WireTap, AClientsFramesAreToldWhenTheyComeAndWhenTheBusHasCarriedThem) {
  class Bus final : public drivers::CanBus {
   public:
    void start(Receiver given) override { receiver = std::move(given); }
    bool send(const protocols::can::Frame&) override { return true; }
    [[nodiscard]] drivers::EndpointStatus status() const override { return {"bus", true}; }
    Receiver receiver;
  } bus;
  FrameOutlet outlet(bus);
  Listener listener;
  outlet.tell(listener);
  outlet.start([](const protocols::can::Frame&) {});
  WireStatistics device;
  for (const std::uint32_t id : {1U, 2U, 3U}) {
    bus.receiver({.id = id});
  }
  outlet.confirm(kStart + 1ms, true);
  outlet.send(kStart + 2ms, device, {.id = 100});
  outlet.confirm(kStart + 3ms, false);  // the second lost every try
  outlet.report(kStart + 3ms, {});
  outlet.confirm(kStart + 4ms, true);
  while (outlet.next_due() != kNever) {
    outlet.transmit_front(std::nullopt);
  }
  EXPECT_EQ(listener.told,
            (std::vector<std::string>{"received 0 id 1", "received 0 id 2", "received 0 id 3",
                                      "carried 1000 id 1", "sent 2000 id 100", "sent 3000 error",
                                      "carried 4000 id 3"}));
}

TEST(WireTap, AConnectionIsToldFromItsBeginningToItsEnd) {
  class Server final : public drivers::StreamServer {
   public:
    void start(Handler given) override { handler = std::move(given); }
    bool send(ConnectionId, std::span<const std::uint8_t>) override { return true; }
    void close(ConnectionId) override {}
    [[nodiscard]] drivers::EndpointStatus status() const override { return {"server", true}; }
    Handler handler;
  } server;
  WireStatistics statistics;
  ServerOutlet outlet(server, statistics);
  Listener listener;
  outlet.tell(listener);
  std::vector<std::string> device;
  outlet.start({.connected = [&](auto) { device.push_back("connected"); },
                .received = [&](auto, auto) { device.push_back("received"); },
                .disconnected = [&](auto) { device.push_back("disconnected"); }});
  EXPECT_FALSE(server.handler.half_closed) << "who gave none is asked for none";
  server.handler.connected(7);
  server.handler.received(7, Bytes(12));
  outlet.send(7, kStart + 1ms, Bytes(9));
  outlet.transmit_front(std::nullopt);
  outlet.close(7, kStart + 2ms);
  outlet.transmit_front(std::nullopt);
  server.handler.disconnected(7);
  EXPECT_EQ(device, (std::vector<std::string>{"connected", "received", "disconnected"}));
  EXPECT_EQ(listener.told,
            (std::vector<std::string>{"received 0 7 0 0", "received 0 7 1 12", "sent 1000 7 1 9",
                                      "sent 2000 7 2 0", "received 0 7 3 0"}));
}

TEST(WireTap, APortOfTheSystemsChoiceIsToldAsTheDestinations) {
  class Socket final : public drivers::DatagramSocket {
   public:
    void start(Receiver) override {}
    bool send(std::span<const std::uint8_t>) override { return true; }
    [[nodiscard]] Ends ends() const override {
      return {{0x7F000001, own_port}, {0x7F000001, 2368}};
    }
    [[nodiscard]] drivers::EndpointStatus status() const override { return {"udp", true}; }
    std::uint16_t own_port = 0;
  } socket;
  WireStatistics statistics;
  DatagramOutlet outlet(socket, statistics);
  Listener listener;
  outlet.tell(listener);
  outlet.send(kStart + 1ms, Bytes(4));
  outlet.transmit_front(std::nullopt);
  socket.own_port = 443;
  outlet.send(kStart + 2ms, Bytes(4));
  outlet.transmit_front(std::nullopt);
  EXPECT_EQ(listener.told, (std::vector<std::string>{"sent 1000 2368 2368", "sent 2000 443 2368"}));
}

}  // namespace
}  // namespace rigwire::hil
