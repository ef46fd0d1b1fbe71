// What every emulated device has: a life in simulated time, a wire face and a backend face.
//
// Wire face: bytes or frames arrive by receive(), and leave through an output object given at
// construction, each with the instant at which it is due on the wire. Backend face: SI samples
// arrive by update(), actuator commands are read by the executive. An emulator is a state machine
// over simulated time: no sockets, no threads, no wall time, no hidden randomness (a named random
// stream seed is a constructor argument where a device needs one). Calls come from one thread, with
// times that never decrease.
//
// Steady state never throws and does not allocate per message.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "protocols/can/controller_report.h"
#include "protocols/can/frame.h"
#include "protocols/can/message.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// What reached a device over its wire.
struct ReceiveCounters {
  std::uint64_t bytes = 0;      ///< Everything that arrived.
  std::uint64_t accepted = 0;   ///< Messages understood and meant for this device.
  std::uint64_t ignored = 0;    ///< Well formed, but not for this device, or not supported by it.
  std::uint64_t malformed = 0;  ///< Bad checksum, bad length, garbage runs.
};

/// One physical quantity of a backend: what the wire format can carry of it. Tests compare what a
/// client reads with the truth to within `resolution`.
struct Quantity {
  std::string_view name;    ///< Field term, for example "latitude".
  std::string_view unit;    ///< SI or accepted unit, for example "deg".
  double lower = 0.0;       ///< Minimum value that the format can carry.
  double upper = 0.0;       ///< Maximum value that the format can carry.
  double resolution = 0.0;  ///< One count.
};

/// Returns the quantity that a signal carries; `name` replaces the signal's name unless it is
/// empty.
[[nodiscard]] constexpr Quantity quantity(const protocols::can::Signal& signal,
                                          std::string_view name = {}) {
  return {name.empty() ? signal.name : name, signal.unit, signal.lower, signal.upper,
          signal.scale < 0.0 ? -signal.scale : signal.scale};
}
/// Returns `quantity` with the narrower limits of a device that measures less than its format
/// carries.
[[nodiscard]] constexpr Quantity within(Quantity quantity, double lower, double upper) {
  quantity.lower = lower;
  quantity.upper = upper;
  return quantity;
}

/// The latest client request to a device, for viewers: when it came, and the bytes by which its
/// protocol identifies it.
struct LastRequest {
  static constexpr std::size_t kHeadBytes = 16;

  SimTime at = kNever;  ///< kNever: no request yet.
  std::array<std::uint8_t, kHeadBytes> head{};
  std::size_t size = 0;  ///< Bytes of `head`; what is longer is cut off.

  void note(SimTime now, std::span<const std::uint8_t> bytes) {
    at = now;
    size = std::min(bytes.size(), kHeadBytes);
    std::copy_n(bytes.begin(), size, head.begin());
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return std::span(head).first(size); }
};

/// For a constructor's member list: the settings, when their validate() does not throw.
template <class Settings>
[[nodiscard]] const Settings& checked(const Settings& settings) {
  validate(settings);
  return settings;
}

class Device {
 public:
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Lets the device live up to and including `now`: everything it does by itself until then is
  /// done and sent. Calling it earlier than next_event() is harmless.
  virtual void advance(SimTime now) = 0;

  /// The instant at which the device wants to be advanced next; kNever when it only reacts.
  [[nodiscard]] virtual SimTime next_event() const = 0;

  /// When the device wants its sensor sampled. May change when a client reconfigures it. Devices
  /// without a sensor return a plan whose first is kNever.
  [[nodiscard]] virtual SamplePlan sample_plan() const = 0;

  [[nodiscard]] virtual ReceiveCounters received() const = 0;

  /// Messages per simulated second (sentences, packets, frames) that the device sends by itself in
  /// its present configuration; 0 when it only answers.
  [[nodiscard]] virtual double nominal_rate_hz() const = 0;

  /// What the wire format carries, for `rigwire describe` and for tests.
  [[nodiscard]] virtual std::span<const Quantity> quantities() const = 0;

 protected:
  Device() = default;
};

/// Where a device sends bytes: a serial line, or one UDP port. Each call is one unit that the wire
/// keeps together (a datagram; for a serial line the bytes that leave the UART by `due`). `due`
/// never decreases from call to call on one output. The bytes are copied before the call returns.
class ByteOutput {
 public:
  virtual ~ByteOutput() = default;
  virtual void send(SimTime due, std::span<const std::uint8_t> bytes) = 0;
};

/// Where a device sends CAN frames. `due` is when the controller wants to start transmitting.
class FrameOutput {
 public:
  virtual ~FrameOutput() = default;
  virtual void send(SimTime due, const protocols::can::Frame& frame) = 0;
};

/// Number of one client connection of a stream server; never reused within a run.
using ConnectionId = std::uint64_t;

/// Where a server device answers its clients.
class StreamOutput {
 public:
  virtual ~StreamOutput() = default;
  virtual void send(ConnectionId connection, SimTime due, std::span<const std::uint8_t> bytes) = 0;
  /// Ends the connection after everything sent so far has left.
  virtual void close(ConnectionId connection, SimTime due) = 0;
};

/// The far end of a serial line as the device's line sees it.
struct SerialClient {
  bool present = false;    ///< A client has the line open.
  std::uint32_t baud = 0;  ///< The speed that the client's end is set to, bit/s; 0 = not known.

  friend bool operator==(const SerialClient&, const SerialClient&) = default;
};

/// A device on a serial line.
class SerialDevice : public Device {
 public:
  /// The client's end changed at `now`. While its speed is known and differs from the device's,
  /// both ends receive garbage, as on a real line.
  virtual void set_client(SimTime /*now*/, const SerialClient& /*client*/) {}
  /// Bytes from the client, in arrival order, at `now`.
  virtual void receive(SimTime now, std::span<const std::uint8_t> bytes) = 0;
  /// Whole messages handed to the line so far; what leaves through the output are parts of them.
  [[nodiscard]] virtual std::uint64_t messages_sent() const = 0;
  /// Line speed that the device uses at present, bits per second.
  [[nodiscard]] virtual std::uint32_t baud() const = 0;
};

/// A device on a CAN bus.
class CanDevice : public Device {
 public:
  /// A frame that another node sent, complete at `now`.
  virtual void receive(SimTime now, const protocols::can::Frame& frame) = 0;
  /// An error that the device's own controller saw, a change of its state, or both.
  virtual void controller(SimTime /*now*/, const protocols::can::ControllerReport& /*report*/) {}
  /// How the messages that it sends and takes are laid out, for the bus's DBC file: as it is
  /// configured, before any client changes it. `name` is the device's in its rig: the sender of
  /// what it sends.
  [[nodiscard]] virtual std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const = 0;
};

/// A device that serves byte streams (USB/IP).
class StreamDevice : public Device {
 public:
  virtual void connected(SimTime now, ConnectionId connection) = 0;
  virtual void receive(SimTime now, ConnectionId connection,
                       std::span<const std::uint8_t> bytes) = 0;
  virtual void disconnected(SimTime now, ConnectionId connection) = 0;
};

// Outputs that lead nowhere: for an emulator that is only built to be asked what it can say.
class NullByteOutput final : public ByteOutput {
 public:
  void send(SimTime /*due*/, std::span<const std::uint8_t> /*bytes*/) override {}
};
class NullFrameOutput final : public FrameOutput {
 public:
  void send(SimTime /*due*/, const protocols::can::Frame& /*frame*/) override {}
};

}  // namespace rigwire::emulators
