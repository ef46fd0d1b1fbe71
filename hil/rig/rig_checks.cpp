// How the parts of a rig go together. Nothing here repeats what a single field's range says.
#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hil/configuration/document.h"
#include "hil/configuration/suggest.h"
#include "hil/devices/bus_devices.h"
#include "hil/rig/rig_configuration.h"
#include "protocols/can/frame_text.h"

namespace rigwire::hil {

namespace {

class Checker {
 public:
  Checker(const RigConfiguration& rig, const Origins& origins, Problems& problems)
      : rig_(rig), origins_(origins), problems_(problems), known_(problems.sorted()) {
    for (const std::string_view link : link_names(rig.machine.settings)) {
      links_.emplace_back(link);
    }
    for (const auto& [name, bus] : rig.buses) {
      bus_names_.push_back(name);
    }
    for (const auto& [name, line] : rig.modbus) {
      line_names_.push_back(name);
    }
  }

  void run() {
    check_time();
    check_machine();
    for (const auto& [name, bus] : rig_.buses) {
      if (!faulty("buses." + name)) {
        check_bus(name, bus);
      }
    }
    for (const auto& [name, line] : rig_.modbus) {
      if (!faulty("modbus." + name)) {
        check_modbus_line("modbus." + name, line);
      }
    }
    for (const auto& [name, device] : rig_.devices) {
      const std::string path = "devices." + name;
      if (!faulty(path)) {
        std::visit([&](const auto& settings) { check_device(path, settings); }, device.settings);
      }
    }
    for (const auto& [name, bus] : rig_.buses) {
      check_load(name, bus);
    }
  }

 private:
  void report(const std::string& path, std::string what, std::string found = {},
              std::string allowed = {}, std::string suggestion = {}) {
    problems_.add({origins_.nearest(path), path, std::move(what), std::move(found),
                   std::move(allowed), std::move(suggestion)});
  }

  /// Something below was not read, so that its members are defaults that nobody asked for.
  [[nodiscard]] bool faulty(const std::string& path) const {
    return std::any_of(known_.begin(), known_.end(), [&](const Problem& problem) {
      return problem.path == path || problem.path.starts_with(path + ".");
    });
  }

  void check_time() {
    if (faulty("lead") || faulty("step") || faulty("slice")) {
      return;
    }
    if (rig_.slice % rig_.step != Duration{0}) {
      report("slice", "must be a whole number of steps", fields::print_duration(rig_.slice.count()),
             "multiples of step = " + fields::print_duration(rig_.step.count()));
    }
    if (rig_.lead < rig_.slice) {
      report("lead", "must not be less than a slice", fields::print_duration(rig_.lead.count()),
             ">= " + fields::print_duration(rig_.slice.count()));
    }
  }

  void check_machine() {
    for (std::size_t i = 0; i < rig_.machine.shapes.size(); ++i) {
      check_link(fmt::format("machine.shapes.{}.link", i), rig_.machine.shapes[i].link);
    }
  }

  void check_link(const std::string& path, const std::string& link) {
    if (std::find(links_.begin(), links_.end(), link) == links_.end()) {
      report(path, "no such link of the machine", "\"" + link + "\"", join_words(links_),
             nearest_word(link, links_));
    }
  }

  /// `key` is the resource that only one part of the rig can own.
  void claim(const std::string& path, const std::string& key, const std::string& shown) {
    const auto [it, fresh] = owners_.emplace(key, path);
    if (!fresh) {
      report(path, fmt::format("already taken by {}", it->second), "\"" + shown + "\"");
    }
  }

  void check_path(const std::string& path, const std::string& file) {
    if (file.empty() || file.front() != '/' || file.back() == '/') {
      report(path, "must be an absolute path", "\"" + file + "\"", "a path like /tmp/rigwire/gnss");
    }
    claim(path, "path " + file, file);
  }

  void check_address(const std::string& path, const std::string& address, bool allow_remote) {
    std::array<std::uint8_t, 4> parts{};
    if (::inet_pton(AF_INET, address.c_str(), parts.data()) != 1) {
      report(path, "not an IPv4 address", "\"" + address + "\"", "four numbers like 127.0.0.1");
      return;
    }
    if (parts[0] != 127 && !allow_remote) {
      report(path, "reaches beyond this machine without the device's `allow_remote: true`",
             "\"" + address + "\"", "127.0.0.0 .. 127.255.255.255");
    }
  }

  void check_bus(const std::string& name, const BusConfiguration& bus) {
    const std::string path = "buses." + name;
    if (bus.wire == CanWire::gs_usb) {
      check_usb();
    }
    if (bus.wire == CanWire::slcan || bus.wire == CanWire::automatic) {
      check_path(path + ".path", bus.path);
    }
    if (bus.wire == CanWire::socketcan || bus.wire == CanWire::automatic) {
      constexpr std::size_t kLongestInterface = 15;  // IFNAMSIZ - 1
      if (bus.interface.empty() || bus.interface.size() > kLongestInterface) {
        report(path + ".interface", "not an interface name", "\"" + bus.interface + "\"",
               "1 .. 15 characters");
      }
      claim(path + ".interface", "interface " + bus.interface, bus.interface);
    }
    for (std::size_t i = 0; i < bus.faults.size(); ++i) {
      check_bus_fault(fmt::format("{}.faults.{}", path, i), name, bus.faults[i]);
    }
  }

  void check_bus_fault(const std::string& path, const std::string& bus,
                       const CanFaultConfiguration& fault) {
    if (const std::string device = device_of(fault); !device.empty()) {
      std::vector<std::string> names = devices_on(rig_, bus);
      names.emplace_back(kClientNode);
      if (std::find(names.begin(), names.end(), device) == names.end()) {
        report(path + ".device", "not on this bus", "\"" + device + "\"", join_words(names),
               nearest_word(device, names));
      }
    }
    if (const auto* intruder = std::get_if<IntruderFault>(&fault.settings)) {
      if (!protocols::can::parse_frame_text(intruder->frame)) {
        report(path + ".frame", "not a frame", "\"" + intruder->frame + "\"",
               "18EAFFFE#00EE00, 123#, 123#R4");
      }
    }
  }

  /// For every device on USB: they share one server.
  void check_usb() {
    check_address("usb.address", rig_.usb.address, rig_.usb.allow_remote);
    if (!std::exchange(usb_claimed_, true)) {
      claim("usb.port", fmt::format("tcp {}:{}", rig_.usb.address, rig_.usb.port),
            std::to_string(rig_.usb.port));
    }
  }

  void check_device(const std::string& path, const UbloxConfiguration& device) {
    if (device.wire == SerialWire::pty) {
      check_path(path + ".path", device.path);
    } else {
      check_usb();
    }
    check_link(path + ".mount.link", device.mount.link);
  }

  void check_device(const std::string& path, const StarFireConfiguration& device) {
    if (!device.path.empty()) {
      check_path(path + ".path", device.path);
    }
    if (!device.bus.empty()) {
      check_node(path, device.bus, device.receiver.source_address, device.receiver.serial);
    }
    check_link(path + ".mount.link", device.mount.link);
    for (std::size_t i = 0; i < device.faults.size(); ++i) {
      if (!implements(device, device.faults[i])) {
        report(fmt::format("{}.faults.{}.type", path, i),
               "this device does not implement that fault",
               fmt::format("\"{}\"", device.faults[i].type()), "those of signals and antenna");
      }
    }
  }

  void check_device(const std::string& path, const VelodyneConfiguration& device) {
    const auto claim_port = [&](const char* key, const std::string& where, std::uint16_t port) {
      claim(path + key, fmt::format("{}:{}", where, port), std::to_string(port));
    };
    check_address(path + ".address", device.lidar.host_address, device.allow_remote);
    check_link(path + ".mount.link", device.mount.link);
    claim_port(".port", "udp " + device.lidar.host_address, device.lidar.data_port);
    if (model_of(device).position_layout != protocols::velodyne::PositionLayout::none) {
      claim_port(".position_port", "udp " + device.lidar.host_address, device.lidar.telemetry_port);
    }
    if (!device.source_address.empty()) {
      check_address(path + ".source_address", device.source_address, true);
    }
    if (device.web.port != 0) {
      check_address(path + ".web.address", device.web.address, device.allow_remote);
      claim_port(".web.port", "tcp " + device.web.address, device.web.port);
    }
    check_time_source(path + ".time_source", device.time_source);
  }

  void check_time_source(const std::string& path, const std::string& source) {
    using Lidar = VelodyneConfiguration;
    std::vector<std::string> words;
    for (const auto name : {Lidar::kAutomaticTimeSource, Lidar::kIdealTimeSource,
                            Lidar::kPulseTimeSource, Lidar::kNoTimeSource}) {
      words.emplace_back(name);
    }
    check_receiver(path, source, std::move(words));
  }

  /// `source` is one of the words or a receiver of the rig.
  void check_receiver(const std::string& path, const std::string& source,
                      std::vector<std::string> names) {
    for (const auto& [name, device] : rig_.devices) {
      if (is_receiver(device.settings)) {
        names.push_back(name);
      }
    }
    if (std::find(names.begin(), names.end(), source) == names.end()) {
      report(path, "no such satellite receiver", "\"" + source + "\"", join_words(names),
             nearest_word(source, names));
    }
  }

  void check_device(const std::string& path, const OpenImuDeviceConfiguration& device) {
    check_link(path + ".mount.link", device.mount.link);
    check_node(path, device.bus, device.imu.source_address, device.imu.serial);
  }

  void check_bus_name(const std::string& path, const std::string& bus) {
    if (!rig_.buses.contains(bus)) {
      report(path + ".bus", "no such bus", "\"" + bus + "\"", join_words(bus_names_),
             nearest_word(bus, bus_names_));
    }
  }

  void check_device(const std::string& path, const XsensMtiConfiguration& device) {
    check_link(path + ".mount.link", device.mount.link);
    check_bus_name(path, device.bus);
    // Its identifiers are fixed: a second unit on the bus would send the same ones.
    claim(path + ".bus", fmt::format("{} mti {}", device.bus, device.mti.extended), device.bus);
  }

  void check_device(const std::string& path, const EncoderDeviceConfiguration& device) {
    check_link(path + ".base", device.base);
    check_link(path + ".link", device.link);
    if (device.base == device.link) {
      report(path + ".link", "turns against itself", "\"" + device.link + "\"",
             "another link than `base`");
    }
    check_bus_name(path, device.bus);
    const bool duplicates =
        rig_.buses.contains(device.bus) && rig_.buses.at(device.bus).duplicate_addresses;
    if (!duplicates) {
      claim(path + ".node_id", fmt::format("{} node {}", device.bus, device.encoder.node.node_id),
            std::to_string(device.encoder.node.node_id));
    }
  }

  void check_device(const std::string& path, const VehicleGatewayDeviceConfiguration& device) {
    check_node(path, device.bus, device.gateway.source_address, device.gateway.serial);
    if (!device.position_from.empty()) {
      check_receiver(path + ".position_from", device.position_from, {});
    }
    if (std::holds_alternative<ExcavatorMachine>(rig_.machine.settings)) {
      report(path + ".type", "the machine has no drive train", "", "a machine that drives");
    }
  }

  void check_device(const std::string& path, const IsoValvesConfiguration& device) {
    check_node(path, device.bus, device.valves.source_address, device.valves.serial);
    check_valve_block(path);
  }

  void check_valve_block(const std::string& path) {
    if (!std::holds_alternative<ExcavatorMachine>(rig_.machine.settings)) {
      report(path + ".type", "the machine has no valve block", "", "an excavator");
    }
  }

  void check_node(const std::string& path, const std::string& bus, unsigned address,
                  std::uint32_t serial) {
    if (!rig_.buses.contains(bus)) {
      report(path + ".bus", "no such bus", "\"" + bus + "\"", join_words(bus_names_),
             nearest_word(bus, bus_names_));
      return;
    }
    if (!rig_.buses.at(bus).duplicate_addresses) {
      claim(path + ".source_address", fmt::format("{} address {}", bus, address),
            std::to_string(address));
    }
    claim(path + ".serial", fmt::format("{} serial {}", bus, serial), std::to_string(serial));
  }

  void check_listener(const std::string& path, const std::string& address, std::uint16_t port,
                      bool allow_remote) {
    check_address(path + ".address", address, allow_remote);
    claim(path + ".port", fmt::format("tcp {}:{}", address, port), std::to_string(port));
  }

  void check_modbus_line(const std::string& path, const ModbusLineConfiguration& line) {
    if (line.wire == emulators::ModbusWire::rtu) {
      check_path(path + ".path", line.path);
    } else {
      check_listener(path, line.address, line.port, line.allow_remote);
    }
  }

  void check_device(const std::string& path, const ValveDriverConfiguration& device) {
    if (device.line.empty()) {
      check_listener(path, device.address, device.port, device.allow_remote);
    } else if (!rig_.modbus.contains(device.line)) {
      report(path + ".line", "no such Modbus line", "\"" + device.line + "\"",
             join_words(line_names_), nearest_word(device.line, line_names_));
    } else {
      claim(path + ".unit", fmt::format("{} unit {}", device.line, device.unit),
            std::to_string(device.unit));
    }
    check_valve_block(path);
  }

  void check_device(const std::string& path, const UsbPassThroughConfiguration& device) {
    check_usb();
    claim(path + ".device", "USB device " + device.device, device.device);
  }

  void check_device(const std::string& path, const UsbJoystickConfiguration& device) {
    check_usb();
    if (device.source == LeverSource::commands &&
        !std::holds_alternative<ExcavatorMachine>(rig_.machine.settings)) {
      report(path + ".source", "the machine has no valve block", "commands", "script");
    }
  }

  /// Frames of data per second against the bit rate.
  void check_load(const std::string& name, const BusConfiguration& bus) {
    // Extended data frame with 8 bytes: 67 bits of frame and interframe space around 64 bits of
    // data, and at worst one stuff bit for every four of the 118 bits that are stuffed.
    constexpr double kBitsPerFrame = 67 + 64 + 118 / 4;
    double frames = 0.0;
    for (const auto& [device_name, device] : rig_.devices) {
      if (!faulty("devices." + device_name)) {
        frames += frame_rate_on(name, device);
      }
    }
    const double needed = frames * kBitsPerFrame;
    if (needed > static_cast<double>(bus.bus.bit_rate_bps)) {
      report("buses." + name + ".bitrate",
             fmt::format("the devices of this bus send up to {:.0f} frames/s, {:.0f} bit/s", frames,
                         needed),
             fmt::format("{} bit/s", bus.bus.bit_rate_bps),
             fmt::format(">= {:.0f} bit/s, or a lower rate of the devices", needed));
    }
  }

  const RigConfiguration& rig_;
  const Origins& origins_;
  Problems& problems_;
  std::vector<Problem> known_;  ///< Found while reading.
  std::vector<std::string> links_;
  std::vector<std::string> bus_names_;
  std::vector<std::string> line_names_;  ///< Modbus.
  std::map<std::string, std::string> owners_;
  bool usb_claimed_ = false;
};

}  // namespace

void check_rig(const RigConfiguration& configuration, const Origins& origins, Problems& problems) {
  Checker(configuration, origins, problems).run();
}

}  // namespace rigwire::hil
