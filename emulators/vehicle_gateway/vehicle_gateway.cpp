#include "emulators/vehicle_gateway/vehicle_gateway.h"

#include <algorithm>

#include "protocols/j1939/message.h"

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

J1939AddressPolicy make_policy(const VehicleGatewaySettings& settings) {
  J1939AddressPolicy policy;
  policy.preferred = settings.source_address;
  policy.name = make_name(settings);
  policy.arbitrary_address = settings.arbitrary_address;
  policy.first_claim = kStart + settings.power_on;
  policy.answer_delay = settings.processing_delay;
  return policy;
}

const VehicleGatewaySettings& checked(const VehicleGatewaySettings& settings) {
  validate(settings);
  return settings;
}

}  // namespace

VehicleGateway::VehicleGateway(const VehicleGatewaySettings& settings, FrameOutput& output)
    : settings_(checked(settings)),
      output_(output),
      address_(make_policy(settings), output),
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
  for (const VehicleReport::Entry& entry : VehicleReport::schedule()) {
    if (entry.group.period.count() != 0) {
      rate_hz += static_cast<double>(report_.count(entry.group.pgn)) /
                 to_seconds(Duration{entry.group.period});
    }
  }
  return rate_hz;
}

SimTime VehicleGateway::next_event() const {
  return std::min({address_.next_event(), control_.next_event(), next_tick_});
}

void VehicleGateway::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    address_.advance(instant);
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

void VehicleGateway::send(SimTime now, const Frame& frame) {
  output_.send(now + settings_.processing_delay, frame);
}

void VehicleGateway::send_group(SimTime now, std::uint32_t pgn) {
  for (const Frame& frame : report_.frames(now, pgn, address_.address(), control_)) {
    send(now, frame);
  }
}

void VehicleGateway::tick(SimTime now) {
  if (address_.held()) {
    for (const VehicleReport::Entry& entry : VehicleReport::schedule()) {
      if (VehicleReport::is_due(entry, ticks_)) {
        send_group(now, entry.group.pgn);
      }
    }
    if (const auto frame = diagnostics_.tick(ticks_, control_, address_.address())) {
      send(now, *frame);
    }
  }
  ++ticks_;
}

bool VehicleGateway::is_for_us(std::uint8_t destination) const {
  return address_.held() &&
         (destination == j1939::kGlobalAddress || destination == address_.address());
}

void VehicleGateway::receive(SimTime now, const Frame& frame) {
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
  switch (identifier->pgn) {
    case j1939::kAddressClaimedPgn: {
      const auto name = j1939::decode_address_claim(frame);
      if (!name.ok()) {
        ++received_.malformed;
        return;
      }
      ++received_.accepted;
      address_.on_claim(now, identifier->source, *name);
      return;
    }
    case j1939::kRequestPgn:
      return receive_request(now, frame);
    case vehicle::Tsc1::kGroup.pgn:
      return receive_command<vehicle::Tsc1>(now, frame, false);
    case vehicle::Tc1::kGroup.pgn:
      return receive_command<vehicle::Tc1>(now, frame, false);
    case vehicle::Xbr::kGroup.pgn:
      return receive_command<vehicle::Xbr>(now, frame, false);
    case vehicle::GuidanceCommand::kGroup.pgn:
      return receive_command<vehicle::GuidanceCommand>(now, frame, false);
    case vehicle::MachineSelectedSpeedCommand::kGroup.pgn:
      return receive_command<vehicle::MachineSelectedSpeedCommand>(now, frame, false);
    case vehicle::Tprs::kGroup.pgn:
      return receive_command<vehicle::Tprs>(now, frame, true);
    case vehicle::MachineFunctionCommand::kGroup.pgn:
      return receive_command<vehicle::MachineFunctionCommand>(now, frame, true);
    default:
      ++received_.ignored;
  }
}

template <class Message>
void VehicleGateway::receive_command(SimTime now, const Frame& frame, bool refuse_it) {
  const auto message = vehicle::decode<Message>(frame);
  if (!message.ok()) {
    ++received_.malformed;
    return;
  }
  const j1939::Identifier identifier = *j1939::identify(frame);
  if (!is_for_us(identifier.destination)) {
    ++received_.ignored;
    return;
  }
  if (control_.take(now, *message)) {
    ++received_.accepted;
    return;
  }
  ++received_.ignored;
  if (refuse_it && identifier.destination != j1939::kGlobalAddress) {
    refuse(now, identifier.source, identifier.pgn);
  }
}

void VehicleGateway::refuse(SimTime now, std::uint8_t requester, std::uint32_t pgn) {
  j1939::Acknowledgement refusal;
  refusal.control = j1939::Acknowledge::negative;
  refusal.address = requester;
  refusal.pgn = pgn;
  send(now, j1939::make_acknowledgement(address_.address(), j1939::kGlobalAddress, refusal));
}

void VehicleGateway::receive_request(SimTime now, const Frame& frame) {
  const auto pgn = j1939::decode_request(frame);
  if (!pgn.ok()) {
    ++received_.malformed;
    return;
  }
  const j1939::Identifier identifier = *j1939::identify(frame);
  const bool global = identifier.destination == j1939::kGlobalAddress;
  if (*pgn == j1939::kAddressClaimedPgn && (global || identifier.destination == address())) {
    ++received_.accepted;
    address_.on_request(now);  // also without an address: "cannot claim"
    return;
  }
  if (!is_for_us(identifier.destination)) {
    ++received_.ignored;
    return;
  }
  if (*pgn == vehicle::kDm1Pgn) {
    ++received_.accepted;
    diagnostics_.ask();
    return;
  }
  const auto entries = VehicleReport::schedule();
  if (std::ranges::any_of(entries, [&](const auto& entry) { return entry.group.pgn == *pgn; })) {
    ++received_.accepted;
    send_group(now, *pgn);
    return;
  }
  ++received_.ignored;
  if (!global) {
    refuse(now, identifier.source, *pgn);
  }
}

}  // namespace rigwire::emulators
