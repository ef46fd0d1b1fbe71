// Shows the status of a running rig from a thread of its own, so that a slow terminal never holds
// up a wire. It asks the wire thread for a snapshot and draws it itself.
#pragma once

#include <boost/asio/io_context.hpp>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "hil/control/run.h"
#include "hil/executive/truth_source.h"
#include "hil/rig/rig_status.h"

namespace rigwire::hil {

enum class StatusStyle {
  live,   ///< A table refreshed in place; needs a terminal.
  plain,  ///< One block of lines per period, for logs.
  none
};

class StatusReporter {
 public:
  /// Rates are means over this much simulated time: a receiver of 1 Hz sends in bursts.
  static constexpr Duration kRateWindow = std::chrono::seconds{5};

  /// `snapshot` is called on the thread that runs `io`. Writes to standard output.
  StatusReporter(boost::asio::io_context& io, std::function<RigStatus()> snapshot,
                 std::vector<StateQuantity> machine, StatusStyle style, bool colour,
                 Duration period);
  /// Stops the thread; it never waits for the wire thread for longer than one period.
  ~StatusReporter();
  StatusReporter(const StatusReporter&) = delete;
  StatusReporter& operator=(const StatusReporter&) = delete;

 private:
  struct Mailbox {
    std::mutex mutex;
    std::condition_variable arrived;
    std::optional<RigStatus> status;
    bool ended = false;
  };

  void loop();
  void show(const RigStatus& status);

  boost::asio::io_context& io_;
  std::function<RigStatus()> snapshot_;
  std::vector<StateQuantity> machine_;
  StatusStyle style_;
  bool colour_;
  Duration period_;
  std::shared_ptr<Mailbox> mailbox_ = std::make_shared<Mailbox>();
  std::deque<RigStatus> history_;  ///< Of the last kRateWindow of simulated time; never empty.
  bool drawn_ = false;
  std::thread thread_;
};

/// Tells what is run and by which wires, then shows the table as long as the run lasts. Empty for
/// StatusStyle::none. `colour`: not with NO_COLOR, nor when the output is no terminal.
[[nodiscard]] Onlooker status_onlooker(StatusStyle style, bool colour, const ClockMode& clock);

}  // namespace rigwire::hil
