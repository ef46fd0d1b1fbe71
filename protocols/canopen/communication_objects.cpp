#include "protocols/canopen/communication_objects.h"

#include <utility>

namespace rigwire::protocols::canopen {
namespace {

can::OwnedSignal counts(std::string name, std::uint16_t bit, std::uint16_t width,
                        bool is_signed = false) {
  can::OwnedSignal signal;
  signal.name = std::move(name);
  signal.bit = bit;
  signal.width = width;
  signal.is_signed = is_signed;
  return can::unlimited(std::move(signal));
}

}  // namespace

can::OwnedMessage make_layout(std::string name, std::uint32_t base, std::uint8_t node_id,
                              std::uint8_t length, std::string text) {
  can::OwnedMessage layout;
  layout.name = std::move(name);
  layout.id = base + node_id;
  layout.length = length;
  layout.text = std::move(text);
  return layout;
}

can::OwnedSignal make_signal(std::string name, const ObjectEntry& entry, std::uint16_t bit,
                             std::string_view profile) {
  const auto width = static_cast<std::uint16_t>(8 * size_of(entry.type));
  can::OwnedSignal field = counts(std::move(name), bit, width, is_signed(entry.type));
  field.unit = entry.unit;
  field.text = std::string(profile) + ": " + std::string(entry.name);
  return field;
}

can::OwnedMessage make_heartbeat_layout(const std::string& device, std::uint8_t node_id) {
  auto layout = make_layout(device + "_heartbeat", kHeartbeatBase, node_id, 1,
                            "Boot-up and heartbeat, CiA 301");
  layout.signals = {counts("node_state", 0, 8)};
  layout.signals[0].values = {
      {0, "boot-up"}, {4, "stopped"}, {5, "operational"}, {127, "pre-operational"}};
  return layout;
}

can::OwnedMessage make_emergency_layout(const std::string& device, std::uint8_t node_id) {
  auto layout =
      make_layout(device + "_emergency", kEmergencyBase, node_id, 8, "Emergency, CiA 301");
  layout.signals = {counts("error_code", 0, 16), counts("error_register", 16, 8),
                    counts("detail", 24, 8)};
  return layout;
}

}  // namespace rigwire::protocols::canopen
