#include "hil/devices/rotary_encoder.h"

#include <fmt/format.h>

#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/rig_check.h"
#include "hil/files/settings_file.h"
#include "protocols/canopen/rotary_encoder.h"

namespace rigwire::hil {

namespace {

using EncoderDevice = CanDeviceOf<emulators::RotaryEncoder, emulators::EncoderBackend>;

}  // namespace

void EncoderConfiguration::visit(fields::Visitor& v) {
  visit_node(v, bus, clock, faults);
  hil::visit(v, joint);
  emulators::visit(v, encoder);
  v.file("settings_file", settings_file, fields::FileKind::memory,
         "What a client saved, for the next run; empty: as long as the run.");
}

void EncoderConfiguration::validate() const {
  emulators::validate(encoder);
}

void EncoderConfiguration::check(const std::string& at, RigCheck& check) const {
  check_joint(joint, at, check);
  check.canopen_node(at, bus, encoder.node.node_id);
}

void EncoderConfiguration::each_fault(const FaultEar& take) {
  show_faults(faults, take);
}

std::vector<fields::Named> EncoderConfiguration::fault_kinds() const {
  return mixed_kinds(faults);
}

std::vector<LiveKey> EncoderConfiguration::live_keys() const {
  return hil::live_keys(emulators::RotaryEncoder::live_settings());
}

DevicePlan EncoderConfiguration::plan(const RigView& rig) const {
  return {can_wire(rig, bus, fmt::format("node {}", encoder.node.node_id)),
          fmt::format("{:.0f} frames/s", bus_share({})->frames_hz), "",
          fmt::format("{} bits, {} against {}", encoder.resolution_bits, joint.link, joint.base)};
}

std::optional<BusShare> EncoderConfiguration::bus_share(std::string_view name) const {
  return asked_with_memory<emulators::RotaryEncoder>(bus_share_of(bus, name), encoder);
}

DeviceDescription EncoderConfiguration::describe() const {
  DeviceDescription description;
  description.quantities = asked_with_memory<emulators::RotaryEncoder>(quantities_of, encoder);
  description.wire = "CAN 2.0A, CANopen: SocketCAN or slcan on a pty";
  description.document = "CiA 301 V4.2.0, CiA 406 V3.2";
  for (const auto& layout : protocols::canopen::rotary_encoder_layouts(encoder.node.node_id)) {
    description.messages.push_back(
        {fmt::format("{:03X} {}", layout.id, layout.name), "by its parameters", layout.text});
  }
  description.messages.push_back(
      {"SDO", "on request",
       fmt::format("{} entries of the object dictionary",
                   protocols::canopen::rotary_encoder_objects().size())});
  return description;
}

std::optional<std::string> EncoderConfiguration::electronic_data_sheet() const {
  return asked_with_memory<emulators::RotaryEncoder>(
      [](const emulators::RotaryEncoder& node) { return node.node().electronic_data_sheet(); },
      encoder);
}

std::unique_ptr<Device> EncoderConfiguration::make(Site& site) const {
  emulators::RotaryEncoderSettings on_bus = encoder;
  on_bus.node.bit_rate_bps = site.bus(bus).bus().settings().bit_rate_bps;
  auto device = std::make_unique<EncoderDevice>(
      site, bus, clock, node_faults<EncoderSample>(faults), with_supply_faults(on_bus, faults),
      open_settings(settings_file));
  device->hear(emulators::RotaryEncoder::live_settings(), &EncoderConfiguration::encoder);
  mount_encoder(site, device->enlist(site.executive()), joint);
  return device;
}

}  // namespace rigwire::hil
