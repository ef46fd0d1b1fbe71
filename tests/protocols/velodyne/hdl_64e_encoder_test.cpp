#include "protocols/velodyne/hdl_64e_encoder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kRate_degps = 3600.0;

const Model& model() {
  return *find_model("HDL-64E S2");
}

Hdl64eCalibration unit() {
  Hdl64eCalibration calibration = nominal_calibration(model());
  for (std::size_t i = 0; i < calibration.lasers.size(); ++i) {
    Hdl64eLaser& laser = calibration.lasers[i];
    const double phase = 2.4 * static_cast<double>(i);
    laser.dist_correction_m += 0.15 * std::sin(phase + 1.0);
    laser.dist_correction_x_m = laser.dist_correction_m + 0.04 * std::sin(phase + 2.0);
    laser.dist_correction_y_m = laser.dist_correction_m + 0.05 * std::cos(phase + 3.0);
    laser.focal_distance_m = 12.0 + 10.0 * std::sin(phase);
  }
  return calibration;
}

/// Largest difference to what the client should see, of range and of intensity.
struct Worst {
  double range_m = 0.0;
  double intensity = 0.0;
};

Worst worst(NearCorrection near, double from_m, double to_m) {
  const Hdl64eCalibration calibration = unit();
  Hdl64eEncoder encoder(model(), calibration, near);
  encoder.set_rotor_rate(kRate_degps);
  Worst result;
  for (double azimuth = 0.3; azimuth < 360.0; azimuth += 13.7) {
    for (double range = from_m; range < to_m; range *= 1.043) {
      for (const std::size_t first : {0U, 32U}) {
        std::array<float, 32> ranges{};
        std::array<float, 32> intensities{};
        std::array<Channel, 32> channels{};
        ranges.fill(static_cast<float>(range));
        intensities.fill(190.0F);
        encoder.encode(first, azimuth, ranges, intensities, channels);
        for (std::size_t lane = 0; lane < 32; ++lane) {
          const std::size_t i = first + lane;
          const double at = azimuth + kRate_degps * 1e-9 * model().lasers[i].time_offset_ns;
          const Hdl64eLaser& laser = calibration.lasers[i];
          const double counts = channels[lane].distance_counts;
          result.range_m = std::max(result.range_m,
                                    std::abs(corrected(laser, counts, at, near).range_m - range));
          // The client adds so much to far returns that even a raw 0 may look brighter.
          const double wanted = std::max(190.0, corrected_intensity(laser, 0, counts));
          result.intensity = std::max(
              result.intensity,
              std::abs(corrected_intensity(laser, channels[lane].reflectivity, counts) - wanted));
        }
      }
    }
  }
  return result;
}

TEST(Hdl64eEncoder, ClientGetsTheTrueRangeToHalfACount) {
  const Worst everywhere = worst(NearCorrection::everywhere, 2.0, 120.0);
  EXPECT_LE(everywhere.range_m, 0.0011) << "half a count and a tenth of a millimetre";
  EXPECT_LE(everywhere.intensity, 0.52);
  EXPECT_LE(worst(NearCorrection::below_25_m, 2.0, 24.0).range_m, 0.0011);
  EXPECT_LE(worst(NearCorrection::below_25_m, 28.0, 120.0).range_m, 0.0011);
}

TEST(Hdl64eEncoder, WhatTheFieldCannotTellIsNoReturn) {
  const Hdl64eEncoder encoder(model(), unit());
  std::array<float, 32> ranges{};
  ranges[1] = 0.7F;
  ranges[2] = 500.0F;
  ranges[3] = std::nanf("");
  ranges[4] = 10.0F;
  std::array<float, 32> intensities{};
  intensities.fill(100.0F);
  std::array<Channel, 32> channels{};
  channels.fill({7, 7});
  encoder.encode(32, 10.0, ranges, intensities, channels);
  for (const std::size_t lane : {0U, 1U, 2U, 3U, 5U}) {
    EXPECT_EQ(channels[lane], Channel{}) << lane;
  }
  EXPECT_GT(channels[4].distance_counts, 4000);
}

TEST(Hdl64eEncoder, UnitWithoutNearCorrectionAddsTheFarOne) {
  Hdl64eCalibration calibration = unit();
  for (Hdl64eLaser& laser : calibration.lasers) {
    laser.dist_correction_m = 1.0;
    laser.dist_correction_x_m = 0.0;
    laser.dist_correction_y_m = 0.0;
  }
  const Hdl64eEncoder encoder(model(), calibration);
  std::array<float, 32> ranges{};
  ranges.fill(3.0F);
  std::array<Channel, 32> channels{};
  encoder.encode(0, 77.0, ranges, ranges, channels);
  for (const Channel& channel : channels) {
    EXPECT_EQ(channel.distance_counts, 1000);
  }
}

}  // namespace
}  // namespace rigwire::protocols::velodyne
