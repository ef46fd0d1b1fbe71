// What a driving field program decides: orders from beliefs. Knows neither wires nor clocks.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "field/json_line.h"
#include "field/lidar_wire.h"
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

/// Wheels that turn while the vehicle stays where it is: over kSpan_s, its way by the wheels
/// against what it has moved, and less than a third came of it.
class SpinWatch {
 public:
  static constexpr double kSpan_s = 10.0;

  void update(const PlanePosition& position, double speed_mps, double step_s) {
    if (span_s_ == 0.0) {
      from_ = position;
    }
    span_s_ += step_s;
    way_m_ += std::abs(speed_mps) * step_s;
    if (span_s_ >= kSpan_s) {
      by_wheels_m_ = way_m_;
      moved_m_ = std::hypot(position.east_m - from_.east_m, position.north_m - from_.north_m);
      spinning_ = spinning_ || (by_wheels_m_ > kLeast_m && moved_m_ < by_wheels_m_ / 3.0);
      span_s_ = way_m_ = 0.0;
    }
  }
  [[nodiscard]] bool spinning() const { return spinning_; }
  /// Distances in the last span.
  [[nodiscard]] double by_wheels_m() const { return by_wheels_m_; }
  [[nodiscard]] double moved_m() const { return moved_m_; }

 private:
  static constexpr double kLeast_m = 6.0;  ///< More than the drift of a receiver's position.

  PlanePosition from_;
  double span_s_ = 0.0;
  double way_m_ = 0.0;
  double by_wheels_m_ = 0.0;
  double moved_m_ = 0.0;
  bool spinning_ = false;
};

class Mission {
 public:
  virtual ~Mission() = default;

  /// Initial heading and its standard deviation, for the first position of the antenna, averaged at
  /// standstill. `position` is in the mission's plane.
  /// its standard deviation. `position` is in the mission's plane.
  struct Start {
    double heading_rad = 0.0;
    double sigma_rad = 0.3;
  };
  [[nodiscard]] virtual Start start(const PlanePosition& position) = 0;

  /// Orders for the next `step_s`. Called only while every device is alive.
  [[nodiscard]] virtual VehicleOrders update(const Pose& pose, const VehicleReadings& readings,
                                             double step_s) = 0;
  /// One return of the lidar, in the frame of the odometry's reference point; and the end of a
  /// revolution of them. Only where there is a lidar.
  virtual void see(const LidarPoint& /*point*/) {}
  virtual void finish_revolution() {}

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
