#include "drivers/serial_splitter.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace rigwire::drivers {

SerialSplitter::SerialSplitter(std::vector<std::unique_ptr<ByteStream>> ports)
    : ports_(std::move(ports)) {
  if (ports_.empty()) {
    throw std::invalid_argument("serial splitter: 0 ports, at least 1 is needed");
  }
}

void SerialSplitter::start(Receiver receiver) {
  ports_.front()->start(std::move(receiver));
  for (std::size_t i = 1; i < ports_.size(); ++i) {
    ports_[i]->start([](std::span<const std::uint8_t>) {});
  }
}

void SerialSplitter::on_client(ClientWatcher watcher) {
  ports_.front()->on_client(std::move(watcher));
}

std::size_t SerialSplitter::write(std::span<const std::uint8_t> bytes) {
  std::size_t least = bytes.size();
  for (const auto& port : ports_) {
    least = std::min(least, port->write(bytes));
  }
  return least;
}

EndpointStatus SerialSplitter::status() const {
  EndpointStatus status = ports_.front()->status();
  for (std::size_t i = 1; i < ports_.size(); ++i) {
    const EndpointStatus other = ports_[i]->status();
    status.client_present = status.client_present || other.client_present;
    status.readers = std::max(status.readers, other.readers);
  }
  status.further_ports = static_cast<unsigned>(ports_.size() - 1);
  return status;
}

}  // namespace rigwire::drivers
