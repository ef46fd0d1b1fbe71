// Lane control as a mission for the drive program.
#pragma once

#include "field/mission.h"
#include "roll_lane/lane_control.h"

namespace rigwire::roll_lane {

struct LaneMissionSettings {
  LaneSettings lanes;
  LaneControlSettings control;
  /// Direction of the lanes and of the machine at the start, left from east.
  double direction_rad = 0.0;
  bool vibration = false;
};

class LaneMission final : public field::Mission {
 public:
  /// Throws std::invalid_argument.
  explicit LaneMission(const LaneMissionSettings& settings);

  [[nodiscard]] Start start(const field::PlanePosition& position) override;
  [[nodiscard]] field::VehicleOrders update(const field::Pose& pose,
                                            const field::VehicleReadings& readings,
                                            double step_s) override;
  [[nodiscard]] field::VehicleOrders halt(const field::VehicleReadings& readings,
                                          bool standing) const override;
  [[nodiscard]] bool done() const override { return control_.done(); }
  [[nodiscard]] std::optional<std::string> fault() const override;
  [[nodiscard]] std::string progress() const override;
  void log(field::JsonLine& line) const override;

 private:
  LaneMissionSettings settings_;
  LaneControl control_;
  field::Pose pose_;
  double crab_rad_ = 0.0;
  field::StuckWatch stuck_{0.05};
};

}  // namespace rigwire::roll_lane
