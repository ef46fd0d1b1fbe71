#include "emulators/vehicle_gateway/control.h"

#include <algorithm>
#include <cmath>

#include "protocols/j1939/identifier.h"

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;
using vehicle::ExitReason;
using vehicle::FailureMode;
using vehicle::LimitStatus;
using vehicle::SteeringMode;
using vehicle::Switch;

namespace {

constexpr std::array<VehicleRequest, kVehicleRequests> kRequests{
    VehicleRequest::engine,   VehicleRequest::gearbox, VehicleRequest::brake,
    VehicleRequest::guidance, VehicleRequest::speed,   VehicleRequest::implement};
constexpr std::size_t kGearRefused = kVehicleRequests;
constexpr std::size_t kEngineRequestInError = kGearRefused + 1;

// The parameters whose absence is reported, in the order of VehicleRequest, then those that were
// not understood.
constexpr std::array<TroubleMemory::Kind, kEngineRequestInError + 1> kTroubles{
    {{695, FailureMode::abnormal_update_rate},
     {525, FailureMode::abnormal_update_rate},
     {2920, FailureMode::abnormal_update_rate},
     {5237, FailureMode::abnormal_update_rate},
     {4310, FailureMode::abnormal_update_rate},
     {1874, FailureMode::abnormal_update_rate},
     {525, FailureMode::received_data_in_error},
     {695, FailureMode::received_data_in_error}}};

constexpr SteeringMode first_mode(SteeringLayout layout) {
  return layout == SteeringLayout::front_only ? SteeringMode::front : SteeringMode::counter;
}

/// On or off; what is neither leaves `value` alone.
void set(bool& value, Switch request) {
  if (request == Switch::on || request == Switch::off) {
    value = request == Switch::on;
  }
}

}  // namespace

VehicleControl::VehicleControl(const VehicleGatewaySettings& settings)
    : settings_(settings), troubles_(kTroubles), mode_(first_mode(settings.steering)) {
  deadline_.fill(kNever);
}

SimTime VehicleControl::next_event() const {
  return *std::ranges::min_element(deadline_);
}

void VehicleControl::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    for (const VehicleRequest source : kRequests) {
      if (deadline_[index(source)] == instant) {
        lose(instant, source);
      }
    }
    compose(instant);
  }
}

Duration VehicleControl::timeout(VehicleRequest source) const {
  const VehicleTimeouts& t = settings_.timeouts;
  const std::array<Duration, kVehicleRequests> timeouts{t.engine,   t.gearbox, t.brake,
                                                        t.guidance, t.speed,   t.implement};
  return timeouts[index(source)];
}

void VehicleControl::note_engine_request(bool right) {
  troubles_.set(kEngineRequestInError, !right);
}

std::uint8_t VehicleControl::requester(VehicleRequest source) const {
  return in_force(source) ? requester_[index(source)] : protocols::j1939::kGlobalAddress;
}

bool VehicleControl::in_force(VehicleRequest source) const {
  return deadline_[index(source)] != kNever;
}

void VehicleControl::renew(SimTime now, VehicleRequest source) {
  deadline_[index(source)] = now + timeout(source);
  troubles_.set(index(source), false);
}

void VehicleControl::end(VehicleRequest source) {
  deadline_[index(source)] = kNever;
  troubles_.set(index(source), false);
}

void VehicleControl::lose(SimTime now, VehicleRequest source) {
  deadline_[index(source)] = kNever;
  troubles_.set(index(source), true);
  switch (source) {
    case VehicleRequest::engine:
      clear_engine_limit();
      asked_.engine_control = EngineControl::torque;
      asked_.engine_torque_share = 0.0;
      asked_.engine_speed_radps = 0.0;
      break;
    case VehicleRequest::gearbox:
      break;
    case VehicleRequest::brake:
      asked_.brake_share = 0.0;
      break;
    case VehicleRequest::guidance:
      fail_guidance(now, ExitReason::command_timeout);
      break;
    case VehicleRequest::speed:
      asked_.travel_speed_mps = 0.0;
      speed_exit_ = ExitReason::command_timeout;
      speed_clipped_ = false;
      break;
    case VehicleRequest::implement:
      asked_.hitch_share = {};
      asked_.power_take_off = {};
      break;
  }
}

void VehicleControl::fail_guidance(SimTime now, ExitReason reason) {
  guidance_exit_ = reason;
  if (guidance_ == Guidance::engaged) {
    guidance_ = Guidance::fault;
    deadline_[index(VehicleRequest::guidance)] = kNever;
    compose(now);
  }
}

void VehicleControl::clear_engine_limit() {
  asked_.engine_speed_limit_radps = VehicleCommand{}.engine_speed_limit_radps;
  asked_.engine_torque_limit_share = VehicleCommand{}.engine_torque_limit_share;
}

bool VehicleControl::take(SimTime now, const vehicle::Tsc1& request) {
  const auto mode = static_cast<vehicle::OverrideMode>(request.override_mode);
  if (!is_complete(request)) {
    return false;
  }
  const bool drives = mode == vehicle::OverrideMode::speed || mode == vehicle::OverrideMode::torque;
  if (drives && !in_force(VehicleRequest::engine) && !in_force(VehicleRequest::speed)) {
    asked_.travel_speed_mps.reset();  // TSC1 takes over, without a speed request
  }
  clear_engine_limit();
  switch (mode) {
    case vehicle::OverrideMode::speed:
      asked_.engine_control = EngineControl::speed;
      asked_.engine_speed_radps = request.speed_radps;
      asked_.engine_torque_share = 0.0;
      break;
    case vehicle::OverrideMode::torque:
      asked_.engine_control = EngineControl::torque;
      asked_.engine_torque_share = std::clamp(request.torque_share, 0.0, 1.0);
      asked_.engine_speed_radps = 0.0;
      break;
    case vehicle::OverrideMode::limit:  // of what the travel speed asks of the engine
      if (std::isfinite(request.speed_radps)) {
        asked_.engine_speed_limit_radps = request.speed_radps;
      }
      if (std::isfinite(request.torque_share)) {
        asked_.engine_torque_limit_share = std::clamp(request.torque_share, 0.0, 1.0);
      }
      asked_.engine_control = EngineControl::torque;
      asked_.engine_torque_share = 0.0;
      asked_.engine_speed_radps = 0.0;
      break;
    case vehicle::OverrideMode::disabled:
      asked_.engine_control = EngineControl::torque;
      asked_.engine_torque_share = 0.0;
      asked_.engine_speed_radps = 0.0;
      end(VehicleRequest::engine);
      compose(now);
      return true;
  }
  renew(now, VehicleRequest::engine);
  compose(now);
  return true;
}

bool VehicleControl::take(SimTime now, const vehicle::Tc1& request) {
  const auto gear = vehicle::gear_of(request.requested_gear);
  const bool park = request.requested_gear == vehicle::kGearPark;
  renew(now, VehicleRequest::gearbox);
  if (gear && (*gear < -settings_.gears_reverse || *gear > settings_.gears_forward)) {
    troubles_.set(kGearRefused, true);
    compose(now);
    return false;
  }
  if (gear || park) {
    asked_.gear = gear.value_or(0);
    asked_.parking_brake = asked_.parking_brake || park;
    troubles_.set(kGearRefused, false);
  }
  const auto lock = [this](Differential differential, Switch disengage) {
    if (disengage == Switch::off || disengage == Switch::on) {
      asked_.lock[static_cast<std::size_t>(differential)] = disengage == Switch::off;
    }
  };
  lock(Differential::front, request.disengage_front_lock_1);
  lock(Differential::centre, request.disengage_central_lock);
  lock(Differential::rear, request.disengage_rear_lock_1);
  compose(now);
  return true;
}

bool VehicleControl::take(SimTime now, const vehicle::Xbr& request) {
  const auto mode = static_cast<vehicle::BrakeControlMode>(request.control_mode);
  if (mode != vehicle::BrakeControlMode::addition && mode != vehicle::BrakeControlMode::maximum) {
    asked_.brake_share = 0.0;
    end(VehicleRequest::brake);
    compose(now);
    return true;
  }
  if (!std::isfinite(request.acceleration_mps2)) {
    return false;
  }
  asked_.brake_share =
      std::clamp(-request.acceleration_mps2 / settings_.full_brake_deceleration_mps2, 0.0, 1.0);
  renew(now, VehicleRequest::brake);
  compose(now);
  return true;
}

// Engages guidance with the requested curvature, or ends it. After a fault "not intended" is needed
// before the next "intended" is accepted.
bool VehicleControl::take(SimTime now, const vehicle::GuidanceCommand& request) {
  switch (request.intended) {
    case Switch::off:
      guidance_ = Guidance::idle;
      guidance_exit_ = ExitReason::none;
      guidance_limit_ = LimitStatus::not_limited;
      end(VehicleRequest::guidance);
      break;
    case Switch::on:
      if (guidance_ == Guidance::fault) {
        return false;
      }
      if (!std::isfinite(request.curvature_1pm)) {
        fail_guidance(now, ExitReason::out_of_range);
        return false;
      }
      guidance_ = Guidance::engaged;
      guidance_exit_ = ExitReason::none;
      curvature_1pm_ = request.curvature_1pm;
      renew(now, VehicleRequest::guidance);
      steer();
      break;
    case Switch::error:
      fail_guidance(now, ExitReason::other_error);
      return false;
    case Switch::not_available:
      return false;
  }
  compose(now);
  return true;
}

bool VehicleControl::take(SimTime now, const vehicle::MachineSelectedSpeedCommand& request) {
  const bool forward = request.forward == Switch::on;
  if (std::isnan(request.speed_mps) && request.forward == Switch::not_available) {
    if (in_force(VehicleRequest::speed)) {
      // Released: to TSC1 if that is there, else the machine is held.
      end(VehicleRequest::speed);
      asked_.travel_speed_mps =
          in_force(VehicleRequest::engine) ? std::nullopt : std::optional<double>(0.0);
      speed_exit_ = ExitReason::released;
      speed_clipped_ = false;
      compose(now);
    }
    return true;
  }
  if (!std::isfinite(request.speed_mps) || (!forward && request.forward != Switch::off)) {
    if (request.speed_mps == vehicle::kError || request.forward == Switch::error) {
      speed_exit_ = ExitReason::out_of_range;
    }
    return false;
  }
  double limit = forward ? settings_.maximum_speed_mps : settings_.maximum_reverse_speed_mps;
  if (std::isfinite(request.speed_limit_mps)) {
    limit = std::min(limit, request.speed_limit_mps);
  }
  const double speed_mps = std::min(request.speed_mps, limit);
  speed_clipped_ = request.speed_mps > limit;
  speed_exit_ = ExitReason::none;
  asked_.travel_speed_mps = forward ? speed_mps : -speed_mps;
  renew(now, VehicleRequest::speed);
  compose(now);
  return true;
}

bool VehicleControl::take(SimTime now, const vehicle::Tprs& request) {
  const auto tyre = vehicle::tyre_of(request.location);
  const double pressure_pa = request.reference_pressure_pa;
  if (!tyre || !(pressure_pa >= settings_.minimum_tyre_pressure_pa &&
                 pressure_pa <= settings_.maximum_tyre_pressure_pa)) {
    return false;
  }
  asked_.tyre_pressure_pa[*tyre] = pressure_pa;
  compose(now);
  return true;
}

bool VehicleControl::allows(SteeringMode mode) const {
  switch (mode) {
    case SteeringMode::front:
      return true;
    case SteeringMode::counter:
      return settings_.steering != SteeringLayout::front_only;
    case SteeringMode::crab:
      return settings_.steering == SteeringLayout::crab;
    case SteeringMode::not_available:
      break;
  }
  return false;
}

// Refuses the whole message if it requests a steering mode that the machine does not have or a
// spreader rate above its maximum. The crab angle is limited to what both axles can steer.
bool VehicleControl::take(SimTime now, const vehicle::MachineFunctionCommand& request) {
  const auto mode = static_cast<SteeringMode>(request.steering_mode);
  const bool asks_mode = mode != SteeringMode::not_available;
  const bool asks_rate = std::isfinite(request.spreader_rate_kgpm2);
  if ((asks_mode && !allows(mode)) ||
      (asks_rate && request.spreader_rate_kgpm2 > settings_.maximum_spreader_rate_kgpm2)) {
    return false;
  }
  set(asked_.parking_brake, request.parking_brake);
  set(asked_.crawler_group, request.crawler_group);
  set(asked_.vibration[0], request.vibration_front);
  set(asked_.vibration[1], request.vibration_rear);
  if (std::isfinite(request.edge_cutter_share)) {
    asked_.edge_cutter_share = std::clamp(request.edge_cutter_share, 0.0, 1.0);
  }
  if (asks_rate) {
    asked_.spreader_rate_kgpm2 = request.spreader_rate_kgpm2;
  }
  const SteeringMode last_mode = mode_;
  const double last_angle_rad = crab_angle_rad_;
  if (asks_mode) {
    mode_ = mode;
  }
  if (std::isfinite(request.crab_angle_rad)) {
    const double limit_rad =
        std::min(settings_.maximum_front_steer_rad, settings_.maximum_rear_steer_rad);
    crab_angle_rad_ = std::clamp(request.crab_angle_rad, -limit_rad, limit_rad);
  }
  if (mode_ != last_mode || crab_angle_rad_ != last_angle_rad) {
    steer();
  }
  compose(now);
  return true;
}

// Applies what the message requests of the hitches and shafts that the machine has. Economy and
// mode are noted as refused; a message with nothing applicable is refused.
bool VehicleControl::take(SimTime now, const vehicle::HitchPowerTakeOffCommand& request) {
  struct End {
    double hitch_share;
    double speed_radps;
    Switch engage;
    Switch economy;
    Switch mode;
  };
  const std::array<End, kImplementEnds> ends{
      {{request.front_hitch_share, request.front_speed_radps, request.front_engage,
        request.front_economy, request.front_mode},
       {request.rear_hitch_share, request.rear_speed_radps, request.rear_engage,
        request.rear_economy, request.rear_mode}}};
  const auto asks = [](Switch one) { return one == Switch::on || one == Switch::off; };
  bool any = false;
  for (std::size_t i = 0; i < kImplementEnds; ++i) {
    if (settings_.has_hitch[i] && std::isfinite(ends[i].hitch_share)) {
      asked_.hitch_share[i] = std::clamp(ends[i].hitch_share, 0.0, 1.0);
      any = true;
    }
    if (settings_.has_power_take_off[i]) {
      if (asks(ends[i].engage)) {
        asked_.power_take_off[i].engaged = ends[i].engage == Switch::on;
        any = true;
      }
      if (std::isfinite(ends[i].speed_radps)) {
        asked_.power_take_off[i].speed_radps = ends[i].speed_radps;
        any = true;
      }
      economy_refused_[i] = asks(ends[i].economy);
      mode_refused_[i] = asks(ends[i].mode);
    }
  }
  if (!any) {
    return false;
  }
  renew(now, VehicleRequest::implement);
  compose(now);
  return true;
}

void VehicleControl::switch_off(SimTime now) {
  key_off_ = true;
  compose(now);
}

void VehicleControl::lose_supply(SimTime now) {
  asked_.parking_brake = true;
  asked_.gear = 0;
  asked_.hitch_share = {};
  asked_.power_take_off = {};
  compose(now);
}

void VehicleControl::fail(SimTime now) {
  VehicleControl fresh(settings_);
  fresh.troubles_ = troubles_;
  fresh.troubles_.restart();
  fresh.asked_.front_steer_rad = asked_.front_steer_rad;
  fresh.asked_.rear_steer_rad = asked_.rear_steer_rad;
  fresh.command_ = command_;
  fresh.drives_ = drives_;
  fresh.key_off_ = key_off_;
  *this = fresh;
  compose(now);
}

void VehicleControl::steer() {
  // Reference point: rear axle for front steering, half-way between the axles otherwise. With
  // tan(front) = t + d and tan(rear) = t - d the reference point moves at the angle atan(t) with
  // the curvature 2 d cos(atan(t)) / wheelbase; both exact for the equivalent single wheels.
  const double curve = curvature_1pm_ * settings_.wheelbase_m;
  double front_rad = std::atan(curve);
  double rear_rad = 0.0;
  if (mode_ != SteeringMode::front) {
    const double crab_rad = mode_ == SteeringMode::crab ? crab_angle_rad_ : 0.0;
    const double difference = curve / (2.0 * std::cos(crab_rad));
    front_rad = std::atan(std::tan(crab_rad) + difference);
    rear_rad = std::atan(std::tan(crab_rad) - difference);
  }
  asked_.front_steer_rad =
      std::clamp(front_rad, -settings_.maximum_front_steer_rad, settings_.maximum_front_steer_rad);
  asked_.rear_steer_rad =
      std::clamp(rear_rad, -settings_.maximum_rear_steer_rad, settings_.maximum_rear_steer_rad);
  const bool limited = asked_.front_steer_rad != front_rad || asked_.rear_steer_rad != rear_rad;
  // "High" and "low" are those of the wire, on which curvature is right positive.
  guidance_limit_ = !limited               ? LimitStatus::not_limited
                    : curvature_1pm_ < 0.0 ? LimitStatus::limited_high
                                           : LimitStatus::limited_low;
}

void VehicleControl::observe(SimTime now, double speed_mps, bool drives) {
  if (drives != drives_) {
    drives_ = drives;
    compose(now);
  }
  if (!(std::abs(speed_mps) < settings_.standstill_speed_mps)) {
    standing_since_ = kNever;
    return;
  }
  if (standing_since_ == kNever) {
    standing_since_ = now;
  }
  if (stopping_ && now - standing_since_ >= settings_.park_delay && !asked_.parking_brake) {
    asked_.parking_brake = true;
    asked_.gear = 0;
    compose(now);
  }
}

void VehicleControl::travel(VehicleCommand& next) {
  const bool commanded = in_force(VehicleRequest::speed);
  speed_limit_ = speed_clipped_ ? LimitStatus::limited_high : LimitStatus::not_limited;
  if (commanded && (speed_exit_ == ExitReason::gear || speed_exit_ == ExitReason::function_fault)) {
    speed_exit_ = ExitReason::none;
  }
  if (!drives_) {
    next.travel_speed_mps.reset();
    speed_limit_ = LimitStatus::not_recoverable;
    speed_exit_ = ExitReason::function_fault;
    return;
  }
  if (!next.travel_speed_mps) {
    return;
  }
  if (stopping_ && commanded && asked_.travel_speed_mps.value_or(0.0) != 0.0) {
    speed_limit_ = LimitStatus::operator_limited;
  }
  // A gear request in force and the parking brake decide whether it may travel that way.
  const bool held = in_force(VehicleRequest::gearbox);
  const double speed_mps = *next.travel_speed_mps;
  next.automatic_gear = !held;
  if (speed_mps != 0.0 && (next.parking_brake || (held && next.gear * speed_mps <= 0.0))) {
    next.travel_speed_mps = 0.0;
    speed_limit_ = LimitStatus::operator_limited;
    speed_exit_ = ExitReason::gear;
  }
}

void VehicleControl::compose(SimTime now) {
  // A gear that is no longer asked for just stays: that alone is no reason to stop. Implements do
  // not drive.
  const bool any_lost = std::ranges::any_of(kRequests, [this](VehicleRequest source) {
    return source != VehicleRequest::gearbox && source != VehicleRequest::implement && lost(source);
  });
  const bool none_left = std::ranges::none_of(kRequests, [this](VehicleRequest source) {
    return source != VehicleRequest::implement && in_force(source);
  });
  stopping_ = key_off_ || (any_lost && none_left) ||
              (guidance_ == Guidance::fault && settings_.stop_without_guidance);
  VehicleCommand next = asked_;
  next.ignition = !key_off_;
  if (stopping_) {
    next.engine_control = EngineControl::torque;
    next.engine_torque_share = 0.0;
    next.engine_speed_radps = 0.0;
    next.travel_speed_mps = 0.0;
    next.brake_share = std::max(next.brake_share, settings_.stop_brake_share);
  }
  travel(next);
  next.time = command_.time;
  if (next != command_) {
    command_ = next;
    command_.time = now;
  }
}

}  // namespace rigwire::emulators
