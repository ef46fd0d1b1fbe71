#include "hil/record/recorded_clients.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "hil/wires/outlets.h"
#include "protocols/can/frame_text.h"
#include "protocols/pcapng/link_packet.h"

namespace rigwire::hil {

namespace pcapng = protocols::pcapng;

namespace {

/// Returns the piece that a line of NAME.ends describes.
WirePiece piece_of(const std::string& act, WireKind kind, const std::string& wire) {
  std::istringstream words(act);
  std::string what;
  words >> what;
  if (what == "frame" && kind == WireKind::can) {
    std::string text;
    words >> text;
    if (const auto frame = protocols::can::parse_frame_text(text)) {
      return *frame;
    }
  }
  std::uint32_t rate = 0;
  if (what == "closed" || (what == "open" && words >> rate)) {
    if (kind == WireKind::serial) {
      return drivers::LineClient{what == "open", rate};
    }
    drivers::CanClient client{.open = what == "open", .bit_rate_bps = rate};
    for (std::string word; words >> word;) {
      client.listen_only = client.listen_only || word == "listen_only";
      client.one_shot = client.one_shot || word == "one_shot";
    }
    return client;
  }
  throw std::invalid_argument(fmt::format(
      "the recording's wires/{}.ends: no act of a client, found \"{}\", allowed open RATE, closed, "
      "frame ID#DATA",
      wire, act));
}

}  // namespace

/// The connections of one wire, by what passed on it: the recorder laid them out
/// (hil/record/recorder.cpp).
class RecordedClients::Connections {
 public:
  Connections(std::vector<Step>& steps, std::size_t wire) : steps_(steps), wire_(wire) {}

  void take(SimTime at, bool inbound, const pcapng::TcpPacket& packet) {
    using What = StreamPiece::What;
    constexpr std::uint16_t kFirstClientPort = 49'152;
    const std::uint16_t port = inbound ? packet.from.port : packet.to.port;
    const std::uint64_t id = port - kFirstClientPort;
    const pcapng::IpEnd device = inbound ? packet.to : packet.from;
    State& state = states_[id];
    if (inbound && packet.opens) {
      state = {};
      add(at, id, device, What::opened, {});
    }
    if (inbound && !packet.bytes.empty()) {
      add(at, id, device, What::bytes, packet.bytes);
    }
    if (packet.ends && inbound) {
      // With the device's end at the same instant, or after it, the connection is over.
      state.last = steps_.size();
      add(at, id, device, state.device_ended ? What::gone : What::ended, {});
      state.client_ended = at;
    } else if (packet.ends) {
      if (state.client_ended == at) {
        std::get<StreamPiece>(steps_[state.last].piece).what = What::gone;
      } else if (state.client_ended != kNever) {
        add(at, id, device, What::gone, {});
      }
      state.device_ended = true;
    }
  }

 private:
  struct State {
    SimTime client_ended = kNever;
    bool device_ended = false;
    std::size_t last = 0;  ///< The step of the client's end.
  };

  void add(SimTime at, std::uint64_t id, const pcapng::IpEnd& device, StreamPiece::What what,
           std::span<const std::uint8_t> bytes) {
    steps_.push_back({at,
                      wire_,
                      StreamPiece{{device.address, device.port}, id, what, {}},
                      {bytes.begin(), bytes.end()}});
  }

  std::vector<Step>& steps_;
  std::size_t wire_;
  std::map<std::uint64_t, State> states_;
};

RecordedClients::RecordedClients(const std::filesystem::path& folder) {
  const RecordingContents contents = read_recording_description(folder);
  std::vector<Connections> connections;
  std::vector<std::size_t> carried(contents.wires.size());
  for (std::size_t i = 0; i < contents.wires.size(); ++i) {
    wires_.push_back(contents.wires[i].about.name);
    connections.emplace_back(steps_, i);
  }
  each_packet(folder, [&](std::size_t wire, SimTime at, const pcapng::Packet& packet) {
    const bool inbound = packet.direction == pcapng::Direction::inbound;
    switch (contents.wires[wire].about.kind) {
      case WireKind::serial:
        if (inbound) {
          const auto bytes = pcapng::serial_bytes(packet.bytes);
          steps_.push_back({at, wire, SerialPiece{}, {bytes.begin(), bytes.end()}});
        }
        break;
      case WireKind::can:
        carried[wire] += inbound ? 1 : 0;
        break;
      case WireKind::ethernet:
        if (const auto segment = pcapng::tcp_packet(packet.bytes); segment.ok()) {
          connections[wire].take(at, inbound, *segment);
        } else if (const auto datagram = pcapng::udp_packet(packet.bytes);
                   datagram.ok() && inbound) {
          steps_.push_back({at,
                            wire,
                            DatagramPiece{{datagram->to.address, datagram->to.port},
                                          {datagram->from.address, datagram->from.port},
                                          {}},
                            {datagram->bytes.begin(), datagram->bytes.end()}});
        }
        break;
    }
  });
  // What a client did with its end comes before its bytes of the same instant.
  std::vector<Step> packets = std::exchange(steps_, {});
  for (std::size_t wire = 0; wire < wires_.size(); ++wire) {
    const RecordedWire& about = contents.wires[wire].about;
    const std::vector<RecordedAct> acts = client_acts(folder, about.name);
    for (const RecordedAct& act : acts) {
      steps_.push_back({act.at, wire, piece_of(act.text, about.kind, about.name), {}});
    }
    if (carried[wire] != 0 && acts.empty()) {
      remarks_.push_back(fmt::format(
          "{}: {} frames of clients cannot be given again: the recording does not say when they "
          "were offered to the bus (it has no wires/{}.ends)",
          about.name, carried[wire], about.name));
    }
  }
  std::ranges::move(packets, std::back_inserter(steps_));
  std::ranges::stable_sort(steps_, {}, &Step::at);
}

void RecordedClients::advance(SimTime now) {
  giving_ = true;
  while (next_ < steps_.size() && steps_[next_].at <= now) {
    give(steps_[next_++]);
  }
  giving_ = false;
}

void RecordedClients::begin_again() {
  next_ = 0;
  outlets_.clear();
}

void RecordedClients::give(const Step& step) {
  WirePiece given = step.piece;
  std::visit(
      [&](auto& piece) {
        if constexpr (requires { piece.bytes; }) {
          piece.bytes = step.bytes;
        }
      },
      given);
  const auto outlets = outlets_.find(wires_[step.wire]);
  if (outlets == outlets_.end()) {
    return;
  }
  for (QueuedOutlet* const outlet : outlets->second) {
    if (outlet->arrive(given)) {
      return;
    }
    auto* const stream = std::get_if<StreamPiece>(&given);
    if (stream != nullptr && stream->what == StreamPiece::What::ended) {
      stream->what = StreamPiece::What::gone;  // a server that knows no half of a connection
      if (outlet->arrive(given)) {
        return;
      }
    }
  }
}

}  // namespace rigwire::hil
