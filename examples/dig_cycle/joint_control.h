// From wanted joint angles to valve openings: proportional, limited in size, in slope, and near the
// joints' stops.
#pragma once

#include "dig_cycle/machine.h"

namespace rigwire::dig_cycle {

struct JointControlSettings {
  /// Opening per rad of error.
  PerJoint gain_per_rad{1.2, 4.0, 4.0, 1.5};
  /// Travel that lets no oil through: added to every opening, fading out below `fine_error_rad`.
  double dead_band = 0.04;
  double fine_error_rad = 0.5 * kDegree;
  /// Largest opening, 0..1 of full travel.
  PerJoint largest_opening{0.8, 0.8, 0.8, 0.8};
  /// The bucket's, where it is curled further than that: its linkage turns it there at 270 deg/s of
  /// full opening, and its inertial unit reports no more than 250 deg/s (SAE J1939-71, PGN 61482).
  double curled_opening = 0.35;
  double curled_rad = -100.0 * kDegree;
  /// Largest change of an opening, per second.
  double slope_per_s = 3.0;
  /// Nearer than this to its stop a joint is not driven towards it.
  double stop_margin_rad = 2.0 * kDegree;
  /// From here to the margin the opening towards the stop falls to nothing.
  double stop_approach_rad = 4.0 * kDegree;
};

class JointControl {
 public:
  JointControl(const Machine& machine, const JointControlSettings& settings);

  /// Openings -1..1 after `step_s`. Targets beyond a soft stop count as the soft stop.
  [[nodiscard]] PerJoint update(const PerJoint& target_rad, const PerJoint& angle_rad,
                                double step_s);
  /// All sections to neutral at once; the next update starts from there.
  void neutral() { openings_ = {}; }

 private:
  Machine machine_;
  JointControlSettings settings_;
  PerJoint openings_{};
};

}  // namespace rigwire::dig_cycle
