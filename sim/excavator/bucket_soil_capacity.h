// How much soil a bucket can hold at each pitch.
#pragma once

#include <vector>

#include "sim/excavator/bucket_soil_parameters.h"

namespace rigwire::sim {

/// Soil stays in the shell as far as it lies below a slope at its angle of repose that rises from
/// either lip, and is carried by the shell rather than hanging over the opening. The share is
/// worked out once, for each degree of pitch, by counting points of the bucket's cross-section
/// (within 1 % of the struck capacity), and interpolated.
class BucketCapacity {
 public:
  BucketCapacity(const BucketSoilParameters& parameters, double bucket_tip_m);

  /// Opening level and up: the struck capacity plus a roof at the angle of repose.
  [[nodiscard]] double heaped_m3() const { return heaped_m3_; }
  [[nodiscard]] double opening_length_m() const { return opening_m_; }
  /// Depth of the shell below the opening.
  [[nodiscard]] double depth_m() const { return depth_m_; }

  /// `pitch_rad`: of the bucket's x above the horizontal, along the arm; +-pi holds most. Any
  /// angle.
  [[nodiscard]] double held_m3(double pitch_rad) const;

 private:
  [[nodiscard]] double counted_m3(const BucketSoilParameters& parameters, double pitch_rad) const;

  double opening_m_;
  double depth_m_;
  double heaped_m3_;
  std::vector<double> held_m3_;  ///< From -180 degrees on, one for each.
};

}  // namespace rigwire::sim
