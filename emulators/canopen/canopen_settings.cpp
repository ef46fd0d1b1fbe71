// Keys and checks that every CANopen node has.
#include <stdexcept>
#include <string>

#include "emulators/canopen/canopen_node.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
using fields::IntegerRule;

void visit_canopen(fields::Visitor& v, CanopenNodeSettings& node, std::uint8_t& transmission_type,
                   std::uint16_t& event_timer_ms, std::uint16_t& heartbeat_ms,
                   std::uint32_t& serial) {
  v.integer("node_id", node.node_id, IntegerRule{1, canopen::kNoNodeId},
            "CANopen node, 1 .. 127 and unique on a bus; 255 = none until a master gives it one.");
  v.check(node.node_id <= canopen::kGreatestNodeId || node.node_id == canopen::kNoNodeId, "node_id",
          "no node-ID of CiA 301", std::to_string(node.node_id), "1 .. 127, 255");
  v.integer("transmission_type", transmission_type, IntegerRule{0, 255},
            "When the first message is sent: 0 .. 240 after SYNC, 254 timer and change, 255 "
            "timer.");
  v.check(
      transmission_type <= canopen::kGreatestSynchronous || transmission_type >= canopen::kOnChange,
      "transmission_type", "reserved by CiA 301", std::to_string(transmission_type),
      "0 .. 240, 254, 255");
  v.integer("event_timer", event_timer_ms, IntegerRule{0, 65535, fields::unit("ms")},
            "Time between two of the first message; 0 = only on SYNC or change.");
  v.integer("heartbeat", heartbeat_ms, IntegerRule{0, 65535, fields::unit("ms")},
            "Time between two heartbeats; 0 = none.");
  v.boolean("starts_itself", node.starts_itself, "Operational without a master's command.");
  v.integer("serial", serial, IntegerRule{0, 0xFFFFFFFF},
            "Serial number that its identity object tells.");
}

void validate(const CanopenNodeSettings& settings) {
  if (settings.boot < Duration{0} || settings.processing_delay < Duration{0}) {
    throw std::invalid_argument("CANopen node: boot and processing_delay must not be negative");
  }
}

}  // namespace rigwire::emulators
