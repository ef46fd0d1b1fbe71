#include "emulators/iso_valve/channel.h"

#include <algorithm>
#include <cmath>

namespace rigwire::emulators {

using namespace protocols::iso11783;

namespace {

constexpr std::uint8_t kExtendedResolution = 1;

/// What a command asks for; nothing when state and value do not agree.
struct Demand {
  double share = 0.0;
  bool floating = false;
};
std::optional<Demand> demand_of(const ValveCommandMembers& command) {
  const bool extended =
      command.resolution == kExtendedResolution || !std::isfinite(command.flow_share);
  const double flow = extended ? command.extended_flow_share : command.flow_share;
  const bool none = std::isnan(flow) || flow == 0.0;
  const bool usable = std::isfinite(flow) && flow >= 0.0 && flow <= 1.0;
  switch (static_cast<ValveState>(command.state)) {
    case ValveState::neutral:
      return none ? std::optional(Demand{}) : std::nullopt;
    case ValveState::extend:
      return usable ? std::optional(Demand{flow, false}) : std::nullopt;
    case ValveState::retract:
      return usable ? std::optional(Demand{-flow, false}) : std::nullopt;
    case ValveState::floating:
      return none ? std::optional(Demand{0.0, true}) : std::nullopt;
    default:
      return std::nullopt;
  }
}

}  // namespace

bool IsoValveChannel::command(SimTime now, std::uint8_t source,
                              const ValveCommandMembers& command) {
  advance(now);
  if (commander_ && *commander_ != source) {
    return false;
  }
  const auto demand = demand_of(command);
  if (!demand) {
    exit_ = ValveExit::out_of_range;
    return false;
  }
  commander_ = source;
  command_expires_ = now + timeout_;
  timed_out_ = false;
  if (command.fail_safe <= static_cast<std::uint8_t>(FailSafeMode::floating)) {
    fail_safe_ = static_cast<FailSafeMode>(command.fail_safe);
  }
  const bool neutral = demand->share == 0.0 && !demand->floating;
  neutral_required_ = neutral_required_ && !neutral;
  if (neutral_required_) {
    commanded_ = 0.0;
    float_commanded_ = false;
    return true;
  }
  commanded_ = demand->share;
  float_commanded_ = demand->floating;
  if (!by_operator()) {
    exit_ = ValveExit::none;
  }
  return true;
}

void IsoValveChannel::lever(SimTime now, double share) {
  advance(now);
  if (!std::isfinite(share)) {
    return;
  }
  lever_expires_ = now + timeout_;
  lever_was_neutral_ = lever_was_neutral_ || share == 0.0;
  const double taken = lever_was_neutral_ ? std::clamp(share, -1.0, 1.0) : 0.0;
  if (taken != 0.0) {
    exit_ = ValveExit::operator_override;
    require_neutral();
  }
  lever_share_ = taken;
}

void IsoValveChannel::refuse(SimTime now) {
  advance(now);
  commander_.reset();
  command_expires_ = kNever;
  timed_out_ = false;
  require_neutral();
  exit_ = ValveExit::error;
}

void IsoValveChannel::require_neutral() {
  neutral_required_ = true;
  commanded_ = 0.0;
  float_commanded_ = false;
}

SimTime IsoValveChannel::next_event() const {
  return std::min(command_expires_, lever_expires_);
}

void IsoValveChannel::advance(SimTime now) {
  if (lever_expires_ <= now) {
    lever_expires_ = kNever;
    lever_share_ = 0.0;
    lever_was_neutral_ = false;
  }
  if (command_expires_ <= now) {
    command_expires_ = kNever;
    commander_.reset();
    timed_out_ = true;
    require_neutral();
    float_commanded_ = fail_safe_ == FailSafeMode::floating;
    exit_ = by_operator() ? exit_ : ValveExit::command_timeout;
  }
}

double IsoValveChannel::opening() const {
  return by_operator() ? lever_share_ : commanded_;
}

bool IsoValveChannel::floating() const {
  return !by_operator() && float_commanded_;
}

}  // namespace rigwire::emulators
