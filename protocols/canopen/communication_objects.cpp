#include "protocols/canopen/communication_objects.h"

#include <utility>

namespace rigwire::protocols::canopen {
namespace {

can::OwnedSignal unsigned_field(std::string name, std::uint16_t bit, std::uint16_t width) {
  can::OwnedSignal field;
  field.name = std::move(name);
  field.bit = bit;
  field.width = width;
  field.upper = static_cast<double>((std::uint64_t{1} << width) - 1U);
  return field;
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
  can::OwnedSignal field = unsigned_field(std::move(name), bit, width);
  field.is_signed = is_signed(entry.type);
  if (field.is_signed) {
    const auto half = static_cast<double>(std::uint64_t{1} << (width - 1U));
    field.lower = -half;
    field.upper = half - 1.0;
  }
  field.unit = entry.unit;
  field.text = std::string(profile) + ": " + std::string(entry.name);
  return field;
}

can::OwnedMessage make_heartbeat_layout(const std::string& device, std::uint8_t node_id) {
  auto layout = make_layout(device + "_heartbeat", kHeartbeatBase, node_id, 1,
                            "Boot-up and heartbeat, CiA 301");
  layout.signals = {unsigned_field("node_state", 0, 8)};
  layout.signals[0].values = {
      {0, "boot-up"}, {4, "stopped"}, {5, "operational"}, {127, "pre-operational"}};
  return layout;
}

can::OwnedMessage make_emergency_layout(const std::string& device, std::uint8_t node_id) {
  auto layout =
      make_layout(device + "_emergency", kEmergencyBase, node_id, 8, "Emergency, CiA 301");
  layout.signals = {unsigned_field("error_code", 0, 16), unsigned_field("error_register", 16, 8),
                    unsigned_field("detail", 24, 8)};
  return layout;
}

}  // namespace rigwire::protocols::canopen
