// What satellites and air do to every receiver alike: one field of errors for all receivers of a
// rig, a function of satellite, place and time. Evaluating it draws no random numbers.
//
// Each part is a sum of waves whose frequencies are drawn by what they are to be like, at the start
// and by name (so that the satellites that there are change nothing of each other):
//
//   f(t, x) = sqrt(2 / N) sum cos(w_i t / tau + k_i x / L + phase_i)
//
//   time              w from Cauchy's distribution: correlation exp(-|t| / tau); waves shorter than
//                     tau / 1.6 are left out, so that carriers see no noise
//   ionosphere        k normal: correlation exp(-d^2 / 2 L^2), smooth, where the signal passes a
//                     shell at 350 km; L = sigma / gradient, 1 mm/km being quiet and 4 disturbed
//   troposphere       k of Cauchy's distribution in three dimensions: correlation exp(-d / L), at
//                     the antenna; L = 500 km (estimated zenith delays agree within 200 km)
//   satellite         half of its variance the clock, the same everywhere; half the orbit, three
//                     components projected on the line of sight, so that receivers d apart differ
//                     by the orbit's error times d / 20 000 km
//
// One field serves all receivers of a rig, from any thread (Constellation::errors()).
//
// With N waves the distribution is not quite normal: the fourth moment is 3 - 1.5 / N.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <span>
#include <vector>

#include "sim/gnss/constellation.h"

namespace rigwire::sim {

class ErrorField {
 public:
  /// The field depends on satellites and seed alone.
  ErrorField(std::span<const Satellite> satellites, std::uint64_t seed);

  // All values have variance 1. Times are since the start of the simulation; places and directions
  // are earth-fixed.

  /// Orbit and clock of satellite `index`; `direction_E` unit, from the antenna.
  [[nodiscard]] double satellite(std::size_t index, double time_s, double correlation_s,
                                 const Eigen::Vector3d& direction_E) const;
  /// Vertical, at the pierce point of a signal from `p_E_m` along `direction_E`.
  [[nodiscard]] double ionosphere(double time_s, double correlation_s, double length_m,
                                  const Eigen::Vector3d& p_E_m,
                                  const Eigen::Vector3d& direction_E) const;
  /// Vertical.
  [[nodiscard]] double troposphere(double time_s, double correlation_s,
                                   const Eigen::Vector3d& p_E_m) const;

 private:
  static constexpr std::size_t kFieldWaves = 24;
  static constexpr std::size_t kSatelliteWaves = 6;
  struct Wave {
    double frequency = 0.0;
    Eigen::Vector3d number = Eigen::Vector3d::Zero();
    double phase = 0.0;
  };
  /// Wave of a satellite's errors, which do not depend on the antenna's place.
  struct TimeWave {
    double frequency = 0.0;
    double phase = 0.0;
  };
  struct SatelliteWaves {
    std::array<TimeWave, kSatelliteWaves> clock;
    std::array<std::array<TimeWave, kSatelliteWaves>, 3> orbit;
  };
  /// What a satellite's waves come to at a time, the last that was asked for.
  struct SatelliteValue {
    double time = std::numeric_limits<double>::quiet_NaN();
    double clock = 0.0;
    Eigen::Vector3d orbit = Eigen::Vector3d::Zero();
  };

  std::vector<SatelliteWaves> satellites_;
  mutable std::mutex mutex_;  ///< Guards values_.
  mutable std::vector<SatelliteValue> values_;
  std::array<Wave, kFieldWaves> ionosphere_;
  std::array<Wave, kFieldWaves> troposphere_;
};

}  // namespace rigwire::sim
