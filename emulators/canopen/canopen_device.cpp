#include "emulators/canopen/canopen_device.h"

#include <algorithm>
#include <stdexcept>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
namespace object = protocols::canopen::object;
using fields::IntegerRule;

CanopenDevice::CanopenDevice(const CanopenDeviceSettings& settings,
                             std::span<const canopen::ObjectEntry> objects,
                             NonvolatileMemory& memory, FrameOutput& output)
    : dictionary_(objects, settings.node.node_id),
      node_(settings.node, dictionary_, *this, memory, output),
      supply_(settings.supply),
      plan_{kStart + settings.supply.power_on, settings.sampling} {}

void CanopenDevice::deliver(const CanopenDeviceSettings& settings, std::uint32_t device_type,
                            std::uint32_t product, const std::string& file,
                            const std::string& description, const std::string& vendor_name) {
  constexpr std::uint32_t kRevision = 0x0001'0000;
  dictionary_.set_delivered(object::kDeviceType, device_type);
  dictionary_.set_delivered({object::kTransmitPdo, canopen::kPdoEventTimer_ms},
                            settings.event_timer_ms);
  dictionary_.set_delivered({object::kTransmitPdo, canopen::kPdoType}, settings.transmission_type);
  dictionary_.set_delivered(object::kHeartbeatTime, settings.heartbeat_ms);
  dictionary_.set_delivered(object::kVendor, settings.vendor);
  dictionary_.set_delivered(object::kProductCode, product);
  dictionary_.set_delivered(object::kRevisionNumber, kRevision);
  dictionary_.set_delivered(object::kSerialNumber, settings.serial);
  node_.describe(file, description, vendor_name);
}

SimTime CanopenDevice::next_event() const {
  return std::min(supply_.next_change(), node_.next_event());
}

void CanopenDevice::advance(SimTime now) {
  while (supply_.next_change() <= now) {
    const SimTime instant = supply_.next_change();
    node_.advance(instant);
    supply_.change();
    node_.power(instant, supply_.on());
    switched(instant);
  }
  node_.advance(now);
}

std::string_view CanopenDevice::configure(SimTime now, canopen::ObjectAddress address,
                                          std::int64_t value) {
  advance(now);
  const std::string_view why = node_.configure(now, address, value);
  written(now);
  return why;
}

void CanopenDevice::receive(SimTime now, const protocols::can::Frame& frame) {
  advance(now);
  node_.receive(now, frame);
  written(now);
}

std::vector<protocols::can::OwnedMessage> sent_by(
    std::string_view name, const CanopenDeviceSettings& settings, bool timed,
    std::vector<protocols::can::OwnedMessage> layouts) {
  for (auto& layout : layouts) {
    layout.sender = name;
    if (timed && layout.id == canopen::kTransmitPdo1Base + settings.node.node_id) {
      layout.period_ms = settings.event_timer_ms;
    } else if (layout.id == canopen::kHeartbeatBase + settings.node.node_id) {
      layout.period_ms = settings.heartbeat_ms;
    }
  }
  return layouts;
}

void visit_canopen(fields::Visitor& v, CanopenDeviceSettings& p) {
  v.integer("node_id", p.node.node_id, IntegerRule{1, canopen::kNoNodeId},
            "CANopen node, 1 .. 127 and unique on a bus; 255 = none until a master gives it one.");
  v.check(p.node.node_id <= canopen::kGreatestNodeId || p.node.node_id == canopen::kNoNodeId,
          "node_id", "no node-ID of CiA 301", std::to_string(p.node.node_id), "1 .. 127, 255");
  v.integer("transmission_type", p.transmission_type, IntegerRule{0, 255},
            "When the first message is sent: 0 .. 240 after SYNC, 254 timer and change, 255 "
            "timer.");
  v.check(p.transmission_type <= canopen::kGreatestSynchronous ||
              p.transmission_type >= canopen::kOnChange,
          "transmission_type", "reserved by CiA 301", std::to_string(p.transmission_type),
          "0 .. 240, 254, 255");
  v.integer("event_timer", p.event_timer_ms, IntegerRule{0, 65535, fields::unit("ms")},
            "Time between two of the first message; 0 = only on SYNC or change.");
  v.integer("heartbeat", p.heartbeat_ms, IntegerRule{0, 65535, fields::unit("ms")},
            "Time between two heartbeats; 0 = none.");
  v.boolean("starts_itself", p.node.starts_itself, "Operational without a master's command.");
  v.integer("serial", p.serial, IntegerRule{0, 0xFFFFFFFF},
            "Serial number in its identity object.");
}

void validate_canopen(const CanopenDeviceSettings& settings) {
  validate(settings.supply);
  const CanopenNodeSettings& node = settings.node;
  if (node.boot < Duration{0} || node.processing_delay < Duration{0}) {
    throw std::invalid_argument("CANopen node: boot and processing_delay must not be negative");
  }
}

}  // namespace rigwire::emulators
