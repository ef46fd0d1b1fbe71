// A spinning lidar: the pattern in which a model fires, what the device asks of its head, and what
// one firing sees.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/samples/time.h"

namespace rigwire {

/// Lasers are reported in banks; a head with more than one bank fires all of them each period.
inline constexpr std::size_t kBankLasers = 32;
inline constexpr std::size_t kMaxBanks = 4;
inline constexpr std::size_t kMaxLasers = kBankLasers * kMaxBanks;

/// One laser of the head, in the order of the model's own numbers.
///
/// Sensor frame S: x forward, y left, z up, origin on the spin axis. With the rotor at azimuth a
/// (clockwise from forward, seen from above) the laser points along azimuth b = a +
/// azimuth_offset_rad, elevation w: direction (cos w cos b, -cos w sin b, sin w). Its beam leaves
/// from (-h sin b, -h cos b, vertical offset): the horizontal offset h is positive to the right,
/// looking along the direction.
struct LaserGeometry {
  double elevation_rad = 0.0;        ///< Above the horizontal plane of the sensor.
  double azimuth_offset_rad = 0.0;   ///< Clockwise from the rotor's azimuth.
  double vertical_offset_m = 0.0;    ///< Where the beam leaves, along the spin axis.
  double horizontal_offset_m = 0.0;  ///< Where the beam leaves, to the right of its direction.
  Duration time_offset{};            ///< After the first laser of the same firing.
};

/// Shape of a beam and its pulse.
struct LaserBeam {
  double horizontal_divergence_rad = 0.0;  ///< Full angle at 1/e2 of the intensity.
  double vertical_divergence_rad = 0.0;
  Duration pulse{5};  ///< Length of the pulse, ns.
};

/// What the caster must know about a model. Filled by the emulator from its model table.
struct LidarPattern {
  std::vector<LaserGeometry> lasers;  ///< At most kMaxLasers.
  Duration firing_period{};           ///< From one firing of all lasers to the next.
  double minimum_range_m = 0.0;
  double maximum_range_m = 0.0;
  LaserBeam beam;

  /// Banks of each firing: 32 lasers each, the last one the rest.
  [[nodiscard]] std::size_t banks() const {
    return (lasers.size() + kBankLasers - 1) / kBankLasers;
  }
};

/// The rotor passes an azimuth at a known instant of every second.
struct PhaseLock {
  double azimuth_rad = 0.0;
  SimTime pulse{};  ///< An instant at which some second begins; the others follow from it.

  friend bool operator==(const PhaseLock&, const PhaseLock&) = default;
};

/// What the device asks of its head.
struct LidarCommand {
  double rotor_rate_radps = 0.0;  ///< Clockwise positive; 0 stops the motor.
  std::optional<PhaseLock> phase_lock;
  /// Lasers fire while the rotor's azimuth is within [start, end), clockwise; the window may
  /// contain 0; equal ends: all round.
  double view_start_rad = 0.0;
  double view_end_rad = 0.0;
  bool laser_on = true;
  /// Whether the receiver separates echoes (last and dual return). Otherwise it finds only the
  /// strongest, which is cheaper.
  bool several_echoes = false;

  friend bool operator==(const LidarCommand&, const LidarCommand&) = default;
};

/// One echo of a laser shot.
struct LidarReturn {
  float range_m = 0.0F;  ///< From the beam's exit point; 0 means nothing came back.
  /// 0 .. 1 apparent diffuse reflectance (1 = white Lambertian, head on); above 1 .. 2 a
  /// retro-reflector, 2 an ideal one.
  float reflectivity = 0.0F;

  friend bool operator==(const LidarReturn&, const LidarReturn&) = default;
};

using BankReturns = std::array<LidarReturn, kBankLasers>;

/// One bank of lasers fired once. Laser first_laser + i was shot at time + its time offset, at the
/// rotor angle and sensor pose of that very instant. Banks of one firing follow each other with the
/// same time.
struct LidarFiring {
  SimTime time{};  ///< Time of the first laser of all banks.
  double rotor_azimuth_rad =
      0.0;  ///< At `time`; clockwise seen from above, 0 = sensor forward, [0, 2 pi).
  double rotor_rate_radps = 0.0;  ///< At `time`, positive clockwise.
  std::size_t first_laser = 0;    ///< 0, 32, 64 or 96.
  BankReturns strongest{};
  /// Echoes were separated: `last` and `second` are valid. Otherwise there is at most one echo,
  /// which is also the last.
  bool several = false;
  BankReturns last{};    ///< The farthest echo.
  BankReturns second{};  ///< The second strongest; range 0: there was but one.
};

}  // namespace rigwire
