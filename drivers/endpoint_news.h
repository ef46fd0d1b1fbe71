// What the endpoints of an io_context report to people: a client that was closed because it does
// not read. A service of the io_context: endpoints find it there.
//
// Belongs to the thread that runs the io_context.
#pragma once

#include <boost/asio/execution_context.hpp>
#include <boost/asio/io_context.hpp>
#include <functional>
#include <string>
#include <utility>

namespace rigwire::drivers {

class EndpointNews final : public boost::asio::execution_context::service {
 public:
  using key_type = EndpointNews;
  /// Called with one sentence, from within io_context::poll()/run() or an endpoint's send().
  using Listener = std::function<void(const std::string& news)>;

  explicit EndpointNews(boost::asio::execution_context& context);

  /// An empty listener ends the reports.
  void on_news(Listener listener) { listener_ = std::move(listener); }
  void report(const std::string& news) const {
    if (listener_) {
      listener_(news);
    }
  }

 private:
  void shutdown() override { listener_ = {}; }

  Listener listener_;
};

[[nodiscard]] EndpointNews& endpoint_news(boost::asio::io_context& context);

}  // namespace rigwire::drivers
