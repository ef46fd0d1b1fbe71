#include "emulators/velodyne/raw_ranges.h"

#include "fields/constants.h"
#include "sim/samples/wide_vectors.h"

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;

}  // namespace

RawRanges::RawRanges(const velodyne::Hdl64eCalibration& calibration,
                     std::span<const velodyne::Laser> lasers) {
  for (std::size_t n = 0; n < velodyne::kHdl64eLasers; ++n) {
    const velodyne::Hdl64eLaser& laser = calibration.lasers[n];
    const double offset_rad = -laser.rot_correction_deg * kDegree;
    const double far_m = laser.dist_correction_m;
    const bool has_near = laser.dist_correction_x_m != 0.0 || laser.dist_correction_y_m != 0.0;
    const double near_x_m = has_near ? laser.dist_correction_x_m : far_m;
    const double near_y_m = has_near ? laser.dist_correction_y_m : far_m;
    const velodyne::FocusTerm focus = velodyne::focus_term(laser);
    offset_sine_[n] = std::sin(offset_rad);
    offset_cosine_[n] = std::cos(offset_rad);
    shot_after_s_[n] = lasers[n].time_offset_ns * 1e-9;
    cos_elevation_[n] = std::cos(laser.vert_correction_deg * kDegree);
    horizontal_offset_m_[n] = laser.horiz_offset_m;
    far_m_[n] = far_m;
    // Correction linear between near and far calibration point, for x and y apart (user's manual).
    slope_x_[n] = (far_m - near_x_m) / (velodyne::kFarPoint_m - velodyne::kNearPointX_m);
    slope_y_[n] = (far_m - near_y_m) / (velodyne::kFarPoint_m - velodyne::kNearPointY_m);
    at_axis_x_[n] = near_x_m - slope_x_[n] * velodyne::kNearPointX_m;
    at_axis_y_[n] = near_y_m - slope_y_[n] * velodyne::kNearPointY_m;
    focus_strength_[n] = focus.strength;
    at_focus_[n] = focus.at_focus;
  }
}

RIGWIRE_WIDE_VECTORS
void RawRanges::aim(double rotor_azimuth_rad, double rotor_rate_radps, std::size_t first_laser,
                    Beams& beams) const {
  const double rotor_sine = std::sin(rotor_azimuth_rad);
  const double rotor_cosine = std::cos(rotor_azimuth_rad);
  beams.first_laser = first_laser;
  for (std::size_t i = 0; i < kBankLasers; ++i) {
    const std::size_t n = first_laser + i;
    // Turned on by the offset, then by what the rotor turns until the shot: under 0.01 rad, so that
    // two terms do.
    const double sine = rotor_sine * offset_cosine_[n] + rotor_cosine * offset_sine_[n];
    const double cosine = rotor_cosine * offset_cosine_[n] - rotor_sine * offset_sine_[n];
    const double turned = rotor_rate_radps * shot_after_s_[n];
    const double left = 1.0 - 0.5 * turned * turned;
    const double right = sine * left + cosine * turned;
    const double ahead = cosine * left - sine * turned;
    // Coordinate = per_m range + at, and how much of each axis's correction goes into the range.
    const double x_per_m = cos_elevation_[n] * right;
    const double y_per_m = cos_elevation_[n] * ahead;
    const double x_at = -horizontal_offset_m_[n] * ahead;
    const double y_at = horizontal_offset_m_[n] * right;
    const double steep_x = std::abs(slope_x_[n]);
    const double steep_y = std::abs(slope_y_[n]);
    beams.x.share[i] = x_per_m * x_per_m;
    beams.y.share[i] = 1.0 - beams.x.share[i];
    beams.x.per_m[i] = std::copysign(1.0, slope_x_[n]) * x_per_m;
    beams.y.per_m[i] = std::copysign(1.0, slope_y_[n]) * y_per_m;
    beams.x.at[i] = std::copysign(1.0, slope_x_[n]) * x_at;
    beams.y.at[i] = std::copysign(1.0, slope_y_[n]) * y_at;
    beams.x.turn[i] = beams.x.share[i] * steep_x * x_per_m;
    beams.y.turn[i] = beams.y.share[i] * steep_y * y_per_m;
    beams.x.lean[i] = steep_x * x_at;
    beams.y.lean[i] = steep_y * y_at;
  }
}

}  // namespace rigwire::emulators
