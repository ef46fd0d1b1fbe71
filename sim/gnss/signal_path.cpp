#include "sim/gnss/signal_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigwire::sim {

SignalPath signal_path(const Constellation& constellation, std::size_t index,
                       const ReceptionPoint& antenna) {
  constexpr double kSettled_s = 1e-12;
  constexpr int kMostRounds = 10;  // two rounds suffice for every real satellite
  const Eigen::Vector3d earth_rate = kEarthRate_radps * Eigen::Vector3d::UnitZ();

  SignalPath path;
  SatelliteState satellite;
  Eigen::Vector3d satellite_m;
  Eigen::Vector3d satellite_mps;
  double by_flight = 0.0;  // by how much the range falls as the flight grows, over c
  path.flight_s = 0.075;
  for (int round = 0; round < kMostRounds; ++round) {
    satellite = constellation.state(index, antenna.time, antenna.offset_s - path.flight_s);
    // The earth turns during the flight: in the frame of reception the satellite was further west.
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
    // -d(range)/d(flight) / c: with a longer flight the satellite is further back and turned
    // further.
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
  path.second_delay_s = satellite.second_delay_s;
  path.healthy = satellite.healthy;
  return path;
}

// The two models of the atmosphere that receivers and their clients use.

double klobuchar_delay_m(const KlobucharParameters& parameters, double latitude_rad,
                         double longitude_rad, double azimuth_rad, double elevation_rad,
                         double time_of_week_s) {
  constexpr double kPi = std::numbers::pi;
  constexpr double kHighestLatitude = 0.416;  // semicircles, as every angle here
  constexpr double kDay_s = 86'400.0;
  const double elevation = elevation_rad / kPi;
  // Central angle, and latitude and longitude of the pierce point, clamped as the standard says.
  const double earth_angle = 0.0137 / (elevation + 0.11) - 0.022;
  const double latitude = std::clamp(latitude_rad / kPi + earth_angle * std::cos(azimuth_rad),
                                     -kHighestLatitude, kHighestLatitude);
  const double longitude =
      longitude_rad / kPi + earth_angle * std::sin(azimuth_rad) / std::cos(latitude * kPi);
  // Geomagnetic latitude of the pierce point.
  const double geomagnetic = latitude + 0.064 * std::cos((longitude - 1.617) * kPi);

  // Local time there; amplitude and period of the day's cosine are cubics in geomagnetic latitude.
  const double local_s = longitude * 43'200.0 + time_of_week_s;
  const double time_of_day_s = local_s - kDay_s * std::floor(local_s / kDay_s);
  const auto cubic = [&](const std::array<double, 4>& c) {
    return c[0] + geomagnetic * (c[1] + geomagnetic * (c[2] + geomagnetic * c[3]));
  };
  const double amplitude_s = std::max(cubic(parameters.alpha), 0.0);
  const double period_s = std::max(cubic(parameters.beta), 72'000.0);
  const double phase = 2.0 * kPi * (time_of_day_s - 50'400.0) / period_s;

  // 5 ns, by day with the half cosine as a series to x^4; slant factor 1 + 16 (0.53 - E)^3.
  double vertical_s = 5e-9;
  if (std::abs(phase) < 1.57) {
    const double square = phase * phase;
    vertical_s += amplitude_s * (1.0 - square / 2.0 + square * square / 24.0);
  }
  const double below = 0.53 - elevation;
  return kLightSpeed_mps * vertical_s * (1.0 + 16.0 * below * below * below);
}

double saastamoinen_delay_m(double latitude_rad, double height_m, double elevation_rad) {
  if (height_m < -100.0 || height_m > 10'000.0 || elevation_rad <= 0.0) {
    return 0.0;
  }
  constexpr double kRelativeHumidity = 0.7;
  const double h_m = std::max(height_m, 0.0);
  // ISO 2533 standard atmosphere.
  const double pressure_hpa = 1013.25 * std::pow(1.0 - 2.2557e-5 * h_m, 5.2568);
  const double temperature_k = 15.0 - 6.5e-3 * h_m + 273.16;
  const double vapour_hpa = 6.108 * kRelativeHumidity *
                            std::exp((17.15 * temperature_k - 4684.0) / (temperature_k - 38.45));
  // Zenith delays: dry 0.0022768 P / (1 - 0.00266 cos 2 lat - 0.00028 h), wet by temperature.
  const double gravity = 1.0 - 0.00266 * std::cos(2.0 * latitude_rad) - 0.00028 * h_m / 1e3;
  const double dry_m = 0.0022768 * pressure_hpa / gravity;
  const double wet_m = 0.002277 * (1255.0 / temperature_k + 0.05) * vapour_hpa;
  return (dry_m + wet_m) / std::sin(elevation_rad);
}

}  // namespace rigwire::sim
