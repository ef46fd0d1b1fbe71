// A node fed with transport, requests and claims in any order, with time going on in between:
// frames leave in order, messages have the length that was announced, every frame is counted once,
// every session ends by itself, and nothing is sent under an address that is not held.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "emulators/j1939/j1939_node.h"
#include "frame_output.h"

namespace emulators = rigwire::emulators;
namespace j1939 = rigwire::protocols::j1939;
using rigwire::SimTime;
using rigwire::protocols::can::Frame;

namespace {

constexpr std::uint32_t kShortGroup = 0xFE10;
constexpr std::uint32_t kLongGroup = 0xFEDA;

using rigwire::fuzz::Output;
using rigwire::fuzz::require;

struct Application final : emulators::J1939Application {
  emulators::J1939Answer answer(SimTime now, std::uint32_t pgn, std::uint8_t destination) override {
    require(node->held());
    static constexpr std::array<std::uint8_t, 300> kBytes{};
    if (pgn != kShortGroup && pgn != kLongGroup) {
      return emulators::J1939Answer::unknown;
    }
    const std::size_t size = pgn == kShortGroup ? 8 : kBytes.size();
    const bool sent = node->send(now, {6, pgn, destination, 0}, std::span(kBytes).first(size));
    return sent ? emulators::J1939Answer::sent : emulators::J1939Answer::busy;
  }
  emulators::J1939Reception take(SimTime, const emulators::J1939Message& message) override {
    require(node->held() && message.payload.size() <= j1939::kGreatestTransported);
    return emulators::J1939Reception::accepted;
  }
  emulators::J1939Node* node = nullptr;
};

/// The groups that a node itself looks at, and one that it does not.
constexpr std::array<std::uint32_t, 7> kGroups{j1939::kTransportManagementPgn,
                                               j1939::kTransportDataPgn,
                                               j1939::kRequestPgn,
                                               j1939::kAddressClaimedPgn,
                                               j1939::kTransportDataPgn,
                                               j1939::kAcknowledgementPgn,
                                               kShortGroup};

}  // namespace

/// Each record is (group, source, destination, length, wait in 4 ms, data).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kRecord = 5 + 8;
  Output output;
  Application application;
  emulators::J1939NodeSettings settings;
  settings.address.preferred = 0x20;
  settings.address.name = 0x1000;
  settings.address.arbitrary_address = size % 2 == 0;
  emulators::J1939Node node(settings, application, output);
  application.node = &node;
  SimTime now = rigwire::kStart;
  node.advance(now);
  std::uint64_t fed = 0;
  for (; size >= kRecord; data += kRecord, size -= kRecord) {
    Frame frame;
    // Destinations: the node, everybody, or somebody.
    const std::uint8_t destination = data[2] < 128   ? node.address()
                                     : data[2] < 224 ? j1939::kGlobalAddress
                                                     : data[2];
    frame.id =
        j1939::pack(j1939::Identifier{6, kGroups[data[0] % kGroups.size()], destination, data[1]});
    frame.extended = true;
    frame.length = data[3] < 200 ? 8 : data[3] % 10;
    if (kGroups[data[0] % kGroups.size()] == j1939::kRequestPgn && data[3] < 200) {
      frame.length = 3;
    }
    std::copy_n(data + 5, frame.data.size(), frame.data.begin());
    now += std::chrono::milliseconds(4 * data[4]);
    node.advance(now);
    node.receive(now, frame);
    ++fed;
    require(node.next_event() > now);
  }
  const auto counters = node.received();
  require(counters.accepted + counters.ignored + counters.malformed == fed);
  // Longest: 43 packets to everybody, 50 ms apart.
  node.advance(now + std::chrono::seconds{10});
  require(node.next_event() == rigwire::kNever);
  return 0;
}
