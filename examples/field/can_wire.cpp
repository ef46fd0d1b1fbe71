#include "field/can_wire.h"

#include "drivers/socketcan.h"

namespace rigwire::field {

CanWire::CanWire(boost::asio::io_context& context, const std::string& name) : name_(name) {
  if (name_ == "auto") {
    name_ = drivers::socketcan_available("vcan0") ? "vcan0" : "/tmp/rigwire/can";
  }
  if (name_.find('/') == std::string::npos) {
    bus_ = std::make_unique<drivers::SocketCanBus>(context, name_);
    return;
  }
  line_ = std::make_unique<drivers::SerialPort>(
      context, drivers::SerialPortSettings{.path = name_, .baud = 115200, .wait_for_device = true});
  auto adapter = std::make_unique<drivers::SlcanClient>(*line_, kBitRate_bps);
  adapter_ = adapter.get();
  bus_ = std::move(adapter);
}

void CanWire::tend(bool silent) {
  if (adapter_ == nullptr) {
    return;
  }
  const bool open = line_->status().client_present;
  if (open && (!line_was_open_ || silent)) {
    adapter_->reopen();
  }
  line_was_open_ = open;
}

}  // namespace rigwire::field
