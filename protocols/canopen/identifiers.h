// The identifiers of CANopen's predefined connection set, and the states of a node.
//
// Source: CiA 301 V4.2.0, 7.3.3 (predefined connection set), 7.2.8.3 (network management, error
// control). All frames have 11-bit identifiers: function code 4, node-ID 7. Node-IDs are 1..127; 0
// means every node.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocols/can/frame.h"

namespace rigwire::protocols::canopen {

inline constexpr std::uint8_t kGreatestNodeId = 127;
inline constexpr std::uint8_t kAllNodes = 0;

inline constexpr std::uint32_t kNetworkManagementId = 0x000;
inline constexpr std::uint32_t kSynchronisationId = 0x080;
inline constexpr std::uint32_t kEmergencyBase = 0x080;     ///< Plus node-ID, as all bases.
inline constexpr std::uint32_t kTransmitPdo1Base = 0x180;  ///< Each further one 0x100 more.
inline constexpr std::uint32_t kReceivePdo1Base = 0x200;
inline constexpr std::uint32_t kSdoAnswerBase = 0x580;   ///< Server to client.
inline constexpr std::uint32_t kSdoRequestBase = 0x600;  ///< Client to server.
inline constexpr std::uint32_t kHeartbeatBase = 0x700;   ///< Boot-up and heartbeat.

/// Bits of a COB-ID entry of the dictionary beside the identifier (CiA 301, 7.5.2.17, 7.5.2.36).
inline constexpr std::uint32_t kCobIdentifierMask = 0x7FF;
inline constexpr std::uint32_t kCobExtended = 1U << 29U;  ///< 29-bit identifier.
inline constexpr std::uint32_t kCobNoRemote = 1U << 30U;  ///< PDO: no remote request allowed.
inline constexpr std::uint32_t kCobInvalid = 1U << 31U;   ///< PDO or EMCY does not exist.

/// State of a node, coded as in the heartbeat's byte.
enum class NodeState : std::uint8_t {
  initialising = 0x00,  ///< The boot-up message.
  stopped = 0x04,
  operational = 0x05,
  pre_operational = 0x7F,
};

enum class NetworkCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};

struct NetworkRequest {
  NetworkCommand command = NetworkCommand::start;
  std::uint8_t node_id = kAllNodes;
};

[[nodiscard]] can::Frame make_network_request(const NetworkRequest& request);
/// Nothing unless the frame is an 11-bit data frame of identifier 0 with two bytes, a command of
/// the standard and a node-ID up to 127.
[[nodiscard]] std::optional<NetworkRequest> decode_network_request(const can::Frame& frame);

[[nodiscard]] can::Frame make_heartbeat(std::uint8_t node_id, NodeState state);

/// Emergency object (CiA 301, 7.2.7): error code, error register, five bytes of the maker.
struct Emergency {
  std::uint16_t code = 0;  ///< 0: no error any more.
  std::uint8_t error_register = 0;
  std::uint8_t detail = 0;  ///< First of the maker's bytes; the others are 0.
};
[[nodiscard]] can::Frame make_emergency(std::uint32_t identifier, const Emergency& emergency);

/// An 11-bit data frame.
[[nodiscard]] can::Frame make_frame(std::uint32_t identifier,
                                    std::span<const std::uint8_t> payload);

}  // namespace rigwire::protocols::canopen
