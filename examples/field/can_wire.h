// Opens the CAN bus that the user names: a kernel interface ("vcan0"), an slcan adapter on a serial
// line (a path), or "auto": vcan0 where the kernel has it, else the adapter at /tmp/rigwire/can.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/endpoints.h"
#include "drivers/serial_port.h"
#include "drivers/slcan_client.h"

namespace rigwire::field {

class CanWire {
 public:
  static constexpr std::uint32_t kBitRate_bps = 250'000;

  /// An adapter's line that is not there yet is waited for. Throws drivers::EndpointError when a
  /// kernel interface does not open.
  CanWire(boost::asio::io_context& context, const std::string& name);

  [[nodiscard]] drivers::CanBus& bus() { return *bus_; }
  /// "vcan0", or the adapter's path.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// To be called about once a second: reopens the channel of an adapter that has come (back) or
  /// has been silent.
  void tend(bool silent);

 private:
  std::string name_;
  std::unique_ptr<drivers::SerialPort> line_;  ///< Outlives the client on it.
  std::unique_ptr<drivers::CanBus> bus_;
  drivers::SlcanClient* adapter_ = nullptr;  ///< bus_, when it is one.
  bool line_was_open_ = false;
};

}  // namespace rigwire::field
