// What a satellite receiver's antenna and navigation engine measure at one epoch, in SI units.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sim/samples/time.h"
#include "sim/samples/vector3.h"

namespace rigwire {

/// Quality of the position, in the words of Wolf et al. 2020, Eq. 3.
enum class GnssFix : std::uint8_t {
  none,     ///< No Fix: at most one satellite.
  bad,      ///< Bad Fix: two satellites; no position either.
  two_d,    ///< Three satellites (or an empty quadrant, where that rule is switched on).
  three_d,  ///< More than three satellites.
};

/// One GPS satellite above the receiver's horizon.
struct SatelliteView {
  std::uint8_t prn = 0;        ///< GPS 1..32.
  double azimuth_rad = 0.0;    ///< Clockwise from north, [0, 2 pi).
  double elevation_rad = 0.0;  ///< Above the horizon.
  double cn0_dbhz = 0.0;       ///< Carrier-to-noise density; 0 when not tracked.
  bool tracked = false;        ///< Line of sight is free and the signal strong enough.
  bool used = false;           ///< Takes part in the fix.
};

/// One navigation epoch. Position, velocity and accuracies are meaningful only when `fix` is two_d
/// or three_d; dilutions are NaN when not available.
struct GnssSample {
  SimTime time{};  ///< The navigation epoch.
  GnssFix fix = GnssFix::none;
  double latitude_deg = 0.0;   ///< WGS-84 geodetic, of the antenna, error included.
  double longitude_deg = 0.0;  ///< [-180, 180).
  double ellipsoid_height_m = 0.0;
  double geoid_separation_m = 0.0;     ///< Height of the geoid above the ellipsoid.
  Vector3 velocity_ned_mps;            ///< x north, y east, z down; error included.
  double horizontal_accuracy_m = 0.0;  ///< The receiver's own estimate, 1 sigma.
  double vertical_accuracy_m = 0.0;
  double speed_accuracy_mps = 0.0;
  double time_accuracy_s = 0.0;
  double clock_bias_s = 0.0;  ///< Receiver clock minus GPS time.
  double clock_drift = 0.0;   ///< Seconds per second.
  double horizontal_dilution = std::numeric_limits<double>::quiet_NaN();
  double vertical_dilution = std::numeric_limits<double>::quiet_NaN();
  double position_dilution = std::numeric_limits<double>::quiet_NaN();
  double time_dilution = std::numeric_limits<double>::quiet_NaN();
  std::vector<SatelliteView> satellites;  ///< Above the horizon, in order of PRN.
};

}  // namespace rigwire
