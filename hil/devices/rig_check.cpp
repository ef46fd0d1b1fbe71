#include "hil/devices/rig_check.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "hil/configuration/suggest.h"
#include "hil/wires/line_ports.h"
#include "protocols/canopen/lss.h"

namespace rigwire::hil {
namespace {

std::string quoted(const std::string& text) {
  return "\"" + text + "\"";
}

template <class Content>
std::vector<std::string> names_of(const std::map<std::string, Content>& map) {
  std::vector<std::string> names;
  for (const auto& [name, content] : map) {
    names.push_back(name);
  }
  return names;
}

}  // namespace

std::string usb_wire(const RigView& rig) {
  return fmt::format("usb {}:{}", rig.usb.address, rig.usb.port);
}

void RigCheck::report(const std::string& path, std::string what, std::string found,
                      std::string allowed, std::string suggestion) {
  problems_.add({origins_.nearest(path), path, std::move(what), std::move(found),
                 std::move(allowed), std::move(suggestion)});
}

void RigCheck::without_effect(const std::string& path, const std::string& cause,
                              const std::string& why, const std::string& found,
                              const std::string& allowed) {
  const Location written = origins_.of(path);
  if (written.source != nullptr && written.layer >= origins_.of(cause).layer) {
    report(path, "has no effect: " + why, found, allowed);
  }
}

void RigCheck::claim(const std::string& path, const std::string& resource,
                     const std::string& shown) {
  const auto [owner, fresh] = owners_.emplace(resource, path);
  if (!fresh) {
    report(path, fmt::format("already taken by {}", owner->second), quoted(shown));
  }
}

void RigCheck::one_of(const std::string& path, const std::string& what, const std::string& found,
                      const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), found) == names.end()) {
    report(path, what, quoted(found), join_words(names), nearest_word(found, names));
  }
}

void RigCheck::link(const std::string& path, const std::string& link) {
  one_of(path, "no such link of the machine", link, rig_.links);
}

void RigCheck::file_path(const std::string& path, const std::string& file) {
  if (file.empty() || file.front() != '/' || file.back() == '/') {
    report(path, "must be an absolute path", quoted(file), "a path like /tmp/rigwire/gnss");
  } else if (file.starts_with("/dev/") && !file.starts_with("/dev/shm/")) {
    report(path, "is the place of a device, where the program would put a link to its own terminal",
           quoted(file),
           "a path like /tmp/rigwire/gnss; another program joins it to a real serial line (socat)");
  }
  claim(path, "path " + file, file);
}

void RigCheck::port_paths(const std::string& path, const std::string& file, unsigned ports) {
  file_path(path + ".path", file);
  for (unsigned port = 1; port < ports; ++port) {
    claim(path + ".ports", "path " + port_path(file, port), port_path(file, port));
  }
}

void RigCheck::address(const std::string& path, const std::string& address, bool allow_remote) {
  std::array<std::uint8_t, 4> parts{};
  if (::inet_pton(AF_INET, address.c_str(), parts.data()) != 1) {
    report(path, "not an IPv4 address", quoted(address), "four numbers like 127.0.0.1");
    return;
  }
  if (parts[0] != 127 && !allow_remote) {
    report(path, "reaches beyond this machine without the device's `allow_remote: true`",
           quoted(address), "127.0.0.0 .. 127.255.255.255");
  }
}

void RigCheck::listener(const std::string& path, const std::string& listening, std::uint16_t port,
                        bool allow_remote) {
  address(path + ".address", listening, allow_remote);
  claim(path + ".port", fmt::format("tcp {}:{}", listening, port), std::to_string(port));
}

bool RigCheck::bus(const std::string& path, const std::string& bus) {
  one_of(path + ".bus", "no such bus", bus, names_of(rig_.buses));
  return rig_.buses.contains(bus);
}

bool RigCheck::modbus_line(const std::string& path, const std::string& line) {
  one_of(path + ".line", "no such Modbus line", line, names_of(rig_.modbus));
  return rig_.modbus.contains(line);
}

bool RigCheck::duplicates(const std::string& bus) const {
  const auto found = rig_.buses.find(bus);
  return found != rig_.buses.end() && found->second.duplicate_addresses;
}

void RigCheck::j1939_node(const std::string& path, const std::string& on_bus, unsigned address,
                          std::uint32_t serial) {
  if (!bus(path, on_bus)) {
    return;
  }
  if (!duplicates(on_bus)) {
    claim(path + ".source_address", fmt::format("{} address {}", on_bus, address),
          std::to_string(address));
  }
  claim(path + ".serial", fmt::format("{} serial {}", on_bus, serial), std::to_string(serial));
}

void RigCheck::canopen_node(const std::string& path, const std::string& on_bus, unsigned node_id) {
  bus(path, on_bus);
  if (!duplicates(on_bus) && node_id != protocols::canopen::kNoNodeId) {
    claim(path + ".node_id", fmt::format("{} node {}", on_bus, node_id), std::to_string(node_id));
  }
}

void RigCheck::usb() {
  address("usb.address", rig_.usb.address, rig_.usb.allow_remote);
  if (!std::exchange(usb_claimed_, true)) {
    claim("usb.port", fmt::format("tcp {}:{}", rig_.usb.address, rig_.usb.port),
          std::to_string(rig_.usb.port));
  }
}

void RigCheck::receiver(const std::string& path, const std::string& source,
                        const std::vector<std::string>& words) {
  std::vector<std::string> names = words;
  names.insert(names.end(), rig_.receivers.begin(), rig_.receivers.end());
  one_of(path, "no such satellite receiver", source, names);
}

void RigCheck::base_station(const std::string& path, const std::string& source,
                            const std::string& self) {
  std::vector<std::string> names = rig_.base_stations;
  std::erase(names, self);
  one_of(path, "no such base station", source, names);
}

void RigCheck::valve_block(const std::string& path, const std::vector<std::string>& sections) {
  if (rig_.actuators.empty()) {
    report(path + ".type", "the machine has no valve block", "", "an excavator");
    return;
  }
  for (std::size_t i = 0; i < sections.size(); ++i) {
    one_of(fmt::format("{}.sections.{}", path, i), "no such actuator of the machine", sections[i],
           rig_.actuators);
  }
}

}  // namespace rigwire::hil
