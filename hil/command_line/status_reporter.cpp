#include "hil/command_line/status_reporter.h"

#include <fmt/format.h>

#include <boost/asio/post.hpp>
#include <cstdio>

#include "hil/command_line/status_table.h"

namespace rigwire::hil {

StatusReporter::StatusReporter(boost::asio::io_context& io, std::function<RigStatus()> snapshot,
                               std::vector<StateQuantity> machine, StatusStyle style, bool colour,
                               Duration period)
    : io_(io),
      snapshot_(std::move(snapshot)),
      machine_(std::move(machine)),
      style_(style),
      colour_(colour),
      period_(period),
      history_(1) {
  if (style_ != StatusStyle::none) {
    thread_ = std::thread([this] { loop(); });
  }
}

StatusReporter::~StatusReporter() {
  {
    const std::scoped_lock lock(mailbox_->mutex);
    mailbox_->ended = true;
  }
  mailbox_->arrived.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void StatusReporter::loop() {
  std::unique_lock lock(mailbox_->mutex);
  while (!mailbox_->arrived.wait_for(lock, period_, [this] { return mailbox_->ended; })) {
    lock.unlock();
    // The mailbox outlives this object: the wire thread may come to the request after the run.
    boost::asio::post(io_, [mailbox = mailbox_, snapshot = snapshot_] {
      {
        const std::scoped_lock guard(mailbox->mutex);
        if (mailbox->ended) {
          return;
        }
        mailbox->status = snapshot();
      }
      mailbox->arrived.notify_one();
    });
    lock.lock();
    mailbox_->arrived.wait_for(lock, period_,
                               [this] { return mailbox_->ended || mailbox_->status; });
    if (mailbox_->status && !mailbox_->ended) {
      const RigStatus status = std::move(*mailbox_->status);
      mailbox_->status.reset();
      lock.unlock();
      show(status);
      lock.lock();
    }
  }
}

void StatusReporter::show(const RigStatus& status) {
  while (history_.size() > 1 && status.now - history_[1].now >= kRateWindow) {
    history_.pop_front();
  }
  std::string text = draw_status_table(history_.front(), status, machine_, colour_);
  if (style_ == StatusStyle::live) {
    // Cursor to where the table began; every line clears its rest, what is below is cleared too.
    std::string lines;
    std::size_t count = 0;
    for (const char c : text) {
      if (c == '\n') {
        lines += "\x1b[K";
        ++count;
      }
      lines += c;
    }
    const std::string up = drawn_ ? "\x1b[" + std::to_string(count) + "A\r" : "";
    text = up + lines + "\x1b[J";
    drawn_ = true;
  } else {
    text += "\n";
  }
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
  history_.push_back(status);
}

Onlooker status_onlooker(StatusStyle style, bool colour, const ClockMode& clock) {
  if (style == StatusStyle::none) {
    return {};
  }
  return [style, colour, clock](const RunView& run) -> std::shared_ptr<void> {
    fmt::print("{}: seed {}, configuration {}, clock {}\n", run.configuration.name,
               run.configuration.seed, config_hash(run.configuration), to_string(clock));
    for (const std::string& wire : run.wires) {
      fmt::print("{}\n", wire);
    }
    std::fflush(stdout);
    return std::make_shared<StatusReporter>(run.io, run.status, run.quantities, style, colour,
                                            run.configuration.status.period);
  };
}

}  // namespace rigwire::hil
