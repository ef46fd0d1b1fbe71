// A satellite receiver's antenna and navigation engine: which satellites it sees past the scene,
// how good its position is, and the position with its error.
//
// Model of Wolf, Groll, Hemer, Berns, SIMULTECH 2020: one ray per satellite; dilution by Eq. 1 and
// Table 1; error by Eq. 2; kind of fix by Eq. 3. The paper's open points are settled so: satellites
// are directions (not points "above the scene"); Eq. 2 gives metres in the local tangent plane;
// horizontal dilution scales north and east, vertical dilution the height; the data-sheet precision
// is a CEP, so that one horizontal axis has sigma = dilution * CEP / 1.1774 / sqrt(2) with dilution
// understood as the horizontal one. Consecutive errors are correlated (first-order Gauss-Markov,
// exact discretisation) unless correlation_time_s is 0, the paper's white noise.
//
// Known limits: no multipath, no atmosphere, no satellite clock; one constellation (24 GPS slots).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/gnss/constellation.h"
#include "sim/gnss/dilution.h"
#include "sim/link_motion.h"
#include "sim/local_frame.h"
#include "sim/random.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"
#include "sim/visibility.h"

namespace rigwire::sim {

/// The paper's rule: 3D degrades to 2D when one of four sectors of the sky has no satellite.
enum class QuadrantRule : unsigned char {
  off,       ///< Default. Under open sky the rule alone costs 35 % of all 3D fixes at 49 deg north.
  cardinal,  ///< Sectors centred on north, east, south, west.
  diagonal,  ///< Sectors centred on north-east, south-east, south-west, north-west.
};

struct GnssParameters {
  DilutionKind dilution = DilutionKind::regression;
  QuadrantRule quadrant_rule = QuadrantRule::off;
  double elevation_mask_deg = 5.0;      ///< [0, 90).
  double antenna_clearance_m = 0.05;    ///< Things nearer than this do not block the sky.
  double circular_error_m = 2.5;        ///< CEP under open sky: data sheet, GPS only; >= 0.
  double correlation_time_s = 60.0;     ///< Of the position error; 0 = white, as in the paper.
  double speed_sigma_mps = 0.05;        ///< White, per axis, at horizontal dilution 1.
  double cn0_zenith_dbhz = 48.0;        ///< Carrier-to-noise density at 90 deg of elevation ...
  double cn0_horizon_dbhz = 38.0;       ///< ... and at 0 deg; between them with the sine.
  double cn0_threshold_dbhz = 25.0;     ///< Weaker satellites are not tracked.
  std::uint32_t maximum_channels = 22;  ///< Satellites that can be tracked at once; 1..24.
  double clock_drift = 4.3e-7;          ///< Mean receiver clock drift, s/s; |drift| <= 1e-4.
  double clock_drift_sigma = 2e-9;      ///< Of its slow wander (100 s), s/s.
};

/// Throws std::invalid_argument naming the parameter, its value and what is allowed.
void validate(const GnssParameters& parameters);

/// Eq. 3.
[[nodiscard]] GnssFix fix_by_count(int satellites);

class GnssSensor {
 public:
  /// Throws as validate(). The random stream is named `name`. Calendar and frame are copied.
  GnssSensor(const GnssParameters& parameters, const Calendar& calendar, const LocalFrame& frame,
             std::uint64_t seed, std::string_view name);

  /// One navigation epoch at `time` (not earlier than the one before). `antenna`: motion of the
  /// antenna's phase centre, X_WL its frame. Position and velocity are meaningful for 2D and 3D.
  [[nodiscard]] GnssSample sample(SimTime time, const LinkMotion& antenna,
                                  const Visibility& visibility);

 private:
  void advance_errors(SimTime time);
  void view_satellites(SimTime time, const Eigen::Vector3d& p_W, const Visibility& visibility,
                       GnssSample& sample);
  [[nodiscard]] bool quadrants_filled(const GnssSample& sample) const;

  GnssParameters parameters_;
  Calendar calendar_;
  LocalFrame frame_;
  std::unique_ptr<DilutionModel> dilution_;
  RandomStream random_;
  std::vector<Eigen::Vector3d> directions_enu_;           ///< Of the satellites used.
  Eigen::Vector3d unit_error_ = Eigen::Vector3d::Zero();  ///< East, north, up; sigma 1 each.
  double unit_drift_ = 0.0;
  double clock_bias_s_ = 0.0;
  SimTime last_ = kNever;
};

}  // namespace rigwire::sim
