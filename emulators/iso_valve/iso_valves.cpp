#include "emulators/iso_valve/iso_valves.h"

#include <algorithm>
#include <cmath>

#include "protocols/j1939/name.h"
#include "protocols/vehicle/joystick.h"

namespace rigwire::emulators {

namespace iso = protocols::iso11783;
namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using protocols::can::Frame;

using vehicle::signal_of;

namespace {

constexpr std::array kQuantities{
    quantity(signal_of<iso::AuxiliaryValveEstimate>(&iso::AuxiliaryValveEstimate::extend_share),
             "port flow"),
    quantity(signal_of(&iso::AuxiliaryValveMeasuredFlow::extend_share), "measured flow"),
    quantity(signal_of(&iso::AuxiliaryValveMeasuredFlow::extend_pressure_pa), "port pressure"),
    within(quantity(signal_of(&iso::AuxiliaryValveMeasuredPosition::position_share)), -1.0, 1.0),
    within(quantity(signal_of(&iso::AuxiliaryValveMeasuredPosition::position_m)), -0.032, 0.032),
};

const IsoValveSettings& checked(const IsoValveSettings& settings) {
  validate(settings);
  return settings;
}

ValveAmplifierSettings amplifier_of(const IsoValveSettings& settings) {
  ValveAmplifierSettings amplifier = settings.amplifier;
  amplifier.parameters.watchdog = Duration{0};
  return amplifier;
}

J1939NodeSettings node_of(const IsoValveSettings& settings) {
  constexpr std::uint8_t kAgriculture = 2;
  j1939::Name name;
  name.identity = settings.serial;
  name.manufacturer = settings.manufacturer;
  name.function = settings.function;
  name.industry_group = kAgriculture;
  name.arbitrary_address = true;
  J1939NodeSettings node;
  node.address.preferred = settings.source_address;
  node.address.name = pack(name);
  node.address.arbitrary_address = true;
  node.address.first_claim = kStart + settings.power_on;
  node.address.answer_delay = settings.processing_delay;
  return node;
}

// Proprietary parameter numbers (J1939-73: 520192 .. 524287), this project's own; 168 and 1136 are
// the standard's supply voltage and control unit temperature.
constexpr std::uint32_t kCoilSpn = 520192;      // + section
constexpr std::uint32_t kPositionSpn = 520208;  // + section
constexpr std::uint32_t kCommandSpn = 520224;   // + section
constexpr std::uint32_t kSetUpSpn = 520240;
constexpr std::uint32_t kSupplyVoltageSpn = 168;
constexpr std::uint32_t kTemperatureSpn = 1136;

// Failure modes of J1939-73, annex A.
constexpr std::uint8_t kAboveNormal = 0;
constexpr std::uint8_t kErratic = 2;
constexpr std::uint8_t kVoltageLow = 4;
constexpr std::uint8_t kCurrentLow = 5;
constexpr std::uint8_t kCurrentHigh = 6;
constexpr std::uint8_t kMechanical = 7;
constexpr std::uint8_t kAbnormalRate = 9;
constexpr std::uint8_t kOutOfCalibration = 13;

vehicle::TroubleCode code_of(ValveFault fault, std::uint32_t section) {
  switch (fault) {
    case ValveFault::open_coil:
      return {kCoilSpn + section, kCurrentLow, 1};
    case ValveFault::over_current:
      return {kCoilSpn + section, kCurrentHigh, 1};
    case ValveFault::under_voltage:
      return {kSupplyVoltageSpn, kVoltageLow, 1};
    case ValveFault::spool_not_following:
      return {kPositionSpn + section, kMechanical, 1};
    case ValveFault::sensor:
      return {kPositionSpn + section, kErratic, 1};
    case ValveFault::over_temperature:
      return {kTemperatureSpn, kAboveNormal, 1};
    case ValveFault::none:
    case ValveFault::watchdog:
    case ValveFault::configuration:
      break;
  }
  return {kSetUpSpn, kOutOfCalibration, 1};
}

}  // namespace

IsoValves::IsoValves(const IsoValveSettings& settings, FrameOutput& output)
    : settings_(checked(settings)),
      amplifier_(amplifier_of(settings_)),
      node_(node_of(settings_), *this, output),
      channels_(amplifier_.sections(), IsoValveChannel(settings_.command_timeout)),
      next_tick_(kStart + settings_.power_on + kTick) {
  const auto& names = settings_.amplifier.sections;
  for (std::size_t axis = 0; axis < kJoystickAxes; ++axis) {
    const std::string& lever = settings_.levers[axis];
    const bool turned = lever.starts_with("-");
    const auto found = std::ranges::find(names, turned ? lever.substr(1) : lever);
    if (found != names.end()) {
      levers_[axis] = {static_cast<std::size_t>(found - names.begin()), turned ? -1.0 : 1.0};
    }
  }
  for (IsoValveChannel& channel : channels_) {
    channel.require_neutral();
  }
}

SamplePlan IsoValves::sample_plan() const {
  return {kStart + settings_.power_on, settings_.sample_period};
}

double IsoValves::nominal_rate_hz() const {
  constexpr double kMessagesPerValve = 3.0;
  const double valves = kMessagesPerValve * static_cast<double>(amplifier_.sections());
  const double general = settings_.general_purpose_section != 0 ? 1.0 : 0.0;
  return (valves + general) / to_seconds(kSlots * kTick) +
         1.0 / to_seconds(kDiagnosticTicks * kTick);
}

std::span<const Quantity> IsoValves::quantities() const {
  return kQuantities;
}

std::vector<protocols::can::OwnedMessage> IsoValves::messages(std::string_view name) const {
  return iso::message_layouts(settings_.first_valve, static_cast<unsigned>(channels_.size()),
                              settings_.source_address, std::string(name));
}

SimTime IsoValves::next_event() const {
  SimTime next = std::min({node_.next_event(), amplifier_.next_event(), next_tick_});
  for (const IsoValveChannel& channel : channels_) {
    next = std::min(next, channel.next_event());
  }
  return next;
}

void IsoValves::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    node_.advance(instant);
    follow_address(instant);
    amplifier_.advance(instant);
    follow_fault();
    bool expired = false;
    for (IsoValveChannel& channel : channels_) {
      expired = expired || channel.next_event() <= instant;
      channel.advance(instant);
    }
    if (expired) {
      drive(instant);
    }
    if (next_tick_ == instant) {
      next_tick_ += kTick;
      tick(instant);
    }
  }
}

void IsoValves::follow_address(SimTime now) {
  if (node_.held() == was_held_) {
    return;
  }
  was_held_ = node_.held();
  ValveRequest request;
  request.enable = was_held_;
  amplifier_.request(now, request);
  for (IsoValveChannel& channel : channels_) {
    channel.require_neutral();
  }
}

void IsoValves::follow_fault() {
  if (amplifier_.fault() == seen_fault_) {
    return;
  }
  seen_fault_ = amplifier_.fault();
  for (IsoValveChannel& channel : channels_) {
    if (seen_fault_ != ValveFault::none) {
      channel.require_neutral();
      channel.note(iso::ValveExit::function_fault);
    }
  }
}

void IsoValves::receive(SimTime now, const Frame& frame) {
  advance(now);
  node_.receive(now, frame);
  follow_address(now);
}

void IsoValves::update(const ValveSample& sample) {
  advance(sample.time);
  amplifier_.update(sample);
  follow_fault();
}

J1939Reception IsoValves::take(SimTime now, const J1939Message& message) {
  const Frame frame = j1939::make_frame(message.identifier, message.payload);
  const std::uint32_t pgn = message.identifier.pgn;
  if (const auto valve = iso::valve_of<iso::AuxiliaryValveCommand>(pgn)) {
    const auto command = iso::decode<iso::AuxiliaryValveCommand>(*valve, frame);
    if (!command.ok()) {
      return J1939Reception::malformed;
    }
    const unsigned section = *valve - settings_.first_valve;  // wraps below the first
    return section < channels_.size()
               ? take_command(now, section, message.identifier.source, *command)
               : J1939Reception::ignored;
  }
  if (pgn == iso::GeneralPurposeValveCommand::kGroup.pgn &&
      settings_.general_purpose_section != 0) {
    const auto command = vehicle::decode<iso::GeneralPurposeValveCommand>(frame);
    return command.ok() ? take_command(now, settings_.general_purpose_section - 1U,
                                       message.identifier.source, *command)
                        : J1939Reception::malformed;
  }
  switch (pgn) {
    case vehicle::Bjm1::kGroup.pgn:
    case vehicle::Ejm1::kGroup.pgn:
      return take_joystick<vehicle::Bjm1, vehicle::Ejm1>(now, frame, JoystickAxis::x1);
    case vehicle::Bjm2::kGroup.pgn:
    case vehicle::Ejm2::kGroup.pgn:
      return take_joystick<vehicle::Bjm2, vehicle::Ejm2>(now, frame, JoystickAxis::x2);
    default:
      return J1939Reception::ignored;
  }
}

J1939Reception IsoValves::take_command(SimTime now, std::size_t section, std::uint8_t source,
                                       const iso::ValveCommandMembers& command) {
  if (!channels_[section].command(now, source, command)) {
    return J1939Reception::ignored;
  }
  const bool neutral = command.state == static_cast<std::uint8_t>(iso::ValveState::neutral);
  const auto faulty = amplifier_.fault_section();
  if (neutral && amplifier_.fault() != ValveFault::none && (!faulty || *faulty == section)) {
    reset_fault(now);
  }
  drive(now);
  return J1939Reception::accepted;
}

void IsoValves::reset_fault(SimTime now) {
  ValveRequest request;
  request.fault_reset = true;
  amplifier_.request(now, request);
  request.fault_reset = false;
  amplifier_.request(now, request);
}

template <class Basic, class Extended>
J1939Reception IsoValves::take_joystick(SimTime now, const Frame& frame, JoystickAxis first) {
  const auto axis = static_cast<std::size_t>(first);
  const auto end = levers_.begin() + static_cast<std::ptrdiff_t>(axis + kJoystickAxes / 2);
  if (std::none_of(levers_.begin() + static_cast<std::ptrdiff_t>(axis), end,
                   [](const auto& lever) { return lever.has_value(); })) {
    return J1939Reception::ignored;
  }
  const auto x = [](const auto& m) {
    return vehicle::axis_share(m.x_neutral, m.x_negative, m.x_positive, m.x_share);
  };
  const auto y = [](const auto& m) {
    return vehicle::axis_share(m.y_neutral, m.y_negative, m.y_positive, m.y_share);
  };
  if (const auto stick = vehicle::decode<Basic>(frame); stick.ok()) {
    move_lever(now, axis, x(*stick));
    move_lever(now, axis + 1, y(*stick));
  } else if (const auto grip = vehicle::decode<Extended>(frame); grip.ok()) {
    move_lever(now, axis + 2, x(*grip));
    move_lever(now, axis + 3, y(*grip));
    move_lever(now, axis + 4,
               vehicle::axis_share(grip->theta_neutral, grip->theta_negative, grip->theta_positive,
                                   grip->theta_share));
  } else {
    return J1939Reception::malformed;
  }
  drive(now);
  return J1939Reception::accepted;
}

void IsoValves::move_lever(SimTime now, std::size_t axis, double share) {
  if (levers_[axis]) {
    channels_[levers_[axis]->section].lever(now, levers_[axis]->sign * share);
  }
}

void IsoValves::drive(SimTime now) {
  ValveRequest request;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    request.command[i] = channels_[i].opening();
    request.floating[i] = channels_[i].floating();
  }
  amplifier_.request(now, request);
  follow_fault();
}

void IsoValves::tick(SimTime now) {
  if (node_.held()) {
    const std::size_t slot = ticks_ % kSlots;
    if (slot < channels_.size()) {
      send_estimate(now, slot);
      send_measurement(now, slot);
      send_position(now, slot);
    } else if (slot == kValveSections && settings_.general_purpose_section != 0) {
      send_general_purpose(now);
    } else if (slot == kSlots - 1) {
      const bool changed = troubles() != reported_;
      if (ticks_ % kDiagnosticTicks == kSlots - 1 ||
          (changed && ticks_ - last_change_tick_ >= kDiagnosticTicks)) {
        last_change_tick_ = changed ? ticks_ : last_change_tick_;
        (void)send_diagnostics(now);
      }
    }
  }
  ++ticks_;
}

template <class Message>
Message IsoValves::estimate(std::size_t section) const {
  const IsoValveChannel& channel = channels_[section];
  const double set_point = amplifier_.set_point(section);
  const bool fault = amplifier_.fault() != ValveFault::none;
  const bool limited = set_point != 0.0 && amplifier_.limited(section);
  Message message;
  message.extend_share = std::max(0.0, set_point);
  message.retract_share = std::max(0.0, -set_point);
  message.state =
      static_cast<std::uint8_t>(fault                          ? iso::ValveState::error
                                : amplifier_.floating(section) ? iso::ValveState::floating
                                : set_point > 0.0              ? iso::ValveState::extend
                                : set_point < 0.0              ? iso::ValveState::retract
                                                               : iso::ValveState::neutral);
  message.fail_safe = static_cast<std::uint8_t>(channel.fail_safe());
  message.limit = static_cast<std::uint8_t>(fault ? iso::ValveLimit::not_recoverable
                                            : channel.by_operator() ? iso::ValveLimit::by_operator
                                            : limited               ? iso::ValveLimit::limited_high
                                                                    : iso::ValveLimit::not_limited);
  message.exit_reason = static_cast<std::uint8_t>(channel.exit_reason());
  return message;
}

void IsoValves::send_estimate(SimTime now, std::size_t section) {
  node_.send(now, iso::encode(valve_of(section), estimate<iso::AuxiliaryValveEstimate>(section),
                              node_.address()));
}

void IsoValves::send_general_purpose(SimTime now) {
  node_.send(now, vehicle::encode(estimate<iso::GeneralPurposeValveEstimate>(
                                      settings_.general_purpose_section - 1U),
                                  node_.address()));
}

void IsoValves::send_measurement(SimTime now, std::size_t section) {
  iso::AuxiliaryValveMeasuredFlow message;
  if (amplifier_.measurements() > 0) {
    const ValveSample& measured = amplifier_.measured();
    const double flow = amplifier_.position(now, section);
    message.extend_share = flow;
    message.retract_share = -flow;
    message.extend_pressure_pa = measured.port_a_pressure_pa[section];
    message.retract_pressure_pa = measured.port_b_pressure_pa[section];
    message.limit = estimate<iso::AuxiliaryValveEstimate>(section).limit;
  }
  node_.send(now, iso::encode(valve_of(section), message, node_.address()));
}

void IsoValves::send_position(SimTime now, std::size_t section) {
  iso::AuxiliaryValveMeasuredPosition message;
  if (amplifier_.measurements() > 0) {
    message.position_share = amplifier_.position(now, section);
    message.position_m = message.position_share * settings_.spool_travel_m;
  }
  message.state = estimate<iso::AuxiliaryValveEstimate>(section).state;
  node_.send(now, iso::encode(valve_of(section), message, node_.address()));
}

J1939Answer IsoValves::answer(SimTime now, std::uint32_t pgn, std::uint8_t destination) {
  const auto section_of = [&](std::optional<unsigned> valve) -> std::optional<std::size_t> {
    const unsigned section = valve ? *valve - settings_.first_valve : 0xFFU;
    return section < channels_.size() ? std::optional<std::size_t>(section) : std::nullopt;
  };
  const std::array functionalities{iso::SupportedFunctionality{}};
  if (const auto answered =
          answer_identification(node_, now, pgn, destination, settings_.identification,
                                settings_.serial, functionalities)) {
    return *answered;
  }
  if (pgn == vehicle::kDm1Pgn) {
    return send_diagnostics(now) ? J1939Answer::sent : J1939Answer::busy;
  }
  if (const auto section = section_of(iso::valve_of<iso::AuxiliaryValveEstimate>(pgn))) {
    send_estimate(now, *section);
  } else if (const auto measured =
                 section_of(iso::valve_of<iso::AuxiliaryValveMeasuredFlow>(pgn))) {
    send_measurement(now, *measured);
  } else if (const auto position =
                 section_of(iso::valve_of<iso::AuxiliaryValveMeasuredPosition>(pgn))) {
    send_position(now, *position);
  } else if (pgn == iso::GeneralPurposeValveEstimate::kGroup.pgn &&
             settings_.general_purpose_section != 0) {
    send_general_purpose(now);
  } else {
    return J1939Answer::unknown;
  }
  return J1939Answer::sent;
}

// What the ISO 11783 valve block says in its trouble codes.

IsoValves::Troubles IsoValves::troubles() const {
  Troubles troubles;
  const auto add = [&](const vehicle::TroubleCode& code) {
    if (troubles.count < troubles.codes.size()) {
      troubles.codes[troubles.count++] = code;
    }
  };
  if (amplifier_.fault() != ValveFault::none) {
    const auto section = static_cast<std::uint32_t>(amplifier_.fault_section().value_or(0));
    add(code_of(amplifier_.fault(), section));
  }
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].timed_out()) {
      add({kCommandSpn + static_cast<std::uint32_t>(i), kAbnormalRate, 1});
    }
  }
  return troubles;
}

bool IsoValves::send_diagnostics(SimTime now) {
  const Troubles troubles = this->troubles();
  vehicle::Lamps lamps;
  lamps.amber_warning = troubles.count != 0;
  lamps.red_stop = amplifier_.fault() != ValveFault::none;
  const vehicle::TroubleReport report =
      vehicle::make_trouble_report(lamps, std::span(troubles.codes).first(troubles.count));
  protocols::j1939::Identifier identifier;
  identifier.pgn = vehicle::kDm1Pgn;
  const bool sent = node_.send(now, identifier, report.payload());
  if (sent) {
    reported_ = troubles;
  }
  return sent;
}

}  // namespace rigwire::emulators
