// What a controller asks of a vehicle gateway under test, and machines to ask it of.
#pragma once

#include <cmath>

#include "fields/constants.h"
#include "rig.h"

namespace rigwire::emulators {

inline protocols::vehicle::Tsc1 torque(double share) {
  protocols::vehicle::Tsc1 request;
  request.override_mode = static_cast<std::uint8_t>(protocols::vehicle::OverrideMode::torque);
  request.torque_share = share;
  return request;
}
inline protocols::vehicle::Tsc1 engine_speed(double speed_radps) {
  protocols::vehicle::Tsc1 request;
  request.override_mode = static_cast<std::uint8_t>(protocols::vehicle::OverrideMode::speed);
  request.speed_radps = speed_radps;
  return request;
}
inline protocols::vehicle::Tc1 gear(int number) {
  protocols::vehicle::Tc1 request;
  request.requested_gear = protocols::vehicle::gear_code(number);
  return request;
}
inline protocols::vehicle::Xbr brake(double acceleration_mps2) {
  protocols::vehicle::Xbr request;
  request.acceleration_mps2 = acceleration_mps2;
  request.control_mode = static_cast<std::uint8_t>(protocols::vehicle::BrakeControlMode::maximum);
  return request;
}
inline protocols::vehicle::GuidanceCommand curvature(double curvature_1pm) {
  return {curvature_1pm, protocols::vehicle::Switch::on};
}
inline protocols::vehicle::GuidanceCommand not_intended() {
  return {0.0, protocols::vehicle::Switch::off};
}
inline protocols::vehicle::MachineSelectedSpeedCommand travel(double speed_mps) {
  return {std::abs(speed_mps), protocols::vehicle::kNotAvailable,
          protocols::vehicle::to_switch(speed_mps >= 0.0)};
}
inline protocols::vehicle::MachineFunctionCommand parking(bool on) {
  protocols::vehicle::MachineFunctionCommand request;
  request.parking_brake = protocols::vehicle::to_switch(on);
  return request;
}
inline protocols::vehicle::MachineFunctionCommand crab(double angle_rad) {
  protocols::vehicle::MachineFunctionCommand request;
  request.steering_mode = static_cast<std::uint8_t>(protocols::vehicle::SteeringMode::crab);
  request.crab_angle_rad = angle_rad;
  return request;
}

inline VehicleGatewaySettings roller() {
  VehicleGatewaySettings settings;
  settings.steering = SteeringLayout::crab;
  settings.wheelbase_m = 3.6;
  return settings;
}

inline VehicleSample rolling(double speed_mps) {
  VehicleSample sample = standing();
  sample.odometry.speed_mps = speed_mps;
  return sample;
}

}  // namespace rigwire::emulators
