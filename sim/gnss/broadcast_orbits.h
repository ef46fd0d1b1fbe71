// Orbits and clocks as Galileo, BeiDou and GLONASS broadcast them, and satellites that move exactly
// as a receiver computes them from the broadcast.
//
// Galileo, BeiDou: the nominal circular orbit, issued every two hours of the system's own time in
// whole steps of its message. Mean motion is chosen so that two hours of it are a whole number of
// steps within 3e-5 of one, so consecutive sets describe the same orbit within 2e-6 m (when the
// week turns, within a step of the node, 5 cm). Galileo's sets refer to their beginning, as
// receivers expect, BeiDou's to their middle. Group delays by number, up to 5 ns.
//
// GLONASS: position, velocity and clock every half hour, for 15 minutes before and after; a
// receiver integrates the motion under an oblate earth (ICD 5.1, appendix A.3.1.2). The orbit below
// is a periodic solution of these equations: it crosses equator and highest latitude at right
// angles to the radius, was found once by shooting, and is given as five odd harmonics (1e-4 m).
// The quantisation of a set (0.5 m, 1 mm/s) is added to it, by the motion's variational equations
// (1e-3 m over the 15 minutes). Consecutive sets may differ by a metre; in the half minute around
// the change satellites pass smoothly from one to the next.
//
// Each satellite's clock of these systems has a constant offset, within 8e-5 s.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "sim/gnss/constellation.h"
#include "sim/gnss/nominal_slots.h"
#include "sim/samples/gps_navigation.h"

namespace rigwire::sim {

/// A satellite of Galileo or BeiDou.
class KeplerBroadcast {
 public:
  explicit KeplerBroadcast(const NominalOrbit& orbit);

  /// Number of the set on the air at `time` plus `offset_s`.
  [[nodiscard]] std::int64_t interval(const GpsTime& time, double offset_s = 0.0) const;
  [[nodiscard]] GpsEphemeris set(std::int64_t interval) const;
  [[nodiscard]] SatelliteState state(const GpsTime& time, double offset_s) const;

 private:
  Satellite satellite_;
  std::int64_t first_ = 0;
  std::int64_t anomaly_steps_ = 0;  ///< In the first interval, and from one to the next.
  std::int64_t anomaly_change_ = 0;
  std::int64_t node_steps_ = 0;  ///< In the week of the first, and from one to the next.
  std::int64_t node_change_ = 0;
  std::int32_t first_week_ = 0;
  GpsEphemeris fixed_;  ///< What does not change.
};

/// A satellite of GLONASS.
class GlonassBroadcast {
 public:
  explicit GlonassBroadcast(const NominalOrbit& orbit);

  [[nodiscard]] static std::int64_t interval(const GpsTime& time, double offset_s = 0.0);
  [[nodiscard]] GlonassEphemeris set(std::int64_t interval) const;
  [[nodiscard]] SatelliteState state(const GpsTime& time, double offset_s) const;

 private:
  struct Motion {
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  };
  /// Phase and longitude of the node in the middle of an interval.
  struct Middle {
    std::int64_t interval = 0;
    double phase_rad = 0.0;
    double node_rad = 0.0;
  };
  [[nodiscard]] Middle middle(std::int64_t interval) const;
  [[nodiscard]] static Motion orbit(const Middle& middle, double since_s);
  [[nodiscard]] static Motion deviation(const Middle& middle, double since_s);

  std::uint8_t slot_ = 0;
  double phase_rad_ = 0.0;  ///< At the nominal epoch.
  double node_rad_ = 0.0;
  double clock_correction_s_ = 0.0;
};

}  // namespace rigwire::sim
