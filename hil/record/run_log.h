// The messages of a run for its user: a line each, from any thread, with level and simulated time.
//
//   rigwire: 12.345 s: warning: pty /tmp/rigwire/gnss: the link was removed; it is there again
//
// Before the first instant and after the end of a run the time is left out. Only code that is given
// a log writes to it; without one a rig is silent. The reason why a run cannot begin, or has ended,
// is no line of the log: complain() always writes it.
#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "sim/samples/time.h"

namespace spdlog {
class logger;
namespace sinks {
class sink;
}
}  // namespace spdlog

namespace rigwire::hil {

/// Level of a line, and lowest level that is logged, as in --log-level.
enum class LogLevel {
  debug,    ///< What the run does by itself, for debugging.
  info,     ///< What the run did as it was asked to.
  warning,  ///< Something is not as it was asked for; the run goes on as it should.
  error     ///< Something that was asked for is missing from now on.
};
inline constexpr std::array<std::string_view, 4> kLogLevels{"debug", "info", "warning", "error"};

class RunLog {
 public:
  /// Writes lines of level `least` and above to standard error or where divert() says. Does not
  /// wait for a reader that stalls: the line is lost.
  explicit RunLog(LogLevel least);
  /// Writes such lines to a sink of the caller's, whose pattern is set here.
  RunLog(LogLevel least, std::shared_ptr<spdlog::sinks::sink> sink);
  ~RunLog();
  RunLog(const RunLog&) = delete;
  RunLog& operator=(const RunLog&) = delete;

  /// May be called from any thread. Control characters in the text are escaped.
  void debug(std::string_view text) { say(LogLevel::debug, text); }
  void info(std::string_view text) { say(LogLevel::info, text); }
  void warning(std::string_view text) { say(LogLevel::warning, text); }
  void error(std::string_view text) { say(LogLevel::error, text); }

  /// Logs a line without calling the listener, which receives the message in another way.
  void apart(LogLevel level, std::string_view text);

  /// Sets the source of the simulated time of later lines, called by the thread that logs; empty:
  /// the lines have no time.
  void follow(std::function<SimTime()> now);

  /// Called with warnings and errors, on the thread that logs; must not log. Lower levels are not
  /// passed on, since they hold tokens of control servers. Empty: no listener. inform() returns
  /// when no listener is being called.
  using Listener = std::function<void(LogLevel level, std::string_view text)>;
  void inform(Listener listener);

  /// Takes whole lines without their ends in place of standard error; false: it does not take this
  /// one. Must not log.
  using Taker = std::function<bool(std::string_view line)>;
  /// Empty: back to standard error. Returns when no line is on its way to the taker before. Without
  /// effect on a sink of the caller's.
  void divert(Taker taker);

 private:
  class StandardError;
  void say(LogLevel level, std::string_view text);

  std::mutex mutex_;
  std::function<SimTime()> now_;
  Listener listener_;
  std::shared_ptr<StandardError> standard_error_;  ///< Null with a sink of the caller's.
  std::unique_ptr<spdlog::logger> logger_;
};

/// Reports why a run did not begin or ended early, whatever the level of the log: writes "rigwire:
/// TEXT" to standard error, with control characters escaped. Waits up to `patience` for a reader
/// that stalls; then the line is lost.
void complain(const std::string& text,
              std::chrono::milliseconds patience = std::chrono::milliseconds{0});

}  // namespace rigwire::hil
