#include "protocols/velodyne/hdl_64e_encoder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocols/velodyne/hdl_64e_formula.h"

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr float kCountsPerMetre = 1.0F / static_cast<float>(kHdl64eDistanceUnit_m);

float narrow(double value) {
  return static_cast<float>(value);
}

}  // namespace

Hdl64eEncoder::Hdl64eEncoder(const Model& model, const Hdl64eCalibration& calibration,
                             NearCorrection near)
    : near_(near) {
  validate(calibration);
  for (std::size_t i = 0; i < kHdl64eLasers; ++i) {
    const Hdl64eLaser& laser = calibration.lasers[i];
    const bool has_near = has_near_correction(laser);
    const double near_x_m = has_near ? laser.dist_correction_x_m : laser.dist_correction_m;
    const double near_y_m = has_near ? laser.dist_correction_y_m : laser.dist_correction_m;
    ahead_deg_[i] = -laser.rot_correction_deg;
    time_offset_ns_[i] = model.lasers[i].time_offset_ns;
    cos_elevation_[i] = narrow(std::cos(laser.vert_correction_deg * kDegree));
    horizontal_m_[i] = narrow(laser.horiz_offset_m);
    far_m_[i] = narrow(laser.dist_correction_m);
    slope_x_[i] = narrow((laser.dist_correction_m - near_x_m) / (kFarPoint_m - kNearPointX_m));
    slope_y_[i] = narrow((laser.dist_correction_m - near_y_m) / (kFarPoint_m - kNearPointY_m));
    near_x_m_[i] = narrow(near_x_m) - slope_x_[i] * narrow(kNearPointX_m);
    near_y_m_[i] = narrow(near_y_m) - slope_y_[i] * narrow(kNearPointY_m);
    const double at_focus = 1.0 - laser.focal_distance_m / kIntensityReach_m;
    at_focus_[i] = narrow(at_focus * at_focus);
    intensity_slope_[i] = narrow(kIntensityScale * laser.focal_slope);
  }
  set_rotor_rate(0.0);
}

void Hdl64eEncoder::set_rotor_rate(double rate_degps) {
  for (std::size_t i = 0; i < kHdl64eLasers; ++i) {
    const double ahead_deg = ahead_deg_[i] + rate_degps * 1e-9 * time_offset_ns_[i];
    cos_ahead_[i] = narrow(std::cos(ahead_deg * kDegree));
    sin_ahead_[i] = narrow(std::sin(ahead_deg * kDegree));
  }
}

void Hdl64eEncoder::encode(std::size_t first_laser, double rotor_azimuth_deg,
                           std::span<const float, kBankLasers> ranges_m,
                           std::span<const float, kBankLasers> intensities,
                           std::span<Channel, kBankLasers> channels) const {
  const float cos_rotor = narrow(std::cos(rotor_azimuth_deg * kDegree));
  const float sin_rotor = narrow(std::sin(rotor_azimuth_deg * kDegree));
  const auto near_until_m = narrow(kFarPoint_m);
  const bool near_everywhere = near_ == NearCorrection::everywhere;
  std::array<float, kBankLasers> counts;
  std::array<float, kBankLasers> bytes;
  for (std::size_t lane = 0; lane < kBankLasers; ++lane) {
    const std::size_t i = first_laser + lane;
    const float sin_azimuth = sin_rotor * cos_ahead_[i] + cos_rotor * sin_ahead_[i];
    const float cos_azimuth = cos_rotor * cos_ahead_[i] - sin_rotor * sin_ahead_[i];
    // |level sin - h cos| and |level cos + h sin|, opened where the level distance outweighs h.
    const float sideways = std::abs(sin_azimuth);
    const float ahead = std::abs(cos_azimuth);
    const float fold_x = sin_azimuth < 0.0F ? horizontal_m_[i] : -horizontal_m_[i];
    const float fold_y = cos_azimuth < 0.0F ? -horizontal_m_[i] : horizontal_m_[i];
    const float far_level_m = far_m_[i] * cos_elevation_[i];
    const float base_x_m =
        near_x_m_[i] + slope_x_[i] * (far_level_m * sideways + fold_x * cos_azimuth);
    const float base_y_m =
        near_y_m_[i] + slope_y_[i] * (far_level_m * ahead + fold_y * sin_azimuth);
    const float growth_x = slope_x_[i] * cos_elevation_[i] * sideways;
    const float growth_y = slope_y_[i] * cos_elevation_[i] * ahead;
    const float share_x = cos_elevation_[i] * sideways * cos_elevation_[i] * sideways;
    const float share_y = 1.0F - share_x;

    const float range_m = ranges_m[lane];
    const float near_raw_m = (range_m - base_x_m * share_x - base_y_m * share_y) /
                             (1.0F + growth_x * share_x + growth_y * share_y);
    const float far_raw_m = range_m - far_m_[i];
    const float below_m = std::min(near_raw_m, near_until_m);
    const float split_raw_m =
        far_raw_m >= near_until_m && near_raw_m >= near_until_m ? far_raw_m : below_m;
    const float raw_m = near_everywhere ? near_raw_m : split_raw_m;
    const float count = raw_m * kCountsPerMetre + 0.5F;
    const bool seen = (range_m > 0.0F) & (count >= 1.0F) & (count < 65536.0F);
    counts[lane] = seen ? count : 0.0F;

    const float here = 1.0F - count * narrow(1.0 / kDistanceField);
    const float focus = intensity_slope_[i] * std::abs(at_focus_[i] - here * here);
    const float byte = std::clamp(intensities[lane] - focus + 0.5F, 0.0F, 255.0F);
    bytes[lane] = seen ? byte : 0.0F;
  }
  for (std::size_t lane = 0; lane < kBankLasers; ++lane) {
    channels[lane] = {static_cast<std::uint16_t>(static_cast<std::int32_t>(counts[lane])),
                      static_cast<std::uint8_t>(static_cast<std::int32_t>(bytes[lane]))};
  }
}

}  // namespace rigwire::protocols::velodyne
