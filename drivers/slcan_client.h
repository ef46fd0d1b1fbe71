// The field side of slcan: a CAN bus behind an adapter on a serial line.
//
// start() sends C, Sn, O, as the kernel does, and from then on frames pass in both directions. The
// adapter's answers are read and counted, not waited for. Adapters that speak the kernel's dialect
// also report their controller by state and error lines. When the line comes back after it was
// gone, reopen() sends the same commands again.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "drivers/endpoints.h"
#include "protocols/slcan/slcan.h"

namespace rigwire::drivers {

struct SlcanClientCounters {
  std::uint64_t refused = 0;     ///< BEL from the adapter.
  std::uint64_t malformed = 0;   ///< Lines that are no reply.
  std::uint64_t backlogged = 0;  ///< Frames refused because the line was full.
  std::uint64_t bus_errors = 0;  ///< Error lines.
};

class SlcanClient final : public CanBus {
 public:
  /// `line` (a serial port) must outlive the client. Throws std::invalid_argument when slcan has no
  /// code for the bit rate.
  SlcanClient(ByteStream& line, std::uint32_t bit_rate_bps);
  /// Sends C.
  ~SlcanClient() override;
  SlcanClient(const SlcanClient&) = delete;
  SlcanClient& operator=(const SlcanClient&) = delete;

  using ReportWatcher = std::function<void(const protocols::can::ControllerReport&)>;
  /// Calls `watcher` for every state line and error line. To be called before start().
  void on_report(ReportWatcher watcher) { watcher_ = std::move(watcher); }
  void start(Receiver receiver) override;
  /// False when the line is full.
  bool send(const protocols::can::Frame& frame) override;
  /// client_present: the adapter has answered.
  [[nodiscard]] EndpointStatus status() const override;

  /// Opens the channel again.
  void reopen();
  /// State and error counters of the adapter's controller, as last reported.
  [[nodiscard]] const protocols::can::ControllerReport& controller() const { return controller_; }
  [[nodiscard]] const SlcanClientCounters& counters() const { return counters_; }

 private:
  void take_line(const protocols::slcan::LineSplitter::Line& line);
  void take_report(const protocols::can::ControllerReport& report);
  bool flush();
  void write(std::span<const std::uint8_t> bytes);

  ByteStream& line_;
  unsigned rate_code_;
  Receiver receiver_;
  ReportWatcher watcher_;
  protocols::can::ControllerReport controller_;
  protocols::slcan::LineSplitter splitter_;
  bool answered_ = false;
  std::vector<std::uint8_t> kept_;  ///< Tail of a line that the serial line did not take.
  SlcanClientCounters counters_;
};

}  // namespace rigwire::drivers
