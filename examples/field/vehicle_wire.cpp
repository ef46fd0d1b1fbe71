#include "field/vehicle_wire.h"

#include <cmath>
#include <utility>

#include "field/geometry.h"
#include "protocols/j1939/message.h"
#include "protocols/openimu/messages.h"
#include "protocols/vehicle/brake.h"
#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/speed.h"
#include "protocols/vehicle/steering.h"
#include "protocols/vehicle/transmission.h"

namespace rigwire::field {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
namespace vehicle = protocols::vehicle;
using vehicle::Switch;

namespace {

/// Whether a message with this period is due in this tick.
bool due(std::uint64_t tick, int period_ms) {
  return tick % static_cast<std::uint64_t>(period_ms / VehicleWire::kTick_ms) == 0;
}

}  // namespace

VehicleWire::VehicleWire(const VehicleWireSettings& settings, Heard heard)
    : settings_(settings), heard_(std::move(heard)) {}

void VehicleWire::take_speed(double speed_mps, Switch forward) {
  if (std::isfinite(speed_mps)) {
    readings_.wheel_based_speed_mps = forward == Switch::off ? -speed_mps : speed_mps;
  }
}

void VehicleWire::receive(const protocols::can::Frame& frame) {
  const auto identifier = j1939::identify(frame);
  if (!identifier) {
    return;
  }
  if (identifier->source == settings_.imu && identifier->pgn == openimu::kAngularRatePgn) {
    const auto rate = openimu::decode<openimu::AngularRate>(frame);
    if (rate.ok() && std::isfinite(rate->yaw_dps) &&
        rate->yaw_merit != openimu::FigureOfMerit::kError) {
      yaw_sum_radps_ -= rate->yaw_dps * kDegree;  // Positive clockwise on the wire.
      ++yaw_count_;
      heard_.imu();
    }
    return;
  }
  if (identifier->source != settings_.gateway) {
    return;
  }
  const auto take = [&]<class Message>(const auto& use) {
    if (identifier->pgn == Message::kGroup.pgn) {
      if (const auto message = vehicle::decode<Message>(frame); message.ok()) {
        use(*message);
      }
    }
  };
  take.operator()<vehicle::Hrw>([&](const vehicle::Hrw& m) {
    readings_.wheel_mps = {m.front_left_mps, m.front_right_mps, m.rear_left_mps, m.rear_right_mps};
    heard_.gateway();
  });
  take.operator()<vehicle::WheelBasedSpeed>(
      [&](const vehicle::WheelBasedSpeed& m) { take_speed(m.speed_mps, m.forward); });
  take.operator()<vehicle::GuidanceMachineInfo>([&](const vehicle::GuidanceMachineInfo& m) {
    readings_.steering_ready = m.ready == Switch::on;
    if (m.reset_required == Switch::on && !readings_.steering_needs_reset) {
      ++steering_resets_;
    }
    readings_.steering_needs_reset = m.reset_required == Switch::on;
    if (std::isfinite(m.curvature_1pm)) {
      readings_.curvature_1pm = m.curvature_1pm;
    }
  });
  take.operator()<vehicle::Esc1>([&](const vehicle::Esc1& m) {
    if (std::isfinite(m.steer_rad)) {
      readings_.steer_rad[m.location == vehicle::kRearAxle ? 1 : 0] = m.steer_rad;
    }
  });
  take.operator()<vehicle::Eec1>([&](const vehicle::Eec1& m) {
    if (std::isfinite(m.speed_radps)) {
      readings_.engine_speed_radps = m.speed_radps;
    }
  });
  take.operator()<vehicle::Etc1>(
      [&](const vehicle::Etc1& m) { readings_.shifting = m.shift_in_process == Switch::on; });
  take.operator()<vehicle::Etc2>(
      [&](const vehicle::Etc2& m) { readings_.gear = vehicle::gear_of(m.current_gear); });
  take.operator()<vehicle::MachineFunctionState>([&](const vehicle::MachineFunctionState& m) {
    readings_.parking_brake = m.parking_brake == Switch::on;
    if (std::isfinite(m.slip_angle_rad)) {
      readings_.slip_angle_rad = m.slip_angle_rad;
    }
  });
}

double VehicleWire::take_yaw_rate_radps() {
  if (yaw_count_ > 0) {
    yaw_rate_radps_ = yaw_sum_radps_ / yaw_count_;
    yaw_sum_radps_ = 0.0;
    yaw_count_ = 0;
  }
  return yaw_rate_radps_;
}

void VehicleWire::claim(drivers::CanBus& bus) const {
  j1939::Name name;
  name.identity = 0x2A2A;
  (void)bus.send(j1939::make_address_claim(settings_.own, j1939::pack(name)));
}

/// Encodes the orders as TSC1, TC1 and XBR (J1939), guidance and machine selected speed (ISO
/// 11783-7) and the gateway's function command, each at its own period.
void VehicleWire::send(drivers::CanBus& bus, const VehicleOrders& orders) {
  const std::uint64_t tick = ticks_++;
  const auto put = [&](const auto& message) {
    (void)bus.send(vehicle::encode(message, settings_.own, settings_.gateway));
  };
  if (orders.engine_speed_radps || orders.engine_torque_share) {
    vehicle::Tsc1 engine;
    engine.priority = 1;
    if (orders.engine_speed_radps) {
      engine.override_mode = static_cast<std::uint8_t>(vehicle::OverrideMode::speed);
      engine.speed_radps = *orders.engine_speed_radps;
    } else {
      engine.override_mode = static_cast<std::uint8_t>(vehicle::OverrideMode::torque);
      engine.torque_share = *orders.engine_torque_share;
    }
    put(engine);
  }
  if (orders.gear && due(tick, 60)) {
    vehicle::Tc1 transmission;
    transmission.requested_gear = vehicle::gear_code(*orders.gear);
    put(transmission);
  }
  if (due(tick, 40)) {
    vehicle::Xbr brake;
    brake.priority = 1;
    brake.control_mode = static_cast<std::uint8_t>(vehicle::BrakeControlMode::maximum);
    brake.acceleration_mps2 = -std::abs(orders.brake_mps2);
    put(brake);
  }
  if (due(tick, 40)) {
    vehicle::GuidanceCommand guidance;
    guidance.intended =
        vehicle::to_switch(orders.curvature_1pm.has_value() && !readings_.steering_needs_reset);
    guidance.curvature_1pm = orders.curvature_1pm.value_or(0.0);
    put(guidance);
  }
  if (orders.travel_speed_mps && due(tick, 60)) {
    vehicle::MachineSelectedSpeedCommand speed;
    speed.speed_mps = std::abs(*orders.travel_speed_mps);
    speed.forward = vehicle::to_switch(*orders.travel_speed_mps >= 0.0);
    put(speed);
  }
  if (due(tick, 100)) {
    vehicle::MachineFunctionCommand functions;
    functions.parking_brake = vehicle::to_switch(orders.parking_brake);
    if (orders.steering_mode) {
      functions.steering_mode = static_cast<std::uint8_t>(*orders.steering_mode);
      functions.crab_angle_rad = orders.crab_angle_rad;
    }
    if (orders.vibration) {
      functions.vibration_front = vehicle::to_switch(*orders.vibration);
      functions.vibration_rear = functions.vibration_front;
    }
    put(functions);
  }
}

void VehicleWire::release(drivers::CanBus& bus) const {
  const auto put = [&](const auto& message) {
    (void)bus.send(vehicle::encode(message, settings_.own, settings_.gateway));
  };
  put(vehicle::Tsc1{});
  put(vehicle::Xbr{});
  vehicle::GuidanceCommand guidance;
  guidance.intended = Switch::off;
  put(guidance);
}

}  // namespace rigwire::field
