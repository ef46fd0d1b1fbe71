// One client of an HTTP server whose connection has become a WebSocket (RFC 6455).
//
// What is sent is pulled: whenever the system has taken one message the owner is asked for the next
// one, so that what waits for a client that reads slowly stays with the owner, who can drop it.
// Pings keep the connection; a client that answers none for some minutes is closed.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace rigwire::drivers {

/// The next message for a client. It is kept until the system has taken it.
struct WebSocketMessage {
  bool text = false;  ///< Else binary.
  std::shared_ptr<const std::string> bytes;
};

class WebSocket {
 public:
  struct Owner {
    /// The next message; `bytes` is null when there is none for now.
    std::function<WebSocketMessage()> next;
    /// A message of the client, whole; the bytes are valid during the call.
    std::function<void(bool text, std::string_view bytes)> received;
    /// Called once when the connection has closed, by either side; not after the server's end.
    std::function<void()> closed;
  };

  virtual ~WebSocket() = default;
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

  /// There may be a next message.
  virtual void wake() = 0;
  /// Ends the connection.
  virtual void close() = 0;

 protected:
  WebSocket() = default;
};

}  // namespace rigwire::drivers
