// An HTTP/1.1 server: for devices that have a web interface, and for the control surface of a run.
//
// Loopback only, unless the settings opt in to more, or a socket in the file system, which its
// owner alone can open. Connections stay open between requests when the client wants it; requests
// that come before their predecessor's answer wait in the system. A client that stops half-way
// through a request, or does not read its answer, is closed after a while; no other client waits
// for it. When all places are taken, a newcomer gets the place of the client that has been silent
// longest and does not wait for an answer; when all wait for one, the newcomer is closed.
//
// A client that leaves while it waits for an answer keeps no place: its connection is closed when
// the system reports that it has gone (a Unix socket that is closed, a TCP connection that is
// reset). A TCP client that has closed looks like one that has only stopped sending and still
// reads: it gets its answer, unless a newcomer needs its place before.
//
// The server itself answers malformed requests: 400 for bytes that are not HTTP or have two Host
// headers, 413 for a body and 431 for a header beyond the limits; the connection ends then.
// "Expect: 100-continue" is obeyed: a client that asks sends a body only when its length is within
// the limit.
//
// A connection may become a WebSocket, if a handler for them is set (on_web_socket()).
//
// A test without a system calls the handler; there is no twin in memory.
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"
#include "drivers/web_socket.h"

namespace rigwire::drivers {

class KeptListener;

struct HttpServerSettings {
  std::string address = "127.0.0.1";  ///< Numeric IPv4 or IPv6.
  std::uint16_t port = 8080;          ///< 0 takes a free one (tests).
  bool allow_remote = false;          ///< Opt-in for addresses other than loopback.
  /// Path of a Unix socket, mode 0600, in place of address and port; empty: none.
  std::string path;
  std::string server;  ///< Header "Server"; empty: none.
  /// Keeps the listening socket of a port from one server to the next (drivers/listener.h); null:
  /// the socket is opened and closed.
  std::shared_ptr<KeptListener> kept;
  std::size_t clients_max = 16;     ///< 1 .. 1024.
  std::size_t header_bytes = 8192;  ///< Limit for one request, 256 .. 64 KiB.
  /// Limit for one request or one WebSocket message, 256 .. 16 MiB.
  std::size_t body_bytes = 65536;
  /// Time limit (1 ms .. 1 h) for one request to arrive, for one answer to leave, and between two
  /// requests.
  std::chrono::milliseconds patience = std::chrono::seconds(10);
};

struct HttpRequest {
  std::string method;  ///< Method as received: "GET".
  std::string target;  ///< Path with query, as received.
  std::string body;
  std::string host;           ///< Header "Host".
  std::string origin;         ///< Header "Origin": the page for which a browser asks.
  std::string authorization;  ///< Header "Authorization".
  std::string subprotocols;   ///< Header "Sec-WebSocket-Protocol".
};

struct HttpResponse {
  int status = 200;
  std::string content_type;  ///< Empty: no such header.
  std::string body;          ///< Left out for a HEAD request and with status 204.
  std::string allow;         ///< Header "Allow"; empty: none.
  bool close = false;        ///< The connection ends after it.
  std::vector<std::pair<std::string, std::string>> headers{};  ///< Further ones.
};

/// What becomes of a request for a WebSocket.
struct WebSocketAnswer {
  std::optional<HttpResponse> refusal;  ///< It stays HTTP. Nothing: it becomes one.
  std::string subprotocol;              ///< The one chosen of those offered; empty: none.
  /// Called once with the connection; returns the connection's owner.
  std::function<WebSocket::Owner(std::shared_ptr<WebSocket>)> open;
};

class HttpServer {
 public:
  using Handler = std::function<HttpResponse(const HttpRequest&)>;
  /// Called once, from the io_context, now or later; nothing happens when the client has gone.
  using Respond = std::function<void(const HttpResponse&)>;
  using PatientHandler = std::function<void(const HttpRequest&, Respond)>;

  /// Binds and listens; clients are taken from start() on. Throws std::invalid_argument for a
  /// setting out of range, EndpointError when the system refuses, when the address is not loopback
  /// without opt-in, or when another process serves the path. A socket file that no process serves
  /// any more is replaced.
  HttpServer(boost::asio::io_context& context, const HttpServerSettings& settings);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// `handler` is called from the io_context, once for each complete request, and answers at once.
  void start(Handler handler);
  /// Starts like start(), with a handler that may answer later; the connection stays open until
  /// then.
  void start_patiently(PatientHandler handler);
  /// Handler of requests to become a WebSocket; to be set before start(). Without one they are
  /// handled as other requests. At most HttpServerSettings::clients_max WebSockets, beside as many
  /// clients.
  using WebSocketHandler = std::function<WebSocketAnswer(const HttpRequest&)>;
  void on_web_socket(WebSocketHandler handler);
  [[nodiscard]] EndpointStatus status() const;
  /// The port that is bound; 0 with a path.
  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] std::size_t clients() const;
  [[nodiscard]] std::uint64_t requests() const;  ///< Given to the handler so far.

 private:
  struct State;
  class Session;
  class Socket;
  std::shared_ptr<State> state_;
};

}  // namespace rigwire::drivers
