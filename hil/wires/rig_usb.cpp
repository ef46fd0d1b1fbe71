#include "hil/wires/rig_usb.h"

#include <algorithm>

#include "fields/check.h"

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
  const Socket socket = server_.add(device, name);
  plugs_.try_emplace(socket);
  return socket;
}

FaultBook<PlugFault>::Id RigUsb::begin(Socket socket, const PlugFault& fault) {
  fields::check(fault);
  Plug& plug = plugs_.at(socket);
  const auto id = plug.faults.add(fault);
  find_next_change(plug);
  return id;
}

bool RigUsb::end(Socket socket, FaultBook<PlugFault>::Id id, SimTime now) {
  Plug& plug = plugs_.at(socket);
  const bool ended = plug.faults.end(id, now);
  find_next_change(plug);
  return ended;
}

FaultBook<emulators::SupplyFault>::Id RigUsb::begin(Socket socket,
                                                    const emulators::SupplyFault& fault) {
  fields::check(fault);
  Plug& plug = plugs_.at(socket);
  const auto id = plug.outages.add(fault);
  find_next_change(plug);
  return id;
}

bool RigUsb::end_outage(Socket socket, FaultBook<emulators::SupplyFault>::Id id, SimTime now) {
  Plug& plug = plugs_.at(socket);
  const bool ended = plug.outages.end(id, now);
  find_next_change(plug);
  return ended;
}

void RigUsb::find_next_change(Plug& plug) const {
  const auto is_out = [&plug](SimTime instant) {
    return plug.faults.first<UnpluggedFault>(instant) != nullptr ||
           plug.outages.first<emulators::NoSupplyFault>(instant) != nullptr;
  };
  SimTime instant = advanced_;
  while (instant != kNever && is_out(instant) == plug.out) {
    instant = std::min(plug.faults.next_change<>(instant), plug.outages.next_change<>(instant));
  }
  plug.next_change = instant;
}

std::string RigUsb::address(Socket socket) const {
  return "usb" + endpoint_.status().address.substr(3) + " " + server_.bus_id(socket);
}

SimTime RigUsb::next_event() const {
  SimTime next = server_.next_event();
  for (const auto& [socket, plug] : plugs_) {
    next = std::min(next, plug.next_change);
  }
  return next;
}

void RigUsb::advance(SimTime now) {
  const auto earliest = [this] {
    return std::ranges::min_element(
        plugs_, {}, [](const auto& socket_and_plug) { return socket_and_plug.second.next_change; });
  };
  for (auto next = earliest(); next != plugs_.end() && next->second.next_change <= now;
       next = earliest()) {
    auto& [socket, plug] = *next;
    advanced_ = plug.next_change;
    server_.advance(advanced_);
    plug.out = !plug.out;
    plug.out ? server_.unplug(advanced_, socket) : server_.plug(advanced_, socket);
    find_next_change(plug);
  }
  advanced_ = now;
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
