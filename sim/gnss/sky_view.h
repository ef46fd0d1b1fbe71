// Which satellites an antenna receives past the scene, and how strongly.
//
// C/N0 of satellite at elevation E:
//
//   horizon + (zenith - horizon) (1 - e^(-E / 20 deg)) / (1 - e^(-90 / 20))
//   - foliage attenuation x metres of crown + 20 log10(open share)
//   - loss at a reflection - jamming + fading
//
// With 11 and 52 dBHz these are 24, 39, 46, 49 and 51 dBHz at the middles of five bands of 15
// degrees from the horizon up. A NEO-M8T on a roof has means of 24, 39, 46, 48 and 52 there
// (gpsd's regression tests, ublox-neo-m8t); antennas of less gain, on the roof of a car, have 27
// to 29, 35 to 38, 39 to 43, 43 to 46 and 44 to 48 in a town (26 and 48.5 dBHz here).
//
// Fading: sigma (1 + 2.2 (1 - sin E)), sigma from that at rest to that in motion by 1 - e^(-v / 2
// m/s), correlated as range_errors.h says. Figures: two recordings of NEO-7Ps on drives through a
// town, C/N0 by elevation (sd 1 dB overhead to 3 dB low at rest, 2 to 6 dB in motion; 2.9 dB from
// one second to the next).
//
// The open share is the part of a narrow cone around the satellite that nothing solid blocks: a
// signal does not end at an edge like light, its Fresnel zone does (half of it blocked: 6 dB, as at
// a knife edge; J. D. Parsons, "The Mobile Radio Propagation Channel", 2nd ed., section 3.3). With
// one sample the edge is sharp. Foliage takes 0.5 to 1.5 dB/m at L1 (recalled, not measured here).
// Near crowns its mean is over a ring of 8 degrees, too: the first Fresnel zone of a crown ten
// metres away, sqrt(0.19 m x 10 m) = 1.4 m. Leaves and branches fade a signal by 2.5 dB x
// sqrt(loss / dB), at most 7 dB (5 to 8 dB under crowns, recalled), over 3 s at rest and 4 m in
// motion, and never to more than an open sky gives.
//
// Tracking has a memory: a satellite is lost below the threshold and comes back when it has been
// above threshold + hysteresis for the reacquisition time.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "fields/rules.h"
#include "sim/gnss/gauss_markov.h"
#include "sim/samples/time.h"
#include "sim/visibility.h"

namespace rigwire::sim {

/// Directions per satellite. Four and sixteen begin with the four of the cone's rim; sixteen goes
/// on only where these disagree: near edges.
enum class SkySamples : unsigned char { one, four, sixteen };

struct SkyViewParameters {
  double elevation_mask_deg = 5.0;        ///< Below it not used; [0, 90).
  double antenna_clearance_m = 0.05;      ///< Things nearer than this do not block the sky.
  double cn0_zenith_dbhz = 52.0;          ///< Carrier-to-noise density at 90 deg of elevation ...
  double cn0_horizon_dbhz = 11.0;         ///< ... and at 0 deg.
  double cn0_threshold_dbhz = 12.0;       ///< Weaker ones are not tracked; a NEO-7P: 1 % below.
  double cn0_hysteresis_db = 2.0;         ///< So much stronger to be acquired again.
  double cn0_sigma_db = 1.0;              ///< Fading of each satellite overhead, at rest ...
  double cn0_sigma_moving_db = 2.0;       ///< ... and in motion.
  double reacquisition_time_s = 1.0;      ///< From signal to tracking, after a loss.
  double foliage_attenuation_dbpm = 1.0;  ///< dB per metre within crowns.
  SkySamples samples = SkySamples::four;
  double cone_half_angle_deg = 1.5;     ///< Of the cone of samples; [0, 10].
  std::uint32_t maximum_channels = 22;  ///< Satellites that can be tracked at once; 1..184.
};
void visit(fields::Visitor& v, SkyViewParameters& p);

/// Throws std::invalid_argument naming the key, its value and what is allowed.
void validate(const SkyViewParameters& parameters);

/// What is left of the direct signal.
struct SkyArrival {
  double open_share = 1.0;  ///< 0 blocked .. 1 free.
  double foliage_m = 0.0;   ///< Mean over the open part.
  int rays = 0;             ///< Cast for it.
};

/// Samples the cone. `p_W` m, `direction_W` unit. `near_crowns`: samples foliage in the first
/// Fresnel zone of crowns near by, too (the file's comment).
[[nodiscard]] SkyArrival sky_arrival(const SkyViewParameters& parameters,
                                     const Visibility& visibility, const Eigen::Vector3d& p_W,
                                     const Eigen::Vector3d& direction_W, bool near_crowns = false);

/// C/N0 of the direct signal without fading and jamming; -infinity when it is blocked.
[[nodiscard]] double direct_cn0_dbhz(const SkyViewParameters& parameters, double sin_elevation,
                                     const SkyArrival& arrival);

/// Standard deviation of the fading of a satellite's signal.
[[nodiscard]] double fading_sigma_db(const SkyViewParameters& parameters, double sin_elevation,
                                     double speed_mps);

/// Standard deviation of what leaves and branches add, for a mean loss in crowns.
[[nodiscard]] double foliage_sigma_db(double foliage_db);

/// The tracking channel of one satellite.
class SatelliteTracker {
 public:
  struct Step {
    SimTime time{};
    double cn0_dbhz = 0.0;
    bool channel_free = true;  ///< Needed to acquire, not to go on.
    bool instantly = false;    ///< Without hysteresis and waiting.
  };
  /// Whether the satellite is tracked at `step.time`, not earlier than the step before.
  bool advance(const SkyViewParameters& parameters, const Step& step);
  /// Below the horizon.
  void set() {
    tracked_ = false;
    strong_since_ = kNever;
  }
  [[nodiscard]] bool tracked() const { return tracked_; }
  /// Since when; meaningful while tracked.
  [[nodiscard]] SimTime since() const { return since_; }

 private:
  bool tracked_ = false;
  bool begun_ = false;
  SimTime since_{};
  SimTime strong_since_ = kNever;
};

}  // namespace rigwire::sim
