#include "hil/command_line/doctor.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>

#include "drivers/can_interface.h"
#include "drivers/descriptor.h"
#include "drivers/published_link.h"
#include "drivers/usb_host.h"
#include "drivers/vhci.h"
#include "hil/files/geoid_file.h"
#include "hil/wires/can_hop.h"

namespace rigwire::hil {

namespace {

namespace fs = std::filesystem;
using drivers::Descriptor;

Finding can_sockets() {
  const Descriptor socket(::socket(AF_CAN, SOCK_RAW, 1 /*CAN_RAW*/));
  if (socket.open()) {
    return {"AF_CAN", Health::good, "the kernel has CAN sockets", ""};
  }
  return {"AF_CAN", Health::limited, fmt::format("no CAN sockets ({})", std::strerror(errno)),
          "sudo modprobe can_raw    (needs a kernel with CAN; hosted machines often lack it)"};
}

std::string shown(const drivers::CanInterface& interface) {
  const std::string rate =
      interface.bit_rate_bps != 0 ? fmt::format(", {} bit/s", interface.bit_rate_bps) : "";
  return fmt::format("{} ({}{}, {})", interface.name, interface.kind, rate,
                     interface.up ? "up" : "down");
}

Finding can_interfaces() {
  const auto interfaces = drivers::can_interfaces();
  std::string text;
  bool usable = false;
  for (const drivers::CanInterface& interface : interfaces) {
    text += (text.empty() ? "" : ", ") + shown(interface);
    usable = usable || interface.up;
  }
  if (usable) {
    return {"CAN interfaces", Health::good, text, ""};
  }
  return {
      "CAN interfaces", Health::limited, text.empty() ? "none" : text,
      "sudo modprobe vcan && sudo ip link add dev vcan0 type vcan && sudo ip link set up vcan0"};
}

/// What `wire: auto` would do here with a bus that is configured by default.
Finding can_wire() {
  const CanWireChoice choice = choose_can_wire({}, examine_can_host());
  const auto found = std::find_if(kCanWires.begin(), kCanWires.end(),
                                  [&](const auto& wire) { return wire.value == choice.wire; });
  return {"CAN wire", Health::good, fmt::format("`auto` takes {}: {}", found->name, choice.why),
          ""};
}

Finding pty() {
  const Descriptor master(::posix_openpt(O_RDWR | O_NOCTTY));
  if (master.open() && ::grantpt(master.get()) == 0 && ::unlockpt(master.get()) == 0) {
    return {"pty", Health::good, "pseudo-terminals can be opened", ""};
  }
  return {"pty", Health::missing, std::string("no pseudo-terminal: ") + std::strerror(errno),
          "mount devpts on /dev/pts"};
}

Finding link_folder() {
  const fs::path folder = "/tmp/rigwire";
  const fs::path asked = fs::exists(folder) ? folder : folder.parent_path();
  constexpr const char* kMend = "give it to yourself, or set `path` of gnss and can elsewhere";
  if (::access(asked.c_str(), W_OK | X_OK) == 0) {
    const std::string danger = drivers::danger_of_link(asked / "gnss");
    return danger.empty() ? Finding{"links", Health::good, "/tmp/rigwire can be written", ""}
                          : Finding{"links", Health::missing, danger, kMend};
  }
  return {"links", Health::missing,
          fmt::format("{} cannot be written: {}", asked.string(), std::strerror(errno)), kMend};
}

std::string user_name() {
  const passwd* const user = ::getpwuid(::geteuid());
  return user == nullptr ? std::to_string(::geteuid()) : user->pw_name;
}

/// Rigwire asks for none itself: `chrt` gives it to the thread of the wires.
Finding real_time_priority() {
  constexpr rlim_t kWanted = 20;
  const std::string use = fmt::format("`chrt -f {} rigwire run RIG`", kWanted);
  rlimit value{};
  ::getrlimit(RLIMIT_RTPRIO, &value);
  if (::geteuid() == 0 || value.rlim_cur == RLIM_INFINITY || value.rlim_cur >= kWanted) {
    return {"real-time priority", Health::good, use + " is permitted", ""};
  }
  return {
      "real-time priority", Health::limited,
      fmt::format("at most {}: {} is refused; without it wires are later on a busy host",
                  value.rlim_cur, use),
      fmt::format("echo '{} - rtprio {}' | sudo tee /etc/security/limits.d/rigwire.conf    (and "
                  "log in again)",
                  user_name(), kWanted)};
}

Finding udp_buffers() {
  constexpr int kWanted = 1 << 20;
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM, 0));
  if (!socket.open()) {
    return {"udp", Health::missing, std::string("no UDP socket: ") + std::strerror(errno),
            "allow IPv4 sockets"};
  }
  int granted = kWanted;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &granted, sizeof(granted));
  socklen_t size = sizeof(granted);
  ::getsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &granted, &size);
  // The kernel doubles what it grants, for its own book-keeping (socket(7)).
  granted /= 2;
  if (granted >= kWanted) {
    return {"udp buffers", Health::good, fmt::format("{} bytes", granted), ""};
  }
  return {"udp buffers", Health::limited,
          fmt::format("{} of {} bytes; a lidar client may lose packets", granted, kWanted),
          fmt::format("sudo sysctl -w net.core.rmem_max={}", kWanted)};
}

Finding tcp_port(std::uint16_t port, const char* owner) {
  const std::string name = fmt::format("tcp {}", port);
  const Descriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
  if (!socket.open()) {
    return {name, Health::missing, std::string("no TCP socket: ") + std::strerror(errno),
            "allow IPv4 sockets"};
  }
  const int reuse = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof(reuse));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    return {name, Health::good, fmt::format("free for {}", owner), ""};
  }
  return {name, Health::missing,
          fmt::format("127.0.0.1:{} is taken ({})", port, std::strerror(errno)),
          fmt::format("ss -ltnp 'sport = :{}' names the owner; or --set devices.{}.port=N", port,
                      owner)};
}

/// The HDL lidars' source port, which one of their clients filters by.
Finding lidar_source_port() {
  constexpr std::uint16_t kPort = 443;
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM, 0));
  const int share = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &share, sizeof(share));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kPort);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    return {"udp 443", Health::good, "HDL lidars send from it, as real ones do", ""};
  }
  return {"udp 443", Health::limited,
          fmt::format("cannot be bound ({}); HDL lidars send from another port, which PCL's "
                      "HDLGrabber drops",
                      std::strerror(errno)),
          "sudo sysctl -w net.ipv4.ip_unprivileged_port_start=443    (or stop the program that has "
          "the port)"};
}

Finding geoid() {
  if (::access(kEgm96File, R_OK) == 0) {
    return {"geoid", Health::good, "EGM96 is installed", ""};
  }
  return {"geoid", Health::limited,
          fmt::format("no {}: {}; rigs with `origin.geoid: egm96` do not start", kEgm96File,
                      std::strerror(errno)),
          "sudo apt-get install proj-data"};
}

Finding processors() {
  const unsigned count = std::thread::hardware_concurrency();
  utsname system{};
  ::uname(&system);
  return {"processors", count >= 2 ? Health::good : Health::limited,
          fmt::format("{} on Linux {}", count, system.release),
          count >= 2 ? "" : "a rig with a lidar wants two"};
}

/// Attaching emulated devices here: vhci-hcd and rights.
Finding usbip_client() {
  const std::string obstacle = drivers::vhci_obstacle();
  if (obstacle.empty()) {
    return {"USB/IP", Health::good, "emulated USB devices can be attached to this kernel", ""};
  }
  const auto split = obstacle.find("; ");
  return {"USB/IP", Health::limited,
          obstacle.substr(0, split) + ": emulated USB devices are served, for other machines",
          obstacle.substr(split + 2)};
}

/// Loaded, or there to be loaded.
bool has_module(const std::string& name) {
  std::error_code ignored;
  if (fs::exists("/sys/module/" + name, ignored)) {
    return true;
  }
  utsname system{};
  ::uname(&system);
  const fs::path folder = fs::path("/lib/modules") / system.release / "kernel/drivers/net/can/usb";
  for (const char* suffix : {".ko", ".ko.xz", ".ko.zst", ".ko.gz"}) {
    if (fs::exists(folder / (name + suffix), ignored)) {
      return true;
    }
  }
  return false;
}

Finding gs_usb_driver() {
  if (has_module("gs_usb")) {
    return {"gs_usb", Health::good, "the kernel makes CAN interfaces of USB adapters", ""};
  }
  return {"gs_usb", Health::limited, "the kernel has no driver for USB to CAN adapters",
          "a kernel with CONFIG_CAN_GS_USB, as Debian's linux-image-amd64 (not the cloud one)"};
}

Finding usbip_program() {
  for (const char* path : {"/usr/sbin/usbip", "/usr/bin/usbip", "/sbin/usbip"}) {
    if (::access(path, X_OK) == 0) {
      return {"usbip", Health::good, std::string(path) + " attaches devices on request", ""};
    }
  }
  return {"usbip", Health::limited, "no program `usbip`", "sudo apt-get install usbip"};
}

Finding usb_devices() {
  try {
    std::string text;
    for (const drivers::UsbListed& device : drivers::list_usb_devices()) {
      text += fmt::format("{}{} {:04x}:{:04x}{}{}{}", text.empty() ? "" : ", ", device.place,
                          device.vendor, device.product, device.product_name.empty() ? "" : " ",
                          device.product_name, device.permitted ? "" : " (not permitted)");
    }
    return {"USB devices", Health::good, text.empty() ? "none" : text, ""};
  } catch (const drivers::EndpointError& error) {
    return {"USB devices", Health::limited, error.what(), "mount /dev and /sys"};
  }
}

}  // namespace

std::vector<Finding> examine_machine() {
  return {
      can_sockets(),   can_interfaces(),    can_wire(),
      pty(),           link_folder(),       real_time_priority(),
      udp_buffers(),   lidar_source_port(), tcp_port(1502, "valves"),
      geoid(),         processors(),        usbip_client(),
      gs_usb_driver(), usbip_program(),     usb_devices(),
  };
}

const char* to_string(Health health) {
  switch (health) {
    case Health::good:
      return "good";
    case Health::limited:
      return "limited";
    case Health::missing:
      break;
  }
  return "missing";
}

}  // namespace rigwire::hil
