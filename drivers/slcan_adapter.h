// The device side of slcan: a CAN adapter on a serial line, as the kernel's slcan driver,
// python-can and other LAWICEL masters expect it.
//
// - The adapter represents the client's controller. on_client() reports whether the client holds
//   the channel open (O, or L for listening only) and at which rate (S, s; without them the bus's
//   own). The bus model decides what a wrong rate does to the bus; such a client receives nothing.
//   A second O while open changes nothing: python-can sends two.
// - Every command is answered: CR, or BEL when it is unknown, malformed, or not possible now. A
//   frame is answered CR, after X1 z CR or Z CR; BEL in listen-only mode, when closed, and when
//   `transmit_queue_frames` frames wait for their confirm().
// - Received frames are handed over at once. After X0 they wait for P and A instead, kFetched at
//   most.
// - Time stamps (Z1) are milliseconds modulo 60000 of the frame's end on the bus.
// - F answers the SJA1000's flags: 01 receive queue full, 02 transmit queue full, 04 error warning,
//   08 a received frame was lost, 20 error passive, 40 arbitration lost, 80 bus error. 04 and 20
//   last as long as the state; the others since the last F.
// - M, m and W set the acceptance filter (protocols/slcan/acceptance_filter.h), while closed.
// - The kernel's dialect differs in one thing: changes of state and errors are announced by lines
//   of their own (protocols/slcan/slcan.h). LAWICEL masters take every line for the
//   answer to their command, so that they get none.
// - Z, X and U are taken in any state of the channel, where LAWICEL wants it closed; U changes
//   nothing.
// - A client that leaves the line takes the adapter's power with it: channel closed, defaults
//   again.
// - A line is never torn: what the serial line does not take at once is kept, and the next frame is
//   refused until it has left. Nothing is lost without being counted.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "drivers/endpoints.h"
#include "protocols/slcan/acceptance_filter.h"
#include "protocols/slcan/slcan.h"

namespace rigwire::drivers {

enum class SlcanDialect : std::uint8_t {
  automatic,  ///< The kernel's while its driver is attached to the line, else LAWICEL's.
  kernel,     ///< With state and error lines.
  lawicel,    ///< Without.
};

struct SlcanAdapterSettings {
  std::uint32_t bit_rate_bps = 250'000;  ///< The bus's.
  SlcanDialect dialect = SlcanDialect::automatic;
  /// Whether the kernel's driver holds the far end; what `automatic` goes by. Empty: it does not.
  std::function<bool()> kernel_attached{};
  /// Limit of unconfirmed frames; 0: confirm() is never called, no limit.
  std::size_t transmit_queue_frames = 0;
};

struct SlcanAdapterCounters {
  std::uint64_t refused_commands = 0;  ///< Commands answered with BEL.
  std::uint64_t too_long_lines = 0;    ///< Refused commands that were dropped before their end.
  std::uint64_t wrong_rate = 0;        ///< Frames not handed over: the client has another bit rate.
  std::uint64_t filtered = 0;          ///< Frames that the client's filter keeps out.
  std::uint64_t backlogged = 0;        ///< Frames lost because line or receive queue were full.
  std::uint64_t queue_full = 0;        ///< The client's frames refused for want of room.
  std::uint64_t unsent = 0;            ///< The client's frames that never went out.
  std::uint64_t unanswered = 0;  ///< Answers and announcements for which the line had no room.
};

class SlcanAdapter final : public CanBus {
 public:
  /// Frames that wait for P and A.
  static constexpr std::size_t kFetched = 32;

  /// `line` must outlive the adapter. Throws std::invalid_argument when the bit rate is not
  /// 5000 .. 1000000 bit/s.
  SlcanAdapter(ByteStream& line, SlcanAdapterSettings settings);
  SlcanAdapter(ByteStream& line, std::uint32_t bit_rate_bps);

  /// The receiver gets the frames that the client sends.
  void start(Receiver receiver) override;
  void on_client(ClientWatcher watcher) override { watcher_ = std::move(watcher); }
  /// With the time stamp of the frame before.
  bool send(const protocols::can::Frame& frame) override { return deliver(frame, newest_stamp_); }
  /// Frames that the client does not want (closed, other rate, filter) are taken and forgotten.
  /// False when the line or the receive queue is full.
  bool deliver(const protocols::can::Frame& frame, Stamp stamp) override;
  void confirm(bool sent, Stamp stamp) override;
  bool report(const protocols::can::ControllerReport& report, Stamp stamp) override;
  /// client_present: the client holds the channel open.
  [[nodiscard]] EndpointStatus status() const override;

  [[nodiscard]] const SlcanAdapterCounters& counters() const { return counters_; }

 private:
  enum class Channel : std::uint8_t { closed, open, listening };

  void take_line(const protocols::slcan::LineSplitter::Line& line);
  /// What to answer; BEL when the command cannot be carried out.
  [[nodiscard]] protocols::slcan::Reply execute(const protocols::slcan::Command& command);
  [[nodiscard]] protocols::slcan::Reply take_frame(const protocols::can::Frame& frame);
  [[nodiscard]] bool set_bit_rate(std::optional<std::uint32_t> rate_bps);
  [[nodiscard]] bool set_filter(const protocols::slcan::Command& command);
  [[nodiscard]] protocols::slcan::Reply fetch_all();
  [[nodiscard]] std::uint16_t take_flags();
  void set_channel(Channel channel);
  void power_up();
  [[nodiscard]] bool announces(Stamp stamp);
  [[nodiscard]] bool hears_bus() const;
  void answer(const protocols::slcan::Reply& reply);
  /// Writes what is kept; true when nothing is left.
  bool flush();
  /// False when there was no room.
  bool write(std::span<const std::uint8_t> bytes);

  /// What the client has set, and loses when it leaves.
  struct Session {
    Channel channel = Channel::closed;
    std::uint32_t bit_rate_bps = 0;  ///< 0: the bus's own.
    bool time_stamps = false;
    std::optional<bool> auto_poll;  ///< Set by the command X; empty: X was not received.
    protocols::slcan::AcceptanceFilter filter;
    std::uint16_t flags = 0;  ///< Events since the last F.
    protocols::can::ErrorState state = protocols::can::ErrorState::active;
    bool kernel_seen = false;
    std::optional<Stamp> looked_for_kernel;
    std::deque<protocols::slcan::Reply> fetched;  ///< Frames for P and A.
  };

  ByteStream& line_;
  SlcanAdapterSettings settings_;
  Receiver receiver_;
  ClientWatcher watcher_;
  CanClient told_;
  protocols::slcan::LineSplitter splitter_;
  Session session_;
  std::size_t unconfirmed_ = 0;  ///< The client's frames on their way.
  Stamp newest_stamp_{0};
  std::vector<std::uint8_t> kept_;  ///< Tail of a line, and answers, that the line did not take.
  SlcanAdapterCounters counters_;
};

}  // namespace rigwire::drivers
