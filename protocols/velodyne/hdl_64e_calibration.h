// Calibration of an HDL-64E unit, and what its clients do with it.
//
// A unit measures raw distances. Its clients add, for each laser, a distance correction that was
// found at 25.04 m, replace it nearby by one interpolated in x and in y towards those found at 2.4
// m and 1.93 m, and then put the beam where it leaves the head. With raw distance d and azimuth b
// of the laser (rotor's - rot_correction), elevation w, in the manual's frame (x right, y forward):
//
//   far = d + dist_correction
//   xx = |far cos w sin b - horizontal_offset cos b|
//   yy = |far cos w cos b + horizontal_offset sin b|
//   corr_x = near_x + (dist_correction - near_x) (xx - 2.4) / (25.04 - 2.4)
//   corr_y = near_y + (dist_correction - near_y) (yy - 1.93) / (25.04 - 1.93)
//   x = (d + corr_x) cos w sin b - horizontal_offset cos b
//   y = (d + corr_y) cos w cos b + horizontal_offset sin b
//   z = (d + corr_y) sin w + vertical_offset
//
// An emulated sensor must send the raw distance from which such a client gets the true point:
// raw_counts() inverts the formula.
//
// Sources: HDL-64E S2 and S2.1 user's manual, appendix F "Dual two point calibration methodology
// and code samples", appendix E (units); intensity: the same code as carried on by
// ros-drivers/velodyne and velodyne_decoder 3.1.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocols/velodyne/model.h"

namespace rigwire::protocols::velodyne {

inline constexpr std::size_t kHdl64eLasers = 64;
inline constexpr double kHdl64eDistanceUnit_m = 0.002;

/// Where the three distance corrections were found.
inline constexpr double kFarPoint_m = 25.04;
inline constexpr double kNearPointX_m = 2.40;
inline constexpr double kNearPointY_m = 1.93;

/// One laser, with the names of calibration files.
struct Hdl64eLaser {
  double rot_correction_deg = 0.0;   ///< Counter-clockwise: true azimuth = rotor's - this.
  double vert_correction_deg = 0.0;  ///< Elevation.
  double dist_correction_m = 0.0;    ///< Found at 25.04 m.
  double dist_correction_x_m = 0.0;  ///< Found at 2.4 m along x; 0 for both: no near correction.
  double dist_correction_y_m = 0.0;  ///< Found at 1.93 m along y.
  double vert_offset_m = 0.0;        ///< Exit above the foot of the sensor.
  double horiz_offset_m = 0.0;       ///< Exit to the left of the beam, +-0.026.
  double focal_distance_m = 0.0;     ///< Focal distance of the receiver, for the intensity.
  double focal_slope = 0.0;
  std::uint8_t min_intensity = 0;
  std::uint8_t max_intensity = 255;

  friend bool operator==(const Hdl64eLaser&, const Hdl64eLaser&) = default;
};

struct Hdl64eCalibration {
  std::vector<Hdl64eLaser> lasers;  ///< By number, 64 of them.

  friend bool operator==(const Hdl64eCalibration&, const Hdl64eCalibration&) = default;
};

/// Throws std::invalid_argument naming the laser, the quantity, what was found and what is allowed:
/// 64 lasers; angles within +-90 degrees, distance corrections within +-5 m, offsets within 1 m,
/// focal distance within 0 .. 131 m, slope within 0 .. 10, intensity limits in order.
void validate(const Hdl64eCalibration& calibration);

/// Angles and exits of the model's nominal table and 1.4 m distance correction near and far
/// (published calibrations of real units hold 1.1 to 1.6 m). Near and far are the same, and the
/// intensity is left alone (slope 0), so that all clients agree, whichever way they take these
/// terms.
[[nodiscard]] Hdl64eCalibration nominal_calibration(const Model& model);

/// The model's lasers as this unit has them: angles and exits of the calibration, times of the
/// model. Precondition: validated.
[[nodiscard]] std::vector<Laser> calibrated_lasers(const Model& model,
                                                   const Hdl64eCalibration& calibration);

/// Whether clients apply the near correction at all distances (code of the manual, ROS driver) or
/// only to raw distances below 25.04 m (text of the manual, velodyne_decoder), where the formula
/// jumps by up to the difference of the corrections.
enum class NearCorrection : std::uint8_t { everywhere, below_25_m };

/// Where a beam goes, its azimuth clockwise from forward.
struct BeamDirection {
  double cos_elevation = 1.0;
  double sin_elevation = 0.0;
  double cos_azimuth = 1.0;
  double sin_azimuth = 0.0;
};

/// A client's point, in our frame (x forward, y left, z up).
struct CorrectedPoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double range_m = 0.0;  ///< From the beam's exit, along the beam.
};

/// Returns the point that a client computes from a raw count, with the rotor at `azimuth_deg` when
/// the laser fired.
[[nodiscard]] CorrectedPoint corrected(const Hdl64eLaser& laser, double raw_counts,
                                       double azimuth_deg,
                                       NearCorrection near = NearCorrection::everywhere);
/// Returns the point that a client computes for a laser that points along `beam`.
[[nodiscard]] CorrectedPoint corrected(const Hdl64eLaser& laser, double raw_counts,
                                       const BeamDirection& beam,
                                       NearCorrection near = NearCorrection::everywhere);

/// The raw distance in counts, not rounded, from which a client gets `range_m` along the beam.
/// Below 1: nearer than the laser can report. Error: less than 1e-6 counts; with
/// NearCorrection::below_25_m, up to half its jump for ranges that the formula leaves out.
[[nodiscard]] double raw_counts(const Hdl64eLaser& laser, double range_m, double azimuth_deg,
                                NearCorrection near = NearCorrection::everywhere);

/// Term that clients add to a laser's raw intensity; it grows with the distance from its focus.
struct FocusTerm {
  double strength = 0.0;  ///< Strength of the term, from the focal slope.
  double at_focus = 0.0;  ///< (1 - focal distance / 131 m) squared.

  [[nodiscard]] double at(double raw_counts) const {
    constexpr double kPerCount = 1.0 / 65535.0;
    const double here = 1.0 - raw_counts * kPerCount;
    return strength * std::abs(at_focus - here * here);
  }
};
[[nodiscard]] FocusTerm focus_term(const Hdl64eLaser& laser);

/// What a client makes of a raw intensity, and the raw intensity nearest to what it is to see.
[[nodiscard]] double corrected_intensity(const Hdl64eLaser& laser, std::uint8_t raw_intensity,
                                         double raw_counts);
[[nodiscard]] std::uint8_t raw_intensity(const Hdl64eLaser& laser, double intensity,
                                         double raw_counts);

}  // namespace rigwire::protocols::velodyne
