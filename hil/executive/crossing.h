// Calls between two io_contexts, each of which one thread runs.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <utility>

namespace rigwire::hil {

class Crossing {
 public:
  /// Both may be the same: calls are plain ones then.
  Crossing(boost::asio::io_context& here, boost::asio::io_context& there)
      : here_(&here), there_(&there) {}

  /// Calls `what` there, here alone.
  template <class What>
  void go(What what) const {
    call(here_, there_, std::move(what));
  }

  /// What may be called there to have `what` called here, with copies of the arguments.
  template <class What>
  [[nodiscard]] auto back(What what) const {
    return [here = here_, there = there_, what = std::move(what)](auto... arguments) {
      call(there, here, [what, ... arguments = std::move(arguments)] { what(arguments...); });
    };
  }

 private:
  template <class What>
  static void call(const boost::asio::io_context* from, boost::asio::io_context* to, What what) {
    if (from == to) {
      what();
    } else {
      boost::asio::post(*to, std::move(what));
    }
  }

  boost::asio::io_context* here_;
  boost::asio::io_context* there_;
};

}  // namespace rigwire::hil
