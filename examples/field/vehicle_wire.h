// The CAN bus of a vehicle: readings of its gateway and of one inertial sensor in, orders out.
//
// Messages: protocols/vehicle (J1939, ISO 11783-7, and the gateway's own), protocols/openimu.
// Orders are sent to the gateway's address at the messages' periods; what an order leaves out is
// not sent.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "drivers/endpoints.h"
#include "protocols/can/frame.h"
#include "protocols/vehicle/machine.h"

namespace rigwire::field {

struct VehicleWireSettings {
  std::uint8_t gateway = 0x27;  ///< Source address of the vehicle's gateway.
  std::uint8_t imu = 0x80;      ///< Source address of the inertial sensor.
  std::uint8_t own = 0x2A;      ///< Address that this program claims.
};

struct VehicleReadings {
  std::optional<double> wheel_based_speed_mps;  ///< Reverse negative once the direction is known.
  std::array<double, 4> wheel_mps{};            ///< HRW, without sign: front left .. rear right.
  std::optional<double> curvature_1pm;  ///< Curvature estimated by the machine, left positive.
  double slip_angle_rad = 0.0;          ///< Slip angle of the odometry.
  std::array<double, 2> steer_rad{};    ///< Front, rear.
  double engine_speed_radps = 0.0;
  std::optional<int> gear;  ///< Engaged.
  bool shifting = false;
  bool parking_brake = false;
  bool steering_ready = false;
  bool steering_needs_reset = false;  ///< Steering released after too long without a command.
};

struct VehicleOrders {
  std::optional<double> engine_speed_radps;   ///< TSC1, speed.
  std::optional<double> engine_torque_share;  ///< TSC1, torque; when no speed is asked for.
  std::optional<int> gear;
  std::optional<double> travel_speed_mps;  ///< Hydrostatic drive, reverse negative.
  double brake_mps2 = 0.0;                 ///< Deceleration asked of the brakes.
  std::optional<double> curvature_1pm;     ///< Left positive; nothing: do not steer.
  bool parking_brake = true;
  std::optional<protocols::vehicle::SteeringMode> steering_mode;
  double crab_angle_rad = 0.0;
  std::optional<bool> vibration;  ///< Both drums.
};

class VehicleWire {
 public:
  /// Milliseconds between two calls of send().
  static constexpr int kTick_ms = 20;

  /// Callbacks for received data.
  struct Heard {
    std::function<void()> gateway;  ///< Wheel speeds arrived.
    std::function<void()> imu;      ///< A sound yaw rate arrived.
  };
  VehicleWire(const VehicleWireSettings& settings, Heard heard);

  void receive(const protocols::can::Frame& frame);
  [[nodiscard]] const VehicleReadings& readings() const { return readings_; }
  /// Mean yaw rate of the sensor since the last call; the last one when nothing new arrived.
  [[nodiscard]] double take_yaw_rate_radps();

  /// To be called every kTick_ms: sends what is due.
  void send(drivers::CanBus& bus, const VehicleOrders& orders);
  /// Ends the requests properly, so that their end is no fault to the gateway: for a machine that
  /// is parked.
  void release(drivers::CanBus& bus) const;
  /// How often steering had released and was asked to begin anew.
  [[nodiscard]] std::uint64_t steering_resets() const { return steering_resets_; }
  /// Announces the own address.
  void claim(drivers::CanBus& bus) const;

 private:
  void take_speed(double speed_mps, protocols::vehicle::Switch forward);

  VehicleWireSettings settings_;
  Heard heard_;
  VehicleReadings readings_;
  double yaw_sum_radps_ = 0.0;
  int yaw_count_ = 0;
  double yaw_rate_radps_ = 0.0;
  std::uint64_t ticks_ = 0;
  std::uint64_t steering_resets_ = 0;
};

}  // namespace rigwire::field
