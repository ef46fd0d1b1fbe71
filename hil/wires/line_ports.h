// A wire with several ports on pseudo-terminals: `path`, `path.1`, `path.2` ...
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/endpoints.h"
#include "fields/visitor.h"

namespace rigwire::hil {

/// Of one wire.
inline constexpr fields::IntegerRule kPorts{1, 16};

/// The key of a serial device.
inline constexpr const char* kSerialPortsText =
    "Ports of the line, `path`, `path.1` ...: all hear the device, which hears the first.";

/// What a client of the port opens; the first has the number 0.
[[nodiscard]] inline std::string port_path(const std::string& path, unsigned port) {
  return port == 0 ? path : path + "." + std::to_string(port);
}

/// "/tmp/rigwire/gnss", "/tmp/rigwire/gnss, .1, .2": as plans show it.
[[nodiscard]] std::string port_list(const std::string& path, unsigned ports);

/// A device's serial line with its ports: all hear the device, which hears the first
/// (drivers/serial_splitter.h). Throws drivers::EndpointError.
[[nodiscard]] std::unique_ptr<drivers::ByteStream> open_serial_ports(boost::asio::io_context& io,
                                                                     const std::string& path,
                                                                     unsigned ports,
                                                                     std::uint32_t baud);

}  // namespace rigwire::hil
