// Taps of the rig's wires, for recorders and viewers. The outlet (hil/wires/outlets.h), which
// everything passes, calls them, so that no device knows of it.
//
// A tap receives what a client of the wire can observe. What a device sent and the wire did not
// take was on no wire and is reported as lost. On a CAN bus the frames of clients are reported when
// they are complete on the bus, with those of the devices in the order of the bus.
#pragma once

#include <cstdint>
#include <span>
#include <variant>

#include "drivers/endpoints.h"
#include "protocols/can/error_frame.h"
#include "protocols/can/frame.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

enum class WireKind : std::uint8_t { serial, can, ethernet };

struct SerialPiece {
  std::span<const std::uint8_t> bytes;
};

struct DatagramPiece {
  drivers::IpEnd device;
  drivers::IpEnd client;
  std::span<const std::uint8_t> bytes;
};

struct StreamPiece {
  enum class What : std::uint8_t {
    opened,
    bytes,
    ended,  ///< One side sends nothing more.
    gone,   ///< The connection is over; reported once for each that was opened.
  };

  drivers::IpEnd device;
  drivers::StreamServer::ConnectionId connection = 0;
  What what = What::bytes;
  std::span<const std::uint8_t> bytes;
};

/// Bytes, frames, and the settings of the client's end; the settings are only ever received.
using WirePiece = std::variant<SerialPiece, DatagramPiece, StreamPiece, protocols::can::Frame,
                               protocols::can::ErrorFrame, drivers::LineClient, drivers::CanClient>;

/// Receives what passes on one wire, on the wire thread. Functions must not throw or wait;
/// arguments are valid during the call.
class WireTap {
 public:
  virtual ~WireTap() = default;
  /// The device's piece is due at `at`; in order of time among all wires.
  virtual void sent(SimTime at, const WirePiece& piece) = 0;
  /// The bus carried the client's piece at `at`; in order of time among all wires.
  virtual void carried(SimTime at, const WirePiece& piece) = 0;
  /// The device has just received the client's piece. A frame has been offered to the bus, and is
  /// reported again when the bus has carried it.
  virtual void received(const WirePiece& piece) = 0;
  /// A piece of a device, due at `at`, was lost: the queue or the endpoint was full.
  virtual void lost(SimTime at) = 0;
};

}  // namespace rigwire::hil
