// What a rig will do, from its configuration alone.
#include <fmt/format.h>

#include "hil/command_line/verbs.h"
#include "hil/devices/frame_rate.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/packet_layout.h"

namespace rigwire::hil {

namespace {

using Row = std::vector<std::string>;

std::string usb_text(const RigConfiguration& rig) {
  return fmt::format("usb {}:{}", rig.usb.address, rig.usb.port);
}

Row plan(const RigConfiguration& rig, const UbloxConfiguration& device) {
  double bytes = 0.0;
  const double rate_hz = 1.0 / to_seconds(device.receiver.measurement_period);
  for (const auto& names : {device.receiver.nmea_sentences, device.receiver.ubx_messages}) {
    for (const std::string& name : names) {
      const emulators::UbloxProfile& profile = *device.receiver.profile;
      const std::size_t index = emulators::message_index(profile, name);
      if (index < profile.messages.size()) {
        bytes += static_cast<double>(profile.messages[index].greatest_bytes) * rate_hz;
      }
    }
  }
  constexpr double kBitsPerByte = 10.0;  // 8N1
  const std::string wire = device.wire == SerialWire::pty ? "pty " + device.path : usb_text(rig);
  return {fmt::format("{} at {} baud", wire, device.receiver.baud),
          fmt::format("{:.3g} epochs/s", rate_hz), fmt::format("<= {:.0f} B/s", bytes),
          fmt::format("{:.0f} % of the line", 100.0 * bytes * kBitsPerByte / device.receiver.baud)};
}

Row plan(const RigConfiguration&, const StarFireConfiguration& device) {
  const double rate_hz = 1.0 / to_seconds(device.receiver.sentence_period);
  std::string wire = device.path.empty()
                         ? std::string()
                         : fmt::format("pty {} at {} baud", device.path, device.receiver.baud);
  if (!device.bus.empty()) {
    wire += fmt::format("{}can {}, address 0x{:02X}", wire.empty() ? "" : "; ", device.bus,
                        device.receiver.source_address);
  }
  return {wire, fmt::format("{:.3g} epochs/s", rate_hz),
          device.bus.empty() ? "" : fmt::format("{:.1f} frames/s", frame_rate_hz(device)),
          fmt::format("{} sentences", device.receiver.sentences.size())};
}

Row plan(const RigConfiguration&, const VelodyneConfiguration& device) {
  const double packets_hz =
      1e9 / protocols::velodyne::packet_period_ns(model_of(device), device.lidar.return_mode);
  std::string wire = fmt::format("udp {}:{}", device.lidar.host_address, device.lidar.data_port);
  if (model_of(device).position_layout != protocols::velodyne::PositionLayout::none) {
    wire += fmt::format(" and {}", device.lidar.telemetry_port);
  }
  if (device.web.port != 0) {
    wire += fmt::format("; http {}:{}", device.web.address, device.web.port);
  }
  return {wire, fmt::format("{:.1f} packets/s", packets_hz),
          fmt::format("{:.0f} B/s", packets_hz * protocols::velodyne::kDataPacketSize),
          fmt::format("{:.0f} rpm", device.lidar.rotor_rpm)};
}

/// A node of a bus that sends frames of 8 bytes.
Row plan_node(const RigConfiguration& rig, const std::string& bus_name, unsigned address,
              double frames_hz, const std::string& with) {
  const auto bus = rig.buses.find(bus_name);
  return {bus == rig.buses.end() ? bus_name
                                 : fmt::format("can {} at {} bit/s, address 0x{:02X}", bus_name,
                                               bus->second.bus.bit_rate_bps, address),
          fmt::format("{:.0f} frames/s", frames_hz), fmt::format("{:.0f} B/s", frames_hz * 8),
          with};
}

Row plan(const RigConfiguration& rig, const OpenImuDeviceConfiguration& device) {
  const unsigned divider = device.imu.configuration.rate_divider;
  const std::string with =
      divider == 0 ? "silent" : fmt::format("each message at {:.0f} Hz", 100.0 / divider);
  return plan_node(rig, device.bus, device.imu.source_address, frame_rate_hz(device), with);
}

Row plan_can(const RigConfiguration& rig, const std::string& bus_name, const std::string& who,
             double frames_hz, const std::string& with) {
  const auto bus = rig.buses.find(bus_name);
  return {bus == rig.buses.end()
              ? bus_name
              : fmt::format("can {} at {} bit/s, {}", bus_name, bus->second.bus.bit_rate_bps, who),
          fmt::format("{:.0f} frames/s", frames_hz), "", with};
}

Row plan(const RigConfiguration& rig, const XsensMtiConfiguration& device) {
  return plan_can(rig, device.bus, device.mti.extended ? "29-bit" : "11-bit", frame_rate_hz(device),
                  "nothing is received");
}

Row plan(const RigConfiguration& rig, const EncoderDeviceConfiguration& device) {
  return plan_can(rig, device.bus, fmt::format("node {}", device.encoder.node.node_id),
                  frame_rate_hz(device),
                  fmt::format("{} bits, {} against {}", device.encoder.resolution_bits, device.link,
                              device.base));
}

Row plan(const RigConfiguration& rig, const IsoValvesConfiguration& device) {
  return plan_node(rig, device.bus, device.valves.source_address, frame_rate_hz(device),
                   fmt::format("{} sections, neutral {} after the last command",
                               device.valves.amplifier.sections.size(),
                               fields::print_duration(device.valves.command_timeout.count())));
}

Row plan(const RigConfiguration& rig, const VehicleGatewayDeviceConfiguration& device) {
  return plan_node(rig, device.bus, device.gateway.source_address, frame_rate_hz(device),
                   fmt::format("stops {} after the last guidance command",
                               fields::print_duration(device.gateway.timeouts.guidance.count())));
}

/// The wire of a Modbus device.
std::string modbus_wire(const RigConfiguration& rig, const ValveDriverConfiguration& device) {
  const auto line = rig.modbus.find(device.line);
  if (line == rig.modbus.end()) {
    return fmt::format("modbus tcp {}:{}", device.address, device.port);
  }
  const ModbusLineConfiguration& shared = line->second;
  return shared.wire == emulators::ModbusWire::rtu
             ? fmt::format("{}: modbus rtu {} {} bit/s", line->first, shared.path,
                           shared.line.timing.baud)
             : fmt::format("{}: modbus tcp {}:{}", line->first, shared.address, shared.port);
}

Row plan(const RigConfiguration& rig, const ValveDriverConfiguration& device) {
  return {modbus_wire(rig, device), "on request", "",
          fmt::format("unit {}, {} sections, watchdog {}", device.unit,
                      device.driver.amplifier.sections.size(),
                      fields::print_duration(device.driver.amplifier.parameters.watchdog.count()))};
}

Row plan(const RigConfiguration& rig, const UsbJoystickConfiguration& device) {
  return {
      fmt::format("usb {}:{}", rig.usb.address, rig.usb.port),
      fmt::format("when moved, each {} at most", fields::print_duration(device.joystick.interval.count())),
      "",
      device.source == LeverSource::script ? fmt::format("{} keyframes", device.script.size())
                                           : "as the valves are told"};
}

Row plan(const RigConfiguration& rig, const UsbPassThroughConfiguration& device) {
  return {fmt::format("usb {}:{}", rig.usb.address, rig.usb.port), "as it does", "",
          "the real " + device.device};
}

}  // namespace

std::string plan_text(const RigConfiguration& configuration) {
  std::vector<Row> rows{{"device", "type", "wire", "sends", "bytes", "with"}};
  for (const auto& [name, device] : configuration.devices) {
    Row row{name, std::string(device.type())};
    const Row rest = std::visit([&](const auto& settings) { return plan(configuration, settings); },
                                device.settings);
    row.insert(row.end(), rest.begin(), rest.end());
    rows.push_back(std::move(row));
  }
  return table_text(rows);
}

}  // namespace rigwire::hil
