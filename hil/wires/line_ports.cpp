#include "hil/wires/line_ports.h"

#include <utility>
#include <vector>

#include "drivers/pty.h"
#include "drivers/serial_splitter.h"

namespace rigwire::hil {

std::string port_list(const std::string& path, unsigned ports) {
  std::string list = path;
  for (unsigned port = 1; port < ports; ++port) {
    list += ", ." + std::to_string(port);
  }
  return list;
}

std::unique_ptr<drivers::ByteStream> open_serial_ports(boost::asio::io_context& io,
                                                       const std::string& path, unsigned ports,
                                                       std::uint32_t baud) {
  if (ports == 1) {
    return std::make_unique<drivers::Pty>(io, path, baud);
  }
  std::vector<std::unique_ptr<drivers::ByteStream>> lines;
  for (unsigned port = 0; port < ports; ++port) {
    lines.push_back(std::make_unique<drivers::Pty>(io, port_path(path, port), baud));
  }
  return std::make_unique<drivers::SerialSplitter>(std::move(lines));
}

}  // namespace rigwire::hil
