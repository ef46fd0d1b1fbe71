#include "emulators/vehicle_gateway/vehicle_gateway.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "protocols/j1939/message.h"
#include "protocols/vehicle/message.h"

namespace rigwire::emulators {

namespace iso = protocols::iso11783;
namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using protocols::can::Frame;
using protocols::can::OwnedMessage;

namespace {

constexpr vehicle::Group every(vehicle::Group group, std::chrono::milliseconds period) {
  group.period = period;
  return group;
}

using namespace std::chrono_literals;
constexpr std::array kGatewaySchedule{
    VehicleReport::Entry{every(vehicle::VehiclePosition::kGroup, 1s), 12},
    VehicleReport::Entry{every(vehicle::VehicleDirectionSpeed::kGroup, 1s), 22},
    VehicleReport::Entry{every(vehicle::VehiclePosition2::kGroup, 5s), 32},
};

/// A message of these groups that came by transport is too long for its frame, and so malformed.
template <class Message>
protocols::Decoded<Message> decoded(const J1939Message& message) {
  return message.payload.size() > vehicle::kMessageBytes
             ? protocols::Decoded<Message>(protocols::Malformed{"the message has exactly 8 bytes"})
             : vehicle::decode<Message>(j1939::make_frame(message.identifier, message.payload));
}

/// For those that do not ask the machine for anything.
template <class Message, class Take>
J1939Reception take_decoded(const J1939Message& message, const Take& take) {
  const auto request = decoded<Message>(message);
  if (!request.ok()) {
    return J1939Reception::malformed;
  }
  take(*request);
  return J1939Reception::accepted;
}

/// Until a terminal says otherwise: 24 hours and the units' own habits.
vehicle::LanguageCommand make_language(const VehicleGatewaySettings& settings) {
  constexpr std::uint8_t kComma = 0;
  constexpr std::uint8_t kPoint = 1;
  constexpr std::uint8_t kDayFirst = 0;
  constexpr std::uint8_t kMonthFirst = 3;
  const auto letter = [](const std::string& text, std::size_t index) {
    return static_cast<std::uint8_t>(text[index]);
  };
  const bool us = settings.units == DisplayUnits::us;
  const auto units = static_cast<std::uint8_t>(settings.units);
  // Where there is one kind of units beside the metric ones.
  const std::uint8_t two = settings.units == DisplayUnits::metric ? 0 : 1;
  vehicle::LanguageCommand command;
  command.language_first = letter(settings.language, 0);
  command.language_second = letter(settings.language, 1);
  command.time_format = us ? 1 : 0;
  command.decimal_symbol = settings.units == DisplayUnits::metric ? kComma : kPoint;
  command.date_format = us ? kMonthFirst : kDayFirst;
  command.mass_units = command.volume_units = command.general_units = units;
  command.area_units = command.distance_units = command.force_units = two;
  command.pressure_units = command.temperature_units = two;
  command.country_first = letter(settings.country, 0);
  command.country_second = letter(settings.country, 1);
  return command;
}

/// With the period of its place in the schedule.
template <class Message>
OwnedMessage scheduled(const vehicle::LayoutEnds& ends,
                       std::span<const VehicleReport::Entry> schedule) {
  for (const VehicleReport::Entry& entry : schedule) {
    if (entry.group.pgn == Message::kGroup.pgn) {
      return vehicle::layout<Message>(ends, entry.group);
    }
  }
  return vehicle::layout<Message>(ends);
}

}  // namespace

std::span<const VehicleReport::Entry> VehicleSatellites::schedule() {
  return kGatewaySchedule;
}

void VehicleSatellites::take(const GnssSample& sample) {
  report_.take(sample);
  taken_at_ = sample.time;
}

std::optional<protocols::can::Frame> VehicleSatellites::frame(SimTime now, std::uint32_t pgn,
                                                              std::uint8_t source) const {
  const bool fresh = taken_at_ && now - *taken_at_ <= kStale;
  const PositionReport report = fresh ? report_ : PositionReport{};
  switch (pgn) {
    case vehicle::VehiclePosition::kGroup.pgn:
      return vehicle::encode(report.position, source);
    case vehicle::VehicleDirectionSpeed::kGroup.pgn:
      return vehicle::encode(report.direction, source);
    case vehicle::VehiclePosition2::kGroup.pgn:
      return vehicle::encode(report.quality, source);
    default:
      return std::nullopt;
  }
}

VehicleGateway::VehicleGateway(const VehicleGatewaySettings& settings, FrameOutput& output)
    : J1939Device(make_name(settings.name, settings.serial, settings.arbitrary_address),
                  settings.source_address, settings.supply, settings.processing_delay, output),
      settings_(checked(settings)),
      control_(settings),
      report_(settings),
      language_(make_language(settings)) {
  identify_as({settings_.identification, settings_.serial, {{}, tractor()}});
}

SamplePlan VehicleGateway::sample_plan() const {
  return {kStart + settings_.supply.power_on + settings_.sensor_start_up, kTick};
}

std::span<const Quantity> VehicleGateway::quantities() const {
  return VehicleReport::quantities();
}

double VehicleGateway::nominal_rate_hz() const {
  double rate_hz = TroubleMemory::kRate_hz;
  const auto add = [&](std::span<const VehicleReport::Entry> schedule) {
    for (const VehicleReport::Entry& entry : schedule) {
      if (entry.group.period.count() != 0 && report_.sends(entry)) {
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

std::vector<OwnedMessage> VehicleGateway::messages(std::string_view name) const {
  using namespace vehicle;
  std::vector<OwnedMessage> list;
  const LayoutEnds sent{name, node_.address(), j1939::kGlobalAddress};
  append_layouts<Etc1, Vdc2, Sas, Hrw, Eec1, Esc1, Eec2, Hpg, GuidanceMachineInfo,
                 MachineSelectedSpeed, WheelBasedSpeed, Ebc2, Ccvs1, Etc2, Ebc1,
                 MachineFunctionState, Eac1, Eflp1, Et1, Dd1, VehicleFluids, Tire1, Tire2, Tpri,
                 Tp1, Tp2, Tp3, Hours, Eec3, Vep1, Lfe1, Lfc1, RearHitchStatus, FrontHitchStatus,
                 RearPowerTakeOffStatus, FrontPowerTakeOffStatus, LanguageCommand>(list, sent);
  if (settings_.has_ground_radar) {
    append_layouts<GroundBasedSpeed>(list, sent);
  }
  TroubleMemory::append_layouts(list, sent);
  if (settings_.has_position) {
    const auto schedule = VehicleSatellites::schedule();
    list.push_back(scheduled<VehiclePosition>(sent, schedule));
    list.push_back(scheduled<VehicleDirectionSpeed>(sent, schedule));
    list.push_back(scheduled<VehiclePosition2>(sent, schedule));
  }
  const LayoutEnds taken{"", j1939::kNullAddress, node_.address()};
  append_layouts<Tsc1, Tc1, Xbr, GuidanceCommand, MachineSelectedSpeedCommand, Tprs,
                 MachineFunctionCommand, HitchPowerTakeOffCommand, MaintainPower>(list, taken);
  return list;
}

SimTime VehicleGateway::next_event() const {
  return unsupplied_ ? kNever
                     : std::min({next_node_event(), control_.next_event(), next_tick_,
                                 next_power_change()});
}

SimTime VehicleGateway::next_power_change() const {
  const TractorPower& power = report_.power();
  return key_off_ ? power.off_at() : power.key_off_at();
}

void VehicleGateway::change_power(SimTime now) {
  if (key_off_) {
    unsupplied_ = true;
    control_.lose_supply(now);
  } else {
    key_off_ = true;
    control_.switch_off(now);
  }
}

void VehicleGateway::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    advance_node(instant);
    control_.advance(instant);
    if (next_tick_ == instant) {
      next_tick_ += kTick;
      tick(instant);
    }
    if (next_power_change() == instant) {
      change_power(instant);
    }
  }
}

void VehicleGateway::update(const VehicleSample& sample) {
  advance(sample.time);
  if (unsupplied_ || !supplied() || sample.time < sensors_from_) {
    return;
  }
  report_.take(sample);
  control_.observe(sample.time, report_.speed_mps(sample.time), sample.drives);
}

void VehicleGateway::receive(SimTime now, const Frame& frame) {
  advance(now);
  if (!unsupplied_) {
    J1939Device::receive(now, frame);
  }
}

void VehicleGateway::switched(SimTime now) {
  if (!supplied()) {
    next_tick_ = kNever;
    report_.forget();
    satellites_ = {};
    check_ = TorqueSpeedCheck{false};
    language_ = make_language(settings_);
    control_.fail(now);
    return;
  }
  // Ticks are behind samples.
  const SamplePlan grid{kStart + settings_.supply.power_on, kTick};
  next_tick_ = grid.next_after(now - Duration{1}) + kTickOffset;
  if (now > grid.first) {
    sensors_from_ = now + settings_.sensor_start_up;  // the plan knows of the first time
  }
}

bool VehicleGateway::send_group(SimTime now, std::uint32_t pgn) {
  if (settings_.has_position) {
    if (const auto frame = satellites_.frame(now, pgn, node_.address())) {
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
    if (VehicleReport::is_due(entry, ticks_) && report_.sends(entry) &&
        pace().has_time(now, entry.group.pgn)) {
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
    control_.troubles().send_due(node_, now, ticks_, control_.stopping());
    report_.engine().send_due(node_, now, ticks_);
  }
  ++ticks_;
}

iso::SupportedFunctionality VehicleGateway::tractor() const {
  constexpr auto kFront = static_cast<std::size_t>(ImplementEnd::front);
  constexpr auto kRear = static_cast<std::size_t>(ImplementEnd::rear);
  // Class 1 needs hitch and power take-off at the rear; guidance is always there.
  std::uint8_t options = iso::kTractorGuidance;
  const auto add = [&options](bool there, std::uint8_t option) {
    options = static_cast<std::uint8_t>(options | (there ? option : 0U));
  };
  add(settings_.has_hitch[kRear] && settings_.has_power_take_off[kRear], iso::kTractorClass1);
  add(settings_.has_position, iso::kTractorNavigation);
  add(settings_.has_hitch[kFront], iso::kTractorFrontHitch);
  return {iso::Functionality::basic_tractor_ecu_server, 1, {options}};
}

J1939Answer VehicleGateway::answer_group(SimTime now, std::uint32_t pgn, std::uint8_t destination) {
  switch (pgn) {
    case vehicle::kEngineConfigurationPgn:
      return report_.engine().send_configuration(node_, now, destination);
    case vehicle::LanguageCommand::kGroup.pgn:
      node_.send(now, vehicle::encode(language_, node_.address()));
      return J1939Answer::sent;
    default:
      return send_group(now, pgn) ? J1939Answer::sent : J1939Answer::unknown;
  }
}

bool VehicleGateway::is_command(std::uint32_t pgn) const {
  constexpr std::array kCommands{vehicle::Tsc1::kGroup.pgn,
                                 vehicle::Tc1::kGroup.pgn,
                                 vehicle::Xbr::kGroup.pgn,
                                 vehicle::GuidanceCommand::kGroup.pgn,
                                 vehicle::MachineSelectedSpeedCommand::kGroup.pgn,
                                 vehicle::Tprs::kGroup.pgn,
                                 vehicle::MachineFunctionCommand::kGroup.pgn,
                                 vehicle::HitchPowerTakeOffCommand::kGroup.pgn,
                                 vehicle::MaintainPower::kGroup.pgn,
                                 vehicle::LanguageCommand::kGroup.pgn};
  return std::ranges::find(kCommands, pgn) != kCommands.end();
}

J1939Reception VehicleGateway::obey(SimTime now, const J1939Message& message) {
  switch (message.identifier.pgn) {
    case vehicle::Tsc1::kGroup.pgn:
      return take_engine_request(now, message);
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
    case vehicle::HitchPowerTakeOffCommand::kGroup.pgn:
      return take_command<vehicle::HitchPowerTakeOffCommand>(now, message,
                                                             VehicleRequest::implement);
    case vehicle::MaintainPower::kGroup.pgn:
      return take_decoded<vehicle::MaintainPower>(message, [&](const auto& request) {
        if (request.ecu_power == vehicle::Switch::on ||
            request.actuator_power == vehicle::Switch::on) {
          report_.power().maintain(now);
        }
      });
    case vehicle::LanguageCommand::kGroup.pgn:
      return take_decoded<vehicle::LanguageCommand>(
          message, [this](const auto& command) { language_ = command; });
    default:
      return J1939Reception::ignored;
  }
}

J1939Reception VehicleGateway::take_engine_request(SimTime now, const J1939Message& message) {
  const auto request = decoded<vehicle::Tsc1>(message);
  if (!request.ok()) {
    return J1939Reception::malformed;
  }
  const Frame frame = j1939::make_frame(message.identifier, message.payload);
  const bool right = check_.passes(frame, *request, message.identifier.source);
  control_.note_engine_request(right);
  return right ? take_command<vehicle::Tsc1>(now, message, VehicleRequest::engine)
               : J1939Reception::ignored;
}

template <class Message>
J1939Reception VehicleGateway::take_command(SimTime now, const J1939Message& message,
                                            bool refuse_it) {
  const auto request = decoded<Message>(message);
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
