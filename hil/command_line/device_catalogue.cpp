#include "hil/command_line/device_catalogue.h"

#include <fmt/format.h>

#include "emulators/iso_valve/iso_valves.h"
#include "emulators/starfire/receiver.h"
#include "emulators/ublox/receiver.h"
#include "emulators/vehicle_gateway/report.h"
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "emulators/velodyne/velodyne_lidar.h"
#include "hil/configuration/outline.h"
#include "hil/devices/device_types.h"
#include "protocols/vehicle/identification.h"
#include "protocols/velodyne/packet_layout.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

namespace {

/// Outputs that lead nowhere: devices are only built to be asked what they can carry.
class NoBytes final : public emulators::ByteOutput {
 public:
  void send(SimTime, std::span<const std::uint8_t>) override {}
};
class NoFrames final : public emulators::FrameOutput {
 public:
  void send(SimTime, const protocols::can::Frame&) override {}
};

std::vector<DescribedQuantity> quantities_of(const emulators::Device& device) {
  std::vector<DescribedQuantity> result;
  for (const emulators::Quantity& quantity : device.quantities()) {
    result.push_back({std::string(quantity.name), std::string(quantity.unit), quantity.lower,
                      quantity.upper, quantity.resolution});
  }
  return result;
}

void describe(const UbloxConfiguration& configuration, DeviceDescription& description) {
  NoBytes output;
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  description.quantities =
      quantities_of(emulators::UbloxReceiver(configuration.receiver, calendar, output));
  description.wire = "serial line on a pty, 8N1; or USB (CDC-ACM) by USB/IP";
  switch (configuration.receiver.profile->generation) {
    case 7:
      description.document =
          "u-blox M8 receiver description UBX-13003221 R28, with what recordings of a NEO-7P show "
          "of protocol 14";
      break;
    case 8:
      description.document = "u-blox M8 receiver description UBX-13003221 R28";
      break;
    default:
      description.document = "u-blox ZED-F9P interface description, HPG 1.13 to 1.51";
      break;
  }
  for (const emulators::UbloxMessage& message : configuration.receiver.profile->messages) {
    if (!message.name.empty() && message.greatest_bytes > 0) {
      description.messages.push_back(
          {(message.sentence ? "NMEA " : "UBX ") + std::string(message.name), "each epoch",
           fmt::format("class {:#04x} id {:#04x}, at most {} bytes", message.id.message_class,
                       message.id.message_id, message.greatest_bytes)});
    }
  }
}

void describe(const StarFireConfiguration& configuration, DeviceDescription& description) {
  NoBytes output;
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  description.quantities =
      quantities_of(emulators::StarFireReceiver(configuration.receiver, calendar, output));
  description.wire = "serial line on a pty, 8N1; CAN 2.0B at 250 kbit/s, J1939; either or both";
  description.document =
      "Operator's manual OMPFP11008 (serial output); SAE J1939-71, -81; NMEA 0183; what is not "
      "documented is marked in the page";
  description.messages = {
      {"GGA GSA RMC VTG ZDA", "1, 5 or 10 Hz", "NMEA sentences on the serial line"},
      {"65267 FEF3 vehicle position", "5 Hz", "latitude, longitude"},
      {"65256 FEE8 vehicle direction and speed", "5 Hz", "course, speed, pitch, altitude"},
      {"64502 FBF6 vehicle position 2", "0.2 Hz", "satellites, dilutions"}};
}

namespace velodyne = protocols::velodyne;

std::string document_of(std::string_view model) {
  if (model.starts_with("HDL-32")) {
    return "Velodyne HDL-32E user's manual 63-9113 Rev. E and H";
  }
  if (model.starts_with("HDL-64")) {
    return "Velodyne HDL-64E S2 and S2.1 user's manual, S3 user's manual 63-HDL64ES3 Rev. J";
  }
  if (model.starts_with("VLP-32")) {
    return "Velodyne VLP-32C user's manual 63-9325 Rev. B";
  }
  if (model.starts_with("VLS")) {
    return "Velodyne VLS-128 user's manual 63-9483 Rev. A (draft)";
  }
  return "Velodyne VLP-16 user's manual 63-9243 Rev. D";
}

void describe(const VelodyneConfiguration& configuration, DeviceDescription& description) {
  NoBytes output;
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  const emulators::VelodyneLidar device(settings_of(configuration), calendar, output, output);
  description.quantities = quantities_of(device);
  const velodyne::Model& model = model_of(configuration);
  const double data_hz = 1e9 / velodyne::packet_period_ns(model, velodyne::ReturnMode::strongest);
  const bool positions = model.position_layout != velodyne::PositionLayout::none;
  description.wire = positions ? "UDP: data packets to port 2368, position packets to port 8308"
                               : "UDP: data packets to port 2368";
  description.document = document_of(model.name);
  description.messages = {
      {"data packet", fmt::format("{:.1f} /s", data_hz),
       fmt::format("1206 bytes: {} firings of {} lasers, azimuth, time of hour",
                   velodyne::firings_per_packet(model, velodyne::ReturnMode::strongest),
                   model.lasers.size())}};
  if (positions) {
    description.messages.push_back({"position packet",
                                    fmt::format("{:.1f} /s", device.nominal_rate_hz() - data_hz),
                                    "512 bytes: time of hour, PPS state, $GPRMC sentence"});
  } else {
    description.messages.push_back(
        {"status channel", "each data packet", "2 bytes: time, state and calibration by turns"});
  }
  if (!model.status_channel) {
    description.wire += "; HTTP where `web.port` is set";
    description.messages.push_back(
        {"web interface", "on request", "settings, status, diagnostics (velodyne-web.md)"});
  }
}

void describe(const OpenImuDeviceConfiguration& configuration, DeviceDescription& description) {
  NoFrames output;
  description.quantities = quantities_of(emulators::OpenImu(configuration.imu, output));
  description.wire = "CAN 2.0B at 250 kbit/s, J1939: SocketCAN or slcan on a pty";
  description.document =
      "SAE J1939-21, -81; ACEINNA openIMU300RI and openIMU335RI firmware and J1939 documentation";
  description.page = "docs/devices/openimu335ri.md";
  description.messages = {
      {"61481 F029 slope sensor information 2", "100 Hz", "pitch, roll, merit, latency"},
      {"61482 F02A angular rate information", "100 Hz", "pitch, roll, yaw rate, merit, latency"},
      {"61485 F02D acceleration sensor", "100 Hz", "lateral, longitudinal, vertical, merit"}};
  if (configuration.imu.variant == emulators::OpenImuVariant::openimu300ri) {
    description.messages.push_back({"65386 FF6A magnetic field", "off", "x, y, z"});
  } else {
    description.messages.push_back({"61459 F013 slope sensor information", "off", "16-bit angles"});
    description.messages.push_back({"65387 FF6B fine angular rate", "off", "19-bit rates"});
    description.messages.push_back({"65226 FECA DM1", "while a trouble is active", "trouble code"});
  }
  description.messages.insert(description.messages.end(),
                              {{"60928 EE00 address claimed", "at start, on request", "NAME"},
                               {"65242 FEDA software version", "on request", "5 bytes"},
                               {"64965 FDC5 ECU identification", "on request", "NAME"},
                               {"FF50 .. FF5E, FFF0 .. FFF2 settings", "received",
                                "rate, messages, filters, orientation, save, groups"}});
}

void describe(const XsensMtiConfiguration& configuration, DeviceDescription& description) {
  NoFrames output;
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  description.quantities = quantities_of(emulators::Mti600(configuration.mti, calendar, output));
  description.wire = "CAN 2.0A or B: SocketCAN or slcan on a pty";
  description.document = "Xsens MT CAN Protocol Documentation MT1604P; the maker's xsens.dbc";
  for (const emulators::MtiOutput& mti_output : configuration.mti.outputs) {
    const auto& message = protocols::xsens::message(mti_output.id);
    description.messages.push_back(
        {fmt::format("{:03X} {}", static_cast<unsigned>(message.id), message.name),
         mti_output.divider == 0
             ? "off"
             : fmt::format("{} Hz", emulators::kMtiSamplesPerSecond / mti_output.divider),
         fmt::format("{} bytes", message.length)});
  }
}

void describe(const EncoderDeviceConfiguration& configuration, DeviceDescription& description) {
  NoFrames output;
  emulators::VolatileMemory memory;
  const emulators::RotaryEncoder encoder(configuration.encoder, memory, output);
  description.quantities = quantities_of(encoder);
  description.wire = "CAN 2.0A, CANopen: SocketCAN or slcan on a pty";
  description.document = "CiA 301 V4.2.0, CiA 406 V3.2";
  for (const auto& layout :
       protocols::canopen::rotary_encoder_layouts(configuration.encoder.node.node_id)) {
    description.messages.push_back(
        {fmt::format("{:03X} {}", layout.id, layout.name), "by its parameters", layout.text});
  }
  description.messages.push_back(
      {"SDO", "on request",
       fmt::format("{} entries of the object dictionary",
                   protocols::canopen::rotary_encoder_objects().size())});
}

void describe(const ValveDriverConfiguration& configuration, DeviceDescription& description) {
  description.quantities = quantities_of(emulators::ValveDriver(configuration.driver));
  description.wire = "Modbus TCP server, default 127.0.0.1:1502";
  description.document =
      "MODBUS Application Protocol Specification V1.1b3; Messaging on TCP/IP Implementation Guide "
      "V1.0b; register map in docs/devices/valve-driver.md";
  description.messages = {
      {"03 read holding registers", "on request", "set points, ramps, watchdog"},
      {"04 read input registers", "on request", "spools, pressures, swing encoder, faults"},
      {"06, 16, 22, 23 write registers", "on request", "control word, set points, parameters"},
      {"17, 43/14 identification", "on request", "vendor, product, revision"}};
}

void describe(const IsoValvesConfiguration& configuration, DeviceDescription& description) {
  NoFrames output;
  const emulators::IsoValves valves(configuration.valves, output);
  description.quantities = quantities_of(valves);
  description.wire = "CAN 2.0B at 250 kbit/s, J1939: SocketCAN or slcan on a pty";
  description.document =
      "ISO 11783-7 auxiliary valves as listed by isobus.net; SAE J1939 digital annex (joysticks); "
      "layouts in docs/devices/iso-valves.md";
  for (const auto& layout : valves.messages("valves")) {
    const bool sent = !layout.sender.empty();
    description.messages.push_back({fmt::format("{:08X} {}", layout.id, layout.name),
                                    fmt::format("{:g} Hz", 1e3 / layout.period_ms),
                                    (sent ? "sent: " : "received: ") + layout.text});
  }
  description.messages.push_back({"64982-64985 BJM1, EJM1, BJM2, EJM2", "10 Hz",
                                  "received: joysticks, where they are mapped"});
  description.messages.push_back({"65226 FECA DM1", "1 Hz", "sent: active trouble codes"});
}

void describe(const VehicleGatewayDeviceConfiguration& configuration,
              DeviceDescription& description) {
  NoFrames output;
  description.quantities = quantities_of(emulators::VehicleGateway(configuration.gateway, output));
  description.wire = "CAN 2.0B at 250 kbit/s, J1939: SocketCAN or slcan on a pty";
  description.document =
      "SAE J1939-21, -71 (2020 annex), -73, -81; ISO 11783-7 guidance and machine selected speed; "
      "layouts in docs/devices/vehicle-gateway.md";
  for (const auto& entry : emulators::VehicleReport::schedule()) {
    const auto& group = entry.group;
    description.messages.push_back(
        {fmt::format("{} {:04X} {}", group.pgn, group.pgn, group.name),
         group.period.count() == 0
             ? "on request"
             : fmt::format("{:g} Hz", 1e3 / static_cast<double>(group.period.count())),
         "sent"});
  }
  const auto add = [&](std::uint32_t pgn, std::string_view name, const char* rate,
                       const char* content) {
    description.messages.push_back({fmt::format("{} {:04X} {}", pgn, pgn, name), rate, content});
  };
  namespace vehicle = protocols::vehicle;
  add(vehicle::kDm1Pgn, "DM1", "1 Hz", "active trouble codes; also on change");
  add(vehicle::kDm2Pgn, "DM2", "on request", "trouble codes that were active");
  for (const auto& entry : emulators::VehicleSatellites::schedule()) {
    add(entry.group.pgn, entry.group.name, "with position_from", "sent");
  }
  add(vehicle::kSoftwareIdentificationPgn, "SOFT", "on request", "by transport");
  add(vehicle::kComponentIdentificationPgn, "CI", "on request", "by transport");
  add(vehicle::kEcuIdentificationPgn, "ECUID", "on request", "by transport");
}

void describe(const UsbJoystickConfiguration& configuration, DeviceDescription& description) {
  description.quantities = quantities_of(emulators::HidJoystick(configuration.joystick));
  description.wire = "USB full speed, HID, by USB/IP, default 127.0.0.1:3240";
  description.document =
      "Universal Serial Bus 2.0; Device Class Definition for HID 1.11; layout in "
      "docs/devices/usb-joystick.md";
  description.messages = {
      {"input report", "when moved, every 10 ms at most", "7 axes, 16 buttons, 16 bytes"},
      {"GET_REPORT, GET_IDLE", "on request", "the present report, the idle time"},
      {"SET_IDLE", "received", "repeats the report while nothing moves"}};
}

void describe(const UsbPassThroughConfiguration& /*configuration*/,
              DeviceDescription& description) {
  description.wire = "USB as the real device's, by USB/IP, default 127.0.0.1:3240";
  description.document = "the real device; Universal Serial Bus 2.0";
  description.page = "docs/usb.md";
  description.messages = {{"transfers", "as it does", "control, bulk, interrupt"}};
}

template <std::size_t kIndex>
void append(std::vector<DeviceDescription>& list) {
  DeviceConfiguration configuration;
  configuration.settings.emplace<kIndex>();
  DeviceDescription description;
  const fields::Named& named = std::variant_alternative_t<kIndex, DeviceSettings>::kNamed;
  description.type = named.name;
  description.text = named.text;
  description.page = "docs/devices/" + description.type + ".md";
  describe(std::get<kIndex>(configuration.settings), description);
  if (as_velodyne(configuration.settings) != nullptr) {
    description.page = "docs/devices/velodyne.md";  // of the whole series
  }
  description.keys = reference_text(outline(configuration));
  list.push_back(std::move(description));
}

}  // namespace

std::vector<DeviceDescription> device_catalogue() {
  std::vector<DeviceDescription> list;
  [&]<std::size_t... kIndices>(std::index_sequence<kIndices...>) {
    (append<kIndices>(list), ...);
  }
  (std::make_index_sequence<std::variant_size_v<DeviceSettings>>{});
  return list;
}

}  // namespace rigwire::hil
