#include "emulators/iso_valve/iso_valves.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "fields/check.h"
#include "fields/visitor.h"
#include "protocols/iso11783/auxiliary_valve.h"
#include "protocols/vehicle/joystick.h"

namespace rigwire::emulators {

namespace iso = protocols::iso11783;
namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using fields::in;
using fields::IntegerRule;
using protocols::can::Frame;
using vehicle::signal_of;

namespace {

/// In the order of JoystickAxis.
constexpr std::array<std::string_view, kJoystickAxes> kAxisNames{
    "x1", "y1", "grip_x1", "grip_y1", "theta1", "x2", "y2", "grip_x2", "grip_y2", "theta2"};

[[noreturn]] void refuse(const std::string& setting, const std::string& found,
                         const std::string& allowed) {
  throw std::invalid_argument("iso valves " + setting + ": found " + found + ", allowed " +
                              allowed);
}

constexpr std::array kQuantities{
    quantity(signal_of<iso::AuxiliaryValveEstimate>(&iso::AuxiliaryValveEstimate::extend_share),
             "port flow"),
    quantity(signal_of(&iso::AuxiliaryValveMeasuredFlow::extend_share), "measured flow"),
    quantity(signal_of(&iso::AuxiliaryValveMeasuredFlow::extend_pressure_pa), "port pressure"),
    within(quantity(signal_of(&iso::AuxiliaryValveMeasuredPosition::position_share)), -1.0, 1.0),
    within(quantity(signal_of(&iso::AuxiliaryValveMeasuredPosition::position_m)), -0.032, 0.032),
};

ValveAmplifierSettings amplifier_of(const IsoValveSettings& settings) {
  ValveAmplifierSettings amplifier = settings.amplifier;
  amplifier.parameters.watchdog = Duration{0};
  return amplifier;
}

// What can be wrong, in this order: of the block, of each section's output, of each section's
// commands. Proprietary parameter numbers (J1939-73: 520192 .. 524287) are this project's own; 168
// and 1136 are the standard's supply voltage and control unit temperature.
using Trouble = TroubleMemory::Kind;
using vehicle::FailureMode;
enum BlockTrouble : std::size_t { set_up, supply_voltage, temperature };
constexpr std::array kBlockTroubles{Trouble{520240, FailureMode::out_of_calibration},
                                    Trouble{168, FailureMode::voltage_low},
                                    Trouble{1136, FailureMode::above_normal}};
enum OutputTrouble : std::size_t { coil_open, coil_current, not_following, no_position };
constexpr std::array kOutputTroubles{Trouble{520192, FailureMode::current_low},   // each + section
                                     Trouble{520192, FailureMode::current_high},  //
                                     Trouble{520208, FailureMode::mechanical},    //
                                     Trouble{520208, FailureMode::erratic}};
constexpr Trouble kNoCommand{520224, FailureMode::abnormal_update_rate};  // + section

std::vector<Trouble> troubles_of(std::size_t sections) {
  std::vector<Trouble> troubles(kBlockTroubles.begin(), kBlockTroubles.end());
  for (std::uint32_t section = 0; section < sections; ++section) {
    for (const Trouble& trouble : kOutputTroubles) {
      troubles.push_back({trouble.spn + section, trouble.mode});
    }
  }
  for (std::uint32_t section = 0; section < sections; ++section) {
    troubles.push_back({kNoCommand.spn + section, kNoCommand.mode});
  }
  return troubles;
}

std::size_t trouble_of(ValveFault fault, std::size_t section) {
  const std::size_t output = kBlockTroubles.size() + section * kOutputTroubles.size();
  switch (fault) {
    case ValveFault::open_coil:
      return output + coil_open;
    case ValveFault::over_current:
      return output + coil_current;
    case ValveFault::spool_not_following:
      return output + not_following;
    case ValveFault::sensor:
      return output + no_position;
    case ValveFault::under_voltage:
      return supply_voltage;
    case ValveFault::over_temperature:
      return temperature;
    case ValveFault::none:
    case ValveFault::watchdog:
    case ValveFault::configuration:
      break;
  }
  return set_up;
}

}  // namespace

void visit(fields::Visitor& v, IsoValveSettings& p) {
  v.integer("source_address", p.source_address, IntegerRule{128, 247},
            "Preferred J1939 address; another one is claimed when it is lost.");
  v.integer("serial", p.serial, IntegerRule{0, (1 << 21) - 1},
            "Identity number in the NAME; unique on a bus.");
  v.integer("manufacturer", p.manufacturer, IntegerRule{0, 2047},
            "Manufacturer code in the NAME; 2047 = no number assigned.");
  v.integer("function", p.function, IntegerRule{0, 255},
            "Function in the NAME; 255 = not specified.");
  visit(v, p.identification);
  v.integer("first_valve", p.first_valve, IntegerRule{0, 15},
            "Auxiliary valve of section 1; the others follow.");
  v.integer("general_purpose_section", p.general_purpose_section, IntegerRule{0, 8},
            "Section of the general-purpose valve, from 1; 0 = none.");
  v.duration("command_timeout", p.command_timeout, {100'000'000, 10'000'000'000},
             "Without a command for this long a valve goes to its fail-safe mode.");
  visit(v, p.supply);
  v.duration("processing_delay", p.processing_delay, {0, 4'000'000},
             "Time from an event to its frame.");
  v.rate("rate", p.sample_period, in("Hz").between(1, 1000),
         "Readings of the transducers per second.");
  v.number("spool_travel", p.spool_travel_m, in("mm").between(0.1, 30),
           "Travel of a spool from neutral to full opening.");
  v.group(
      "joysticks",
      [&p](fields::Visitor& w) {
        for (std::size_t axis = 0; axis < kAxisNames.size(); ++axis) {
          w.text(kAxisNames[axis], p.levers[axis],
                 "Section that this axis moves; -section: turned round; empty: none.");
        }
      },
      "The operator's levers: BJM1, EJM1 and BJM2, EJM2.");
  visit(v, p.amplifier);
}

void validate(const IsoValveSettings& settings) {
  fields::check(settings);
  validate(settings.supply);
  validate(settings.amplifier);
  const auto& names = settings.amplifier.sections;
  const std::size_t last_first = protocols::iso11783::kAuxiliaryValves - names.size();
  if (settings.first_valve > last_first) {
    refuse("first_valve", std::to_string(settings.first_valve),
           "0 .. " + std::to_string(last_first));
  }
  if (settings.general_purpose_section > names.size()) {
    refuse("general_purpose_section", std::to_string(settings.general_purpose_section),
           "0 .. " + std::to_string(names.size()));
  }
  for (const std::string& lever : settings.levers) {
    const std::string name = lever.starts_with("-") ? lever.substr(1) : lever;
    if (!lever.empty() && std::ranges::find(names, name) == names.end()) {
      std::string allowed = "a section, or - and a section:";
      for (const std::string& section : names) {
        allowed.append(" ").append(section);
      }
      refuse("joysticks", "\"" + lever + "\"", allowed);
    }
  }
}

IsoValves::IsoValves(const IsoValveSettings& settings, FrameOutput& output)
    : J1939Device(make_name({.manufacturer = settings.manufacturer,
                             .function = settings.function,
                             .industry_group = kAgriculture},
                            settings.serial, true),
                  settings.source_address, settings.supply, settings.processing_delay, output),
      settings_(checked(settings)),
      amplifier_(amplifier_of(settings_)),
      channels_(amplifier_.sections(), IsoValveChannel(settings_.command_timeout)),
      troubles_(troubles_of(amplifier_.sections())) {
  identify_as({settings_.identification, settings_.serial, {{}}});
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

void IsoValves::switched(SimTime now) {
  next_tick_ = supplied() ? now + kTick : kNever;
  if (supplied()) {
    return;
  }
  follow_address(now);  // to neutral
  for (IsoValveChannel& channel : channels_) {
    channel = IsoValveChannel(settings_.command_timeout);
    channel.require_neutral();
  }
  reset_fault(now);
  follow_fault();
  troubles_.restart();
}

SamplePlan IsoValves::sample_plan() const {
  return {kStart + settings_.supply.power_on, settings_.sample_period};
}

double IsoValves::nominal_rate_hz() const {
  constexpr double kMessagesPerValve = 3.0;
  const double valves = kMessagesPerValve * static_cast<double>(amplifier_.sections());
  const double general = settings_.general_purpose_section != 0 ? 1.0 : 0.0;
  return (valves + general) / to_seconds(kSlots * kTick) + TroubleMemory::kRate_hz;
}

std::span<const Quantity> IsoValves::quantities() const {
  return kQuantities;
}

std::vector<protocols::can::OwnedMessage> IsoValves::messages(std::string_view name) const {
  auto list = iso::message_layouts(settings_.first_valve, static_cast<unsigned>(channels_.size()),
                                   settings_.source_address, std::string(name));
  const vehicle::LayoutEnds sent{name, settings_.source_address};
  TroubleMemory::append_layouts(list, sent);
  if (settings_.general_purpose_section != 0) {
    vehicle::append_layouts<iso::GeneralPurposeValveEstimate>(list, sent);
    vehicle::append_layouts<iso::GeneralPurposeValveCommand>(
        list, {"", j1939::kNullAddress, settings_.source_address});
  }
  return list;
}

SimTime IsoValves::next_event() const {
  SimTime next = std::min({next_node_event(), amplifier_.next_event(), next_tick_});
  for (const IsoValveChannel& channel : channels_) {
    next = std::min(next, channel.next_event());
  }
  return next;
}

void IsoValves::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    advance_node(instant);
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
  const ValveFault fault = amplifier_.fault();
  const std::size_t commands = kBlockTroubles.size() + kOutputTroubles.size() * channels_.size();
  const std::size_t wrong = fault != ValveFault::none
                                ? trouble_of(fault, amplifier_.fault_section().value_or(0))
                                : commands;
  for (std::size_t i = 0; i < commands; ++i) {
    troubles_.set(i, i == wrong);
  }
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    troubles_.set(commands + i, channels_[i].timed_out());
  }
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
  J1939Device::receive(now, frame);
  follow_address(now);
}

void IsoValves::update(const ValveSample& sample) {
  advance(sample.time);
  if (!supplied()) {
    return;
  }
  amplifier_.update(sample);
  follow_fault();
}

std::optional<std::size_t> IsoValves::commanded_section(std::uint32_t pgn) const {
  if (const auto valve = iso::valve_of<iso::AuxiliaryValveCommand>(pgn)) {
    const unsigned section = *valve - settings_.first_valve;  // wraps below the first
    return section < channels_.size() ? std::optional<std::size_t>(section) : std::nullopt;
  }
  return pgn == iso::GeneralPurposeValveCommand::kGroup.pgn &&
                 settings_.general_purpose_section != 0
             ? std::optional<std::size_t>(settings_.general_purpose_section - 1U)
             : std::nullopt;
}

bool IsoValves::is_command(std::uint32_t pgn) const {
  return commanded_section(pgn) || pgn == vehicle::Bjm1::kGroup.pgn ||
         pgn == vehicle::Ejm1::kGroup.pgn || pgn == vehicle::Bjm2::kGroup.pgn ||
         pgn == vehicle::Ejm2::kGroup.pgn;
}

void IsoValves::refused(SimTime now, const J1939Message& message) {
  if (const auto section = commanded_section(message.identifier.pgn)) {
    channels_[*section].refuse(now);
    drive(now);
  }
}

J1939Reception IsoValves::obey(SimTime now, const J1939Message& message) {
  const Frame frame = j1939::make_frame(message.identifier, message.payload);
  const std::uint32_t pgn = message.identifier.pgn;
  if (const auto valve = iso::valve_of<iso::AuxiliaryValveCommand>(pgn)) {
    const auto command = iso::decode<iso::AuxiliaryValveCommand>(*valve, frame);
    if (!command.ok()) {
      return J1939Reception::malformed;
    }
    const auto section = commanded_section(pgn);
    return section ? take_command(now, *section, message.identifier.source, *command)
                   : J1939Reception::ignored;
  }
  if (const auto section = commanded_section(pgn)) {
    const auto command = vehicle::decode<iso::GeneralPurposeValveCommand>(frame);
    return command.ok() ? take_command(now, *section, message.identifier.source, *command)
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
    const bool reports = slot < channels_.size() ||
                         (slot == kValveSections && settings_.general_purpose_section != 0);
    const bool in_time = reports && pace().has_time(now, static_cast<std::uint32_t>(slot));
    if (in_time && slot < channels_.size()) {
      send_estimate(now, slot);
      send_measurement(now, slot);
      send_position(now, slot);
    } else if (in_time) {
      send_general_purpose(now);
    } else if (slot == kSlots - 1) {
      // In the last slot of a second where nothing changes.
      constexpr std::uint64_t kAhead = TroubleMemory::kPhaseTicks - (kSlots - 1);
      troubles_.send_due(node_, now, ticks_ + kAhead, is_stopped());
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

J1939Answer IsoValves::answer_group(SimTime now, std::uint32_t pgn, std::uint8_t /*destination*/) {
  const auto section_of = [&](std::optional<unsigned> valve) -> std::optional<std::size_t> {
    const unsigned section = valve ? *valve - settings_.first_valve : 0xFFU;
    return section < channels_.size() ? std::optional<std::size_t>(section) : std::nullopt;
  };
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

}  // namespace rigwire::emulators
