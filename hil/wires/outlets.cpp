#include "hil/wires/outlets.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>

#include "protocols/bytes.h"

namespace rigwire::hil {

using protocols::can::ControllerReport;

namespace {

// Room for more than one configured lead of the busiest rig, so that only a wire that stands still
// fills a queue.
constexpr std::size_t kSerialUnits = 16'384;
constexpr std::size_t kSerialBytes = 128 * 1024;
constexpr std::size_t kDatagramUnits = 128;
constexpr std::size_t kDatagramBytes = kDatagramUnits * 1472;
constexpr std::size_t kServerUnits = 1024;
constexpr std::size_t kServerBytes = kServerUnits * 260;
constexpr std::size_t kFrameHeader = 4 /* identifier */ + 1 /* flags */ + 1 /* length */;
constexpr std::size_t kFrameUnits = 1024;
constexpr std::size_t kReportUnits = 256;

/// What a unit of a FrameOutlet is.
enum FrameOutletTag : std::uint64_t { kFrameUnit, kSentUnit, kUnsentUnit, kReportUnit };

}  // namespace

SimTime QueuedOutlet::next_due() const {
  const SimTime due = queue_.next_due();
  return apart_ && due != kNever ? std::max(due, last_left_ + (due - last_due_) / 2) : due;
}

void QueuedOutlet::transmit_front(std::optional<Duration> lateness) {
  const EmissionQueue::Unit unit = queue_.front();
  WireStatistics& statistics = *unit.statistics;
  statistics.hash.add(unit.due, unit.bytes);
  if (transmit(unit.tag, unit.bytes)) {
    ++statistics.units;
    statistics.bytes += unit.bytes.size();
  } else {
    ++statistics.dropped;
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

StreamOutlet::StreamOutlet(drivers::ByteStream& stream, WireStatistics& statistics)
    : QueuedOutlet(kSerialUnits, kSerialBytes), stream_(stream), statistics_(statistics) {}

void StreamOutlet::send(SimTime due, std::span<const std::uint8_t> bytes) {
  queue().push(due, 0, statistics_, bytes);
}

bool StreamOutlet::transmit(std::uint64_t /*tag*/, std::span<const std::uint8_t> bytes) {
  return stream_.write(bytes) == bytes.size();
}

DatagramOutlet::DatagramOutlet(drivers::DatagramSocket& socket, WireStatistics& statistics)
    : QueuedOutlet(kDatagramUnits, kDatagramBytes), socket_(socket), statistics_(statistics) {}

void DatagramOutlet::send(SimTime due, std::span<const std::uint8_t> bytes) {
  queue().push(due, 0, statistics_, bytes);
}

bool DatagramOutlet::transmit(std::uint64_t /*tag*/, std::span<const std::uint8_t> bytes) {
  return socket_.send(bytes);
}

AddressedOutlet::AddressedOutlet(drivers::DatagramPort& port, WireStatistics& statistics,
                                 std::size_t units, std::size_t bytes)
    : QueuedOutlet(units, bytes), port_(&port), statistics_(statistics) {
  keep_apart();
}

void AddressedOutlet::send(SimTime due, const emulators::UdpEnd& to,
                           std::span<const std::uint8_t> bytes, bool do_not_fragment) {
  // Address, port and flag side by side.
  const std::uint64_t tag = std::uint64_t{to.address} << 32U | std::uint64_t{to.port} << 16U |
                            (do_not_fragment ? 1U : 0U);
  queue().push(due, tag, statistics_, bytes);
}

bool AddressedOutlet::transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) {
  return port_->send(
      {static_cast<std::uint32_t>(tag >> 32U), static_cast<std::uint16_t>(tag >> 16U)}, bytes,
      (tag & 1U) != 0);
}

ServerOutlet::ServerOutlet(drivers::StreamServer& server, WireStatistics& statistics)
    : QueuedOutlet(kServerUnits, kServerBytes), server_(server), statistics_(statistics) {}

void ServerOutlet::send(emulators::ConnectionId connection, SimTime due,
                        std::span<const std::uint8_t> bytes) {
  queue().push(due, connection, statistics_, bytes);
}

void ServerOutlet::close(emulators::ConnectionId connection, SimTime due) {
  queue().push(due, connection, statistics_, {});
}

bool ServerOutlet::transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) {  // close() queued it
    server_.close(tag);
    return true;
  }
  return server_.send(tag, bytes);
}

FrameOutlet::FrameOutlet(drivers::CanBus& bus, std::size_t unsettled_frames)
    : QueuedOutlet(
          kFrameUnits + kReportUnits + unsettled_frames,
          kFrameUnits * (kFrameHeader + 8) + (kReportUnits + 1) * sizeof(ControllerReport)),
      bus_(bus) {}

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
    return;
  }
  if (queue().push(due, kFrameUnit, statistics, unit)) {
    ++frames_waiting_;
  }
}

void FrameOutlet::confirm(SimTime due, bool sent) {
  queue().push(due, sent ? kSentUnit : kUnsentUnit, controller_, {});
}

void FrameOutlet::report(SimTime due, const ControllerReport& report) {
  static_assert(std::is_trivially_copyable_v<ControllerReport>);
  std::array<std::uint8_t, sizeof(ControllerReport)> bytes{};
  std::memcpy(bytes.data(), &report, sizeof report);
  if (reports_waiting_ == kReportUnits) {
    ++controller_.dropped;
  } else if (queue().push(due, kReportUnit, controller_, bytes)) {
    ++reports_waiting_;
  }
}

bool FrameOutlet::transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) {
  const Duration stamp = next_due() - kStart;
  if (tag == kSentUnit || tag == kUnsentUnit) {
    bus_.confirm(tag == kSentUnit, stamp);
    return true;
  }
  if (tag == kReportUnit) {
    --reports_waiting_;
    ControllerReport report;
    std::memcpy(&report, bytes.data(), sizeof report);
    return bus_.report(report, stamp);
  }
  --frames_waiting_;
  protocols::can::Frame frame;
  frame.id = protocols::load_big<std::uint32_t>(bytes, 0);
  frame.extended = (bytes[4] & 1U) != 0;
  frame.remote = (bytes[4] & 2U) != 0;
  frame.length = bytes[5];
  std::copy(bytes.begin() + kFrameHeader, bytes.end(), frame.data.begin());
  return bus_.deliver(frame, stamp);
}

}  // namespace rigwire::hil
