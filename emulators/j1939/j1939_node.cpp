#include "emulators/j1939/j1939_node.h"

#include <algorithm>

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
using protocols::can::Frame;

namespace {

J1939TransportSettings with_delay(J1939TransportSettings settings, Duration answer_delay) {
  settings.answer_delay = answer_delay;
  return settings;
}

}  // namespace

J1939Node::J1939Node(const J1939NodeSettings& settings, J1939Application& application,
                     FrameOutput& output)
    : settings_(settings),
      application_(application),
      output_(output),
      address_(settings.address, output),
      transport_(with_delay(settings.transport, settings.address.answer_delay), *this, output) {}

SimTime J1939Node::next_event() const {
  return std::min(address_.next_event(), transport_.next_event());
}

void J1939Node::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    address_.advance(instant);
    follow_address();
    transport_.advance(instant);
  }
}

void J1939Node::power(SimTime now, bool on) {
  if (on) {
    address_.claim_at(now);
  } else {
    address_.restart(settings_.address.preferred, kNever);
    follow_address();
  }
}

void J1939Node::follow_address() {
  const std::uint8_t address = held() ? address_.address() : j1939::kNullAddress;
  if (address != transport_address_) {
    transport_address_ = address;
    transport_.reset();
  }
}

bool J1939Node::is_for_us(std::uint8_t destination) const {
  return held() && (destination == j1939::kGlobalAddress || destination == address());
}

void J1939Node::send(SimTime now, const Frame& frame) {
  output_.send(now + settings_.address.answer_delay, frame);
}

bool J1939Node::send(SimTime now, j1939::Identifier identifier,
                     std::span<const std::uint8_t> payload) {
  if (!held()) {
    return false;
  }
  identifier.source = address();
  if (payload.size() >= j1939::kLeastTransported) {
    return transport_.send(now, identifier, payload);
  }
  send(now, j1939::make_frame(identifier, payload));
  return true;
}

J1939Answer J1939Node::send_answer(SimTime now, std::uint32_t pgn, std::uint8_t destination,
                                   std::span<const std::uint8_t> payload) {
  j1939::Identifier identifier;
  identifier.pgn = pgn;
  identifier.destination = destination;
  return send(now, identifier, payload) ? J1939Answer::sent : J1939Answer::busy;
}

void J1939Node::acknowledge(SimTime now, j1939::Acknowledge control, std::uint8_t requester,
                            std::uint32_t pgn) {
  if (!held()) {
    return;
  }
  j1939::Acknowledgement acknowledgement;
  acknowledgement.control = control;
  acknowledgement.address = requester;
  acknowledgement.pgn = pgn;
  send(now, j1939::make_acknowledgement(address(), j1939::kGlobalAddress, acknowledgement));
}

void J1939Node::receive(SimTime now, const Frame& frame) {
  advance(now);
  if (frame.length > frame.data.size()) {
    ++received_.malformed;
    return;
  }
  received_.bytes += frame.payload().size();
  const auto identifier = j1939::identify(frame);
  if (!identifier) {
    ++received_.ignored;
    return;
  }
  switch (dispatch(now, *identifier, frame)) {
    case J1939Reception::accepted:
      ++received_.accepted;
      break;
    case J1939Reception::ignored:
      ++received_.ignored;
      break;
    case J1939Reception::malformed:
      ++received_.malformed;
      break;
  }
}

J1939Reception J1939Node::dispatch(SimTime now, const j1939::Identifier& identifier,
                                   const Frame& frame) {
  switch (identifier.pgn) {
    case j1939::kAddressClaimedPgn: {
      const auto name = j1939::decode_address_claim(frame);
      if (!name.ok()) {
        return J1939Reception::malformed;
      }
      address_.on_claim(now, identifier.source, *name);
      follow_address();
      return J1939Reception::accepted;
    }
    case j1939::kRequestPgn:
      return receive_request(now, identifier, frame);
    case j1939::kTransportManagementPgn:
    case j1939::kTransportDataPgn: {
      // A node without an address still receives messages to all nodes, for commanded addresses.
      const bool to_everybody = identifier.destination == j1939::kGlobalAddress;
      if (!to_everybody && !is_for_us(identifier.destination)) {
        return J1939Reception::ignored;
      }
      return transport_.receive(now, identifier, frame.payload(), transport_address_);
    }
    default:
      return is_for_us(identifier.destination)
                 ? application_.take(now, {identifier, frame.payload()})
                 : J1939Reception::ignored;
  }
}

J1939Reception J1939Node::receive_request(SimTime now, const j1939::Identifier& identifier,
                                          const Frame& frame) {
  const auto pgn = j1939::decode_request(frame);
  if (!pgn.ok()) {
    return J1939Reception::malformed;
  }
  const bool global = identifier.destination == j1939::kGlobalAddress;
  if (*pgn == j1939::kAddressClaimedPgn && (global || identifier.destination == address())) {
    address_.on_request(now);  // also without an address: "cannot claim"
    return J1939Reception::accepted;
  }
  if (!is_for_us(identifier.destination)) {
    return J1939Reception::ignored;
  }
  // A requester without an address of its own cannot be answered individually.
  const bool alone = !global && identifier.source < j1939::kNullAddress;
  const std::uint8_t destination = alone ? identifier.source : j1939::kGlobalAddress;
  switch (application_.answer(now, *pgn, destination)) {
    case J1939Answer::sent:
      return J1939Reception::accepted;
    case J1939Answer::busy:
      if (!global) {
        acknowledge(now, j1939::Acknowledge::busy, identifier.source, *pgn);
      }
      return J1939Reception::accepted;
    case J1939Answer::unknown:
      if (!global) {
        acknowledge(now, j1939::Acknowledge::negative, identifier.source, *pgn);
      }
      break;
  }
  return J1939Reception::ignored;
}

void J1939Node::transported(SimTime now, const J1939Message& message) {
  if (message.identifier.pgn == j1939::kCommandedAddressPgn) {
    receive_commanded_address(now, message.payload);
  } else if (is_for_us(message.identifier.destination)) {
    (void)application_.take(now, message);
  }
}

void J1939Node::receive_commanded_address(SimTime now, std::span<const std::uint8_t> payload) {
  const auto command = j1939::decode_commanded_address(payload);
  if (settings_.takes_commanded_address && application_.takes_commanded_address(now) &&
      command.ok() && command->name == name()) {
    (void)command_address(now, command->address);
  }
}

std::string_view J1939Node::command_address(SimTime now, std::uint8_t address) {
  const bool has_claimed = address_.has_claimed();
  address_.on_command(now, address);
  follow_address();
  return has_claimed ? "" : "it has not claimed an address yet";
}

}  // namespace rigwire::emulators
