#include "emulators/vehicle_gateway/control.h"

#include <algorithm>
#include <cmath>

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;
using vehicle::ExitReason;
using vehicle::LimitStatus;
using vehicle::SteeringMode;
using vehicle::Switch;

namespace {

constexpr std::array<VehicleRequest, kVehicleRequests> kRequests{
    VehicleRequest::engine, VehicleRequest::gearbox, VehicleRequest::brake,
    VehicleRequest::guidance, VehicleRequest::speed};
constexpr std::size_t kGearFault = kVehicleRequests;

constexpr SteeringMode first_mode(SteeringLayout layout) {
  return layout == SteeringLayout::front_only ? SteeringMode::front : SteeringMode::counter;
}

void count(std::uint8_t& occurrences) {
  occurrences = static_cast<std::uint8_t>(std::min(occurrences + 1, 126));
}

/// On or off; what is neither leaves `value` alone.
void set(bool& value, Switch request) {
  if (request == Switch::on || request == Switch::off) {
    value = request == Switch::on;
  }
}

}  // namespace

VehicleControl::VehicleControl(const VehicleGatewaySettings& settings)
    : settings_(settings), mode_(first_mode(settings.steering)) {
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
  const std::array<Duration, kVehicleRequests> timeouts{t.engine, t.gearbox, t.brake, t.guidance,
                                                        t.speed};
  return timeouts[index(source)];
}

bool VehicleControl::in_force(VehicleRequest source) const {
  return deadline_[index(source)] != kNever;
}

void VehicleControl::renew(SimTime now, VehicleRequest source) {
  deadline_[index(source)] = now + timeout(source);
  lost_[index(source)] = false;
}

void VehicleControl::end(VehicleRequest source) {
  deadline_[index(source)] = kNever;
  lost_[index(source)] = false;
}

void VehicleControl::lose(SimTime now, VehicleRequest source) {
  deadline_[index(source)] = kNever;
  lost_[index(source)] = true;
  count(occurrences_[index(source)]);
  switch (source) {
    case VehicleRequest::engine:
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

bool VehicleControl::take(SimTime now, const vehicle::Tsc1& request) {
  switch (static_cast<vehicle::OverrideMode>(request.override_mode)) {
    case vehicle::OverrideMode::speed:
      if (!std::isfinite(request.speed_radps)) {
        return false;
      }
      asked_.engine_control = EngineControl::speed;
      asked_.engine_speed_radps = request.speed_radps;
      asked_.engine_torque_share = 0.0;
      break;
    case vehicle::OverrideMode::torque:
      if (!std::isfinite(request.torque_share)) {
        return false;
      }
      asked_.engine_control = EngineControl::torque;
      asked_.engine_torque_share = std::clamp(request.torque_share, 0.0, 1.0);
      asked_.engine_speed_radps = 0.0;
      break;
    case vehicle::OverrideMode::disabled:
    case vehicle::OverrideMode::limit:  // nobody else's demand is there to be limited
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
    if (!gear_refused_) {
      count(occurrences_[kGearFault]);
    }
    gear_refused_ = true;
    compose(now);
    return false;
  }
  if (gear || park) {
    asked_.gear = gear.value_or(0);
    asked_.parking_brake = asked_.parking_brake || park;
    gear_refused_ = false;
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
  if (!std::isfinite(request.speed_mps) || (!forward && request.forward != Switch::off)) {
    return false;
  }
  double limit = forward ? settings_.maximum_speed_mps : settings_.maximum_reverse_speed_mps;
  if (std::isfinite(request.speed_limit_mps)) {
    limit = std::min(limit, request.speed_limit_mps);
  }
  const double speed_mps = std::min(request.speed_mps, limit);
  speed_limit_ = request.speed_mps > limit ? LimitStatus::limited_high : LimitStatus::not_limited;
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

void VehicleControl::observe(SimTime now, double speed_mps) {
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

void VehicleControl::compose(SimTime now) {
  const auto is_in_force = [this](VehicleRequest source) { return in_force(source); };
  // A gear that is no longer asked for just stays: that alone is no reason to stop.
  const bool any_lost = std::ranges::any_of(kRequests, [this](VehicleRequest source) {
    return source != VehicleRequest::gearbox && lost_[index(source)];
  });
  const bool none_left = std::ranges::none_of(kRequests, is_in_force);
  stopping_ =
      (any_lost && none_left) || (guidance_ == Guidance::fault && settings_.stop_without_guidance);
  VehicleCommand next = asked_;
  if (stopping_) {
    next.engine_control = EngineControl::torque;
    next.engine_torque_share = 0.0;
    next.engine_speed_radps = 0.0;
    next.travel_speed_mps = 0.0;
    next.brake_share = std::max(next.brake_share, settings_.stop_brake_share);
  }
  next.time = command_.time;
  if (next != command_) {
    command_ = next;
    command_.time = now;
  }
}

}  // namespace rigwire::emulators
