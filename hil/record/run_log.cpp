#include "hil/record/run_log.h"

#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <unistd.h>

#include <chrono>

#include "drivers/output.h"
#include "hil/configuration/plain_text.h"

namespace rigwire::hil {
namespace {

spdlog::level::level_enum level_of(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return spdlog::level::debug;
    case LogLevel::info:
      return spdlog::level::info;
    case LogLevel::warning:
      return spdlog::level::warn;
    case LogLevel::error:
      break;
  }
  return spdlog::level::err;
}

/// Puts the run's simulated time, not the day's, into a pattern.
class SimulatedTime final : public spdlog::custom_flag_formatter {
 public:
  explicit SimulatedTime(const std::function<SimTime()>& now) : now_(now) {}
  void format(const spdlog::details::log_msg& /*message*/, const std::tm& /*wall*/,
              spdlog::memory_buf_t& line) override {
    if (now_) {
      fmt::format_to(std::back_inserter(line), "{:.3f} s: ", to_seconds(now_()));
    }
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<SimulatedTime>(now_);
  }

 private:
  const std::function<SimTime()>& now_;  // of the log
};

std::unique_ptr<spdlog::formatter> line_format(const std::function<SimTime()>& now) {
  // Lines end in the sink; no time of the day is read.
  auto format = std::make_unique<spdlog::pattern_formatter>(spdlog::pattern_time_type::utc, "\n");
  format->add_flag<SimulatedTime>('*', now).set_pattern("rigwire: %*%l: %v");
  return format;
}

}  // namespace

class RunLog::StandardError final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  void divert(Taker taker) {
    const std::scoped_lock lock(mutex_);
    taker_ = std::move(taker);
  }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    const std::string_view text(line.data(), line.size());
    if (taker_ && taker_(text.substr(0, text.size() - 1))) {
      return;
    }
    // If this fails, too, there is nowhere to report it.
    static_cast<void>(drivers::Output(STDERR_FILENO).write(text, std::chrono::steady_clock::now()));
  }
  void flush_() override {}

  Taker taker_;
};

RunLog::RunLog(LogLevel least) : standard_error_(std::make_shared<StandardError>()) {
  logger_ = std::make_unique<spdlog::logger>("rigwire", standard_error_);
  logger_->set_level(level_of(least));
  logger_->set_formatter(line_format(now_));
}

RunLog::RunLog(LogLevel least, std::shared_ptr<spdlog::sinks::sink> sink)
    : logger_(std::make_unique<spdlog::logger>("rigwire", std::move(sink))) {
  logger_->set_level(level_of(least));
  logger_->set_formatter(line_format(now_));
}

RunLog::~RunLog() = default;

void RunLog::follow(std::function<SimTime()> now) {
  const std::scoped_lock lock(mutex_);
  now_ = std::move(now);
}

void RunLog::inform(Listener listener) {
  const std::scoped_lock lock(mutex_);
  listener_ = std::move(listener);
}

void RunLog::divert(Taker taker) {
  if (standard_error_) {
    standard_error_->divert(std::move(taker));
  }
}

void RunLog::say(LogLevel level, std::string_view text) {
  const std::scoped_lock lock(mutex_);  // the time that is followed stays until the line is said
  logger_->log(level_of(level), printable(text));
  if (listener_ && level >= LogLevel::warning) {
    listener_(level, text);
  }
}

void RunLog::apart(LogLevel level, std::string_view text) {
  const std::scoped_lock lock(mutex_);
  logger_->log(level_of(level), printable(text));
}

void complain(const std::string& text, std::chrono::milliseconds patience) {
  const std::string line = "rigwire: " + printable(text, "\n") + "\n";
  // If this fails, too, there is nowhere to report it.
  static_cast<void>(
      drivers::Output(STDERR_FILENO).write(line, std::chrono::steady_clock::now() + patience));
}

}  // namespace rigwire::hil
