#include "drivers/http_server.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/version.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cerrno>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "drivers/listener.h"

namespace rigwire::drivers {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;
using Local = asio::local::stream_protocol;
using AnySocket = asio::generic::stream_protocol::socket;

namespace {

/// The server's own answer to a malformed request; nothing when no client is left to answer.
std::optional<HttpResponse> complaint(const error_code& error) {
  if (error.category() != make_error_code(http::error::bad_method).category() ||
      error == http::error::end_of_stream || error == http::error::partial_message) {
    return std::nullopt;
  }
  HttpResponse response{400, "text/plain", error.message() + "\n", {}, true};
  if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    response.status = 431;
  } else if (error == http::error::body_limit) {
    response.status = 413;
  }
  return response;
}

}  // namespace

struct HttpServer::State : Listening, std::enable_shared_from_this<State> {
  State(asio::io_context& context, HttpServerSettings wanted)
      : Listening(context), settings(std::move(wanted)) {}

  void admit(tcp::socket socket) {
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    admit_any(AnySocket(std::move(socket)));
  }
  void admit_any(AnySocket socket);
  void listen_at_path();
  void accept_at_path();

  HttpServerSettings settings;
  std::optional<Local::acceptor> local;  ///< Listens at the path of the Unix socket.
  PatientHandler handler;
  WebSocketHandler web_socket_handler;
  std::vector<std::shared_ptr<Session>> sessions;
  std::vector<std::shared_ptr<Socket>> web_sockets;
  std::uint64_t requests = 0;
};

/// A connection that has become a WebSocket.
class HttpServer::Socket : public WebSocket, public std::enable_shared_from_this<Socket> {
 public:
  Socket(std::shared_ptr<State> server, AnySocket socket)
      : server_(std::move(server)), stream_(std::move(socket)) {
    stream_.set_option(beast::websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.read_message_max(server_->settings.body_bytes);
    // Messages as they were put in, and no copies of large ones for masks that a server has not.
    stream_.auto_fragment(false);
  }

  void accept(http::request<http::string_body> request, WebSocketAnswer answer) {
    request_ = std::move(request);
    if (!answer.subprotocol.empty()) {
      stream_.set_option(beast::websocket::stream_base::decorator(
          [protocol = answer.subprotocol](beast::websocket::response_type& response) {
            response.set(http::field::sec_websocket_protocol, protocol);
          }));
    }
    stream_.async_accept(request_, [self = shared_from_this(),
                                    open = std::move(answer.open)](const error_code& error) {
      if (self->over(error)) {
        return;
      }
      self->owner_ = open(self);
      self->open_ = true;
      self->read();
      self->wake();
    });
  }

  void wake() override {
    if (!open_ || ended_ || sending_.bytes) {
      return;
    }
    sending_ = owner_.next();
    if (!sending_.bytes) {
      return;
    }
    stream_.text(sending_.text);
    stream_.async_write(asio::buffer(*sending_.bytes),
                        [self = shared_from_this()](const error_code& error, std::size_t) {
                          if (self->over(error)) {
                            return;
                          }
                          self->sending_ = {};
                          self->wake();
                        });
  }

  void close() override { end(); }

  /// Ends the connection now and calls the owner's `closed`.
  void end() {
    if (std::exchange(ended_, true)) {
      return;
    }
    error_code ignored;
    beast::get_lowest_layer(stream_).shutdown(AnySocket::shutdown_both, ignored);
    beast::get_lowest_layer(stream_).close(ignored);
    if (owner_.closed && !server_->stopped) {
      owner_.closed();
    }
    // The owner may be the caller, so that it is released later.
    asio::post(stream_.get_executor(), [self = shared_from_this()] { self->forget_owner(); });
    std::erase(server_->web_sockets, shared_from_this());
  }
  /// Breaks the cycle: the owner may hold this connection in turn.
  void forget_owner() { owner_ = {}; }

 private:
  bool over(const error_code& error) {
    if (error) {
      end();
    }
    return ended_ || server_->stopped;
  }

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](const error_code& error, std::size_t) {
      if (self->over(error)) {
        return;
      }
      const auto bytes = self->buffer_.cdata();
      self->owner_.received(self->stream_.got_text(),
                            {static_cast<const char*>(bytes.data()), bytes.size()});
      self->buffer_.consume(self->buffer_.size());
      if (!self->ended_) {
        self->read();
      }
    });
  }

  std::shared_ptr<State> server_;
  beast::websocket::stream<AnySocket> stream_;
  http::request<http::string_body> request_;
  beast::flat_buffer buffer_;
  Owner owner_;
  WebSocketMessage sending_;
  bool open_ = false;
  bool ended_ = false;
};

/// One connection: read a request, answer it, read the next.
class HttpServer::Session : public std::enable_shared_from_this<Session> {
  /// A completion handler that keeps the session, and does nothing once it has ended.
  template <class Then>
  auto guarded(Then then) {
    return [self = shared_from_this(), then = std::move(then)](const error_code& error,
                                                               std::size_t size) {
      if (self->ended_ || self->server_->stopped) {
        return;
      }
      self->heard_ = std::chrono::steady_clock::now();
      if constexpr (std::is_invocable_v<Then, const error_code&, std::size_t>) {
        then(error, size);
      } else {
        then(error);
      }
    };
  }

 public:
  Session(std::shared_ptr<State> server, AnySocket socket)
      : server_(std::move(server)),
        stream_(std::move(socket)),
        buffer_(server_->settings.header_bytes + kSlack) {}

  [[nodiscard]] std::chrono::steady_clock::time_point heard() const { return heard_; }
  /// Whether its request is at the handler and the client still waits for the answer.
  [[nodiscard]] bool waits_for_answer() const { return asked_ && !sends_no_more_; }
  /// Whether its client may have gone while its request is at the handler.
  [[nodiscard]] bool may_have_gone() const { return asked_ && sends_no_more_; }

  void read_header() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(server_->settings.header_bytes));
    parser_->body_limit(server_->settings.body_bytes);
    stream_.expires_after(server_->settings.patience);
    http::async_read_header(stream_, buffer_, *parser_, guarded([this](const error_code& error) {
                              if (error) {
                                give_up(error);
                              } else if (expects_continue()) {
                                write_continue();
                              } else {
                                read_body();
                              }
                            }));
  }

  /// Ends the connection now.
  void end() {
    if (std::exchange(ended_, true)) {
      return;
    }
    error_code ignored;
    stream_.socket().shutdown(AnySocket::shutdown_both, ignored);
    stream_.close();
    std::erase(server_->sessions, shared_from_this());
  }

 private:
  /// Bytes of a body that may come with the header.
  static constexpr std::size_t kSlack = 4096;
  /// Bytes of a request that was refused, read on so that its sender sees the answer.
  static constexpr std::size_t kDrained = std::size_t{1} << 20U;
  /// Maximum number of times that one waiting connection is checked.
  static constexpr unsigned kMaxLooks = 8;

  [[nodiscard]] bool expects_continue() const {
    return beast::iequals(parser_->get()[http::field::expect], "100-continue") &&
           parser_->get().version() >= 11;
  }

  void write_continue() {
    continue_ = http::response<http::string_body>(http::status::continue_, 11);
    http::async_write(stream_, continue_,
                      guarded([this](const error_code& error) { error ? end() : read_body(); }));
  }

  void read_body() {
    http::async_read(stream_, buffer_, *parser_, guarded([this](const error_code& error) {
                       error ? give_up(error) : answer();
                     }));
  }

  void give_up(const error_code& error) {
    if (const auto response = complaint(error)) {
      refused_ = true;
      write(*response, 11, false, false);
    } else {
      end();
    }
  }

  void answer() {
    auto request = parser_->release();
    ++server_->requests;
    stream_.expires_never();
    const auto header = [&](http::field field) { return std::string(request[field]); };
    const HttpRequest asked{std::string(request.method_string()),
                            std::string(request.target()),
                            request.body(),
                            header(http::field::host),
                            header(http::field::origin),
                            header(http::field::authorization),
                            header(http::field::sec_websocket_protocol)};
    if (request.count(http::field::host) > 1) {  // RFC 9112, 3.2
      write({400, "text/plain", "more than one Host\n", {}, true}, request.version(), false, false);
      return;
    }
    if (server_->web_socket_handler && beast::websocket::is_upgrade(request)) {
      upgrade(std::move(request), asked);
      return;
    }
    asked_ = true;
    asked_as_ = server_->requests;
    server_->handler(
        asked,
        [self = weak_from_this(), version = request.version(), keep_alive = request.keep_alive(),
         head = request.method() == http::verb::head](const HttpResponse& response) {
          if (const auto session = self.lock(); session && !session->ended_) {
            session->write(response, version, keep_alive, head);
          }
        });
    if (asked_ && !ended_) {
      looks_ = 0;
      watch(AnySocket::wait_read);
    }
  }

  /// Waits, beside the answer, for its client to go.
  void watch(AnySocket::wait_type kind) {
    watched_ = true;
    stream_.socket().async_wait(
        kind, [self = shared_from_this(), number = asked_as_](const error_code& error) {
          // A later request of this connection has another number.
          if (!error && self->asked_ && self->asked_as_ == number && !self->ended_ &&
              !self->server_->stopped) {
            self->look();
          }
        });
  }

  /// Something has happened at a connection that waits for an answer.
  void look() {
    const int descriptor = stream_.socket().native_handle();
    pollfd state{descriptor, 0, 0};
    char next = 0;
    const auto size = ::recv(descriptor, &next, 1, MSG_PEEK | MSG_DONTWAIT);
    const bool failed = size < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR;
    if (failed || (::poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR)) != 0)) {
      end();
      return;
    }
    sends_no_more_ = size == 0;
    // Neither the end nor a next request is read here: only what ends the connection matters.
    // Urgent bytes, which no handler reads, would otherwise wake this up for ever.
    if (++looks_ < kMaxLooks) {
      watch(size < 0 ? AnySocket::wait_read : AnySocket::wait_error);
    }
  }

  void upgrade(http::request<http::string_body> request, const HttpRequest& asked) {
    WebSocketAnswer answer = server_->web_socket_handler(asked);
    if (!answer.refusal && server_->web_sockets.size() >= server_->settings.clients_max) {
      answer.refusal = {503, "text/plain", "all places for viewers are taken\n", {}, true};
    }
    if (answer.refusal) {
      write(*answer.refusal, request.version(), request.keep_alive(), false);
      return;
    }
    const auto socket = std::make_shared<Socket>(server_, stream_.release_socket());
    server_->web_sockets.push_back(socket);
    socket->accept(std::move(request), std::move(answer));
    ended_ = true;
    std::erase(server_->sessions, shared_from_this());
  }

  void write(const HttpResponse& response, unsigned version, bool keep_alive, bool head) {
    asked_ = false;
    sends_no_more_ = false;
    if (std::exchange(watched_, false)) {
      error_code ignored;
      stream_.socket().cancel(ignored);
    }
    response_ = http::response<http::string_body>();
    response_.result(static_cast<unsigned>(response.status));
    response_.version(version);
    if (!server_->settings.server.empty()) {
      response_.set(http::field::server, server_->settings.server);
    }
    if (!response.allow.empty()) {
      response_.set(http::field::allow, response.allow);
    }
    for (const auto& [name, value] : response.headers) {
      response_.set(name, value);
    }
    if (response.status != 204) {  // RFC 9110, 8.6: no Content-Length with 204
      if (!response.content_type.empty()) {
        response_.set(http::field::content_type, response.content_type);
      }
      response_.content_length(response.body.size());
      if (!head) {
        response_.body() = response.body;
      }
    }
    response_.keep_alive(keep_alive && !response.close);
    stream_.expires_after(server_->settings.patience);
    http::async_write(stream_, response_, guarded([this](const error_code& error) {
                        if (error) {
                          end();
                        } else if (refused_) {
                          drain(kDrained);
                        } else if (response_.need_eof() || !response_.keep_alive()) {
                          end();
                        } else {
                          read_header();
                        }
                      }));
  }

  /// Closing with bytes unread would reset the connection, and the answer could be lost with it.
  void drain(std::size_t left) {
    error_code ignored;
    stream_.socket().shutdown(AnySocket::shutdown_send, ignored);
    stream_.async_read_some(asio::buffer(drained_),
                            guarded([this, left](const error_code& error, std::size_t size) {
                              error || size >= left ? end() : drain(left - size);
                            }));
  }

  std::shared_ptr<State> server_;
  beast::basic_stream<asio::generic::stream_protocol, asio::any_io_executor,
                      beast::unlimited_rate_policy>
      stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> continue_;
  http::response<http::string_body> response_;
  std::array<char, 4096> drained_{};
  bool asked_ = false;
  std::uint64_t asked_as_ = 0;  ///< Number of the request at the handler.
  bool watched_ = false;        ///< The connection, while it waits.
  unsigned looks_ = 0;
  bool sends_no_more_ = false;  ///< What it asked was its last request, or it has gone.
  std::chrono::steady_clock::time_point heard_ = std::chrono::steady_clock::now();
  bool refused_ = false;
  bool ended_ = false;
};

void HttpServer::State::admit_any(AnySocket socket) {
  if (sessions.size() >= settings.clients_max) {
    // A client that waits for an answer keeps its place, however long it takes.
    // One that may have gone is the first to lose it.
    const auto silent = std::ranges::min_element(sessions, {}, [](const auto& s) {
      return std::tuple(s->waits_for_answer(), !s->may_have_gone(), s->heard());
    });
    if ((*silent)->waits_for_answer()) {
      return;  // the newcomer is closed
    }
    (*silent)->end();
  }
  sessions.push_back(std::make_shared<Session>(shared_from_this(), std::move(socket)));
  sessions.back()->read_header();
}

void HttpServer::State::listen_at_path() {
  const std::string where = "http unix:" + settings.path;
  if (settings.path.size() >= sizeof(sockaddr_un::sun_path)) {
    throw EndpointError(where + ": the path has " + std::to_string(settings.path.size()) +
                        " bytes, allowed are " + std::to_string(sizeof(sockaddr_un::sun_path) - 1));
  }
  const Local::endpoint endpoint(settings.path);
  struct stat found {};
  if (::lstat(settings.path.c_str(), &found) == 0) {
    if (!S_ISSOCK(found.st_mode)) {
      throw EndpointError(where + ": there is something else than a socket; choose another path");
    }
    error_code refused;
    Local::socket trial(acceptor.get_executor());
    trial.connect(endpoint, refused);
    if (!refused) {
      throw EndpointError(where + ": another process serves it; stop it or choose another path");
    }
    ::unlink(settings.path.c_str());
  }
  Local::acceptor opened(acceptor.get_executor());
  error_code error;
  opened.open(Local(), error);
  // Set before bind(), so that no other user can connect even for a moment.
  if (!error && ::fchmod(opened.native_handle(), S_IRUSR | S_IWUSR) != 0) {
    error = {errno, boost::system::system_category()};
  }
  if (!error) {
    opened.bind(endpoint, error);
  }
  if (!error) {
    opened.listen(asio::socket_base::max_listen_connections, error);
  }
  if (error) {
    throw EndpointError(where + ": " + error.message() + "; check that its folder can be written");
  }
  local.emplace(std::move(opened));
}

void HttpServer::State::accept_at_path() {
  local->async_accept([server = shared_from_this()](const error_code& error, Local::socket socket) {
    if (server->stopped || error == asio::error::operation_aborted) {
      return;
    }
    if (!error) {
      server->admit_any(AnySocket(std::move(socket)));
      server->accept_at_path();
      return;
    }
    server->after_a_while([server] { server->accept_at_path(); });
  });
}

HttpServer::HttpServer(asio::io_context& context, const HttpServerSettings& settings) {
  constexpr const char* kServer = "http server";
  check_setting<std::size_t>(kServer, "clients_max", settings.clients_max, 1, 1024);
  check_setting<std::size_t>(kServer, "header_bytes", settings.header_bytes, 256,
                             std::size_t{64} << 10U);
  check_setting<std::size_t>(kServer, "body_bytes", settings.body_bytes, 256,
                             std::size_t{16} << 20U);
  check_setting<std::int64_t>(kServer, "patience in ms", settings.patience.count(), 1, 3'600'000);
  auto state = std::make_shared<State>(context, settings);
  if (settings.path.empty()) {
    state->settings.port = listen_again(state->acceptor, settings.kept.get(), "http",
                                        settings.address, settings.port, settings.allow_remote);
    state->kept = settings.kept;
  } else {
    state->settings.port = 0;
    state->listen_at_path();
  }
  state_ = std::move(state);
}

HttpServer::~HttpServer() {
  state_->stop();
  if (state_->local) {
    error_code ignored;
    state_->local->close(ignored);
    ::unlink(state_->settings.path.c_str());
  }
  for (const auto& session : std::exchange(state_->sessions, {})) {
    session->end();
  }
  for (const auto& socket : std::exchange(state_->web_sockets, {})) {
    socket->end();
    socket->forget_owner();
  }
}

void HttpServer::on_web_socket(WebSocketHandler handler) {
  state_->web_socket_handler = std::move(handler);
}

void HttpServer::start(Handler handler) {
  start_patiently(
      [handler = std::move(handler)](const HttpRequest& request, const Respond& respond) {
        respond(handler(request));
      });
}

void HttpServer::start_patiently(PatientHandler handler) {
  state_->handler = std::move(handler);
  if (state_->local) {
    state_->accept_at_path();
  } else {
    accept_clients(state_);
  }
}

EndpointStatus HttpServer::status() const {
  const HttpServerSettings& settings = state_->settings;
  return {settings.path.empty() ? describe_listener("http", settings.address, settings.port)
                                : "http unix:" + settings.path,
          !state_->sessions.empty()};
}

std::uint16_t HttpServer::port() const {
  return state_->settings.port;
}

std::size_t HttpServer::clients() const {
  return state_->sessions.size();
}

std::uint64_t HttpServer::requests() const {
  return state_->requests;
}

}  // namespace rigwire::drivers
