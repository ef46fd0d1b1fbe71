#include "protocols/velodyne/hdl_64e_calibration.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "protocols/angle.h"

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kNominalDistance_m = 1.400;
constexpr double kNominalFocus_m = 10.0;

/// Reach of the distance field, and scale, in the formula of the intensity.
constexpr double kIntensityReach_m = 131.0;
constexpr double kIntensityScale = 256.0;

BeamDirection direction(const Hdl64eLaser& laser, double azimuth_deg) {
  const double elevation = laser.vert_correction_deg * kDegree;
  const double azimuth = (azimuth_deg - laser.rot_correction_deg) * kDegree;
  return {std::cos(elevation), std::sin(elevation), std::cos(azimuth), std::sin(azimuth)};
}

struct DistanceCorrections {
  double x_m;
  double y_m;
};

DistanceCorrections distance_corrections(const Hdl64eLaser& laser, const BeamDirection& beam,
                                         double raw_m, NearCorrection near) {
  const double far_m = laser.dist_correction_m;
  const bool has_near = laser.dist_correction_x_m != 0.0 || laser.dist_correction_y_m != 0.0;
  if (!has_near || (near == NearCorrection::below_25_m && raw_m >= kFarPoint_m)) {
    return {far_m, far_m};
  }
  const double level_m = (raw_m + far_m) * beam.cos_elevation;
  const double xx_m =
      std::abs(level_m * beam.sin_azimuth - laser.horiz_offset_m * beam.cos_azimuth);
  const double yy_m =
      std::abs(level_m * beam.cos_azimuth + laser.horiz_offset_m * beam.sin_azimuth);
  const double near_x_m = laser.dist_correction_x_m;
  const double near_y_m = laser.dist_correction_y_m;
  return {near_x_m + (far_m - near_x_m) * (xx_m - kNearPointX_m) / (kFarPoint_m - kNearPointX_m),
          near_y_m + (far_m - near_y_m) * (yy_m - kNearPointY_m) / (kFarPoint_m - kNearPointY_m)};
}

/// The corrected point is off the beam where the corrections of x and y differ; its range is what
/// lies along the beam.
double range_along_beam(const BeamDirection& beam, double raw_m, const DistanceCorrections& by) {
  const double sideways = beam.cos_elevation * beam.sin_azimuth;
  return raw_m + by.x_m * sideways * sideways + by.y_m * (1.0 - sideways * sideways);
}

void require(bool holds, std::size_t laser, const char* quantity, double found,
             const char* allowed) {
  if (!holds) {
    throw std::invalid_argument("HDL-64E calibration: laser " + std::to_string(laser) + ": " +
                                quantity + " is " + std::to_string(found) +
                                ", allowed: " + allowed);
  }
}

}  // namespace

void validate(const Hdl64eCalibration& calibration) {
  if (calibration.lasers.size() != kHdl64eLasers) {
    throw std::invalid_argument("HDL-64E calibration: it holds " +
                                std::to_string(calibration.lasers.size()) + " lasers, allowed: 64");
  }
  const auto within = [](double value, double limit) { return std::abs(value) <= limit; };
  for (std::size_t i = 0; i < kHdl64eLasers; ++i) {
    const Hdl64eLaser& laser = calibration.lasers[i];
    const auto angle = [&](const char* name, double value) {
      require(within(value, 90.0), i, name, value, "-90 to 90 degrees");
    };
    const auto distance = [&](const char* name, double value) {
      require(within(value, 5.0), i, name, value, "-5 to 5 m");
    };
    const auto offset = [&](const char* name, double value) {
      require(within(value, 1.0), i, name, value, "-1 to 1 m");
    };
    angle("rot_correction", laser.rot_correction_deg);
    angle("vert_correction", laser.vert_correction_deg);
    distance("dist_correction", laser.dist_correction_m);
    distance("dist_correction_x", laser.dist_correction_x_m);
    distance("dist_correction_y", laser.dist_correction_y_m);
    offset("vert_offset_correction", laser.vert_offset_m);
    offset("horiz_offset_correction", laser.horiz_offset_m);
    require(laser.focal_distance_m >= 0.0 && laser.focal_distance_m <= kIntensityReach_m, i,
            "focal_distance", laser.focal_distance_m, "0 to 131 m");
    require(laser.focal_slope >= 0.0 && laser.focal_slope <= 10.0, i, "focal_slope",
            laser.focal_slope, "0 to 10");
    require(laser.min_intensity <= laser.max_intensity, i, "min_intensity", laser.min_intensity,
            "at most max_intensity");
  }
}

Hdl64eCalibration nominal_calibration(const Model& model) {
  Hdl64eCalibration calibration;
  for (const Laser& laser : model.lasers) {
    calibration.lasers.push_back({.rot_correction_deg = -laser.azimuth_offset_deg,
                                  .vert_correction_deg = laser.elevation_deg,
                                  .dist_correction_m = kNominalDistance_m,
                                  .dist_correction_x_m = kNominalDistance_m,
                                  .dist_correction_y_m = kNominalDistance_m,
                                  .vert_offset_m = laser.vertical_offset_mm * 1e-3,
                                  .horiz_offset_m = -laser.horizontal_offset_mm * 1e-3,
                                  .focal_distance_m = kNominalFocus_m});
  }
  return calibration;
}

std::vector<Laser> calibrated_lasers(const Model& model, const Hdl64eCalibration& calibration) {
  std::vector<Laser> lasers(model.lasers.begin(), model.lasers.end());
  for (std::size_t i = 0; i < lasers.size(); ++i) {
    const Hdl64eLaser& unit = calibration.lasers[i];
    lasers[i].elevation_deg = unit.vert_correction_deg;
    lasers[i].azimuth_offset_deg = -unit.rot_correction_deg;
    lasers[i].vertical_offset_mm = unit.vert_offset_m * 1e3;
    lasers[i].horizontal_offset_mm = -unit.horiz_offset_m * 1e3;
  }
  return lasers;
}

CorrectedPoint corrected(const Hdl64eLaser& laser, double raw_counts, double azimuth_deg,
                         NearCorrection near) {
  return corrected(laser, raw_counts, direction(laser, azimuth_deg), near);
}

CorrectedPoint corrected(const Hdl64eLaser& laser, double raw_counts, const BeamDirection& beam,
                         NearCorrection near) {
  const double raw_m = raw_counts * kHdl64eDistanceUnit_m;
  const DistanceCorrections by = distance_corrections(laser, beam, raw_m, near);
  const double right_m = (raw_m + by.x_m) * beam.cos_elevation * beam.sin_azimuth -
                         laser.horiz_offset_m * beam.cos_azimuth;
  const double forward_m = (raw_m + by.y_m) * beam.cos_elevation * beam.cos_azimuth +
                           laser.horiz_offset_m * beam.sin_azimuth;
  return {.x_m = forward_m,
          .y_m = -right_m,
          .z_m = (raw_m + by.y_m) * beam.sin_elevation + laser.vert_offset_m,
          .range_m = range_along_beam(beam, raw_m, by)};
}

double raw_counts(const Hdl64eLaser& laser, double range_m, double azimuth_deg,
                  NearCorrection near) {
  // The corrections of real units change by millimetres per metre, so each round gains two digits
  // and more; what validate() admits at most halves the error.
  constexpr int kRounds = 60;
  constexpr double kConverged_m = 1e-12;
  const BeamDirection beam = direction(laser, azimuth_deg);
  double raw_m = range_m - laser.dist_correction_m;
  double error_m = range_m;
  for (int i = 0; i < kRounds && std::abs(error_m) > kConverged_m; ++i) {
    const DistanceCorrections by =
        distance_corrections(laser, beam, raw_m, NearCorrection::everywhere);
    error_m = range_m - range_along_beam(beam, raw_m, by);
    raw_m += error_m;
  }
  if (near == NearCorrection::below_25_m && raw_m >= kFarPoint_m) {
    const double far_raw_m = range_m - laser.dist_correction_m;
    const double below_m = std::nextafter(kFarPoint_m, 0.0);
    if (far_raw_m >= kFarPoint_m) {
      raw_m = far_raw_m;
    } else {
      // The range falls into the formula's jump: its nearer side.
      const auto missed_m = [&](double at_m) {
        const DistanceCorrections by = distance_corrections(laser, beam, at_m, near);
        return std::abs(range_along_beam(beam, at_m, by) - range_m);
      };
      raw_m = missed_m(below_m) < missed_m(kFarPoint_m) ? below_m : kFarPoint_m;
    }
  }
  return raw_m / kHdl64eDistanceUnit_m;
}

FocusTerm focus_term(const Hdl64eLaser& laser) {
  const double at_focus = 1.0 - laser.focal_distance_m / kIntensityReach_m;
  return {kIntensityScale * laser.focal_slope, at_focus * at_focus};
}

double corrected_intensity(const Hdl64eLaser& laser, std::uint8_t raw_intensity,
                           double raw_counts) {
  return std::clamp<double>(raw_intensity + focus_term(laser).at(raw_counts), laser.min_intensity,
                            laser.max_intensity);
}

std::uint8_t raw_intensity(const Hdl64eLaser& laser, double intensity, double raw_counts) {
  const double raw = intensity - focus_term(laser).at(raw_counts);
  return static_cast<std::uint8_t>(std::lround(std::clamp(raw, 0.0, 255.0)));
}

}  // namespace rigwire::protocols::velodyne
