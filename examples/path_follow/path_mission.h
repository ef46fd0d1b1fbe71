// Follower and speed control as a mission for the drive program.
#pragma once

#include "field/mission.h"
#include "path_follow/follower.h"
#include "path_follow/speed_control.h"

namespace rigwire::path_follow {

struct PathMissionSettings {
  FollowerSettings follower;
  SpeedControlSettings speed;
  std::optional<int> gear;                  ///< Nothing: chosen for the cruise speed.
  std::optional<double> start_heading_rad;  ///< Nothing: along the path.
};

class PathMission final : public field::Mission {
 public:
  /// Throws std::invalid_argument.
  PathMission(field::Polyline path, const PathMissionSettings& settings);

  [[nodiscard]] Start start(const field::PlanePosition& position) override;
  [[nodiscard]] field::VehicleOrders update(const field::Pose& pose,
                                            const field::VehicleReadings& readings,
                                            double step_s) override;
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
  field::StuckWatch stuck_{0.1};
  double last_curvature_1pm_ = 0.0;
};

}  // namespace rigwire::path_follow
