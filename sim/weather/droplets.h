// Fog and haze: droplets too many and too small to be met one by one, so that they weaken a beam
// evenly and send an echo that begins at the sensor.
//
// Optical constants:
//   fog   alpha = ln(20) / MOR, beta = 0.046 / MOR   (R. H. Rasshofer, M. Spies, H. Spies,
//         "Influences of weather phenomena on automotive laser radar systems", Adv. Radio Sci. 9,
//         2011; MOR the distance at which 5 % of the light is left)
//   haze  alpha = (3.912 / V) (wavelength / 550 nm)^-q, q = 1.6 for V > 50 km, 1.3 for V > 6 km,
//         0.585 (V / km)^(1/3) below   (P. W. Kruse et al., Elements of Infrared Technology, 1962),
//         beta = alpha / lidar ratio
// Fog may have an upper end: full density up to a base height, falling with a scale height above.
//
// The echo is that of M. Hahner et al., "Fog simulation on real LiDAR point clouds for 3D object
// detection in adverse weather", ICCV 2021: the largest over R of
//   E(R) = pi beta integral of cos^2(pi u / 2 L) exp(-2 alpha s) xi(s) / s^2 du, s = R - u, |u| <
//   L,
// with L half the pulse's length in space and xi the overlap of sender and receiver, 0 up to 0.9 m
// and 1 from 1 m on. R is counted to the middle of the pulse. Hahner's ratio of soft to hard target
// holds a fitted constant; here both are in the unit of weather.h, which has none.
//
// Nearer than its peak the integral is never wanted; farther it falls, so that a lidar whose least
// range lies behind the peak has its echo at its least range. Peaks come from a table, made at
// set-up, for alpha up to 1 per metre and L from 0.15 m to 3 m (clamped outside); error of the
// energy below 0.2 %, of the range below 3 mm for L up to 1 m, 5 cm above, where the peak is flat.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sim/weather/weather_parameters.h"

namespace rigwire::sim {

/// Extinction per metre and back-scatter per metre and steradian.
struct DropletOptics {
  double extinction_pm = 0.0;
  double backscatter_pmsr = 0.0;
};

/// From 1 / visibility, so that 0 is: none.
[[nodiscard]] DropletOptics fog_optics(const FogParameters& parameters, double inverse_mor_pm);
[[nodiscard]] DropletOptics haze_optics(const HazeParameters& parameters,
                                        double inverse_visibility_pm);

/// Metres of full fog that hold as much as a path of that length from height z0_m on, whose height
/// changes by `climb` per metre.
[[nodiscard]] double fog_path_m(const FogParameters& parameters, double z0_m, double climb,
                                double length_m);
/// Density at a height against that below the base.
[[nodiscard]] double fog_density(const FogParameters& parameters, double z_m);

/// Where and how strongly a beam's own near field answers, for beta = 1.
struct SoftEcho {
  double range_m = 0.0;
  double energy = 0.0;
};

class SoftEchoTable {
 public:
  SoftEchoTable(double overlap_start_m, double overlap_end_m);

  /// The integral itself with that many steps; nothing beyond far_m.
  [[nodiscard]] double energy_at(double range_m, double extinction_pm, double pulse_m, double far_m,
                                 int steps) const;

  /// The largest echo at near_m or farther, in front of a surface at far_m, for an even extinction.
  [[nodiscard]] SoftEcho strongest(double extinction_pm, double pulse_m, double near_m,
                                   double far_m) const;

 private:
  static constexpr std::size_t kExtinctions = 25;
  static constexpr std::size_t kPulses = 17;
  struct Node {
    double range_m;
    double log_energy;
  };

  [[nodiscard]] SoftEcho search(double extinction_pm, double pulse_m, double near_m,
                                double far_m) const;
  [[nodiscard]] SoftEcho look_up(double extinction_pm, double pulse_m) const;
  [[nodiscard]] const Node& node(std::size_t extinction, std::size_t pulse) const {
    return nodes_[extinction * kPulses + pulse];
  }

  double overlap_start_m_;
  double overlap_end_m_;
  std::vector<Node> nodes_;
};

}  // namespace rigwire::sim
