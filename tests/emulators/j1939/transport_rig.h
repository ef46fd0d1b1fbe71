// Sessions of the transport protocol against a peer that is written out frame by frame.
#pragma once

#include "emulators/j1939/j1939_transport.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <utility>
#include <vector>

#include "protocols/j1939/message.h"

namespace rigwire::emulators {
using namespace std::chrono_literals;
using protocols::can::Frame;
using testing::ElementsAre;
using testing::IsEmpty;
namespace j1939 = protocols::j1939;
using j1939::AbortReason;
using j1939::TransportControl;
using j1939::TransportManagement;

constexpr std::uint8_t kOwn = 0x27;
constexpr std::uint8_t kPeer = 0x80;
constexpr std::uint8_t kOther = 0x81;
constexpr std::uint32_t kGroup = 0xFECA;

using Bytes = std::vector<std::uint8_t>;

inline Bytes message(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

struct J1939TransportTest : testing::Test, J1939TransportSink, FrameOutput {
  void transported(SimTime, const J1939Message& received) override {
    messages.emplace_back(received.identifier,
                          Bytes(received.payload.begin(), received.payload.end()));
  }
  void send(SimTime due, const Frame& frame) override {
    EXPECT_GE(due, last);
    last = due;
    frames.emplace_back(due, frame);
  }

  J1939Reception give(const Frame& frame) {
    return transport.receive(now, *j1939::identify(frame), frame.payload(), kOwn);
  }
  J1939Reception manage(TransportManagement management, std::uint8_t from = kPeer,
                        std::uint8_t to = kOwn) {
    management.pgn = management.pgn == 0 ? kGroup : management.pgn;
    return give(j1939::make_transport_management(from, to, management));
  }
  J1939Reception request(std::size_t size, std::uint8_t from = kPeer, std::uint32_t pgn = kGroup,
                         std::uint8_t limit = 0xFF) {
    TransportManagement m;
    m.control = TransportControl::request_to_send;
    m.size = static_cast<std::uint16_t>(size);
    m.packets = j1939::packets_of(size);
    m.limit = limit;
    m.pgn = pgn;
    return manage(m, from);
  }
  J1939Reception announce(std::size_t size, std::uint8_t from = kPeer) {
    TransportManagement m;
    m.control = TransportControl::broadcast;
    m.size = static_cast<std::uint16_t>(size);
    m.packets = j1939::packets_of(size);
    return manage(m, from, j1939::kGlobalAddress);
  }
  J1939Reception clear(std::uint8_t packets, std::uint8_t next, std::uint8_t from = kPeer) {
    TransportManagement m;
    m.control = TransportControl::clear_to_send;
    m.packets = packets;
    m.next = next;
    return manage(m, from);
  }
  J1939Reception data(std::size_t size, std::uint8_t number, std::uint8_t from = kPeer,
                      std::uint8_t to = kOwn) {
    return give(j1939::make_transport_data(from, to, message(size), number));
  }
  void run(Duration span) {
    now += span;
    transport.advance(now);
  }
  /// The frames since the last call, as the management or data they are.
  [[nodiscard]] std::vector<TransportManagement> management() {
    std::vector<TransportManagement> found;
    for (const auto& [due, frame] : std::exchange(frames, {})) {
      if (j1939::identify(frame)->pgn == j1939::kTransportManagementPgn) {
        found.push_back(*j1939::decode_transport_management(frame.payload()));
      }
    }
    return found;
  }
  [[nodiscard]] Bytes numbers() {
    Bytes found;
    for (const auto& [due, frame] : std::exchange(frames, {})) {
      if (j1939::identify(frame)->pgn == j1939::kTransportDataPgn) {
        found.push_back(frame.data[0]);
      }
    }
    return found;
  }
  void expect_abort(AbortReason reason) {
    const auto found = management();
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].control, TransportControl::abort);
    EXPECT_EQ(found[0].reason, reason);
    EXPECT_EQ(found[0].pgn, kGroup);
  }
  bool send_to(std::uint8_t destination, std::size_t size) {
    return transport.send(now, {6, kGroup, destination, kOwn}, message(size));
  }

  SimTime now = kStart;
  SimTime last = kStart;
  std::vector<std::pair<SimTime, Frame>> frames;
  std::vector<std::pair<j1939::Identifier, Bytes>> messages;
  J1939Transport transport{J1939TransportSettings{}, *this, *this};
};

}  // namespace rigwire::emulators
