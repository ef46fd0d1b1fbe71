#include "roll_lane/lane_mission.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "field/geometry.h"

namespace rigwire::roll_lane {
namespace {

constexpr double kHaltBrake_mps2 = 1.5;

}  // namespace

LaneMission::LaneMission(const LaneMissionSettings& settings)
    : settings_(settings), control_(settings.lanes, settings.control) {}

field::Mission::Start LaneMission::start(const field::PlanePosition& position) {
  constexpr double kHeadingSigma_rad = 0.1;
  control_.start(position, settings_.direction_rad);
  return {settings_.direction_rad, kHeadingSigma_rad};
}

field::VehicleOrders LaneMission::update(const field::Pose& pose, const field::VehicleReadings&,
                                         double step_s) {
  pose_ = pose;
  const LaneOutput wanted = control_.update(pose, step_s);
  crab_rad_ = wanted.crab_rad;
  stuck_.update(wanted.speed_mps, pose.speed_mps, step_s);
  field::VehicleOrders orders;
  orders.travel_speed_mps = wanted.speed_mps;
  orders.curvature_1pm = wanted.curvature_1pm;
  orders.steering_mode = protocols::vehicle::SteeringMode::crab;
  orders.crab_angle_rad = wanted.crab_rad;
  orders.parking_brake = false;
  if (settings_.vibration) {
    orders.vibration = wanted.vibrate;
  }
  return orders;
}

field::VehicleOrders LaneMission::halt(const field::VehicleReadings&, bool standing) const {
  field::VehicleOrders orders;
  orders.travel_speed_mps = 0.0;
  orders.brake_mps2 = kHaltBrake_mps2;
  orders.curvature_1pm = 0.0;
  orders.steering_mode = protocols::vehicle::SteeringMode::crab;
  orders.crab_angle_rad = crab_rad_;
  orders.parking_brake = standing;
  if (settings_.vibration) {
    orders.vibration = false;
  }
  return orders;
}

std::optional<std::string> LaneMission::fault() const {
  if (control_.off_line()) {
    char text[96];
    (void)std::snprintf(text, sizeof(text), "%.2f m off the line, allowed %.2f m",
                        std::abs(control_.offset_m()), settings_.control.off_line_m);
    return text;
  }
  if (auto why = field::lost(pose_, settings_.control.off_line_m)) {
    return why;
  }
  if (stuck_.stuck()) {
    return "the machine does not move";
  }
  return std::nullopt;
}

std::string LaneMission::progress() const {
  char text[96];
  (void)std::snprintf(text, sizeof(text), "lane %d of %d, %.1f m, %+.2f m off",
                      std::min(control_.leg() + 1, settings_.lanes.lanes), settings_.lanes.lanes,
                      control_.x_m(), control_.offset_m());
  return text;
}

void LaneMission::log(field::JsonLine& line) const {
  line.open("lane");
  line.whole("leg", control_.leg());
  line.number("x_m", control_.x_m(), 2);
  line.number("offset_m", control_.offset_m(), 3);
  line.number("crab_deg", crab_rad_ / field::kDegree, 2);
  line.close();
}

}  // namespace rigwire::roll_lane
