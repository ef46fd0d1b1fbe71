#include "hil/wires/rig_usb.h"

#include <algorithm>

namespace rigwire::hil {
namespace {

/// What a client may leave unread: the pictures of a busy bus for a second, and no more.
constexpr std::size_t kBacklogBytes = std::size_t{1} << 20U;

drivers::TcpServerSettings endpoint_settings(const UsbConfiguration& configuration) {
  drivers::TcpServerSettings settings;
  settings.address = configuration.address;
  settings.port = configuration.port;
  settings.allow_remote = configuration.allow_remote;
  settings.backlog_bytes = kBacklogBytes;
  return settings;
}

}  // namespace

RigUsb::RigUsb(const UsbConfiguration& configuration, boost::asio::io_context& io,
               Executive& executive)
    : executive_(executive),
      endpoint_(io, endpoint_settings(configuration)),
      output_(endpoint_),
      server_({}, output_) {
  executive_.add(*this);
  endpoint_.start({
      .connected =
          [this](emulators::ConnectionId connection) {
            server_.connected(executive_.arrive(), connection);
          },
      .received =
          [this](emulators::ConnectionId connection, std::span<const std::uint8_t> bytes) {
            server_.receive(executive_.arrive(), connection, bytes);
          },
      .disconnected =
          [this](emulators::ConnectionId connection) {
            server_.disconnected(executive_.arrive(), connection);
          },
  });
}

UsbBus::Socket RigUsb::plug(emulators::UsbDevice& device, std::string_view name) {
  return server_.add(device, name);
}

void RigUsb::set_plugged(SimTime now, Socket socket, bool plugged) {
  plugged ? server_.plug(now, socket) : server_.unplug(now, socket);
}

void RigUsb::schedule_unplug(Socket socket, SimTime from, SimTime until) {
  changes_.push_back({from, socket, false});
  changes_.push_back({until, socket, true});
  std::ranges::stable_sort(changes_, {}, &PlugChange::time);
}

std::string RigUsb::address(Socket socket) const {
  return "usb" + endpoint_.status().address.substr(3) + " " + server_.bus_id(socket);
}

SimTime RigUsb::next_event() const {
  const SimTime change = next_change_ < changes_.size() ? changes_[next_change_].time : kNever;
  return std::min(change, server_.next_event());
}

void RigUsb::advance(SimTime now) {
  for (; next_change_ < changes_.size() && changes_[next_change_].time <= now; ++next_change_) {
    const PlugChange& change = changes_[next_change_];
    server_.advance(change.time);
    set_plugged(change.time, change.socket, change.plugged);
  }
  server_.advance(now);
}

void RigUsb::Output::send(emulators::ConnectionId connection, SimTime due,
                          std::span<const std::uint8_t> bytes) {
  statistics.hash.add(due, bytes);
  if (endpoint.send(connection, bytes)) {
    ++statistics.units;
    statistics.bytes += bytes.size();
  } else {
    ++statistics.dropped;
  }
}

void RigUsb::Output::close(emulators::ConnectionId connection, SimTime /*due*/) {
  endpoint.close(connection);
}

}  // namespace rigwire::hil
