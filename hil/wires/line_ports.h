// Serial lines on pseudo-terminals, and wires with several ports: `path`, `path.1`, `path.2` ...
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/endpoints.h"
#include "fields/visitor.h"

namespace rigwire::hil {

/// How a serial line treats a client that is set to another speed.
enum class BaudCheck {
  /// Checks like `strict`, but accepts 9600 bit/s: gpsd sets it on every pseudo-terminal and never
  /// searches for another speed there, and libraries set it for programs that ask for none.
  lenient,
  strict,  ///< A client at another speed receives garbage and sends garbage.
  none,    ///< Accepts a client at any speed.
};
inline constexpr std::array<fields::Choice<BaudCheck>, 3> kBaudChecks{
    {{BaudCheck::lenient, "lenient", "At another speed than the device's, 9600 bit/s excepted."},
     {BaudCheck::strict, "strict", "At another speed than the device's, as on a wire."},
     {BaudCheck::none, "none", "Never."}}};

/// The client's speed as the device is to see it; 0 = not known, so that it matches.
[[nodiscard]] constexpr std::uint32_t seen_baud(BaudCheck check, std::uint32_t client_baud) {
  constexpr std::uint32_t kUnchosen = 9600;
  const bool passes =
      check == BaudCheck::none || (check == BaudCheck::lenient && client_baud == kUnchosen);
  return passes ? 0 : client_baud;
}

/// Allowed number of ports of one wire.
inline constexpr fields::IntegerRule kPorts{1, 16};

/// The key of a serial device.
inline constexpr const char* kSerialPortsText =
    "Ports of the line, `path`, `path.1` ...: all receive from the device, which receives from the "
    "first.";

/// Returns what a client of the port opens; the first has the number 0.
[[nodiscard]] inline std::string port_path(const std::string& path, unsigned port) {
  return port == 0 ? path : path + "." + std::to_string(port);
}

/// "/tmp/rigwire/gnss", "/tmp/rigwire/gnss, .1, .2": as plans show it.
[[nodiscard]] std::string port_list(const std::string& path, unsigned ports);

/// Opens a device's serial line with its ports: all receive from the device, which receives from
/// the first (drivers/serial_splitter.h). Throws drivers::EndpointError.
[[nodiscard]] std::unique_ptr<drivers::ByteStream> open_serial_ports(boost::asio::io_context& io,
                                                                     const std::string& path,
                                                                     unsigned ports,
                                                                     std::uint32_t baud);

}  // namespace rigwire::hil
