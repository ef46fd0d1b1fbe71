// Shows the status of a running rig from a thread of its own, so that a slow terminal never holds
// up a wire, and a summary at its end. It asks the wire thread for a snapshot and draws it itself.
//
// The reader of the output may stall (a pager, a stopped terminal): a picture that is not whole
// within its period is abandoned, and the next one begins on a new line. A reader that closes ends
// the run; another failure is reported, and the pictures end.
//
// Where standard error is the terminal of a table that is refreshed in place, lines of the log
// would shift it: they are shown here, above the table, and scroll off with what was there before.
#pragma once

#include <boost/asio/io_context.hpp>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "drivers/output.h"
#include "hil/command_line/status_table.h"
#include "hil/control/run.h"
#include "hil/rig/rig_status.h"

namespace rigwire::hil {

enum class StatusStyle {
  live,   ///< A table refreshed in place, as large as the terminal's window.
  plain,  ///< One block of lines per period, for logs; not clipped.
};

/// Places the next picture of a table that is refreshed in place, when any of those before may have
/// been cut off at any byte. Lines end in CR LF.
class LivePicture {
 public:
  /// Returns the text that replaces the previous picture by `lines`.
  [[nodiscard]] std::string text(const std::vector<std::string>& lines) const;
  /// Returns the text that clears the screen and draws `lines`, as after a change of the window's
  /// size.
  [[nodiscard]] std::string afresh(const std::vector<std::string>& lines) const;
  /// Returns the rest of the line that was cut off, to be written first; empty when none was.
  [[nodiscard]] std::string rest_of_line() const { return line_.substr(line_written_); }
  /// Reports that the first `bytes` bytes of `text` were written.
  void written(std::string_view text, std::size_t bytes);
  /// Returns the text that replaces the picture by `lines`, which may be wider than the screen;
  /// leave() is to follow.
  [[nodiscard]] std::string instead(const std::vector<std::string>& lines) const;
  /// Makes later text follow below the picture, which is no longer replaced.
  void leave() { row_ = 0; }

 private:
  std::size_t row_ = 0;  ///< Cursor's row where `line_` began, counted from the top of the picture.
  std::string line_;     ///< The line that was cut off, whole; empty: none was.
  std::size_t line_written_ = 0;
};

class StatusReporter final : public Onlooker {
 public:
  /// Rates are means over this much simulated time: a receiver of 1 Hz sends in bursts.
  static constexpr Duration kRateWindow = std::chrono::seconds{5};
  static constexpr std::size_t kMaxHistory = 600;  ///< While the run is paused or slow.
  /// Time limit of the summary for a reader that stalls.
  static constexpr std::chrono::seconds kSummaryPatience{2};

  /// Maximum number of log lines that wait for a terminal that stalls.
  static constexpr std::size_t kMostLines = 1000;

  /// Begins with `head`. Writes to `descriptor`.
  StatusReporter(RunView run, std::string head, StatusStyle style, bool colour, int descriptor);
  /// Stops the thread at once, whatever the reader does.
  ~StatusReporter() override;

  void conclude(const RunReport& report) override;

 private:
  struct Mailbox {
    std::mutex mutex;
    std::condition_variable arrived;
    std::optional<RigStatus> status;
    std::vector<std::string> lines;  ///< Lines of the log; at most kMostLines.
    bool ended = false;
  };

  void loop();
  void request();
  void stop();
  void show(const RigStatus& status);
  /// Returns lines of the log, with the table below them again.
  void tell(const std::vector<std::string>& lines);
  [[nodiscard]] std::string picture(const RigStatus& status);
  /// Returns whether there is a reader to write for.
  bool put(const std::string& text, drivers::Output::Deadline until,
           const drivers::Interrupt* interrupt);

  RunView run_;
  std::string head_;
  StatusStyle style_;
  bool colour_;
  int descriptor_;
  drivers::Output output_;
  drivers::Interrupt interrupt_;
  Duration period_;
  std::shared_ptr<Mailbox> mailbox_ = std::make_shared<Mailbox>();
  /// Statuses of the last kRateWindow of simulated time, at most kMaxHistory; never empty.
  std::deque<RigStatus> history_;
  TableLook look_;  ///< Size and colour of the previous picture.
  LivePicture live_;
  bool over_ = false;  ///< The reader is gone or the output has failed.
  std::thread thread_;
};

/// Shows what is run and on which wires, then the table while the run lasts, and at last the
/// summary. `colour`: not with NO_COLOR, nor when the output is no terminal.
[[nodiscard]] MakeOnlooker status_onlooker(StatusStyle style, bool colour, const ClockMode& clock);

}  // namespace rigwire::hil
