// Bounded real-time waits for tests of endpoints.
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>

namespace rigwire::drivers {

/// Runs what is ready, again and again, until `done` or the limit. True when done.
inline bool run_until(boost::asio::io_context& context, const std::function<bool()>& done,
                      std::chrono::milliseconds limit = std::chrono::seconds(5)) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return false;
    }
    context.restart();
    context.run_one_for(std::chrono::milliseconds(5));
  }
  return true;
}

/// Runs for a while: to see that something does not happen.
inline void run_for(boost::asio::io_context& context, std::chrono::milliseconds span) {
  (void)run_until(
      context, [] { return false; }, span);
}

}  // namespace rigwire::drivers
