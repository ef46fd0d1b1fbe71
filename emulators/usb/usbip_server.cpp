#include "emulators/usb/usbip_server.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include "emulators/usb/usbip_export.h"

namespace rigwire::emulators {

using namespace protocols::usbip;

namespace {

constexpr std::uint32_t kBus = 1;
constexpr std::string_view kPathStart = "/rigwire/";

ListedDevice list_entry(const protocols::usb::DeviceDescription& d, std::string_view name,
                        UsbipServer::PortNumber port) {
  ListedDevice listed;
  DeviceRecord& record = listed.device;
  record.path = std::string(kPathStart) + std::string(name);
  record.bus_id = std::to_string(kBus) + "-" + std::to_string(port);
  record.bus = kBus;
  record.device = port;
  record.speed = d.speed;
  record.vendor = d.vendor;
  record.product = d.product;
  record.release = d.release;
  record.device_class = d.device_class;
  record.subclass = d.subclass;
  record.protocol = d.protocol;
  record.configuration_value = d.configuration_value;
  record.configurations = 1;
  for (const auto& interface : d.interfaces) {
    if (interface.alternate == 0) {
      listed.interfaces.push_back({interface.device_class, interface.subclass, interface.protocol});
    }
  }
  record.interfaces = static_cast<std::uint8_t>(listed.interfaces.size());
  return listed;
}

}  // namespace

void validate(const UsbipServerSettings& settings) {
  if (settings.transfers_max < 1 || settings.transfers_max > 65536) {
    throw std::invalid_argument("usbip transfers_max: found " +
                                std::to_string(settings.transfers_max) + ", allowed 1 .. 65536");
  }
}

UsbipServer::UsbipServer(const UsbipServerSettings& settings, StreamOutput& output)
    : settings_(settings), output_(output) {
  validate(settings);
}

UsbipServer::~UsbipServer() = default;

UsbipServer::PortNumber UsbipServer::add(UsbDevice& device, std::string_view name) {
  if (name.empty() || kPathStart.size() + name.size() >= kPathSize ||
      name.find('\0') != std::string_view::npos) {
    throw std::invalid_argument("usbip device name: found " + std::to_string(name.size()) +
                                " characters, allowed 1 .. 246, none of them zero");
  }
  if (exports_.size() >= 127) {
    throw std::invalid_argument("usbip devices: a bus has at most 127");
  }
  const auto port = static_cast<PortNumber>(exports_.size() + 1);
  exports_.push_back(std::make_unique<Export>(device, list_entry(device.description(), name, port),
                                              settings_.transfers_max, output_, scratch_));
  return port;
}

void UsbipServer::plug(SimTime /*now*/, PortNumber port) {
  at(port).set_plugged(true);
}

void UsbipServer::unplug(SimTime now, PortNumber port) {
  Export& device = at(port);
  device.set_plugged(false);
  if (device.imported()) {
    if (Connection* connection = find(device.importer())) {
      connection->device = nullptr;
      connection->closing = true;
    }
    device.remove(now);
  }
}

bool UsbipServer::plugged(PortNumber port) const {
  return at(port).plugged();
}

bool UsbipServer::imported(PortNumber port) const {
  return at(port).imported();
}

const std::string& UsbipServer::bus_id(PortNumber port) const {
  return at(port).listed().device.bus_id;
}

std::size_t UsbipServer::open_transfers(PortNumber port) const {
  return at(port).open_transfers();
}

UsbipServer::Export& UsbipServer::at(PortNumber port) const {
  assert(port >= 1 && port <= exports_.size());
  return *exports_[port - 1U];
}

void UsbipServer::connected(SimTime /*now*/, ConnectionId connection) {
  if (find(connection) == nullptr) {
    connections_.push_back({connection, nullptr, false, {}});
  }
}

void UsbipServer::disconnected(SimTime now, ConnectionId id) {
  if (Connection* connection = find(id); connection != nullptr && connection->device != nullptr) {
    connection->device->detach(now);
  }
  std::erase_if(connections_, [id](const Connection& c) { return c.id == id; });
}

void UsbipServer::receive(SimTime now, ConnectionId id, std::span<const std::uint8_t> bytes) {
  counters_.bytes += bytes.size();
  Connection* connection = find(id);
  if (connection == nullptr || connection->closing) {
    ++counters_.ignored;
    return;
  }
  std::vector<std::uint8_t>& buffer = connection->buffer;
  if (buffer.empty()) {
    const std::size_t taken = consume(now, *connection, bytes);
    buffer.assign(bytes.begin() + static_cast<std::ptrdiff_t>(taken), bytes.end());
  } else {
    buffer.insert(buffer.end(), bytes.begin(), bytes.end());
    const std::size_t taken = consume(now, *connection, buffer);
    buffer.erase(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(taken));
  }
}

std::size_t UsbipServer::consume(SimTime now, Connection& connection,
                                 std::span<const std::uint8_t> bytes) {
  std::size_t taken = 0;
  while (!connection.closing && taken < bytes.size()) {
    const auto rest = bytes.subspan(taken);
    const std::size_t one = connection.device == nullptr ? consume_request(now, connection, rest)
                                                         : consume_command(now, connection, rest);
    if (one == 0) {
      return connection.closing ? bytes.size() : taken;
    }
    taken += one;
  }
  return bytes.size();
}

std::size_t UsbipServer::consume_request(SimTime now, Connection& connection,
                                         std::span<const std::uint8_t> bytes) {
  const auto request = decode_request(bytes);
  if (request.malformed()) {
    reject(now, connection);
  } else if (request.ok()) {
    if (const auto* wanted = std::get_if<ImportRequest>(&*request)) {
      import(now, connection, wanted->name());
    } else {
      ++counters_.accepted;
      send_list(now, connection);
    }
  }
  return request.consumed();
}

std::size_t UsbipServer::consume_command(SimTime now, Connection& connection,
                                         std::span<const std::uint8_t> bytes) {
  const auto command = decode_from_host(bytes);
  if (command.incomplete()) {
    return 0;
  }
  if (command.malformed()) {
    reject(now, connection);
    return 0;
  }
  Export::Verdict verdict{};
  std::size_t size = command.consumed();
  if (const auto* submit = std::get_if<Submit>(&*command)) {
    if (bytes.size() - size < submit->tail_size()) {
      return 0;
    }
    verdict = connection.device->submit(now, *submit,
                                        bytes.subspan(size, submit->to_host ? 0 : submit->length));
    size += submit->tail_size();
  } else {
    verdict = connection.device->unlink(now, std::get<Unlink>(*command));
  }
  switch (verdict) {
    case Export::Verdict::served:
      ++counters_.accepted;
      break;
    case Export::Verdict::refused:
      ++counters_.ignored;
      break;
    case Export::Verdict::broken:
      reject(now, connection);
      break;
  }
  return size;
}

void UsbipServer::import(SimTime now, Connection& connection, std::string_view bus_id) {
  const auto found = std::ranges::find_if(
      exports_, [bus_id](const auto& device) { return device->listed().device.bus_id == bus_id; });
  if (found == exports_.end() || !(*found)->plugged() || (*found)->imported()) {
    ++counters_.ignored;
    output_.send(connection.id, now, encode_import_refusal());
    return;
  }
  ++counters_.accepted;
  Export& device = **found;
  connection.device = &device;
  output_.send(connection.id, now, encode_import_reply(device.listed().device));
  device.attach(now, connection.id);
}

void UsbipServer::send_list(SimTime now, const Connection& connection) {
  std::vector<ListedDevice> listed;
  for (const auto& device : exports_) {
    if (device->plugged()) {
      listed.push_back(device->listed());
    }
  }
  output_.send(connection.id, now, encode_device_list(listed));
}

void UsbipServer::reject(SimTime now, Connection& connection) {
  ++counters_.malformed;
  connection.closing = true;
  if (connection.device != nullptr) {
    connection.device->detach(now);
    connection.device = nullptr;
  }
  output_.close(connection.id, now);
}

void UsbipServer::advance(SimTime now) {
  for (SimTime next = next_event(); next <= now; next = next_event()) {
    for (const auto& device : exports_) {
      if (device->device().next_event() <= next) {
        device->device().advance(next);
      }
    }
  }
}

SimTime UsbipServer::next_event() const {
  SimTime next = kNever;
  for (const auto& device : exports_) {
    next = std::min(next, device->device().next_event());
  }
  return next;
}

UsbipServer::Connection* UsbipServer::find(ConnectionId connection) {
  const auto found = std::ranges::find(connections_, connection, &Connection::id);
  return found == connections_.end() ? nullptr : &*found;
}

}  // namespace rigwire::emulators
