// Follows a path: pure pursuit for the curvature (R. C. Coulter, CMU-RI-TR-92-01, 1992), a speed
// that the path's curvature, the way that is left and the deviation allow.
#pragma once

#include <optional>

#include "field/geometry.h"
#include "field/pose_estimator.h"

namespace rigwire::path_follow {

struct FollowerSettings {
  double cruise_mps = 2.0;
  double acceleration_mps2 = 0.5;
  double braking_mps2 = 0.6;  ///< Planned towards the path's end and bends.
  double lateral_acceleration_mps2 = 0.8;
  double lookahead_s = 1.4;  ///< Times the speed, within the two limits.
  double lookahead_least_m = 3.5;
  double lookahead_most_m = 9.0;
  double curvature_limit_1pm = 0.12;  ///< Tightest circle of the vehicle.
  double off_path_m = 3.5;            ///< Farther away than this, the follower gives up.
  double laps = 1.0;                  ///< Laps of a closed path; 0 = for ever.
  /// Curvature per lateral offset, 1/m^2: is subtracted from the pursuit's curvature, so that the
  /// vehicle keeps to the path in bends.
  double offset_gain = 0.02;

  /// Throws std::invalid_argument naming the member.
  void validate() const;
};

struct FollowerOutput {
  double curvature_1pm = 0.0;
  double speed_mps = 0.0;
};

class Follower {
 public:
  /// Throws std::invalid_argument.
  Follower(field::Polyline path, const FollowerSettings& settings);

  /// Sets the free way ahead of the vehicle's front, less the distance that it keeps; empty: no
  /// limit is known.
  void set_free_way(std::optional<double> free_m) { free_m_ = free_m; }

  /// Begins at the path's point nearest to the position; returns the direction there.
  double start(const field::PlanePosition& position);
  [[nodiscard]] FollowerOutput update(const field::Pose& pose, double step_s);

  [[nodiscard]] bool done() const { return done_; }
  /// Position of the path's nearest point along the path, from its first point.
  [[nodiscard]] double along_m() const { return along_m_; }
  [[nodiscard]] bool off_path() const { return off_path_; }
  /// Left of the path positive.
  [[nodiscard]] double offset_m() const { return offset_m_; }
  /// Way along the path since the start.
  [[nodiscard]] double travelled_m() const { return travelled_m_; }
  /// Way from start to end; infinite for ever.
  [[nodiscard]] double whole_m() const;
  [[nodiscard]] const field::Polyline& path() const { return path_; }

 private:
  [[nodiscard]] double speed_limit_mps(double left_m) const;

  field::Polyline path_;
  FollowerSettings settings_;
  double start_m_ = 0.0;
  double along_m_ = 0.0;
  double travelled_m_ = 0.0;
  double offset_m_ = 0.0;
  double speed_mps_ = 0.0;  ///< Last desired speed.
  std::optional<double> free_m_;
  bool done_ = false;
  bool off_path_ = false;
};

}  // namespace rigwire::path_follow
