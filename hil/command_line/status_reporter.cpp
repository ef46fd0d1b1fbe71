#include "hil/command_line/status_reporter.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <charconv>
#include <system_error>

#include "hil/command_line/status_table.h"
#include "hil/configuration/plain_text.h"
#include "hil/record/run_log.h"

namespace rigwire::hil {
namespace {

using Clock = std::chrono::steady_clock;
using drivers::WriteEnd;

/// Period at which the window's size is checked between two pictures.
constexpr std::chrono::milliseconds kWindowPeriod{100};
/// Size assumed for a terminal that does not report its window size (VT100).
constexpr std::size_t kUsualColumns = 80;
constexpr std::size_t kUsualLines = 24;

// Control sequences (ECMA-48: ED, EL, CUU, CUP).
constexpr std::string_view kEraseBelow = "\x1b[J";
constexpr std::string_view kEraseLine = "\x1b[K";
constexpr std::string_view kClearScreen = "\x1b[H\x1b[2J";
constexpr std::string_view kLineEnd = "\r\n";

/// The window, but for the line on which the cursor waits.
TableLook window_of(int descriptor, bool colour) {
  winsize window{};
  const bool known = ::ioctl(descriptor, TIOCGWINSZ, &window) == 0;
  TableLook look;
  look.colour = colour;
  look.columns = known && window.ws_col > 0 ? window.ws_col : kUsualColumns;
  look.lines =
      std::max<std::size_t>(known && window.ws_row > 0 ? window.ws_row : kUsualLines, 2) - 1;
  return look;
}

/// Where the cursor's row is after `text`, which holds whole control sequences.
std::size_t row_after(std::size_t row, std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '\n') {
      ++row;
    } else if (text.substr(at).starts_with("\x1b[H")) {
      row = 0;
    } else if (text.substr(at).starts_with("\x1b[")) {
      std::size_t up = 0;
      const auto [end, error] =
          std::from_chars(text.data() + at + 2, text.data() + text.size(), up);
      if (error == std::errc{} && end != text.data() + text.size() && *end == 'A') {
        row -= std::min(row, up);
      }
    }
  }
  return row;
}

/// Whether what is written to one descriptor moves what is on the other one's screen.
bool same_terminal(int one, int other) {
  struct stat a {};
  struct stat b {};
  return ::isatty(one) == 1 && ::isatty(other) == 1 && ::fstat(one, &a) == 0 &&
         ::fstat(other, &b) == 0 && a.st_rdev == b.st_rdev;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    text += line + "\n";
  }
  return text;
}

}  // namespace

std::string LivePicture::text(const std::vector<std::string>& lines) const {
  std::string text = rest_of_line();
  if (const std::size_t row = row_after(row_, line_); row > 0) {
    text += fmt::format("\x1b[{}A", row);
  }
  text += "\r";
  for (const std::string& line : lines) {
    // Erased before it is written: a line as wide as the window leaves the cursor in it.
    text.append(kEraseLine).append(line).append(kLineEnd);
  }
  return text.append(kEraseBelow);
}

std::string LivePicture::instead(const std::vector<std::string>& lines) const {
  std::string text = this->text({});
  for (const std::string& line : lines) {
    text.append(line).append(kLineEnd);
  }
  return text;
}

std::string LivePicture::afresh(const std::vector<std::string>& lines) const {
  std::string text = rest_of_line().append(kClearScreen);
  for (const std::string& line : lines) {
    text.append(line).append(kLineEnd);
  }
  return text;
}

void LivePicture::written(std::string_view text, std::size_t bytes) {
  const std::string all = line_.substr(0, line_written_) + std::string(text);
  const std::size_t end = line_written_ + bytes;
  const std::size_t newline = end == 0 ? std::string::npos : all.rfind('\n', end - 1);
  const std::size_t begin = newline == std::string::npos ? 0 : newline + 1;
  row_ = row_after(row_, std::string_view(all).substr(0, begin));
  line_.clear();
  line_written_ = 0;
  if (begin < end && end < all.size()) {
    const std::size_t stop = all.find('\n', end);
    line_ = all.substr(begin, stop == std::string::npos ? stop : stop + 1 - begin);
    line_written_ = end - begin;
  } else {
    row_ = row_after(row_, std::string_view(all).substr(begin, end - begin));
  }
}

StatusReporter::StatusReporter(RunView run, std::string head, StatusStyle style, bool colour,
                               int descriptor)
    : run_(std::move(run)),
      head_(std::move(head)),
      style_(style),
      colour_(colour),
      descriptor_(descriptor),
      output_(descriptor),
      period_(run_.configuration.status.period),
      history_(1),
      look_(window_of(descriptor, colour)) {
  if (style == StatusStyle::live && same_terminal(descriptor, STDERR_FILENO)) {
    run_.log.divert([mailbox = mailbox_](std::string_view line) {
      {
        const std::scoped_lock guard(mailbox->mutex);
        if (mailbox->ended || mailbox->lines.size() >= kMostLines) {
          return false;
        }
        mailbox->lines.emplace_back(line);
      }
      mailbox->arrived.notify_one();
      return true;
    });
  }
  thread_ = std::thread([this] { loop(); });
}

StatusReporter::~StatusReporter() {
  stop();
}

void StatusReporter::stop() {
  run_.log.divert({});
  {
    const std::scoped_lock lock(mailbox_->mutex);
    mailbox_->ended = true;
  }
  mailbox_->arrived.notify_one();
  interrupt_.raise();
  if (thread_.joinable()) {
    thread_.join();
    const std::vector<std::string> lines = std::exchange(mailbox_->lines, {});
    if (!lines.empty() && !over_) {
      put(live_.rest_of_line() + joined(lines), Clock::now() + period_, nullptr);
    }
  }
}

void StatusReporter::request() {
  // The mailbox outlives this object: the wire thread may come to the request after the run.
  boost::asio::post(run_.io, [mailbox = mailbox_, snapshot = run_.status] {
    {
      const std::scoped_lock guard(mailbox->mutex);
      if (mailbox->ended) {
        return;
      }
      mailbox->status = snapshot();
    }
    mailbox->arrived.notify_one();
  });
}

void StatusReporter::loop() {
  if (!put(head_, Clock::time_point::max(), &interrupt_)) {
    return;
  }
  live_.leave();
  std::unique_lock lock(mailbox_->mutex);
  auto next = Clock::now() + period_;
  bool requested = false;
  while (!mailbox_->ended && !over_) {
    // A picture is drawn when a status arrives, which is requested once each period, and when the
    // window's size has changed; lines of the log are written at once.
    const bool resizable = style_ == StatusStyle::live && history_.size() > 1;
    const auto wake = resizable ? std::min(next, Clock::now() + kWindowPeriod) : next;
    mailbox_->arrived.wait_until(lock, wake, [this] {
      return mailbox_->ended || mailbox_->status || !mailbox_->lines.empty();
    });
    if (mailbox_->ended) {
      break;
    }
    const std::optional<RigStatus> status = std::exchange(mailbox_->status, std::nullopt);
    const std::vector<std::string> lines = std::exchange(mailbox_->lines, {});
    lock.unlock();
    if (!lines.empty()) {
      tell(lines);
    }
    if (status) {
      requested = false;
      history_.push_back(*status);
      while (history_.size() > kMaxHistory ||
             (history_.size() > 2 && status->now - history_[1].now >= kRateWindow)) {
        history_.pop_front();
      }
      show(*status);
    } else if (resizable && window_of(descriptor_, colour_) != look_) {
      show(history_.back());
    }
    if (Clock::now() >= next) {
      if (!requested) {
        request();
        requested = true;
      }
      next = Clock::now() + period_;
    }
    lock.lock();
  }
}

std::string StatusReporter::picture(const RigStatus& status) {
  const auto draw = [&](const TableLook& look) {
    return draw_status_table(history_.front(), status, run_.quantities, look);
  };
  if (style_ == StatusStyle::plain) {
    return live_.rest_of_line() + joined(draw({.colour = colour_})) + "\n";
  }
  const TableLook look = window_of(descriptor_, colour_);
  const bool resized = look != look_;
  look_ = look;
  return resized ? live_.afresh(draw(look)) : live_.text(draw(look));
}

void StatusReporter::show(const RigStatus& status) {
  put(picture(status), Clock::now() + period_, &interrupt_);
}

void StatusReporter::tell(const std::vector<std::string>& lines) {
  put(live_.instead(lines), Clock::now() + period_, &interrupt_);
  live_.leave();
  if (history_.size() > 1) {
    show(history_.back());
  }
}

bool StatusReporter::put(const std::string& text, drivers::Output::Deadline until,
                         const drivers::Interrupt* interrupt) {
  const drivers::Written written = output_.write(text, until, interrupt);
  live_.written(text, written.bytes);
  switch (written.end) {
    case WriteEnd::whole:
    case WriteEnd::late:
      break;
    case WriteEnd::interrupted:
      return false;
    case WriteEnd::closed:
      over_ = true;
      run_.reader_gone();
      return false;
    case WriteEnd::failed:
      over_ = true;
      run_.failed("standard output is not complete: " +
                  std::generic_category().message(written.error));
      return false;
  }
  return true;
}

void StatusReporter::conclude(const RunReport& report) {
  stop();
  if (over_) {
    return;
  }
  const std::string text = live_.rest_of_line() + joined(draw_summary(report, colour_));
  const auto until = Clock::now() + kSummaryPatience;
  const drivers::Written written = output_.write(text, until);
  if (written.end == WriteEnd::late) {
    run_.log.warning("standard output is not read; the summary is left out");
  } else if (written.end == WriteEnd::closed) {
    run_.reader_gone();
  } else if (written.end == WriteEnd::failed) {
    run_.failed("standard output is not complete: " +
                std::generic_category().message(written.error));
  }
}

MakeOnlooker status_onlooker(StatusStyle style, bool colour, const ClockMode& clock) {
  return [style, colour, clock](const RunView& run) -> std::unique_ptr<Onlooker> {
    std::string head =
        fmt::format("{}: seed {}, configuration {}, clock {}\n", printable(run.configuration.name),
                    run.configuration.seed, run.config_hash, to_string(clock));
    for (const std::string& wire : run.wires) {
      head += printable(wire) + "\n";
    }
    return std::make_unique<StatusReporter>(run, std::move(head), style, colour, STDOUT_FILENO);
  };
}

}  // namespace rigwire::hil
