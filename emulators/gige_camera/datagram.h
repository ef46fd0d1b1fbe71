// Datagrams of a device that answers any client: each one carries its destination.
#pragma once

#include <cstdint>
#include <span>

#include "sim/samples/time.h"

namespace rigwire::emulators {

/// An end of UDP on IPv4. Addresses are numbers: 127.0.0.2 is 0x7F000002.
struct UdpEnd {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  friend bool operator==(const UdpEnd&, const UdpEnd&) = default;
};

/// One UDP socket of a device. `due` never decreases from call to call. The bytes are copied before
/// the call returns.
class DatagramOutput {
 public:
  virtual ~DatagramOutput() = default;
  /// `do_not_fragment`: the path must carry it in one piece or lose it.
  virtual void send(SimTime due, const UdpEnd& to, std::span<const std::uint8_t> bytes,
                    bool do_not_fragment) = 0;
};

}  // namespace rigwire::emulators
