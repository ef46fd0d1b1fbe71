// The last step to a wire: a bounded queue of due units of output in front of one endpoint. Input
// from the endpoint's clients passes here as well, so that a tap can observe everything on the wire
// (hil/wires/wire_tap.h).
//
// First in, first out: units must come in order of their due times. The endpoint must outlive the
// outlet, statistics the last unit that is theirs. Nothing throws once it is made: what the queue
// or the endpoint does not take is lost, as on the real wire, and counted.
#pragma once

#include <deque>
#include <optional>
#include <span>

#include "drivers/endpoints.h"
#include "emulators/device.h"
#include "emulators/gige_camera/datagram.h"
#include "hil/executive/event_source.h"
#include "hil/wires/emission_queue.h"
#include "hil/wires/wire_statistics.h"
#include "hil/wires/wire_tap.h"

namespace rigwire::hil {

/// Hands units to the endpoint when they are due and keeps the statistics. Subclasses know the kind
/// of endpoint.
class QueuedOutlet : public Outlet {
 public:
  [[nodiscard]] SimTime next_due() const final;
  void transmit_front(std::optional<Duration> lateness) final;

  /// From now on reports everything to `tap`, which must outlive the outlet's use. To be called
  /// before start().
  void tell(WireTap& tap) { tap_ = &tap; }
  [[nodiscard]] virtual WireKind kind() const = 0;

  /// Returns how many bytes of what left here its clients have not taken; nullopt when the system
  /// does not know, and without a client (drivers/untaken.h).
  [[nodiscard]] virtual std::optional<std::size_t> untaken() const { return std::nullopt; }
  /// Returns how many units have left so far.
  [[nodiscard]] std::uint64_t left() const { return left_; }

  /// Disconnects the wire: from now on units are taken and reported to the tap but reach no
  /// endpoint, and input of the endpoint is ignored.
  void cut_off() { cut_off_ = true; }
  /// Handles `piece` as if a client had sent it just now. False: this outlet receives none of that
  /// kind.
  bool arrive(const WirePiece& piece);

 protected:
  QueuedOutlet(std::size_t units, std::size_t bytes) : queue_(units, bytes) {}
  /// From now on a unit after a late one keeps half of its distance from it, for a wire whose far
  /// end has little room and must not receive bursts. Lateness is measured against the due time all
  /// the same.
  ///
  /// next_due() of a unit is the later of its due time and of when the unit before left plus half
  /// of the two due times' distance. It is never before that unit left, since due times rise; it
  /// catches up with twice the pace, so that a delay of t is gone after 2 t; and it is the due time
  /// wherever nothing is late: free-running, and after a pause. It is called again while a unit is
  /// transmitted, and returns the same as for the executive: the unit is in front until then.
  void keep_apart() { apart_ = true; }
  /// Returns false, and counts the unit as dropped, when there is no room.
  bool push(SimTime due, std::uint64_t tag, WireStatistics& statistics,
            std::span<const std::uint8_t> bytes);
  [[nodiscard]] WireTap* tap() const { return tap_; }
  [[nodiscard]] bool is_cut_off() const { return cut_off_; }

 private:
  /// False when any part of the unit was refused.
  virtual bool transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) = 0;
  /// Reports a unit that was taken to `tap`.
  virtual void tell_of(WireTap& tap, SimTime due, std::uint64_t tag,
                       std::span<const std::uint8_t> bytes) = 0;
  /// Passes what a client sent to the receiver behind the endpoint. False: there is none.
  virtual bool give(const WirePiece& /*piece*/) { return false; }

  WireTap* tap_ = nullptr;
  EmissionQueue queue_;
  std::uint64_t left_ = 0;
  bool apart_ = false;
  bool cut_off_ = false;
  SimTime last_due_{};   ///< Due time of the last unit sent.
  SimTime last_left_{};  ///< Time when it was sent.
};

/// A serial line: what the line does not take is lost.
class StreamOutlet final : public QueuedOutlet, public emulators::ByteOutput {
 public:
  StreamOutlet(drivers::ByteStream& stream, WireStatistics& statistics);
  /// Sets the watcher of the endpoint's client (ByteStream::on_client()); to be called before
  /// start().
  void on_client(drivers::ByteStream::ClientWatcher watcher);
  /// Starts the endpoint.
  void start(drivers::ByteStream::Receiver receiver);
  void send(SimTime due, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] WireKind kind() const override { return WireKind::serial; }
  [[nodiscard]] std::optional<std::size_t> untaken() const override;

 private:
  bool give(const WirePiece& piece) override;
  bool transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) override;
  void tell_of(WireTap& tap, SimTime due, std::uint64_t tag,
               std::span<const std::uint8_t> bytes) override;
  drivers::ByteStream& stream_;
  WireStatistics& statistics_;
  drivers::ByteStream::Receiver receiver_;
  drivers::ByteStream::ClientWatcher watcher_;
};

/// One UDP port.
class DatagramOutlet final : public QueuedOutlet, public emulators::ByteOutput {
 public:
  DatagramOutlet(drivers::DatagramSocket& socket, WireStatistics& statistics);
  void send(SimTime due, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] WireKind kind() const override { return WireKind::ethernet; }
  [[nodiscard]] std::optional<std::size_t> untaken() const override;

 private:
  bool transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) override;
  /// Reports a source port of the system's choice as the destination's, so that two runs report the
  /// same.
  void tell_of(WireTap& tap, SimTime due, std::uint64_t tag,
               std::span<const std::uint8_t> bytes) override;
  drivers::DatagramSocket& socket_;
  WireStatistics& statistics_;
};

/// One UDP port whose datagrams each have a destination. `units` and `bytes`: how much may wait.
/// They keep apart (keep_apart()): a client's system has room for some 200 kB.
class AddressedOutlet final : public QueuedOutlet, public emulators::DatagramOutput {
 public:
  AddressedOutlet(drivers::DatagramPort& port, WireStatistics& statistics, std::size_t units,
                  std::size_t bytes);
  void send(SimTime due, const emulators::UdpEnd& to, std::span<const std::uint8_t> bytes,
            bool do_not_fragment) override;
  /// Starts the port. The receiver may call lead_to(), and must not destroy the outlet.
  void start(drivers::DatagramPort::Receiver receiver);
  /// From now on datagrams leave through `port`; it must outlive the outlet.
  void lead_to(drivers::DatagramPort& port) { port_ = &port; }
  [[nodiscard]] WireKind kind() const override { return WireKind::ethernet; }
  [[nodiscard]] std::optional<std::size_t> untaken() const override;

 private:
  bool give(const WirePiece& piece) override;
  bool transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) override;
  void tell_of(WireTap& tap, SimTime due, std::uint64_t tag,
               std::span<const std::uint8_t> bytes) override;
  drivers::DatagramPort* port_;
  WireStatistics& statistics_;
  drivers::IpEnd last_to_;  ///< Destination of the last datagram.
  drivers::DatagramPort::Receiver receiver_;
};

/// The clients of a stream server.
class ServerOutlet final : public QueuedOutlet, public emulators::StreamOutput {
 public:
  ServerOutlet(drivers::StreamServer& server, WireStatistics& statistics);
  /// Starts the server.
  void start(drivers::StreamServer::Handler handler);
  void send(emulators::ConnectionId connection, SimTime due,
            std::span<const std::uint8_t> bytes) override;
  void close(emulators::ConnectionId connection, SimTime due) override;
  [[nodiscard]] WireKind kind() const override { return WireKind::ethernet; }

 private:
  bool give(const WirePiece& piece) override;
  bool transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) override;
  void tell_of(WireTap& tap, SimTime due, std::uint64_t tag,
               std::span<const std::uint8_t> bytes) override;
  void hear(StreamPiece::What what, emulators::ConnectionId connection,
            std::span<const std::uint8_t> bytes);
  drivers::StreamServer& server_;
  WireStatistics& statistics_;
  drivers::StreamServer::Handler handler_;
};

/// A CAN bus; every frame carries the statistics of the device that sent it. A frame's bytes, as
/// they are counted and hashed: identifier (4, big endian), flags (1: bit 0 extended, bit 1
/// remote), length (1), data.
///
/// Reports of the client's controller wait in the same queue, so that everything reaches the client
/// in the order in which it happened on the bus. They are in no device's statistics. Confirmations
/// have room of their own: none is lost while at most `unsettled_frames` of the client's frames are
/// on their way.
class FrameOutlet final : public QueuedOutlet {
 public:
  explicit FrameOutlet(drivers::CanBus& bus, std::size_t unsettled_frames = 64);
  /// Sets the watcher of the endpoint's client (CanBus::on_client()); to be called before start().
  void on_client(drivers::CanBus::ClientWatcher watcher);
  /// Starts the endpoint. Every frame that it hands over must be confirmed, in that order.
  void start(drivers::CanBus::Receiver receiver);
  void send(SimTime due, WireStatistics& statistics, const protocols::can::Frame& frame);
  void confirm(SimTime due, bool sent);
  void report(SimTime due, const protocols::can::ControllerReport& report);

  /// Confirmations and reports: `units` handed over, `dropped` refused.
  [[nodiscard]] const WireStatistics& controller_statistics() const { return controller_; }
  [[nodiscard]] WireKind kind() const override { return WireKind::can; }
  [[nodiscard]] std::optional<std::size_t> untaken() const override;

 private:
  bool give(const WirePiece& piece) override;
  bool transmit(std::uint64_t tag, std::span<const std::uint8_t> bytes) override;
  void tell_of(WireTap& tap, SimTime due, std::uint64_t tag,
               std::span<const std::uint8_t> bytes) override;
  drivers::CanBus& bus_;
  drivers::CanBus::Receiver receiver_;
  drivers::CanBus::ClientWatcher watcher_;
  /// Frames of the client that are not confirmed; kept while there is a tap.
  std::deque<protocols::can::Frame> unsettled_;
  WireStatistics controller_;
  std::size_t frames_waiting_ = 0;
  std::size_t reports_waiting_ = 0;
};

}  // namespace rigwire::hil
