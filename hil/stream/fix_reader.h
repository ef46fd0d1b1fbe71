// Position fixes from the bytes that a satellite receiver sent: NMEA's GGA and u-blox's NAV-PVT, as
// a client reads them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "hil/stream/receiver_messages.h"
#include "sim/local_frame.h"

namespace rigwire::hil {

class FixReader {
 public:
  using Use = std::function<void(const sim::GeodeticPoint& place)>;
  /// The next piece of the stream. A message without fix makes none; height is above the ellipsoid.
  void take(std::span<const std::uint8_t> bytes, const Use& use);

 private:
  ReceiverMessages messages_;
};

}  // namespace rigwire::hil
