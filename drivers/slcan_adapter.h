// The device side of slcan: a CAN adapter on a serial line, as the kernel's slcan driver,
// python-can and other LAWICEL masters expect it.
//
// - Frames pass only while the client holds the channel open (O, or L for listening only). A second
//   O while open changes nothing: python-can sends two.
// - Every command is answered: CR, or BEL when it is unknown, malformed, or not possible now. A
//   frame is answered CR, with auto-poll (X1) z CR or Z CR; in listen-only mode, or closed, BEL.
// - S sets the rate; a client whose rate is not the bus's hears nothing and is not heard, as on a
//   wire, and is counted. Without S the bus's own rate holds. s (register values) and acceptance
//   filters are refused, because they could not be honoured.
// - Time stamps (Z1) are milliseconds modulo 60000 of the clock given at construction.
// - A line is never torn: what the serial line does not take at once is kept, and the next frame is
//   refused until it has left.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "drivers/endpoints.h"
#include "protocols/slcan/slcan.h"

namespace rigwire::drivers {

struct SlcanAdapterCounters {
  std::uint64_t refused_commands = 0;  ///< Answered with BEL.
  std::uint64_t too_long_lines = 0;    ///< Of them, dropped before they ended.
  std::uint64_t wrong_rate = 0;        ///< Frames lost because the client set another bit rate.
  std::uint64_t backlogged = 0;        ///< Frames refused because the line was full.
};

class SlcanAdapter final : public CanBus {
 public:
  using Clock = std::function<std::chrono::milliseconds()>;

  /// `line` must outlive the adapter. Throws std::invalid_argument when slcan has no code for the
  /// bit rate (10, 20, 50, 100, 125, 250, 500, 800, 1000 kbit/s). Without `clock` time stamps come
  /// from the steady clock.
  SlcanAdapter(ByteStream& line, std::uint32_t bit_rate_bps, Clock clock = {});

  /// The receiver gets the frames that the client sends.
  void start(Receiver receiver) override;
  /// Frames offered while the client holds the channel closed are taken and forgotten. False while
  /// it is open at another rate, or the line is full.
  bool send(const protocols::can::Frame& frame) override;
  /// client_present: the client holds the channel open.
  [[nodiscard]] EndpointStatus status() const override;

  [[nodiscard]] const SlcanAdapterCounters& counters() const { return counters_; }

 private:
  enum class Channel : std::uint8_t { closed, open, listening };

  void take_line(const protocols::slcan::LineSplitter::Line& line);
  /// The answer; BEL when the command cannot be carried out.
  [[nodiscard]] protocols::slcan::Reply execute(const protocols::slcan::Command& command);
  void answer(const protocols::slcan::Reply& reply);
  /// Writes what is kept; true when nothing is left.
  bool flush();
  void write(std::span<const std::uint8_t> bytes);

  ByteStream& line_;
  unsigned bus_rate_code_;
  Clock clock_;
  Receiver receiver_;
  protocols::slcan::LineSplitter splitter_;
  Channel channel_ = Channel::closed;
  unsigned client_rate_code_;
  bool time_stamps_ = false;
  bool auto_poll_ = false;
  std::vector<std::uint8_t> kept_;  ///< Tail of a line, and answers, that the line did not take.
  SlcanAdapterCounters counters_;
};

}  // namespace rigwire::drivers
