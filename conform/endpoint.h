// Where a device under test is: the one grammar for all suites.
//
//   tcp:127.0.0.1:1502, tcp:[::1]:1502     a server; a numeric address
//   serial:/dev/ttyUSB0@19200              raw, eight bits
//   can:can0                               an interface of the kernel
//   slcan:/dev/ttyACM0@250000              a bus behind a serial adapter, and its bit rate
//   udp:2368, udp:127.0.0.1:2368           where it sends to: this machine's address, or all
//
// A suite supplies its defaults for what is left out (port, speed, bit rate).
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

namespace rigwire::conform {

/// The device cannot be reached: no listener, no permission, no such path.
class Unreachable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Endpoint {
  enum class Kind : std::uint8_t { tcp, serial, can, slcan, udp };
  Kind kind = Kind::tcp;
  std::string address;     ///< TCP and UDP: numeric (empty: all), else interface or path.
  std::uint16_t port = 0;  ///< Port of TCP and UDP.
  std::uint32_t rate = 0;  ///< Bits per second of a serial line or a bus; 0: unchanged.

  [[nodiscard]] std::string text() const;
  /// On this machine.
  [[nodiscard]] bool local() const;
};

/// A suite's defaults for parts that an endpoint's text leaves out.
struct EndpointDefaults {
  std::uint16_t port = 0;
  std::uint32_t rate = 0;
};

/// Parses an endpoint; nullopt when it has none of these forms.
[[nodiscard]] std::optional<Endpoint> parse_endpoint(const std::string& text,
                                                     const EndpointDefaults& defaults);

}  // namespace rigwire::conform
