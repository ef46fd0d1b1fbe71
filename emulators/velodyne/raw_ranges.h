// Raw distances of an HDL-64E, fast enough for every shot of the stream.
//
// The correction that clients make (protocols/velodyne/hdl_64e_calibration.h) is linear in the raw
// distance between the places where the beam crosses an axis, so that it is inverted in one step;
// what depends on the laser alone is worked out beforehand, and the direction is turned on from the
// bank's. Error against raw_counts(): 0.01 counts beyond 2 m from the axes' crossings, where the
// sign of a coordinate of centimetres may be guessed wrongly: 0.05 counts.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/model.h"

namespace rigwire::emulators {

class RawRanges {
 public:
  /// The calibration is validated; the lasers' times are the model's.
  RawRanges(const protocols::velodyne::Hdl64eCalibration& calibration,
            std::span<const protocols::velodyne::Laser> lasers);

  /// The rotor when the first laser of a firing is shot.
  struct Rotor {
    Rotor(double azimuth_rad, double rate_radps);
    double sine;
    double cosine;
    double rate_radps;
  };

  /// Not rounded; below 1: nearer than the laser can tell.
  [[nodiscard]] double counts(const Rotor& rotor, std::size_t laser, double range_m) const;

 private:
  struct Constants {
    double offset_sine;  ///< Of the laser's azimuth against the rotor's.
    double offset_cosine;
    double shot_after_s;
    double cos_elevation;
    double horizontal_offset_m;
    double far_m;
    double near_x_m;
    double near_y_m;
    double slope_x;  ///< Of the corrections, metres per metre.
    double slope_y;
  };
  std::array<Constants, protocols::velodyne::kHdl64eLasers> lasers_{};
};

}  // namespace rigwire::emulators
