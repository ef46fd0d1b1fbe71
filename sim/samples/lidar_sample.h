// A spinning lidar: the pattern in which a model fires, and what one firing sees.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/samples/time.h"

namespace rigwire {

/// The most lasers that one firing can have.
inline constexpr std::size_t kMaxLasers = 32;

/// One laser of the head, in the order in which the lasers fire.
struct LaserGeometry {
  double elevation_rad = 0.0;      ///< Above the horizontal plane of the sensor.
  double vertical_offset_m = 0.0;  ///< Where the beam leaves, along the spin axis.
  Duration time_offset{};          ///< After the first laser of the same firing.
};

/// What the caster must know about a model. Filled by the emulator from its model table.
struct LidarPattern {
  std::vector<LaserGeometry> lasers;  ///< At most kMaxLasers.
  Duration firing_period{};           ///< From one firing to the next.
  double minimum_range_m = 0.0;
  double maximum_range_m = 0.0;
};

/// What came back from one laser shot.
struct LidarReturn {
  float range_m = 0.0F;  ///< From the beam's exit point; 0 means nothing came back.
  float reflectivity =
      0.0F;  ///< Apparent diffuse reflectance 0..1 (1 = white Lambertian, head on).

  friend bool operator==(const LidarReturn&, const LidarReturn&) = default;
};

/// All lasers fired once. Laser i was shot at time + pattern.lasers[i].time_offset, at the rotor
/// angle and sensor pose of that very instant.
struct LidarFiring {
  SimTime time{};  ///< Of the first laser.
  double rotor_azimuth_rad =
      0.0;  ///< At `time`; clockwise seen from above, 0 = sensor forward, [0, 2 pi).
  double rotor_rate_radps = 0.0;  ///< At `time`, positive clockwise.
  std::array<LidarReturn, kMaxLasers> returns{};
};

}  // namespace rigwire
