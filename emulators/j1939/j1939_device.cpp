#include "emulators/j1939/j1939_device.h"

#include <string>

#include "protocols/vehicle/identification.h"

namespace rigwire::emulators {

namespace iso = protocols::iso11783;
namespace vehicle = protocols::vehicle;

J1939Device::J1939Device(const protocols::j1939::Name& name, std::uint8_t preferred,
                         const SupplySettings& supply, Duration delay, FrameOutput& output)
    : node_({.address = {.preferred = preferred,
                         .name = pack(name),
                         .arbitrary_address = name.arbitrary_address,
                         .first_claim = kNever,
                         .answer_delay = delay},
             .transport = {}},
            *this, output),
      supply_(supply) {}

void J1939Device::advance_node(SimTime now) {
  while (next_node_event() <= now) {
    const SimTime instant = next_node_event();
    node_.advance(instant);
    if (supply_.next_change() == instant) {
      supply_.change();
      supply_lost_ = !supply_.on();
      node_.power(instant, supply_.on());
      switched(instant);
    }
  }
}

void J1939Device::receive(SimTime now, const protocols::can::Frame& frame) {
  advance(now);
  if (!supply_lost_) {
    node_.receive(now, frame);
  }
}

J1939Reception J1939Device::take(SimTime now, const J1939Message& message) {
  const protocols::j1939::Identifier& identifier = message.identifier;
  if (!refusal_.holds(now) || !is_command(identifier.pgn)) {
    return obey(now, message);
  }
  refused(now, message);
  if (identifier.destination != protocols::j1939::kGlobalAddress) {
    node_.acknowledge(now, protocols::j1939::Acknowledge::negative, identifier.source,
                      identifier.pgn);
  }
  return J1939Reception::ignored;
}

J1939Answer J1939Device::answer(SimTime now, std::uint32_t pgn, std::uint8_t destination) {
  if (refusal_.holds(now) && troubles() != nullptr &&
      (pgn == vehicle::kDm3Pgn || pgn == vehicle::kDm11Pgn)) {
    return J1939Answer::unknown;
  }
  if (TroubleMemory* const memory = troubles()) {
    if (const auto answered = memory->answer(node_, now, pgn, destination, is_stopped())) {
      return *answered;
    }
  }
  const J1939Answer answered =
      identity_ ? answer_identification(now, pgn, destination) : J1939Answer::unknown;
  return answered != J1939Answer::unknown ? answered : answer_group(now, pgn, destination);
}

J1939Answer J1939Device::answer_identification(SimTime now, std::uint32_t pgn,
                                               std::uint8_t destination) {
  const IdentificationSettings& texts = identity_->texts;
  const std::string serial = std::to_string(identity_->serial);
  const auto send = [&](std::span<const std::uint8_t> payload) {
    return node_.send_answer(now, pgn, destination, payload);
  };
  switch (pgn) {
    case vehicle::kSoftwareIdentificationPgn:
      return send(vehicle::make_software_identification({texts.software}).payload());
    case vehicle::kComponentIdentificationPgn:
      return send(vehicle::make_identification({texts.make, texts.model, serial, texts.unit_number})
                      .payload());
    case vehicle::kEcuIdentificationPgn:
      return send(vehicle::make_identification(
                      {texts.part_number, serial, "", texts.type, texts.make, texts.hardware})
                      .payload());
    case vehicle::kVehicleIdentificationPgn:
      return texts.vehicle_identification_number.empty()
                 ? J1939Answer::unknown
                 : send(vehicle::make_identification({texts.vehicle_identification_number})
                            .payload());
    case iso::kFunctionalitiesPgn:
      return identity_->functionalities.empty()
                 ? J1939Answer::unknown
                 : send(iso::make_functionalities(identity_->functionalities));
    default:
      return J1939Answer::unknown;
  }
}

}  // namespace rigwire::emulators
