#include "emulators/canopen/lss_slave.h"

#include "protocols/bytes.h"
#include "protocols/canopen/identifiers.h"

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
using canopen::LssCommand;
using canopen::LssPayload;
using Answer = std::optional<LssPayload>;

namespace {

LssPayload make(LssCommand command, std::uint8_t first = 0) {
  return {static_cast<std::uint8_t>(command), first};
}

LssPayload make_number(LssCommand command, std::uint32_t number) {
  LssPayload payload = make(command);
  protocols::store_little<std::uint32_t>(payload, 1, number);
  return payload;
}

/// Place of `command` in a row that begins with `first`.
std::uint8_t place(LssCommand command, LssCommand first) {
  return static_cast<std::uint8_t>(static_cast<std::uint8_t>(command) -
                                   static_cast<std::uint8_t>(first));
}

bool within(LssCommand command, LssCommand first, LssCommand last) {
  return command >= first && command <= last;
}

}  // namespace

void LssSlave::restart(std::uint8_t node_id) {
  *this = {};
  pending_ = node_id;
}

Answer LssSlave::receive(SimTime now, std::span<const std::uint8_t> payload, LssNode& node) {
  if (payload.size() != canopen::kLssBytes) {
    return std::nullopt;
  }
  const auto command = static_cast<LssCommand>(payload[0]);
  const auto number = protocols::load_little<std::uint32_t>(payload, 1);
  if (command == LssCommand::switch_state_global) {
    const bool had_none = configuring_ && node.node_id() == canopen::kNoNodeId;
    if (payload[1] > 1) {
      return std::nullopt;
    }
    configuring_ = payload[1] == 1;
    selected_ = 0;
    if (!configuring_ && had_none && pending_ != canopen::kNoNodeId) {
      node.reset_communication(now);
    }
    return std::nullopt;
  }
  if (within(command, LssCommand::identify_vendor, LssCommand::identify_unconfigured)) {
    return identify(command, number, node);
  }
  if (configuring_) {
    return configure(now, command, payload, node);
  }
  return command == LssCommand::fastscan ? scan(payload, node) : select(command, number, node);
}

Answer LssSlave::identify(LssCommand command, std::uint32_t number, const LssNode& node) {
  if (command == LssCommand::identify_unconfigured) {
    return node.node_id() == canopen::kNoNodeId && pending_ == canopen::kNoNodeId
               ? Answer(make(LssCommand::unconfigured_identified))
               : std::nullopt;
  }
  const canopen::LssIdentity identity = node.identity();
  const std::uint8_t condition = place(command, LssCommand::identify_vendor);
  const std::array<bool, 6> holds{identity[0] == number, identity[1] == number,
                                  identity[2] >= number, identity[2] <= number,
                                  identity[3] >= number, identity[3] <= number};
  const bool in_order = condition == 0 || condition == identified_;
  identified_ = in_order && holds[condition] ? static_cast<std::uint8_t>(condition + 1) : 0;
  return identified_ == holds.size() ? Answer(make(LssCommand::identified)) : std::nullopt;
}

Answer LssSlave::select(LssCommand command, std::uint32_t number, const LssNode& node) {
  if (!within(command, LssCommand::select_vendor, LssCommand::select_serial)) {
    return std::nullopt;
  }
  const std::uint8_t at = place(command, LssCommand::select_vendor);
  const bool in_order = at == 0 || at == selected_;
  selected_ = in_order && node.identity()[at] == number ? static_cast<std::uint8_t>(at + 1) : 0;
  if (selected_ < canopen::kLssIdentityNumbers) {
    return std::nullopt;
  }
  selected_ = 0;
  configuring_ = true;
  return make(LssCommand::selected);
}

Answer LssSlave::scan(std::span<const std::uint8_t> payload, const LssNode& node) {
  if (node.node_id() != canopen::kNoNodeId || pending_ != canopen::kNoNodeId) {
    return std::nullopt;
  }
  const auto wanted = protocols::load_little<std::uint32_t>(payload, 1);
  const std::uint8_t bit = payload[5];
  const std::uint8_t position = payload[6];
  const std::uint8_t next = payload[7];
  if (bit == canopen::kFastscanReset) {
    fastscan_position_ = 0;
    return make(LssCommand::identified);
  }
  if (bit > 31 || position != fastscan_position_ || position >= canopen::kLssIdentityNumbers ||
      next >= canopen::kLssIdentityNumbers) {
    return std::nullopt;
  }
  // The bits from `bit` up must be those that the master asks for.
  if (((node.identity()[position] ^ wanted) >> bit) != 0) {
    return std::nullopt;
  }
  fastscan_position_ = next;
  configuring_ = bit == 0 && next < position;
  return make(LssCommand::identified);
}

Answer LssSlave::configure(SimTime now, LssCommand command, std::span<const std::uint8_t> payload,
                           LssNode& node) {
  const bool sets = command == LssCommand::configure_node_id ||
                    command == LssCommand::configure_bit_timing ||
                    command == LssCommand::store_configuration;
  if (sets && node.refuses(now)) {
    return make(command, canopen::kLssRefused);
  }
  switch (command) {
    case LssCommand::configure_node_id: {
      const std::uint8_t wanted = payload[1];
      const bool possible =
          (wanted >= 1 && wanted <= canopen::kGreatestNodeId) || wanted == canopen::kNoNodeId;
      pending_ = possible ? wanted : pending_;
      return make(command, possible ? canopen::kLssDone : canopen::kLssOutOfRange);
    }
    case LssCommand::configure_bit_timing: {
      const auto rate_bps = payload[1] == 0 ? canopen::lss_bit_rate_bps(payload[2]) : std::nullopt;
      const bool possible = rate_bps && node.takes_bit_rate(*rate_bps);
      return make(command, possible ? canopen::kLssDone : canopen::kLssOutOfRange);
    }
    case LssCommand::activate_bit_timing: {
      // Everybody is silent for one delay before and one after the change.
      const std::chrono::milliseconds delay{protocols::load_little<std::uint16_t>(payload, 1)};
      node.keep_silent(now, 2 * delay);
      return std::nullopt;
    }
    case LssCommand::store_configuration:
      return make(command,
                  node.store_node_id(pending_) ? canopen::kLssDone : canopen::kLssNotStored);
    case LssCommand::inquire_node_id:
      return make(command, node.node_id());
    default:
      break;
  }
  if (within(command, LssCommand::inquire_vendor, LssCommand::inquire_serial)) {
    return make_number(command, node.identity()[place(command, LssCommand::inquire_vendor)]);
  }
  return std::nullopt;
}

}  // namespace rigwire::emulators
