// The endpoints that a device or a field program holds: byte streams, datagrams, CAN buses, stream
// servers. Each has an implementation on the operating system and, among the tests, an in-memory
// twin with the same behaviour, so that deterministic tests need no system.
//
// All endpoints belong to one Asio io_context and are used from the thread that runs it. Received
// data and changes of clients are delivered from within io_context::poll()/run() only. Writing
// never blocks: what the system does not take at once is refused and reported, and the caller
// counts it. Opening throws EndpointError with the address, what was tried and the remedy.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>

#include "protocols/can/controller_report.h"
#include "protocols/can/frame.h"

namespace rigwire::drivers {

/// Thrown when opening an endpoint failed. what() names the address, the system's reason and the
/// remedy.
class EndpointError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a status table shows of an endpoint.
struct EndpointStatus {
  std::string address;          ///< What a client opens: "/tmp/rigwire/gnss", "udp 127.0.0.1:2368".
  bool client_present = false;  ///< A client has it open, is connected, or has answered.
  /// Programs that have a serial line open; 0: none, or not known (drivers/line_watch.h).
  unsigned readers = 0;
  unsigned further_ports = 0;  ///< Open beside `address`, under its name with ".1", ".2" ...
  std::uint64_t cut_off = 0;   ///< Clients that a stream server closed since they did not read.
};

/// The far end of a serial line.
struct LineClient {
  bool present = false;  ///< A client has the line open.
  /// The speed that the client's end is set to, bit/s; 0 while no client is present.
  std::uint32_t baud = 0;

  friend bool operator==(const LineClient&, const LineClient&) = default;
};

/// A serial line or an equivalent stream of bytes.
class ByteStream {
 public:
  using Receiver = std::function<void(std::span<const std::uint8_t>)>;
  using ClientWatcher = std::function<void(const LineClient&)>;
  virtual ~ByteStream() = default;
  virtual void start(Receiver receiver) = 0;
  /// From start() on, calls `watcher` for every change of the far end, beginning with the first
  /// state in which a client is present. Presence and speed are reported before the bytes that the
  /// client wrote. To be called before start(). Streams without a far end never call `watcher`.
  virtual void on_client(ClientWatcher /*watcher*/) {}
  /// Returns how many of the bytes were taken. Bytes offered while no client has the stream open
  /// are taken and forgotten, as on a line with nothing plugged in.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;
  [[nodiscard]] virtual EndpointStatus status() const = 0;
};

/// An end of UDP or TCP on IPv4. Addresses are numbers: 127.0.0.2 is 0x7F000002.
struct IpEnd {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  friend bool operator==(const IpEnd&, const IpEnd&) = default;
};

/// One UDP socket with a fixed destination, or a bound one that receives.
class DatagramSocket {
 public:
  /// Where a sender's datagrams come from and go to; zeros where there is none.
  struct Ends {
    IpEnd own;  ///< Port 0: the system's choice.
    IpEnd destination;
  };
  using Receiver = std::function<void(std::span<const std::uint8_t>)>;
  virtual ~DatagramSocket() = default;
  virtual void start(Receiver receiver) = 0;
  /// False when the system refused the datagram (buffer full).
  virtual bool send(std::span<const std::uint8_t> datagram) = 0;
  [[nodiscard]] virtual Ends ends() const { return {}; }
  [[nodiscard]] virtual EndpointStatus status() const = 0;
};

/// One UDP port that receives from any sender and can answer each.
class DatagramPort {
 public:
  using Peer = IpEnd;
  using Receiver = std::function<void(const Peer& from, std::span<const std::uint8_t>)>;
  virtual ~DatagramPort() = default;
  virtual void start(Receiver receiver) = 0;
  /// False when the system refused the datagram: buffer full, no route, or longer than the path
  /// carries in one piece with `do_not_fragment`.
  virtual bool send(const Peer& to, std::span<const std::uint8_t> datagram,
                    bool do_not_fragment) = 0;
  /// What it is bound to.
  [[nodiscard]] virtual IpEnd end() const { return {}; }
  [[nodiscard]] virtual EndpointStatus status() const = 0;
};

/// How the far end has set its controller.
struct CanClient {
  bool open = false;               ///< Takes part in the bus.
  std::uint32_t bit_rate_bps = 0;  ///< 0: it does not say; the bus's own holds.
  bool listen_only = false;        ///< Sends nothing, acknowledges nothing.
  bool one_shot = false;           ///< Tries every frame once only.

  friend bool operator==(const CanClient&, const CanClient&) = default;
};

/// A CAN bus as one node sees it. An endpoint that is an adapter (slcan, gs_usb) represents the
/// client's controller: on_client() reports what the client asks of that controller; confirm() and
/// report() pass back what happens to it on the bus.
class CanBus {
 public:
  using Receiver = std::function<void(const protocols::can::Frame&)>;
  using ClientWatcher = std::function<void(const CanClient&)>;
  using Stamp = std::chrono::nanoseconds;  ///< Simulated time since the start of the run.
  virtual ~CanBus() = default;
  virtual void start(Receiver receiver) = 0;
  /// From start() on, calls `watcher` for every change of the client, beginning with the first
  /// state that differs from CanClient{}. To be called before start(). Endpoints that cannot
  /// observe their client never call it: that client is always present, at the bus's rate.
  virtual void on_client(ClientWatcher /*watcher*/) {}
  /// False when the frame could not be queued (ENOBUFS, line full). Frames offered while no client
  /// listens are taken and forgotten.
  virtual bool send(const protocols::can::Frame& frame) = 0;
  /// Sends like send() a frame that was complete on the bus at `stamp`, for ends that pass on time
  /// stamps.
  virtual bool deliver(const protocols::can::Frame& frame, Stamp /*stamp*/) { return send(frame); }
  /// The oldest frame that came from here and is not yet settled went out completely at `stamp`,
  /// or, with `sent` false, never will (one-shot, bus-off, queue full).
  virtual void confirm(bool /*sent*/, Stamp /*stamp*/) {}
  /// An error or a change of state of the client's controller. False when it could not be passed
  /// on; ends that cannot carry it take and forget it.
  virtual bool report(const protocols::can::ControllerReport& /*report*/, Stamp /*stamp*/) {
    return true;
  }
  [[nodiscard]] virtual EndpointStatus status() const = 0;
};

/// A listening stream socket with its clients, numbered from 1 and never reused.
class StreamServer {
 public:
  using ConnectionId = std::uint64_t;
  struct Handler {
    std::function<void(ConnectionId)> connected;
    std::function<void(ConnectionId, std::span<const std::uint8_t>)> received;
    std::function<void(ConnectionId)> disconnected;
    /// The client sends nothing more and may still read: what is due to it is to be sent, then
    /// close() to be called. Empty: the connection ends when what was sent so far has left.
    std::function<void(ConnectionId)> half_closed{};
  };
  virtual ~StreamServer() = default;
  virtual void start(Handler handler) = 0;
  /// False when the connection is gone or its client has not read for so long that its bounded
  /// backlog is full; the connection is then closed. While anything waits for a client, nothing
  /// more is read from it.
  virtual bool send(ConnectionId connection, std::span<const std::uint8_t> bytes) = 0;
  virtual void close(ConnectionId connection) = 0;
  /// Where it listens; zeros where that is no address of IPv4.
  [[nodiscard]] virtual IpEnd end() const { return {}; }
  [[nodiscard]] virtual EndpointStatus status() const = 0;
};

}  // namespace rigwire::drivers
