// A pose from odometry readings alone.
#pragma once

#include "sim/samples/vehicle_sample.h"

namespace rigwire::sim {

/// Of the reference point, in the frame in which it started.
struct PlanarPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< Not wrapped.
};

/// Each reading holds for the span that is given with it; the arc is exact for constant speed,
/// curvature and slip angle, whatever the span. A reading or span that is no finite number, and a
/// span that is not positive, changes nothing.
class DeadReckoning {
 public:
  explicit DeadReckoning(const PlanarPose& start = {}) : pose_(start) {}

  void advance(const OdometryReading& reading, double span_s);

  [[nodiscard]] const PlanarPose& pose() const { return pose_; }
  /// Along the path, forward and backward both counted up.
  [[nodiscard]] double distance_m() const { return distance_m_; }

 private:
  PlanarPose pose_;
  double distance_m_ = 0.0;
};

}  // namespace rigwire::sim
