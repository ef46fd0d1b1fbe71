// What the pictures of docs/weather.md show: transmission over range, and a trail of dust from
// above with what a follower's lidar returns from it.
#pragma once

#include <string>
#include <vector>

#include "sim/weather/dust_cloud.h"

namespace rigwire::bench {

struct TransmissionCurve {
  std::string medium;
  std::vector<double> range_m;
  std::vector<double> two_way;
};

[[nodiscard]] std::vector<TransmissionCurve> transmission_curves();

struct PlanPoint {
  double x_m = 0.0;
  double y_m = 0.0;
  bool from_dust = false;  ///< Else from the ground, weakened, still detected.
};

struct DustView {
  double sensor_x_m = 0.0;
  double sensor_y_m = 0.0;
  std::vector<sim::DustPuff> puffs;
  std::vector<PlanPoint> returns;  ///< The strongest echo of each beam.
  int lost = 0;                    ///< Beams to the ground of which nothing came back.
};

[[nodiscard]] DustView dust_view();

}  // namespace rigwire::bench
