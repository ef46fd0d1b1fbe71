#include "hil/wires/outlets.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>
#include <utility>

#include "drivers/untaken.h"
#include "protocols/bytes.h"

namespace rigwire::hil {

using protocols::can::ControllerReport;

namespace {

// Room for more than one configured lead of the busiest rig, so that only a stalled wire fills a
// queue.
constexpr std::size_t kSerialUnits = 16'384;
constexpr std::size_t kSerialBytes = 128 * 1024;
constexpr std::size_t kDatagramUnits = 128;
constexpr std::size_t kDatagramBytes = kDatagramUnits * 1472;
constexpr std::size_t kServerUnits = 1024;
constexpr std::size_t kServerBytes = kServerUnits * 260;
constexpr std::size_t kFrameHeader = 4 /* identifier */ + 1 /* flags */ + 1 /* length */;
constexpr std::size_t kFrameUnits = 1024;
constexpr std::size_t kReportUnits = 256;

/// Where a unit of an AddressedOutlet goes.
drivers::IpEnd end_of(std::uint64_t tag) {
  return {static_cast<std::uint32_t>(tag >> 32U), static_cast<std::uint16_t>(tag >> 16U)};
}

/// What a unit of a FrameOutlet is.
enum FrameOutletTag : std::uint64_t { kFrameUnit, kSentUnit, kUnsentUnit, kReportUnit };

protocols::can::Frame frame_of(std::span<const std::uint8_t> unit) {
  protocols::can::Frame frame;
  frame.id = protocols::load_big<std::uint32_t>(unit, 0);
  frame.extended = (unit[4] & 1U) != 0;
  frame.remote = (unit[4] & 2U) != 0;
  frame.length = unit[5];
  std::copy(unit.begin() + kFrameHeader, unit.end(), frame.data.begin());
  return frame;
}

/// Returns the bytes that a terminal's client has not read yet. The terminal's address is a path;
/// an adapter's has the path behind its protocol.
std::optional<std::size_t> untaken_at(const drivers::EndpointStatus& endpoint) {
  const std::size_t path = endpoint.address.find('/');
  if (!endpoint.client_present || path == std::string::npos) {
    return std::nullopt;
  }
  return drivers::untaken_bytes(endpoint.address.substr(path));
}

ControllerReport report_of(std::span<const std::uint8_t> unit) {
  ControllerReport report;
  std::memcpy(&report, unit.data(), sizeof report);
  return report;
}

}  // namespace

SimTime QueuedOutlet::next_due() const {
  const SimTime due = queue_.next_due();
  return apart_ && due != kNever ? std::max(due, last_left_ + (due - last_due_) / 2) : due;
}

void QueuedOutlet::transmit_front(std::optional<Duration> lateness) {
  const EmissionQueue::Unit unit = queue_.front();
  WireStatistics& statistics = *unit.statistics;
  statistics.hash.add(unit.due, unit.bytes);
  const bool taken = transmit(unit.tag, unit.bytes);
  ++left_;
  if (taken) {
    ++statistics.units;
    statistics.bytes += unit.bytes.size();
  } else {
    ++statistics.dropped;
  }
  if (tap_ != nullptr) {
    if (taken) {
      tell_of(*tap_, unit.due, unit.tag, unit.bytes);
    } else {
      tap_->lost(unit.due);
    }
  }
  Duration late{0};
  if (lateness) {
    // What was held back counts as late as well.
    late = *lateness + (next_due() - unit.due);
    statistics.lateness.record(late);
  }
  last_due_ = unit.due;
  last_left_ = unit.due + std::max(late, Duration{0});
  queue_.pop();
}

bool QueuedOutlet::arrive(const WirePiece& piece) {
  const bool given = give(piece);
  if (given && tap_ != nullptr) {
    tap_->received(piece);
  }
  return given;
}

bool QueuedOutlet::push(SimTime due, std::uint64_t tag, WireStatistics& statistics,
                        std::span<const std::uint8_t> bytes) {
  const bool fits = queue_.push(due, tag, statistics, bytes);
  if (!fits && tap_ != nullptr) {
    tap_->lost(due);
  }
  return fits;
}

StreamOutlet::StreamOutlet(drivers::ByteStream& stream, WireStatistics& statistics)
    : QueuedOutlet(kSerialUnits, kSerialBytes), stream_(stream), statistics_(statistics) {}

void StreamOutlet::send(SimTime due, std::span<const std::uint8_t> bytes) {
  push(due, 0, statistics_, bytes);
}

bool StreamOutlet::transmit(std::uint64_t /*tag*/, std::span<const std::uint8_t> bytes) {
  return is_cut_off() || stream_.write(bytes) == bytes.size();
}

void StreamOutlet::tell_of(WireTap& tap, SimTime due, std::uint64_t /*tag*/,
                           std::span<const std::uint8_t> bytes) {
  tap.sent(due, SerialPiece{bytes});
}

void StreamOutlet::on_client(drivers::ByteStream::ClientWatcher watcher) {
  watcher_ = std::move(watcher);
  stream_.on_client([this](const drivers::LineClient& client) {
    if (!is_cut_off()) {
      arrive(client);
    }
  });
}

void StreamOutlet::start(drivers::ByteStream::Receiver receiver) {
  receiver_ = std::move(receiver);
  stream_.start([this](std::span<const std::uint8_t> bytes) {
    if (!is_cut_off()) {
      arrive(SerialPiece{bytes});
    }
  });
}

std::optional<std::size_t> StreamOutlet::untaken() const {
  return untaken_at(stream_.status());
}

bool StreamOutlet::give(const WirePiece& piece) {
  if (const auto* bytes = std::get_if<SerialPiece>(&piece); bytes != nullptr && receiver_) {
    receiver_(bytes->bytes);
  } else if (const auto* client = std::get_if<drivers::LineClient>(&piece);
             client != nullptr && watcher_) {
    watcher_(*client);
  } else {
    return false;
  }
  return true;
}

DatagramOutlet::DatagramOutlet(drivers::DatagramSocket& socket, WireStatistics& statistics)
    : QueuedOutlet(kDatagramUnits, kDatagramBytes), socket_(socket), statistics_(statistics) {}

void DatagramOutlet::send(SimTime due, std::span<const std::uint8_t> bytes) {
  push(due, 0, statistics_, bytes);
}

bool DatagramOutlet::transmit(std::uint64_t /*tag*/, std::span<const std::uint8_t> bytes) {
  return is_cut_off() || socket_.send(bytes);
}

void DatagramOutlet::tell_of(WireTap& tap, SimTime due, std::uint64_t /*tag*/,
                             std::span<const std::uint8_t> bytes) {
  drivers::DatagramSocket::Ends ends = socket_.ends();
  if (ends.own.port == 0) {
    ends.own.port = ends.destination.port;
  }
  tap.sent(due, DatagramPiece{ends.own, ends.destination, bytes});
}

std::optional<std::size_t> DatagramOutlet::untaken() const {
  return drivers::untaken_datagrams(socket_.ends().destination);
}

AddressedOutlet::AddressedOutlet(drivers::DatagramPort& port, WireStatistics& statistics,
                                 std::size_t units, std::size_t bytes)
    : QueuedOutlet(units, bytes), port_(&port), statistics_(statistics) {
  keep_apart();
}

void AddressedOutlet::start(drivers::DatagramPort::Receiver receiver) {
  receiver_ = std::move(receiver);
  port_->start([this, own = port_->end()](const drivers::DatagramPort::Peer& from,
                                          std::span<const std::uint8_t> bytes) {
    if (!is_cut_off()) {
      arrive(DatagramPiece{own, from, bytes});
    }
  });
}

bool AddressedOutlet::give(const WirePiece& piece) {
  const auto* datagram = std::get_if<DatagramPiece>(&piece);
  if (datagram == nullptr || !receiver_) {
    return false;
  }
  receiver_(datagram->client, datagram->bytes);
  return true;
}

void AddressedOutlet::send(SimTime due, const emulators::UdpEnd& to,
                           std::span<const std::uint8_t> bytes, bool do_not_fragment) {
  // Address, port and flag side by side.
  const std::uint64_t tag = std::uint64_t{to.address} << 32U | std::uint64_t{to.port} << 16U |
                            (do_not_fragment ? 1U : 0U);
  push(due, tag, statistics_, bytes);
}

bool AddressedOutlet::transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) {
  last_to_ = end_of(tag);
  return is_cut_off() || port_->send(last_to_, bytes, (tag & 1U) != 0);
}

std::optional<std::size_t> AddressedOutlet::untaken() const {
  return drivers::untaken_datagrams(last_to_);
}

void AddressedOutlet::tell_of(WireTap& tap, SimTime due, std::uint64_t tag,
                              std::span<const std::uint8_t> bytes) {
  tap.sent(due, DatagramPiece{port_->end(), end_of(tag), bytes});
}

ServerOutlet::ServerOutlet(drivers::StreamServer& server, WireStatistics& statistics)
    : QueuedOutlet(kServerUnits, kServerBytes), server_(server), statistics_(statistics) {}

void ServerOutlet::send(emulators::ConnectionId connection, SimTime due,
                        std::span<const std::uint8_t> bytes) {
  push(due, connection, statistics_, bytes);
}

void ServerOutlet::close(emulators::ConnectionId connection, SimTime due) {
  push(due, connection, statistics_, {});
}

bool ServerOutlet::transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) {
  if (is_cut_off()) {
    return true;
  }
  if (bytes.empty()) {  // close() queued it
    server_.close(tag);
    return true;
  }
  return server_.send(tag, bytes);
}

void ServerOutlet::tell_of(WireTap& tap, SimTime due, std::uint64_t tag,
                           std::span<const std::uint8_t> bytes) {
  const auto what = bytes.empty() ? StreamPiece::What::ended : StreamPiece::What::bytes;
  tap.sent(due, StreamPiece{server_.end(), tag, what, bytes});
}

void ServerOutlet::start(drivers::StreamServer::Handler handler) {
  using What = StreamPiece::What;
  handler_ = std::move(handler);
  drivers::StreamServer::Handler telling{
      .connected = [this](auto connection) { hear(What::opened, connection, {}); },
      .received = [this](auto connection, auto bytes) { hear(What::bytes, connection, bytes); },
      .disconnected = [this](auto connection) { hear(What::gone, connection, {}); },
  };
  if (handler_.half_closed) {
    telling.half_closed = [this](auto connection) { hear(What::ended, connection, {}); };
  }
  server_.start(std::move(telling));
}

void ServerOutlet::hear(StreamPiece::What what, emulators::ConnectionId connection,
                        std::span<const std::uint8_t> bytes) {
  if (!is_cut_off()) {
    arrive(StreamPiece{server_.end(), connection, what, bytes});
  }
}

bool ServerOutlet::give(const WirePiece& piece) {
  const auto* stream = std::get_if<StreamPiece>(&piece);
  if (stream == nullptr || !handler_.connected) {
    return false;
  }
  switch (stream->what) {
    case StreamPiece::What::opened:
      handler_.connected(stream->connection);
      break;
    case StreamPiece::What::bytes:
      handler_.received(stream->connection, stream->bytes);
      break;
    case StreamPiece::What::ended:
      if (!handler_.half_closed) {
        return false;
      }
      handler_.half_closed(stream->connection);
      break;
    case StreamPiece::What::gone:
      handler_.disconnected(stream->connection);
      break;
  }
  return true;
}

FrameOutlet::FrameOutlet(drivers::CanBus& bus, std::size_t unsettled_frames)
    : QueuedOutlet(
          kFrameUnits + kReportUnits + unsettled_frames,
          kFrameUnits * (kFrameHeader + 8) + (kReportUnits + 1) * sizeof(ControllerReport)),
      bus_(bus) {}

void FrameOutlet::on_client(drivers::CanBus::ClientWatcher watcher) {
  watcher_ = std::move(watcher);
  bus_.on_client([this](const drivers::CanClient& client) {
    if (!is_cut_off()) {
      arrive(client);
    }
  });
}

void FrameOutlet::start(drivers::CanBus::Receiver receiver) {
  receiver_ = std::move(receiver);
  bus_.start([this](const protocols::can::Frame& frame) {
    if (!is_cut_off()) {
      arrive(frame);
    }
  });
}

std::optional<std::size_t> FrameOutlet::untaken() const {
  return untaken_at(bus_.status());
}

bool FrameOutlet::give(const WirePiece& piece) {
  if (const auto* frame = std::get_if<protocols::can::Frame>(&piece);
      frame != nullptr && receiver_) {
    if (tap() != nullptr) {
      unsettled_.push_back(*frame);
    }
    receiver_(*frame);
  } else if (const auto* client = std::get_if<drivers::CanClient>(&piece);
             client != nullptr && watcher_) {
    watcher_(*client);
  } else {
    return false;
  }
  return true;
}

void FrameOutlet::send(SimTime due, WireStatistics& statistics,
                       const protocols::can::Frame& frame) {
  std::array<std::uint8_t, kFrameHeader + 8> bytes{};
  protocols::store_big<std::uint32_t>(bytes, 0, frame.id);
  bytes[4] = static_cast<std::uint8_t>((frame.extended ? 1U : 0U) | (frame.remote ? 2U : 0U));
  bytes[5] = frame.length;
  const auto payload = frame.payload();
  std::copy(payload.begin(), payload.end(), bytes.begin() + kFrameHeader);
  const auto unit = std::span(bytes).first(kFrameHeader + payload.size());
  if (frames_waiting_ == kFrameUnits) {
    statistics.hash.add(due, unit);
    ++statistics.dropped;
    if (tap() != nullptr) {
      tap()->lost(due);
    }
    return;
  }
  if (push(due, kFrameUnit, statistics, unit)) {
    ++frames_waiting_;
  }
}

void FrameOutlet::confirm(SimTime due, bool sent) {
  push(due, sent ? kSentUnit : kUnsentUnit, controller_, {});
}

void FrameOutlet::report(SimTime due, const ControllerReport& report) {
  static_assert(std::is_trivially_copyable_v<ControllerReport>);
  std::array<std::uint8_t, sizeof(ControllerReport)> bytes{};
  std::memcpy(bytes.data(), &report, sizeof report);
  if (reports_waiting_ == kReportUnits) {
    ++controller_.dropped;
  } else if (push(due, kReportUnit, controller_, bytes)) {
    ++reports_waiting_;
  }
}

bool FrameOutlet::transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) {
  const Duration stamp = next_due() - kStart;
  if (tag == kSentUnit || tag == kUnsentUnit) {
    if (!is_cut_off()) {
      bus_.confirm(tag == kSentUnit, stamp);
    }
    return true;
  }
  if (tag == kReportUnit) {
    --reports_waiting_;
    return is_cut_off() || bus_.report(report_of(bytes), stamp);
  }
  --frames_waiting_;
  return is_cut_off() || bus_.deliver(frame_of(bytes), stamp);
}

void FrameOutlet::tell_of(WireTap& tap, SimTime due, std::uint64_t tag,
                          std::span<const std::uint8_t> bytes) {
  switch (static_cast<FrameOutletTag>(tag)) {
    case kFrameUnit:
      tap.sent(due, frame_of(bytes));
      break;
    case kReportUnit:
      tap.sent(due, protocols::can::to_error_frame(report_of(bytes)));
      break;
    case kSentUnit:
    case kUnsentUnit:
      if (!unsettled_.empty()) {
        if (tag == kSentUnit) {
          tap.carried(due, unsettled_.front());
        }
        unsettled_.pop_front();
      }
      break;
  }
}

}  // namespace rigwire::hil
