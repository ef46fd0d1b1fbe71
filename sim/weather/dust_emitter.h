// Where a machine stirs up dust: wheels on dry ground, a bucket that fills or empties; and how
// much, after the emission factors of the US Environmental Protection Agency, AP-42, for particles
// up to 30 um, which are those that stay in the air.
#pragma once

#include <Eigen/Core>

namespace rigwire::sim {

/// Masses are those of ground as dry as AP-42 takes it, with a silt content of 12 %; the scene
/// scales them (DustParameters::silt_share, WeatherFrame::dryness).
struct DustEmitter {
  Eigen::Vector3d position_W = Eigen::Vector3d::Zero();
  double radius_m = 0.3;  ///< Radius of the fresh puff: two standard deviations.
  /// Rate of what stays in the air, before the scene's own dustiness.
  double mass_rate_kgps = 0.0;
  /// Height of the position; the puff has no part below the ground.
  double height_over_ground_m = 0.0;
};

/// What a vehicle of that mass stirs up per metre of its way, all wheels together: 4.9 (s / 12
/// %)^0.7 (W / 3 short tons)^0.45 lb per mile for s = 12 % (AP-42, 13.2.2 "Unpaved roads", 2006,
/// equation 1a). The factor is per length at any speed, so that the rate is proportional to speed.
[[nodiscard]] double road_dust_kgpm(double vehicle_kg);

/// A wheel or drum of that width that carries that share of the vehicle's weight and rolls, or
/// spins, with that speed; `road_kgpm` is road_dust_kgpm() of the vehicle. A share that is not a
/// number makes no dust.
[[nodiscard]] DustEmitter rolling_dust(double road_kgpm, const Eigen::Vector3d& contact_W,
                                       double width_m, double load_share, double speed_mps);

/// What falling soil sends up per volume: 0.0046 d^1.1 / M^0.3 kg per m3 for a drop of d metres, at
/// a moisture of M = 2 % (AP-42, 11.9 "Western surface coal mining", 1998, table 11.9-2, dragline).
[[nodiscard]] double dropped_soil_dust_kgpm3(double drop_height_m);

}  // namespace rigwire::sim
