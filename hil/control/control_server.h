// Access to a run's commands for other processes: HTTP on a Unix socket or a loopback port.
//
//   POST /command      a request of commands.h as JSON or YAML; the reply's JSON (desk.h)
//   GET  /state, /read the same without a body
//   GET  /metrics      the figures of the report so far, as Prometheus reads them
//   GET  /openapi.json what may be asked, made from the table of these and the commands' own rules
//
// Status 200 done, 400 malformed request, 404 and 405 no such path or verb, 409 refused, 410 the
// run has ended. Where GET is served, HEAD is, too.
//
// Only its owner can open a Unix socket (mode 0600). On a port every request needs "Authorization:
// Bearer TOKEN", and is refused (403) when its Host is not the address, so that no name server can
// make this address part of another page's origin. A request with the header Origin, which browsers
// set for pages of other origins, is refused everywhere.
//
// With a dashboard, at a port:
//
//   GET  /             the run's page, and the files that it brings in (hil/control/page_files.h)
//   GET  /stream       a WebSocket: the run's stream (hil/stream/viewers.h)
//
// The page itself needs no token, since it reveals nothing of the run; its requests do. A
// WebSocket, for which pages cannot set a header, has the token in the query (?token=TOKEN). Origin
// may be the server's own address then. The page may load nothing from other origins and runs no
// script but those files (Content-Security-Policy).
//
// Runs on the thread of its io_context, which in a run is not that of the wires: HTTP and the text
// of a request are parsed there, and the desk, which is on the thread of the wires, is handed a
// bounded structure. Requests reach the desk in the order in which they came, since one thread
// hands them over; a client's next one is read when the one before is answered. Clients that do not
// read are closed (drivers/http_server.h); one that leaves while it waits for an answer gives its
// place up, and its request is still executed.
#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/http_server.h"
#include "hil/control/dashboard.h"
#include "hil/control/desk.h"
#include "hil/executive/crossing.h"

namespace rigwire::hil {

/// Where a control server listens.
struct ControlEndpoint {
  std::string path;                   ///< Path of a Unix socket; empty: a port.
  std::string address = "127.0.0.1";  ///< Loopback, numeric.
  std::uint16_t port = 0;             ///< 0: the system chooses one.
  /// Keeps a port open between one run and the next; null: the port is closed.
  std::shared_ptr<drivers::KeptListener> kept;
};

/// "unix:FILE" or "127.0.0.1:PORT"; nullopt for anything else.
[[nodiscard]] std::optional<ControlEndpoint> parse_control_endpoint(std::string_view text);

class ControlServer {
 public:
  /// `token`: for requests at a port. The desk and the dashboard, which may be null, must outlive
  /// this. Throws drivers::EndpointError.
  ControlServer(boost::asio::io_context& io, const ControlEndpoint& endpoint, std::string token,
                Desk& desk, Dashboard* dashboard = nullptr);

  /// "unix:/tmp/control" or "127.0.0.1:40123", as `rigwire ctl` takes it.
  [[nodiscard]] std::string address() const;
  /// "http://127.0.0.1:40123/#TOKEN": what a browser opens.
  [[nodiscard]] std::string page_address() const;

 private:
  void serve(const drivers::HttpRequest& request, const drivers::HttpServer::Respond& respond);
  /// Returns the response that refuses the request; nullopt when it may be served.
  [[nodiscard]] std::optional<drivers::HttpResponse> objection(
      const drivers::HttpRequest& request) const;
  /// Checks like objection(), but not the token.
  [[nodiscard]] std::optional<drivers::HttpResponse> objection_to_origin(
      const drivers::HttpRequest& request) const;
  [[nodiscard]] std::optional<drivers::HttpResponse> page(
      const drivers::HttpRequest& request) const;
  [[nodiscard]] drivers::WebSocketAnswer admit(const drivers::HttpRequest& request);

  ControlEndpoint endpoint_;
  std::string token_;
  Desk& desk_;
  Crossing desk_thread_;
  Dashboard* dashboard_;
  drivers::HttpServer server_;
};

/// 128 random bits of the system, as hexadecimal digits.
[[nodiscard]] std::string fresh_token();

/// JSON text: the requests and replies of the server as an OpenAPI 3.1 document.
[[nodiscard]] std::string control_api();

}  // namespace rigwire::hil
