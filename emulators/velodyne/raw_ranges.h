// Raw distances and intensities of an HDL-64E, fast enough for every shot of the stream.
//
// The correction that clients make (protocols/velodyne/hdl_64e_calibration.h) is linear in the raw
// distance between the places where the beam crosses an axis, so that it is inverted in one step;
// what depends on the laser alone is worked out beforehand, and the direction is turned on from the
// bank's. Error against raw_counts(): 0.01 counts beyond 2 m from the axes' crossings, where the
// sign of a coordinate of centimetres may be guessed wrongly: 0.05 counts.
//
// Constants are stored in columns, by laser, so that loops over a bank run in vector registers.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/model.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/wide_vectors.h"

namespace rigwire::emulators {

class RawRanges {
 public:
  /// The calibration is validated; the lasers' times are the model's.
  RawRanges(const protocols::velodyne::Hdl64eCalibration& calibration,
            std::span<const protocols::velodyne::Laser> lasers);

  /// What counts() needs of the beams of one bank, as they pointed when they were shot. In the
  /// manual's frame a target's coordinate is about per_m * range + at on each axis.
  struct Beams {
    using Column = std::array<double, kBankLasers>;
    struct Axis {
      Column share;  ///< Share of the axis's correction in the range's correction.
      Column per_m;  ///< This and the next with the slope's sign.
      Column at;
      Column turn;  ///< share * slope * per_m for a correction that grows with the coordinate.
      Column lean;  ///< slope * at, for such a correction.
    };
    std::size_t first_laser;
    Axis x;
    Axis y;
  };
  /// The rotor is that of the first laser of the firing. Fills the beams in place.
  void aim(double rotor_azimuth_rad, double rotor_rate_radps, std::size_t first_laser,
           Beams& beams) const;

  /// Returns the distance of laser i of the bank in counts, not rounded; below 1: nearer than the
  /// laser can report.
  [[nodiscard]] double counts(const Beams& beams, std::size_t i, double range_m) const {
    const std::size_t n = beams.first_laser + i;
    // The corrections follow the magnitudes of the coordinates.
    const double sign_x = std::copysign(1.0, beams.x.per_m[i] * range_m + beams.x.at[i]);
    const double sign_y = std::copysign(1.0, beams.y.per_m[i] * range_m + beams.y.at[i]);
    // range = raw + share_x * correction_x + share_y * correction_y, solved for raw + far.
    const double per_m = 1.0 + sign_x * beams.x.turn[i] + sign_y * beams.y.turn[i];
    const double constant = beams.x.share[i] * (at_axis_x_[n] + sign_x * beams.x.lean[i]) +
                            beams.y.share[i] * (at_axis_y_[n] + sign_y * beams.y.lean[i]);
    const double raw_m = (range_m + far_m_[n] - constant) / per_m - far_m_[n];
    return raw_m / protocols::velodyne::kHdl64eDistanceUnit_m;
  }

  /// What protocols::velodyne::raw_intensity() gives, for laser n of the head.
  [[nodiscard]] std::int32_t intensity(std::size_t n, double intensity, double raw_counts) const {
    const double raw =
        intensity - protocols::velodyne::FocusTerm{focus_strength_[n], at_focus_[n]}.at(raw_counts);
    const double shown = choose(raw > 0.0, raw, 0.0);
    const auto whole = static_cast<std::int32_t>(shown);
    // Not shown + 0.5 cut off: the sum rounds 0.5 less its last bit up to 1.
    return whole + static_cast<std::int32_t>(shown - static_cast<double>(whole) >= 0.5);
  }

 private:
  using Column = std::array<double, protocols::velodyne::kHdl64eLasers>;

  Column offset_sine_{};  ///< Sine of the laser's azimuth relative to the rotor's.
  Column offset_cosine_{};
  Column shot_after_s_{};
  Column cos_elevation_{};
  Column horizontal_offset_m_{};
  Column far_m_{};
  Column slope_x_{};  ///< Slopes of the corrections, metres per metre.
  Column slope_y_{};
  Column at_axis_x_{};  ///< Corrections, carried on to the axis.
  Column at_axis_y_{};
  Column focus_strength_{};
  Column at_focus_{};
};

}  // namespace rigwire::emulators
