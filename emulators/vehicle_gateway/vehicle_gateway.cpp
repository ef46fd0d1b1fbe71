#include "emulators/vehicle_gateway/vehicle_gateway.h"

#include <algorithm>
#include <string>
#include <type_traits>

#include "protocols/j1939/message.h"
#include "protocols/j1939/name.h"
#include "protocols/vehicle/identification.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using protocols::can::Frame;

namespace {

std::uint64_t make_name(const VehicleGatewaySettings& settings) {
  j1939::Name name;
  name.identity = settings.serial;
  name.manufacturer = settings.manufacturer;
  name.function = settings.function;
  name.arbitrary_address = settings.arbitrary_address;
  return pack(name);
}

J1939NodeSettings make_node(const VehicleGatewaySettings& settings) {
  J1939NodeSettings node;
  node.address.preferred = settings.source_address;
  node.address.name = make_name(settings);
  node.address.arbitrary_address = settings.arbitrary_address;
  node.address.first_claim = kStart + settings.power_on;
  node.address.answer_delay = settings.processing_delay;
  return node;
}

const VehicleGatewaySettings& checked(const VehicleGatewaySettings& settings) {
  validate(settings);
  return settings;
}

}  // namespace

VehicleGateway::VehicleGateway(const VehicleGatewaySettings& settings, FrameOutput& output)
    : settings_(checked(settings)),
      node_(make_node(settings), *this, output),
      control_(settings),
      report_(settings),
      next_tick_(kStart + settings.power_on + kTickOffset) {}

SamplePlan VehicleGateway::sample_plan() const {
  return {kStart + settings_.power_on + settings_.sensor_start_up, kTick};
}

std::span<const Quantity> VehicleGateway::quantities() const {
  return VehicleReport::quantities();
}

double VehicleGateway::nominal_rate_hz() const {
  double rate_hz = to_seconds(std::chrono::seconds{1}) /
                   to_seconds(VehicleDiagnostics::kPeriodTicks * kTick);  // trouble codes
  const auto add = [&](std::span<const VehicleReport::Entry> schedule) {
    for (const VehicleReport::Entry& entry : schedule) {
      if (entry.group.period.count() != 0) {
        rate_hz += static_cast<double>(report_.count(entry.group.pgn)) /
                   to_seconds(Duration{entry.group.period});
      }
    }
  };
  add(VehicleReport::schedule());
  if (settings_.has_position) {
    add(VehicleSatellites::schedule());
  }
  return rate_hz;
}

SimTime VehicleGateway::next_event() const {
  return std::min({node_.next_event(), control_.next_event(), next_tick_});
}

void VehicleGateway::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    node_.advance(instant);
    control_.advance(instant);
    if (next_tick_ == instant) {
      next_tick_ += kTick;
      tick(instant);
    }
  }
}

void VehicleGateway::update(const VehicleSample& sample) {
  advance(sample.time);
  report_.take(sample);
  control_.observe(sample.time, report_.speed_mps(sample.time));
}

void VehicleGateway::receive(SimTime now, const Frame& frame) {
  advance(now);
  node_.receive(now, frame);
}

bool VehicleGateway::send_group(SimTime now, std::uint32_t pgn) {
  if (settings_.has_position) {
    if (const auto frame = satellites_.frame(now, pgn, node_.address(), report_.speed_mps(now))) {
      node_.send(now, *frame);
      return true;
    }
  }
  const auto frames = report_.frames(now, pgn, node_.address(), control_);
  for (const Frame& frame : frames) {
    node_.send(now, frame);
  }
  return !frames.empty();
}

void VehicleGateway::send_due(SimTime now, std::span<const VehicleReport::Entry> schedule) {
  for (const VehicleReport::Entry& entry : schedule) {
    if (VehicleReport::is_due(entry, ticks_)) {
      send_group(now, entry.group.pgn);
    }
  }
}

void VehicleGateway::tick(SimTime now) {
  if (node_.held()) {
    send_due(now, VehicleReport::schedule());
    if (settings_.has_position) {
      send_due(now, VehicleSatellites::schedule());
    }
    if (diagnostics_.is_due(ticks_, control_) &&
        send_long(now, vehicle::kDm1Pgn, j1939::kGlobalAddress,
                  VehicleDiagnostics::active(control_).payload()) != J1939Answer::sent) {
      diagnostics_.postpone();
    }
  }
  ++ticks_;
}

J1939Answer VehicleGateway::send_long(SimTime now, std::uint32_t pgn, std::uint8_t destination,
                                      std::span<const std::uint8_t> payload) {
  const bool sent = node_.send(now, {vehicle::kTroublePriority, pgn, destination, 0}, payload);
  return sent ? J1939Answer::sent : J1939Answer::busy;
}

J1939Answer VehicleGateway::answer(SimTime now, std::uint32_t pgn, std::uint8_t destination) {
  const auto clear = [&](void (VehicleControl::*forget)()) {
    (control_.*forget)();
    if (destination != j1939::kGlobalAddress) {  // to everybody: cleared without a word
      node_.acknowledge(now, j1939::Acknowledge::positive, destination, pgn);
    }
    return J1939Answer::sent;
  };
  const auto serial = std::to_string(settings_.serial);
  switch (pgn) {
    case vehicle::kDm1Pgn:
      return send_long(now, pgn, destination, VehicleDiagnostics::active(control_).payload());
    case vehicle::kDm2Pgn:
      return send_long(now, pgn, destination, VehicleDiagnostics::previous(control_).payload());
    case vehicle::kDm3Pgn:
      return clear(&VehicleControl::clear_previous_faults);
    case vehicle::kDm11Pgn:
      return clear(&VehicleControl::clear_active_faults);
    case vehicle::kSoftwareIdentificationPgn:
      return send_long(now, pgn, destination,
                       vehicle::make_software_identification({settings_.software}).payload());
    case vehicle::kComponentIdentificationPgn:
      return send_long(now, pgn, destination,
                       vehicle::make_identification(
                           {settings_.make, settings_.model, serial, settings_.unit_number})
                           .payload());
    case vehicle::kEcuIdentificationPgn:
      return send_long(
          now, pgn, destination,
          vehicle::make_identification({"", serial, "", settings_.model, settings_.make, "", ""})
              .payload());
    default:
      return send_group(now, pgn) ? J1939Answer::sent : J1939Answer::unknown;
  }
}

J1939Reception VehicleGateway::take(SimTime now, const J1939Message& message) {
  switch (message.identifier.pgn) {
    case vehicle::Tsc1::kGroup.pgn:
      return take_command<vehicle::Tsc1>(now, message, VehicleRequest::engine);
    case vehicle::Tc1::kGroup.pgn:
      return take_command<vehicle::Tc1>(now, message, VehicleRequest::gearbox);
    case vehicle::Xbr::kGroup.pgn:
      return take_command<vehicle::Xbr>(now, message, VehicleRequest::brake);
    case vehicle::GuidanceCommand::kGroup.pgn:
      return take_command<vehicle::GuidanceCommand>(now, message, VehicleRequest::guidance);
    case vehicle::MachineSelectedSpeedCommand::kGroup.pgn:
      return take_command<vehicle::MachineSelectedSpeedCommand>(now, message,
                                                                VehicleRequest::speed);
    case vehicle::Tprs::kGroup.pgn:
      return take_command<vehicle::Tprs>(now, message, true);
    case vehicle::MachineFunctionCommand::kGroup.pgn:
      return take_command<vehicle::MachineFunctionCommand>(now, message, true);
    default:
      return J1939Reception::ignored;
  }
}

template <class Message>
J1939Reception VehicleGateway::take_command(SimTime now, const J1939Message& message,
                                            bool refuse_it) {
  // A message of these groups that came by transport is too long for its frame, and so malformed.
  const auto request =
      message.payload.size() > vehicle::kMessageBytes
          ? protocols::Decoded<Message>(protocols::Malformed{"the message has exactly 8 bytes"})
          : vehicle::decode<Message>(j1939::make_frame(message.identifier, message.payload));
  if (!request.ok()) {
    return J1939Reception::malformed;
  }
  const j1939::Identifier& identifier = message.identifier;
  if (control_.take(now, *request)) {
    if constexpr (std::is_same_v<Message, vehicle::Tprs>) {
      node_.send(now,
                 vehicle::encode(vehicle::Tpri{request->location, request->reference_pressure_pa},
                                 node_.address()));
    }
    return J1939Reception::accepted;
  }
  if (refuse_it && identifier.destination != j1939::kGlobalAddress) {
    node_.acknowledge(now, j1939::Acknowledge::negative, identifier.source, identifier.pgn);
  }
  return J1939Reception::ignored;
}

template <class Message>
J1939Reception VehicleGateway::take_command(SimTime now, const J1939Message& message,
                                            VehicleRequest source) {
  const J1939Reception reception = take_command<Message>(now, message, false);
  if (reception == J1939Reception::accepted) {
    control_.note_requester(source, message.identifier.source);
  }
  return reception;
}

}  // namespace rigwire::emulators
