// Where navigation satellites are, and what they broadcast.
//
// A constellation is fixed data; its satellites move as functions of GPS time alone, so that any
// number of receivers can share one, from any thread.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"
#include "sim/samples/gps_navigation.h"

namespace rigwire::sim {

/// Speed of light, and the earth's rotation rate and gravity as IS-GPS-200 section 20.3.3.4.3.3
/// fixes them for users of broadcast orbits.
inline constexpr double kLightSpeed_mps = 299'792'458.0;
inline constexpr double kEarthRate_radps = 7.2921151467e-5;
inline constexpr double kEarthGravity_m3ps2 = 3.986005e14;
inline constexpr double kGpsL1_hz = 1'575.42e6;

struct Satellite {
  GnssSystem system = GnssSystem::gps;
  std::uint8_t number = 0;  ///< Number within the system, as in SatelliteView.

  friend bool operator==(const Satellite&, const Satellite&) = default;
};

/// Earth-centred earth-fixed at the instant asked for.
struct SatelliteState {
  Eigen::Vector3d position_E_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_E_mps = Eigen::Vector3d::Zero();
  /// Satellite clock less GPS time: polynomial and relativity, without group delay. 0 for SBAS and
  /// QZSS, whose clocks are not modelled.
  double clock_s = 0.0;
  double clock_drift = 0.0;     ///< s/s.
  double group_delay_s = 0.0;   ///< TGD, which delays the first carrier by so much ...
  double second_delay_s = 0.0;  ///< ... and what delays the second.
  bool healthy = true;
};

class ErrorField;

class Constellation {
 public:
  virtual ~Constellation() = default;
  /// In the order of system, then number.
  [[nodiscard]] virtual std::span<const Satellite> satellites() const = 0;
  /// State of satellite `index` at `time` plus `offset_s` (|offset_s| <= 1 s, for times of flight).
  [[nodiscard]] virtual SatelliteState state(std::size_t index, const GpsTime& time,
                                             double offset_s) const = 0;
  /// state() of those satellites at `time`, in their order. The last one of each is kept: receivers
  /// that measure at the same instants share it. Precondition: as many results as indices.
  void states(std::span<const std::size_t> indices, const GpsTime& time,
              std::span<SatelliteState> results) const;
  /// What the satellites broadcast at `time`. The same object as long as nothing changes. The
  /// satellites of state() move exactly as a receiver finds them from it (broadcast_orbits.h says
  /// how exactly). Null with SBAS and QZSS alone.
  [[nodiscard]] virtual std::shared_ptr<const GpsNavigation> navigation(
      const GpsTime& time) const = 0;

  /// Returns the errors of these satellites and of the air for that seed. Callers share one object
  /// as long as one of them holds it.
  [[nodiscard]] std::shared_ptr<const ErrorField> errors(std::uint64_t seed) const;

 private:
  struct Kept {
    GpsTime time{-1, 0};
    SatelliteState state;
  };
  mutable std::mutex mutex_;
  mutable std::vector<Kept> kept_;  ///< By index.
  mutable std::map<std::uint64_t, std::weak_ptr<const ErrorField>> errors_;
};

/// Returns the published nominal slots of each system: GPS 24, GLONASS 24/3/1, Galileo 24/3/1,
/// BeiDou medium orbits 24/3/1, all with broadcasts; SBAS and QZSS at their longitudes. Sources and
/// bounds are in the source file. Throws std::invalid_argument for a system that has no nominal
/// slots.
[[nodiscard]] std::shared_ptr<const Constellation> make_nominal_constellation(
    std::span<const GnssSystem> systems);

/// GPS satellites from broadcast sets (of a navigation file), of each satellite the set nearest in
/// time, made ready for broadcast. Throws std::invalid_argument without any set.
[[nodiscard]] std::shared_ptr<const Constellation> make_gps_constellation(
    std::span<const GpsEphemeris> sets, const KlobucharParameters& ionosphere,
    const GpsUtcParameters& utc);

inline constexpr std::size_t kGpsSlots = 24;  ///< Nominal ones; PRN 1..24.

}  // namespace rigwire::sim
