// A viewer of a run: a client of its stream (docs/dashboard.md), which receives its subscriptions
// as fast as they arrive and displays nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace rigwire::bench {

class StreamViewer {
 public:
  struct Figures {
    std::uint64_t bytes = 0;     ///< Bytes of all messages so far.
    std::uint64_t messages = 0;  ///< Number of all messages so far.
    /// Time from the connection until the scene, each model that it names, the machine's pose and,
    /// if there are lidars, a turn of each were received; negative: not yet.
    double first_picture_s = -1.0;
    /// Messages dropped by the server, as it reports, because this viewer was too slow.
    std::uint64_t dropped = 0;
    std::uint64_t not_shown = 0;  ///< Messages that the server reports as not decoded.
  };

  /// Views the run from now until its end, on a thread of its own. `page` is the address that the
  /// run reports, "http://127.0.0.1:40123/#TOKEN"; `wants` is called for each topic of the run and
  /// returns whether to subscribe. Throws what Boost throws, and std::invalid_argument for an
  /// address of another form.
  StreamViewer(const std::string& page, std::function<bool(std::string_view topic)> wants);
  ~StreamViewer();
  StreamViewer(const StreamViewer&) = delete;
  StreamViewer& operator=(const StreamViewer&) = delete;

  [[nodiscard]] Figures figures() const;

 private:
  class Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace rigwire::bench
