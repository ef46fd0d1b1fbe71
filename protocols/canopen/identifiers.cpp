#include "protocols/canopen/identifiers.h"

#include <algorithm>
#include <array>

#include "protocols/bytes.h"

namespace rigwire::protocols::canopen {

can::Frame make_frame(std::uint32_t identifier, std::span<const std::uint8_t> payload) {
  can::Frame frame;
  frame.id = identifier & kCobIdentifierMask;
  frame.length = static_cast<std::uint8_t>(std::min(payload.size(), frame.data.size()));
  std::copy_n(payload.begin(), frame.length, frame.data.begin());
  return frame;
}

can::Frame make_network_request(const NetworkRequest& request) {
  const std::array<std::uint8_t, 2> payload{static_cast<std::uint8_t>(request.command),
                                            request.node_id};
  return make_frame(kNetworkManagementId, payload);
}

std::optional<NetworkRequest> decode_network_request(const can::Frame& frame) {
  if (frame.extended || frame.remote || frame.id != kNetworkManagementId || frame.length != 2 ||
      frame.data[1] > kGreatestNodeId) {
    return std::nullopt;
  }
  switch (const auto command = static_cast<NetworkCommand>(frame.data[0]); command) {
    case NetworkCommand::start:
    case NetworkCommand::stop:
    case NetworkCommand::enter_pre_operational:
    case NetworkCommand::reset_node:
    case NetworkCommand::reset_communication:
      return NetworkRequest{command, frame.data[1]};
  }
  return std::nullopt;
}

can::Frame make_heartbeat(std::uint8_t node_id, NodeState state) {
  const std::array<std::uint8_t, 1> payload{static_cast<std::uint8_t>(state)};
  return make_frame(kHeartbeatBase + node_id, payload);
}

can::Frame make_emergency(std::uint32_t identifier, const Emergency& emergency) {
  std::array<std::uint8_t, 8> payload{};  // code 2, register 1, maker's 5
  store_little<std::uint16_t>(payload, 0, emergency.code);
  payload[2] = emergency.error_register;
  payload[3] = emergency.detail;
  return make_frame(identifier, payload);
}

}  // namespace rigwire::protocols::canopen
