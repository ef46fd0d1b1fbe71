// Follower and speed control as a mission for the drive program.
#pragma once

#include "field/mission.h"
#include "path_follow/follower.h"
#include "path_follow/speed_control.h"
#include "path_follow/way_watch.h"

namespace rigwire::path_follow {

struct PathMissionSettings {
  FollowerSettings follower;
  SpeedControlSettings speed;
  std::optional<int> gear;                  ///< Nothing: chosen for the cruise speed.
  std::optional<double> start_heading_rad;  ///< Nothing: along the path.
  WayWatchSettings way;
  double keep_m = 2.0;  ///< Between the vehicle's front and an obstacle.
};

class PathMission final : public field::Mission {
 public:
  /// Throws std::invalid_argument.
  PathMission(field::Polyline path, const PathMissionSettings& settings);

  [[nodiscard]] Start start(const field::PlanePosition& position) override;
  [[nodiscard]] field::VehicleOrders update(const field::Pose& pose,
                                            const field::VehicleReadings& readings,
                                            double step_s) override;
  void see(const field::LidarPoint& point) override { way_.add(point); }
  void finish_revolution() override;
  [[nodiscard]] field::VehicleOrders halt(const field::VehicleReadings& readings,
                                          bool standing) const override;
  [[nodiscard]] bool done() const override { return follower_.done(); }
  [[nodiscard]] std::optional<std::string> fault() const override;
  [[nodiscard]] std::string progress() const override;
  void log(field::JsonLine& line) const override;

 private:
  PathMissionSettings settings_;
  Follower follower_;
  SpeedControl speed_;
  double wish_mps_ = 0.0;
  WayWatch way_;
  field::Pose pose_;
  double blocked_s_ = 0.0;  ///< Time at rest before an obstacle.
  field::StuckWatch stuck_{0.1};
  field::SpinWatch spin_;
  double last_curvature_1pm_ = 0.0;
};

}  // namespace rigwire::path_follow
