// Rolls the lanes: keeps the machine on the planned line in both directions and changes legs at
// standstill.
//
// The course (heading + slip angle) follows the line; crab shifts the slip angle without turning
// the course, so that the body turns by the curvature of the course less the change of the crab
// angle. Feedback, with s the way in driving direction: y'' = -w^2 y - 2 w y' in both directions.
#pragma once

#include "field/pose_estimator.h"
#include "roll_lane/lane_plan.h"

namespace rigwire::roll_lane {

struct LaneControlSettings {
  double speed_mps = 1.2;
  double acceleration_mps2 = 0.4;
  double braking_mps2 = 0.3;    ///< Planned towards a lane's end.
  double bandwidth_1pm = 0.22;  ///< w: the vehicle is back on the line within some 2.5 / w.
  double curvature_limit_1pm = 0.16;
  double off_line_m = 2.5;  ///< Farther off than this it gives up.
  double rest_s = 1.0;      ///< Between two legs.

  /// Throws std::invalid_argument naming the member.
  void validate() const;
};

struct LaneOutput {
  /// Curvature of the body's turn, left positive, like a steering angle.
  double curvature_1pm = 0.0;
  double crab_rad = 0.0;
  double speed_mps = 0.0;  ///< Reverse negative.
  bool vibrate = false;
};

class LaneControl {
 public:
  /// Throws std::invalid_argument.
  LaneControl(const LaneSettings& lanes, const LaneControlSettings& settings);

  /// Where the first lane begins and its direction, left from east.
  void start(const field::PlanePosition& origin, double direction_rad);
  [[nodiscard]] LaneOutput update(const field::Pose& pose, double step_s);

  [[nodiscard]] bool done() const { return leg_ >= plan_.lanes(); }
  [[nodiscard]] bool off_line() const { return off_line_; }
  [[nodiscard]] int leg() const { return leg_; }
  [[nodiscard]] double x_m() const { return x_m_; }
  /// Offset from the line, left positive in the lanes' frame.
  [[nodiscard]] double offset_m() const { return offset_m_; }
  [[nodiscard]] const LanePlan& plan() const { return plan_; }

 private:
  LanePlan plan_;
  LaneControlSettings settings_;
  field::PlanePosition origin_;
  double direction_rad_ = 0.0;
  int leg_ = 0;
  double rest_s_ = 0.0;
  double speed_mps_ = 0.0;  ///< Last desired speed, without sign.
  double x_m_ = 0.0;
  double offset_m_ = 0.0;
  bool arrived_ = false;
  bool off_line_ = false;
};

}  // namespace rigwire::roll_lane
