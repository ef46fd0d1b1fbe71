// Watches the published serial lines of an io_context, away from the thread that runs it: puts back
// links that were removed, and reports when several programs have one line open.
//
// A service of the io_context: lines find it there and add themselves. Nothing is checked before
// start(). Deterministic for tests: look() does once what the thread does every period.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <boost/asio/execution_context.hpp>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "drivers/published_link.h"

namespace rigwire::drivers {

/// A program that has a pseudo-terminal open: a serial line has one plug, and several programs that
/// read one share its bytes as the kernel deals them out.
struct LineReader {
  pid_t process = 0;
  std::string program;  ///< Name that the kernel reports, 15 characters at most.
};

/// Returns the processes but this one that hold each of `terminals` ("/dev/pts/3") open. A process
/// whose ancestor holds it, too, has inherited it and counts with that one. Takes milliseconds, in
/// proportion to the descriptors that all these processes have open. Sees only the processes whose
/// descriptors /proc shows: a user those of its own, root those of all users, both within their PID
/// namespace; a program of another user is not seen. Linux.
[[nodiscard]] std::vector<std::vector<LineReader>> readers_of(
    std::span<const std::string> terminals);

/// What a line and its watch share.
struct WatchedLine {
  explicit WatchedLine(std::filesystem::path path) : link(std::move(path)) {}
  PublishedLink link;
  std::atomic<bool> in_use{false};     ///< Set by the line: a program has it open.
  std::atomic<unsigned> readers{0};    ///< Set by the watch: programs that hold it open.
  std::atomic<bool> told_once{false};  ///< Several readers have been logged once.
};

class LineWatch final : public boost::asio::execution_context::service {
 public:
  using key_type = LineWatch;
  /// Time between two checks; several readers of a line are reported at most this much later.
  static constexpr std::chrono::seconds kPeriod{1};
  /// Called from the watch's own thread.
  using Teller = std::function<void(const std::string& news)>;

  explicit LineWatch(boost::asio::execution_context& context);
  ~LineWatch() override;

  /// The line that is published at `path`. Throws EndpointError.
  [[nodiscard]] std::shared_ptr<WatchedLine> add(const std::filesystem::path& path);
  /// Starts checking every kPeriod, until the io_context ends or stop().
  void start(Teller teller);
  void stop();
  /// Checks once; returns the messages to report.
  [[nodiscard]] std::vector<std::string> look();

 private:
  void shutdown() override;
  void loop(const Teller& teller);
  [[nodiscard]] std::vector<std::shared_ptr<WatchedLine>> lines();

  std::mutex mutex_;
  std::condition_variable stop_;
  bool stopped_ = false;
  std::vector<std::weak_ptr<WatchedLine>> lines_;
  std::thread thread_;
};

[[nodiscard]] LineWatch& line_watch(boost::asio::io_context& context);

}  // namespace rigwire::drivers
