#include "emulators/velodyne/raw_ranges.h"

#include <cmath>
#include <numbers>

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

RawRanges::RawRanges(const velodyne::Hdl64eCalibration& calibration,
                     std::span<const velodyne::Laser> lasers) {
  for (std::size_t i = 0; i < lasers_.size(); ++i) {
    const velodyne::Hdl64eLaser& laser = calibration.lasers[i];
    const double offset_rad = -laser.rot_correction_deg * kDegree;
    const double far_m = laser.dist_correction_m;
    const bool has_near = laser.dist_correction_x_m != 0.0 || laser.dist_correction_y_m != 0.0;
    const double near_x_m = has_near ? laser.dist_correction_x_m : far_m;
    const double near_y_m = has_near ? laser.dist_correction_y_m : far_m;
    lasers_[i] = {
        .offset_sine = std::sin(offset_rad),
        .offset_cosine = std::cos(offset_rad),
        .shot_after_s = lasers[i].time_offset_ns * 1e-9,
        .cos_elevation = std::cos(laser.vert_correction_deg * kDegree),
        .horizontal_offset_m = laser.horiz_offset_m,
        .far_m = far_m,
        .near_x_m = near_x_m,
        .near_y_m = near_y_m,
        .slope_x = (far_m - near_x_m) / (velodyne::kFarPoint_m - velodyne::kNearPointX_m),
        .slope_y = (far_m - near_y_m) / (velodyne::kFarPoint_m - velodyne::kNearPointY_m)};
  }
}

RawRanges::Rotor::Rotor(double azimuth_rad, double rate)
    : sine(std::sin(azimuth_rad)), cosine(std::cos(azimuth_rad)), rate_radps(rate) {}

double RawRanges::counts(const Rotor& rotor, std::size_t laser, double range_m) const {
  const Constants& of = lasers_[laser];
  // Turned on by the offset, then by what the rotor turns until the shot: under 0.01 rad, so that
  // two terms do.
  const double sine = rotor.sine * of.offset_cosine + rotor.cosine * of.offset_sine;
  const double cosine = rotor.cosine * of.offset_cosine - rotor.sine * of.offset_sine;
  const double turned = rotor.rate_radps * of.shot_after_s;
  const double left = 1.0 - 0.5 * turned * turned;
  const double right = sine * left + cosine * turned;
  const double ahead = cosine * left - sine * turned;

  // x = x_per_m * (raw + far) + x_at, and so is y; the corrections follow their magnitudes.
  const double x_per_m = of.cos_elevation * right;
  const double y_per_m = of.cos_elevation * ahead;
  const double x_at = -of.horizontal_offset_m * ahead;
  const double y_at = of.horizontal_offset_m * right;
  const double slope_x = std::copysign(of.slope_x, of.slope_x * (x_per_m * range_m + x_at));
  const double slope_y = std::copysign(of.slope_y, of.slope_y * (y_per_m * range_m + y_at));
  const double share_x = x_per_m * x_per_m;
  const double share_y = 1.0 - share_x;
  // range = raw + share_x * correction_x + share_y * correction_y, solved for raw + far.
  const double per_m = 1.0 + share_x * slope_x * x_per_m + share_y * slope_y * y_per_m;
  const double constant =
      share_x * (of.near_x_m - of.slope_x * velodyne::kNearPointX_m + slope_x * x_at) +
      share_y * (of.near_y_m - of.slope_y * velodyne::kNearPointY_m + slope_y * y_at);
  const double raw_m = (range_m + of.far_m - constant) / per_m - of.far_m;
  return raw_m / velodyne::kHdl64eDistanceUnit_m;
}

}  // namespace rigwire::emulators
