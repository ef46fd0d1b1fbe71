// What a driving field program decides: orders from beliefs. Knows neither wires nor clocks.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "field/json_line.h"
#include "field/pose_estimator.h"
#include "field/vehicle_wire.h"

namespace rigwire::field {

/// A vehicle that does not move for 15 s, asked to, is stuck.
class StuckWatch {
 public:
  /// Slower than this is not moving.
  explicit StuckWatch(double moving_mps) : moving_mps_(moving_mps) {}
  void update(double wish_mps, double speed_mps, double step_s) {
    const bool held = std::abs(wish_mps) > moving_mps_ && std::abs(speed_mps) < moving_mps_;
    held_s_ = held ? held_s_ + step_s : 0.0;
  }
  [[nodiscard]] bool stuck() const { return held_s_ > 15.0; }

 private:
  double moving_mps_;
  double held_s_ = 0.0;
};

class Mission {
 public:
  virtual ~Mission() = default;

  /// The first position of the antenna, averaged at standstill; tells the heading to begin with and
  /// its standard deviation. `position` is in the mission's plane.
  struct Start {
    double heading_rad = 0.0;
    double sigma_rad = 0.3;
  };
  [[nodiscard]] virtual Start start(const PlanePosition& position) = 0;

  /// Orders for the next `step_s`. Called only while every device is alive.
  [[nodiscard]] virtual VehicleOrders update(const Pose& pose, const VehicleReadings& readings,
                                             double step_s) = 0;
  /// Orders that bring the machine to rest; called after the end, or when something is silent.
  /// Standing: with the parking brake on.
  [[nodiscard]] virtual VehicleOrders halt(const VehicleReadings& readings,
                                           bool standing) const = 0;

  [[nodiscard]] virtual bool done() const = 0;
  /// Set when the mission cannot go on: why.
  [[nodiscard]] virtual std::optional<std::string> fault() const = 0;
  /// For the terminal, one short line.
  [[nodiscard]] virtual std::string progress() const = 0;
  virtual void log(JsonLine& line) const = 0;
};

}  // namespace rigwire::field
