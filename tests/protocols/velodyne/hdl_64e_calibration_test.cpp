#include "protocols/velodyne/hdl_64e_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigwire::protocols::velodyne {
namespace {

using testing::HasSubstr;

/// Corrections that differ from laser to laser as much as those of real units do.
Hdl64eCalibration unit() {
  Hdl64eCalibration calibration = nominal_calibration(*find_model("HDL-64E S2"));
  for (std::size_t i = 0; i < calibration.lasers.size(); ++i) {
    Hdl64eLaser& laser = calibration.lasers[i];
    const double phase = 2.4 * static_cast<double>(i);
    laser.rot_correction_deg += 0.2 * std::sin(phase);
    laser.vert_correction_deg += 0.2 * std::cos(phase);
    laser.dist_correction_m += 0.15 * std::sin(phase + 1.0);
    laser.dist_correction_x_m = laser.dist_correction_m + 0.04 * std::sin(phase + 2.0);
    laser.dist_correction_y_m = laser.dist_correction_m + 0.05 * std::cos(phase + 3.0);
    laser.focal_distance_m = 12.0 + 10.0 * std::sin(phase);
    laser.focal_slope = 1.2 + 0.5 * std::cos(phase);
  }
  return calibration;
}

TEST(Hdl64eCalibration, ClientRecoversTheTrueRangeOfEveryLaser) {
  for (const Hdl64eLaser& laser : unit().lasers) {
    for (const double azimuth : {0.0, 33.0, 90.0, 145.5, 181.0, 300.0}) {
      for (double range = 2.0; range <= 120.0; range *= 1.07) {
        const double counts = raw_counts(laser, range, azimuth);
        ASSERT_GT(counts, 0.0);
        EXPECT_NEAR(corrected(laser, counts, azimuth).range_m, range, 1e-9);
        EXPECT_NEAR(corrected(laser, std::round(counts), azimuth).range_m, range,
                    0.5 * kHdl64eDistanceUnit_m * 1.01);
      }
    }
  }
}

TEST(Hdl64eCalibration, RangesWithoutACountAreToldByIt) {
  Hdl64eLaser laser = unit().lasers[0];
  laser.dist_correction_m = 1.5;
  EXPECT_LT(raw_counts(laser, 1.0, 0.0), 1.0) << "nearer than the unit's own zero";
}

TEST(Hdl64eCalibration, NearCorrectionBelow25mJumpsNoFurtherThanItsStep) {
  for (const Hdl64eLaser& laser : unit().lasers) {
    const double step = std::max(std::abs(laser.dist_correction_x_m - laser.dist_correction_m),
                                 std::abs(laser.dist_correction_y_m - laser.dist_correction_m));
    for (double range = 2.0; range <= 120.0; range += 0.37) {
      const double counts = raw_counts(laser, range, 33.0, NearCorrection::below_25_m);
      const double error =
          corrected(laser, counts, 33.0, NearCorrection::below_25_m).range_m - range;
      const double raw_m = counts * kHdl64eDistanceUnit_m;
      EXPECT_LE(std::abs(error), std::abs(raw_m - 25.04) < 0.01 ? step / 2.0 : 1e-9) << range;
    }
  }
}

/// Written anew from appendix F of the manual, in centimetres as there.
std::array<double, 3> manual_point_cm(const Hdl64eLaser& laser, double raw_cm, double azimuth_deg) {
  const double degree = std::numbers::pi / 180.0;
  const double sin_r =
      std::sin(azimuth_deg * degree) * std::cos(laser.rot_correction_deg * degree) -
      std::cos(azimuth_deg * degree) * std::sin(laser.rot_correction_deg * degree);
  const double cos_r =
      std::cos(azimuth_deg * degree) * std::cos(laser.rot_correction_deg * degree) +
      std::sin(azimuth_deg * degree) * std::sin(laser.rot_correction_deg * degree);
  const double cos_v = std::cos(laser.vert_correction_deg * degree);
  const double sin_v = std::sin(laser.vert_correction_deg * degree);
  const double far = laser.dist_correction_m * 100.0;
  const double near_x = laser.dist_correction_x_m * 100.0;
  const double near_y = laser.dist_correction_y_m * 100.0;
  const double side = laser.horiz_offset_m * 100.0;
  const double level = (raw_cm + far) * cos_v;
  const double xx = std::abs(level * sin_r - side * cos_r);
  const double yy = std::abs(level * cos_r + side * sin_r);
  const double by_x = (far - near_x) * (xx - 240.0) / (2504.0 - 240.0) + near_x;
  const double by_y = (far - near_y) * (yy - 193.0) / (2504.0 - 193.0) + near_y;
  return {(raw_cm + by_x) * cos_v * sin_r - side * cos_r,
          (raw_cm + by_y) * cos_v * cos_r + side * sin_r,
          (raw_cm + by_y) * sin_v + laser.vert_offset_m * 100.0};
}

TEST(Hdl64eCalibration, PointIsThatOfTheManualsCode) {
  const Hdl64eCalibration calibration = unit();
  for (std::size_t i = 0; i < kHdl64eLasers; ++i) {
    const double azimuth = 5.7 * static_cast<double>(i);
    const double counts = 700.0 * static_cast<double>(i + 1);
    const auto right_forward_up = manual_point_cm(calibration.lasers[i], counts * 0.2, azimuth);
    const CorrectedPoint point = corrected(calibration.lasers[i], counts, azimuth);
    EXPECT_NEAR(point.x_m * 100.0, right_forward_up[1], 1e-6);
    EXPECT_NEAR(-point.y_m * 100.0, right_forward_up[0], 1e-6);
    EXPECT_NEAR(point.z_m * 100.0, right_forward_up[2], 1e-6);
  }
}

TEST(Hdl64eCalibration, IntensityComesBack) {
  for (const Hdl64eLaser& laser : unit().lasers) {
    for (const double counts : {800.0, 5000.0, 20000.0, 60000.0}) {
      const double dimmest = corrected_intensity(laser, 0, counts);
      const double brightest = corrected_intensity(laser, 255, counts);
      for (double wanted = dimmest; wanted <= brightest; wanted += 7.0) {
        EXPECT_NEAR(corrected_intensity(laser, raw_intensity(laser, wanted, counts), counts),
                    wanted, 0.5 + 1e-9);
      }
    }
  }
}

TEST(Hdl64eCalibration, NominalUnitHasTheModelsLasers) {
  const Model& model = *find_model("HDL-64E S2");
  const Hdl64eCalibration calibration = nominal_calibration(model);
  EXPECT_NO_THROW(validate(calibration));
  const std::vector<Laser> lasers = calibrated_lasers(model, calibration);
  for (std::size_t i = 0; i < kHdl64eLasers; ++i) {
    EXPECT_DOUBLE_EQ(lasers[i].elevation_deg, model.lasers[i].elevation_deg);
    EXPECT_DOUBLE_EQ(lasers[i].azimuth_offset_deg, model.lasers[i].azimuth_offset_deg);
    EXPECT_NEAR(lasers[i].vertical_offset_mm, model.lasers[i].vertical_offset_mm, 1e-9);
    EXPECT_NEAR(lasers[i].horizontal_offset_mm, model.lasers[i].horizontal_offset_mm, 1e-9);
    EXPECT_EQ(lasers[i].time_offset_ns, model.lasers[i].time_offset_ns);
  }
}

std::string refusal(const Hdl64eCalibration& calibration) {
  try {
    validate(calibration);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Hdl64eCalibration, RefusesWhatNoUnitHas) {
  Hdl64eCalibration calibration = unit();
  calibration.lasers.resize(31);
  EXPECT_THAT(refusal(calibration), HasSubstr("31 lasers, allowed: 64"));
  calibration = unit();
  calibration.lasers[7].dist_correction_m = 140.0;
  EXPECT_THAT(refusal(calibration), HasSubstr("laser 7: dist_correction is 140"));
  calibration = unit();
  calibration.lasers[63].vert_correction_deg = std::nan("");
  EXPECT_THAT(refusal(calibration), HasSubstr("laser 63: vert_correction is"));
  calibration = unit();
  calibration.lasers[0].min_intensity = 9;
  calibration.lasers[0].max_intensity = 8;
  EXPECT_THAT(refusal(calibration), HasSubstr("min_intensity is 9"));
}

}  // namespace
}  // namespace rigwire::protocols::velodyne
