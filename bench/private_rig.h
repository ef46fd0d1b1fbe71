// A rig of the configurations on wires of its own, so that a benchmark collides with nothing that
// runs on the machine.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <string>
#include <vector>

#include "hil/files/private_folder.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::bench {

/// The rig that all suites measure.
inline constexpr const char* kBenchRig = "excavator_pit";

class PrivateRig {
 public:
  /// Loads kBenchRig with its ptys in a temporary folder, slcan for its bus, free ports, and
  /// `sets` on top. Throws ConfigurationError, std::runtime_error or boost's system_error.
  explicit PrivateRig(const std::vector<std::string>& sets = {});
  PrivateRig(const PrivateRig&) = delete;
  PrivateRig& operator=(const PrivateRig&) = delete;

  [[nodiscard]] const hil::RigConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] std::uint16_t modbus_port() const { return modbus_port_; }

 private:
  /// Both lidar ports stay bound here. No client reads them, so each datagram reaches a socket and
  /// is dropped by the kernel when that is full.
  boost::asio::io_context io_;
  boost::asio::ip::udp::socket data_sink_;
  boost::asio::ip::udp::socket position_sink_;
  std::uint16_t modbus_port_;  ///< Was free a moment ago.
  hil::PrivateFolder folder_{"bench"};
  hil::RigConfiguration configuration_;
};

}  // namespace rigwire::bench
