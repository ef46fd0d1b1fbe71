#include "bench/stream_viewer.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "protocols/bytes.h"
#include "protocols/foxglove/frames.h"

namespace rigwire::bench {
namespace {

namespace beast = boost::beast;
using boost::asio::ip::tcp;
using Clock = std::chrono::steady_clock;

// Opcodes of the server's frames, and where a message's payload begins
// (protocols/foxglove/frames.h).
constexpr std::uint8_t kMessage = 0x01;
constexpr std::uint8_t kAsset = 0x04;
constexpr std::size_t kPayload = 1 /*opcode*/ + 4 /*subscription*/ + 8 /*time*/;
constexpr std::size_t kMostBytes = 64 * 1024 * 1024;

/// What a picture needs of that topic: the scene, where the machine is, points of any lidar; else
/// empty.
std::string_view awaited_part(std::string_view topic) {
  for (const std::string_view part : {"/scene", "/tf", "/points/"}) {
    if (topic == part || (part.ends_with('/') && topic.starts_with(part))) {
      return part;
    }
  }
  return {};
}

}  // namespace

class StreamViewer::Connection {
 public:
  Connection(const std::string& page, std::function<bool(std::string_view)> wants)
      : wants_(std::move(wants)), begin_(Clock::now()) {
    const std::string_view scheme = "http://";
    const std::size_t token = page.find("/#");
    const std::size_t colon = page.rfind(':', token);
    if (!page.starts_with(scheme) || token == std::string::npos || colon < scheme.size()) {
      throw std::invalid_argument("found page " + page + ", allowed http://ADDRESS:PORT/#TOKEN");
    }
    const std::string host = page.substr(scheme.size(), token - scheme.size());
    tcp::resolver resolver(io_);
    boost::asio::connect(socket_.next_layer(),
                         resolver.resolve(page.substr(scheme.size(), colon - scheme.size()),
                                          page.substr(colon + 1, token - colon - 1)));
    socket_.set_option(beast::websocket::stream_base::decorator([](auto& request) {
      request.set(beast::http::field::sec_websocket_protocol,
                  std::string(protocols::foxglove::kSubprotocols.front()));
    }));
    socket_.read_message_max(kMostBytes);
    socket_.handshake(host, "/stream?token=" + page.substr(token + 2));
    thread_ = std::thread([this] { read(); });
  }
  ~Connection() {
    ::shutdown(socket_.next_layer().native_handle(), SHUT_RDWR);
    thread_.join();
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] Figures figures() const {
    const std::scoped_lock lock(mutex_);
    return figures_;
  }

 private:
  void read() {
    beast::flat_buffer buffer;
    boost::system::error_code error;
    while (true) {
      buffer.clear();
      socket_.read(buffer, error);
      if (error) {
        return;
      }
      const std::string_view bytes(static_cast<const char*>(buffer.data().data()), buffer.size());
      {
        const std::scoped_lock lock(mutex_);
        figures_.bytes += bytes.size();
        ++figures_.messages;
      }
      if (socket_.got_text()) {
        hear_text(bytes);
      } else {
        hear_frame(bytes);
      }
    }
  }

  void send(const nlohmann::json& message) {
    boost::system::error_code error;
    socket_.text(true);
    socket_.write(boost::asio::buffer(message.dump()), error);
  }

  void hear_text(std::string_view bytes) {
    const auto message = nlohmann::json::parse(bytes);
    if (message["op"] != "advertise") {
      return;
    }
    nlohmann::json subscriptions = nlohmann::json::array();
    for (const auto& channel : message["channels"]) {
      const auto topic = channel["topic"].get<std::string>();
      if (wants_(topic)) {
        const auto id = static_cast<std::uint32_t>(topics_.size());
        topics_[id] = topic;
        subscriptions.push_back({{"id", id}, {"channelId", channel["id"]}});
        if (const std::string_view part = awaited_part(topic); !part.empty()) {
          awaited_.insert(part);
        }
      }
    }
    send({{"op", "subscribe"}, {"subscriptions", std::move(subscriptions)}});
  }

  void hear_frame(std::string_view bytes) {
    const std::span<const std::uint8_t> frame(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                              bytes.size());
    if (frame.size() < kPayload) {
      return;
    }
    if (frame[0] == kAsset) {
      assets_.erase(protocols::load_little<std::uint32_t>(frame, 1));
    } else if (frame[0] == kMessage) {
      const std::string& topic = topics_[protocols::load_little<std::uint32_t>(frame, 1)];
      if (topic == "/scene" && awaited_.contains(topic)) {
        fetch_models(bytes.substr(kPayload));
      } else if (topic == "/status") {
        hear_status(bytes.substr(kPayload));
      }
      awaited_.erase(awaited_part(topic));
    }
    if (!complete_ && !topics_.empty() && awaited_.empty() && assets_.empty()) {
      complete_ = true;
      const std::scoped_lock lock(mutex_);
      figures_.first_picture_s = std::chrono::duration<double>(Clock::now() - begin_).count();
    }
  }

  void fetch_models(std::string_view payload) {
    std::set<std::string> uris;
    const auto scene = nlohmann::json::parse(payload);
    for (const auto& entity : scene["entities"]) {
      for (const auto& model : entity["models"]) {
        uris.insert(model["url"].get<std::string>());
      }
    }
    std::uint32_t request = 0;
    for (const std::string& uri : uris) {
      assets_.insert(++request);
      send({{"op", "fetchAsset"}, {"uri", uri}, {"requestId", request}});
    }
  }

  void hear_status(std::string_view payload) {
    const auto viewers = nlohmann::json::parse(payload)["viewers"];
    const std::scoped_lock lock(mutex_);
    figures_.dropped = viewers["dropped"].get<std::uint64_t>();
    figures_.not_shown = viewers["not_shown"].get<std::uint64_t>();
  }

  std::function<bool(std::string_view)> wants_;
  Clock::time_point begin_;
  boost::asio::io_context io_;
  beast::websocket::stream<tcp::socket> socket_{io_};
  // On the thread.
  std::map<std::uint32_t, std::string> topics_;  ///< By subscription.
  std::set<std::string_view> awaited_;           ///< Without which there is no picture.
  std::set<std::uint32_t> assets_;               ///< Requests on their way.
  bool complete_ = false;
  mutable std::mutex mutex_;
  Figures figures_;
  std::thread thread_;
};

StreamViewer::StreamViewer(const std::string& page, std::function<bool(std::string_view)> wants)
    : connection_(std::make_unique<Connection>(page, std::move(wants))) {}

StreamViewer::~StreamViewer() = default;

StreamViewer::Figures StreamViewer::figures() const {
  return connection_->figures();
}

}  // namespace rigwire::bench
