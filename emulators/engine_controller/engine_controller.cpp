#include "emulators/engine_controller/engine_controller.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fields/check.h"
#include "fields/visitor.h"
#include "protocols/j1939/message.h"
#include "protocols/vehicle/condition.h"
#include "protocols/vehicle/engine_configuration.h"
#include "protocols/vehicle/machine.h"
#include "protocols/vehicle/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using fields::IntegerRule;
using protocols::can::Frame;
using vehicle::FailureMode;
using vehicle::is;
using vehicle::magnitude;
using vehicle::reading;

namespace {

// What is wrong is the request: engine override control mode.
enum Trouble : std::size_t { request_lost, request_in_error };
constexpr std::array kTroubles{TroubleMemory::Kind{695, FailureMode::abnormal_update_rate},
                               TroubleMemory::Kind{695, FailureMode::received_data_in_error}};

using Entry = EngineController::Entry;
constexpr std::array kSchedule{
    Entry{vehicle::Eec1::kGroup, 0},  Entry{vehicle::Eec2::kGroup, 1},
    Entry{vehicle::Hpg::kGroup, 3},   Entry{vehicle::Lfe1::kGroup, 4},
    Entry{vehicle::Eec3::kGroup, 12}, Entry{vehicle::Eflp1::kGroup, 13},
    Entry{vehicle::Et1::kGroup, 33},  Entry{vehicle::Dd1::kGroup, 53},
    Entry{vehicle::Vep1::kGroup, 93}, Entry{vehicle::Hours::kGroup, 0},
    Entry{vehicle::Lfc1::kGroup, 0},
};

constexpr std::array kQuantities{
    quantity(vehicle::signal_of(&vehicle::Eec1::speed_radps)),
    quantity(vehicle::signal_of(&vehicle::Eec1::actual_torque_share), "engine torque"),
    quantity(vehicle::signal_of(&vehicle::Eec2::load_share), "load"),
    quantity(vehicle::signal_of(&vehicle::Hpg::pressure_pa), "pump pressure"),
};

}  // namespace

void visit(fields::Visitor& v, EngineControllerSettings& p) {
  v.integer("source_address", p.source_address, IntegerRule{0, 253},
            "Preferred J1939 address; 0 = engine 1.");
  v.integer("serial", p.serial, IntegerRule{0, (1 << 21) - 1},
            "Identity number in the NAME; unique on a bus.");
  visit(v, p.name);
  visit(v, p.identification);
  v.duration("engine_hours", p.engine_hours, {0, 720'000'000'000'000'000},
             "Hours of the engine when the run begins.");
  visit(v, p.supply);
  v.duration("processing_delay", p.processing_delay, {0, 5'000'000},
             "Time from an event to its frame.");
  v.duration("request_timeout", p.request_timeout, {10'000'000, 10'000'000'000},
             "Without TSC1 for so long the engine is the dial's again.");
  v.boolean("requires_checksum", p.requires_checksum,
            "Requests without counter and checksum are refused.");
}

void validate(const EngineControllerSettings& settings) {
  fields::check(settings);
  validate(settings.supply);
}

EngineController::EngineController(const EngineControllerSettings& settings, FrameOutput& output)
    : J1939Device(make_name(settings.name, settings.serial, false), settings.source_address,
                  settings.supply, settings.processing_delay, output),
      settings_(checked(settings)),
      report_(settings_.engine, settings_.engine_hours),
      troubles_(kTroubles),
      check_(settings_.requires_checksum) {
  identify_as({settings_.identification, settings_.serial});
}

std::span<const Entry> EngineController::schedule() {
  return kSchedule;
}

SamplePlan EngineController::sample_plan() const {
  return {kStart + settings_.supply.power_on, kTick};
}

double EngineController::nominal_rate_hz() const {
  double rate_hz = TroubleMemory::kRate_hz;
  for (const Entry& entry : kSchedule) {
    if (entry.group.period.count() != 0) {
      rate_hz += 1.0 / to_seconds(Duration{entry.group.period});
    }
  }
  return rate_hz;
}

std::span<const Quantity> EngineController::quantities() const {
  return kQuantities;
}

std::vector<protocols::can::OwnedMessage> EngineController::messages(std::string_view name) const {
  const vehicle::LayoutEnds sent{name, settings_.source_address, j1939::kGlobalAddress};
  const vehicle::LayoutEnds taken{"", j1939::kNullAddress, settings_.source_address};
  using namespace vehicle;
  std::vector<protocols::can::OwnedMessage> list;
  append_layouts<Eec1, Eec2, Hpg, Lfe1, Eec3, Eflp1, Et1, Dd1, Vep1, Hours, Lfc1>(list, sent);
  TroubleMemory::append_layouts(list, sent);
  append_layouts<Tsc1>(list, taken);
  return list;
}

SimTime EngineController::next_event() const {
  return std::min({next_node_event(), next_tick_, request_ ? request_->expires : kNever});
}

void EngineController::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    advance_node(instant);
    if (request_ && request_->expires == instant) {
      end_request();
      command_.time = instant;
      troubles_.set(request_lost, true);
    }
    if (next_tick_ == instant) {
      next_tick_ += kTick;
      tick(instant);
    }
  }
}

void EngineController::update(const PowerUnitSample& sample) {
  advance(sample.time);
  report_.take(sample.time, sample.engine);
  if (supplied()) {
    sample_ = sample;
  }
}

void EngineController::switched(SimTime now) {
  if (supplied()) {
    // Behind the first sample from now on.
    next_tick_ = sample_plan().next_after(now - Duration{1}) + kTickOffset;
    return;
  }
  next_tick_ = kNever;
  sample_.reset();
  check_ = TorqueSpeedCheck(settings_.requires_checksum);
  troubles_.restart();
  end_request();
  command_.time = now;
}

void EngineController::tick(SimTime now) {
  if (node_.held()) {
    for (const Entry& entry : kSchedule) {
      const auto period = static_cast<std::uint64_t>(Duration{entry.group.period} / kTick);
      if (period != 0 && ticks_ % period == entry.phase && pace().has_time(now, entry.group.pgn)) {
        (void)send_group(now, entry.group.pgn);
      }
    }
    troubles_.send_due(node_, now, ticks_);
    report_.send_due(node_, now, ticks_);
  }
  ++ticks_;
}

bool EngineController::send_group(SimTime now, std::uint32_t pgn) {
  const PowerUnitSample* const s = sample_ ? &*sample_ : nullptr;
  if (const auto frame = report_.frame(pgn, node_.address(), s != nullptr ? &s->engine : nullptr)) {
    node_.send(now, *frame);
    return true;
  }
  const auto send = [&](const auto& message) {
    node_.send(now, vehicle::encode(message, node_.address()));
    return true;
  };
  if (is<vehicle::Eec1>(pgn)) {
    vehicle::Eec1 message;
    if (s != nullptr) {
      // SPN 899: 3: a governor holds the speed; 11: another node requests it.
      constexpr std::uint8_t kSpeedGovernor = 3;
      constexpr std::uint8_t kRemote = 11;
      message.torque_mode = request_ ? kRemote : kSpeedGovernor;
      message.actual_torque_share = report_.torque_share(s->engine);
      message.engine_demand_torque_share = message.actual_torque_share;
      message.speed_radps = magnitude(s->engine.speed_radps);
      message.controlling_address = request_ ? request_->source : node_.address();
    }
    return send(message);
  }
  if (is<vehicle::Eec2>(pgn)) {
    vehicle::Eec2 message;
    if (s != nullptr) {
      message.pedal_share = reading(s->dial_share);
      message.load_share = EngineReport::load_share(s->engine);
    }
    return send(message);
  }
  if (is<vehicle::Hpg>(pgn)) {
    return send(vehicle::Hpg{s != nullptr ? reading(s->pump_pressure_pa) : vehicle::kNotAvailable});
  }
  return false;
}

J1939Answer EngineController::answer_group(SimTime now, std::uint32_t pgn,
                                           std::uint8_t destination) {
  if (pgn == vehicle::kEngineConfigurationPgn) {
    return report_.send_configuration(node_, now, destination);
  }
  return send_group(now, pgn) ? J1939Answer::sent : J1939Answer::unknown;
}

J1939Reception EngineController::obey(SimTime now, const J1939Message& message) {
  return is_command(message.identifier.pgn) ? take_request(now, message) : J1939Reception::ignored;
}

J1939Reception EngineController::take_request(SimTime now, const J1939Message& message) {
  if (message.payload.size() != vehicle::kMessageBytes) {
    return J1939Reception::malformed;
  }
  const Frame frame = j1939::make_frame(message.identifier, message.payload);
  const auto decoded = vehicle::decode<vehicle::Tsc1>(frame);
  if (!decoded.ok()) {
    return J1939Reception::malformed;
  }
  const std::uint8_t source = message.identifier.source;
  const bool right = check_.passes(frame, *decoded, source);
  troubles_.set(request_in_error, !right);
  if (!right || !is_complete(*decoded)) {
    return J1939Reception::ignored;
  }
  if (request_ && request_->source != source && decoded->priority >= request_->priority) {
    return J1939Reception::ignored;
  }
  if (decoded->override_mode == static_cast<std::uint8_t>(vehicle::OverrideMode::disabled)) {
    if (request_ && request_->source == source) {
      end_request();
      command_.time = now;
    }
    return J1939Reception::accepted;
  }
  troubles_.set(request_lost, false);
  request_ = Request{source, decoded->priority, now + settings_.request_timeout};
  govern(now, *decoded);
  return J1939Reception::accepted;
}

void EngineController::govern(SimTime now, const vehicle::Tsc1& request) {
  PowerUnitCommand next;
  const auto mode = static_cast<vehicle::OverrideMode>(request.override_mode);
  const bool torque = std::isfinite(request.torque_share);
  const bool speed = std::isfinite(request.speed_radps);
  if (mode == vehicle::OverrideMode::speed) {
    next.speed_radps = request.speed_radps;
  }
  if ((mode == vehicle::OverrideMode::limit || mode == vehicle::OverrideMode::torque) && torque) {
    // A governed engine takes a requested torque for its limit.
    next.torque_limit_share = std::clamp(request.torque_share, 0.0, 1.0);
  }
  if (mode == vehicle::OverrideMode::limit && speed && sample_) {
    next.speed_radps = std::min(request.speed_radps, sample_->dial_radps);
  }
  if (next != command_) {
    command_ = next;
    command_.time = now;
  }
}

void EngineController::end_request() {
  request_.reset();
  command_ = {};
}

}  // namespace rigwire::emulators
