#include "sim/gnss/signal_path.h"

#include <Eigen/Geometry>

#include <cmath>

namespace rigwire::sim {

SignalPath signal_path(const Constellation& constellation, std::size_t index,
                       const ReceptionPoint& antenna) {
  constexpr double kSettled_s = 1e-12;
  constexpr int kMostRounds = 10;  // two, but for satellites that nobody has launched
  const Eigen::Vector3d earth_rate = kEarthRate_radps * Eigen::Vector3d::UnitZ();

  SignalPath path;
  SatelliteState satellite;
  Eigen::Vector3d satellite_m;
  Eigen::Vector3d satellite_mps;
  double by_flight = 0.0;  // by how much the range falls as the flight grows, over c
  path.flight_s = 0.075;
  for (int round = 0; round < kMostRounds; ++round) {
    satellite = constellation.state(index, antenna.time, antenna.offset_s - path.flight_s);
    // The earth turns under the signal: in the frame of reception the satellite stood further west.
    const double turn = kEarthRate_radps * path.flight_s;
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    const auto turned = [&](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(c * v.x() + s * v.y(), c * v.y() - s * v.x(), v.z());
    };
    satellite_m = turned(satellite.position_E_m);
    satellite_mps = turned(satellite.velocity_E_mps);
    const Eigen::Vector3d from_antenna_m = satellite_m - antenna.position_E_m;
    path.range_m = from_antenna_m.norm();
    path.direction_E = from_antenna_m / path.range_m;
    // -d(range)/d(flight) / c: the satellite stands further back and is turned further.
    by_flight =
        path.direction_E.dot(satellite_mps + earth_rate.cross(satellite_m)) / kLightSpeed_mps;
    const double missing_s = path.range_m / kLightSpeed_mps - path.flight_s;
    if (std::abs(missing_s) < kSettled_s) {
      path.flight_s += missing_s;
      break;
    }
    path.flight_s += missing_s / (1.0 + by_flight);  // Newton
  }
  // The derivative of range(t) = |turned(flight) satellite(t - flight) - antenna(t)| with
  // flight = range / c, solved for itself.
  path.range_rate_mps =
      path.direction_E.dot(satellite_mps - antenna.velocity_E_mps) / (1.0 + by_flight);
  path.satellite_clock_s = satellite.clock_s;
  path.satellite_clock_drift = satellite.clock_drift;
  path.group_delay_s = satellite.group_delay_s;
  path.healthy = satellite.healthy;
  return path;
}

}  // namespace rigwire::sim
