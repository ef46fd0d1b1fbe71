// Satellites that an antenna receives past the scene, and how strongly.
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
  double cone_half_angle_deg = 1.5;     ///< Cone of the samples; [0, 10].
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
  /// Ends tracking: the satellite is below the horizon.
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
