// The slave's side of the layer setting services: which node a master means, and what it sets
// there. What a node-ID does to a node is the node's business.
//
// Source: CiA 305 V3.0.0. Two states, waiting and configuration. Settings are accepted in
// configuration only; a master brings one node there by its whole identity, all nodes by a global
// switch, an unconfigured one by fastscan. A node-ID that was configured is pending: it is in force
// after the next reset of communication, which a node that had none makes by itself when it goes
// back to waiting. Stored, it is that of every later power-on.
//
// The bit rate is the bus's: that one is confirmed, every other one is "not supported".
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocols/canopen/lss.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// The node that is set.
class LssNode {
 public:
  virtual ~LssNode() = default;
  [[nodiscard]] virtual protocols::canopen::LssIdentity identity() const = 0;
  /// The node-ID in force; protocols::canopen::kNoNodeId: none.
  [[nodiscard]] virtual std::uint8_t node_id() const = 0;
  /// False when it cannot be written.
  [[nodiscard]] virtual bool store_node_id(std::uint8_t node_id) = 0;
  [[nodiscard]] virtual bool takes_bit_rate(std::uint32_t bit_rate_bps) const = 0;
  /// Whether nothing of it can be set at present.
  [[nodiscard]] virtual bool refuses(SimTime now) const = 0;
  /// Sends nothing for so long from `now` on, while the bus changes its rate.
  virtual void keep_silent(SimTime now, Duration span) = 0;
  /// The pending node-ID comes into force.
  virtual void reset_communication(SimTime now) = 0;
};

class LssSlave {
 public:
  /// To waiting, with this pending node-ID; at power-on and with a reset of the node.
  void restart(std::uint8_t node_id);

  /// A frame of the master. The answer, where one is due; malformed requests have none.
  [[nodiscard]] std::optional<protocols::canopen::LssPayload> receive(
      SimTime now, std::span<const std::uint8_t> payload, LssNode& node);

  /// What is in force after the next reset of communication.
  [[nodiscard]] std::uint8_t pending_node_id() const { return pending_; }
  [[nodiscard]] bool configuring() const { return configuring_; }

 private:
  [[nodiscard]] std::optional<protocols::canopen::LssPayload> identify(
      protocols::canopen::LssCommand command, std::uint32_t number, const LssNode& node);
  [[nodiscard]] std::optional<protocols::canopen::LssPayload> select(
      protocols::canopen::LssCommand command, std::uint32_t number, const LssNode& node);
  [[nodiscard]] std::optional<protocols::canopen::LssPayload> scan(
      std::span<const std::uint8_t> payload, const LssNode& node);
  [[nodiscard]] std::optional<protocols::canopen::LssPayload> configure(
      SimTime now, protocols::canopen::LssCommand command, std::span<const std::uint8_t> payload,
      LssNode& node);

  std::uint8_t pending_ = protocols::canopen::kNoNodeId;
  bool configuring_ = false;
  std::uint8_t selected_ = 0;    ///< Numbers of the identity that matched so far.
  std::uint8_t identified_ = 0;  ///< Conditions that held so far.
  /// Position (LSSSub) of the identity number that is scanned.
  std::uint8_t fastscan_position_ = 0;
};

}  // namespace rigwire::emulators
