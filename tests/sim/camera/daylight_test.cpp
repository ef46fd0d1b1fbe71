#include "sim/camera/daylight.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace rigwire::sim {
namespace {

const Eigen::Vector3f kLuminance(0.2126F, 0.7152F, 0.0722F);

Eigen::Vector3d sun_at(double elevation_deg, double azimuth_deg = 140.0) {
  const double e = elevation_deg * kDegree;
  const double a = azimuth_deg * kDegree;
  return {std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e)};
}

/// What a surface receives from everything that luminance() has, by sums over the sphere.
Eigen::Vector3d summed_lx(const Daylight& light, const Eigen::Vector3d& normal) {
  constexpr int kRings = 400;
  constexpr int kSectors = 400;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int ring = 0; ring < kRings; ++ring) {
    const double z = -1.0 + 2.0 * (ring + 0.5) / kRings;
    const double across = std::sqrt(1.0 - z * z);
    for (int sector = 0; sector < kSectors; ++sector) {
      const double angle = 2.0 * std::numbers::pi * sector / kSectors;
      const Eigen::Vector3d d(across * std::cos(angle), across * std::sin(angle), z);
      sum += std::max(0.0, d.dot(normal)) * light.luminance(d.cast<float>()).cast<double>();
    }
  }
  return sum * 4.0 * std::numbers::pi / (kRings * kSectors);
}

// USNO Circular 171's own figures: 0 degrees 759 lx (its formula), 6 degrees below 3.4 lx, 12 below
// 0.008 lx, 18 below 6.5e-4 lx; overhead 129 klx.
TEST(Daylight, TotalOfClearSkiesFollowsTheNavalObservatory) {
  EXPECT_NEAR(clear_sky_illuminance_lx(90.0 * kDegree), 128.8e3, 200.0);
  EXPECT_NEAR(clear_sky_illuminance_lx(0.0), 758.6, 1.0);
  EXPECT_NEAR(clear_sky_illuminance_lx(-6.0 * kDegree), 3.4, 0.1);
  EXPECT_NEAR(clear_sky_illuminance_lx(-12.0 * kDegree), 0.0081, 0.0005);
  EXPECT_NEAR(clear_sky_illuminance_lx(-40.0 * kDegree), 6.5e-4, 0.3e-4);
  // Pieces meet.
  for (const double edge : {20.0, 5.0, -0.8, -5.0, -12.0}) {
    EXPECT_NEAR(clear_sky_illuminance_lx((edge + 1e-6) * kDegree) /
                    clear_sky_illuminance_lx((edge - 1e-6) * kDegree),
                1.0, 0.03);
  }
}

TEST(Daylight, SkyAndSunAddUpToTheTotal) {
  for (const double elevation : {70.0, 40.0, 10.0, 3.0}) {
    const Daylight light({}, sun_at(elevation));
    const double total = static_cast<double>(kLuminance.dot(light.total_lx()));
    EXPECT_NEAR(total / clear_sky_illuminance_lx(elevation * kDegree), 1.0, 0.06) << elevation;
    const double sky = static_cast<double>(kLuminance.dot(light.sky_lx()));
    EXPECT_NEAR(
        static_cast<double>(kLuminance.cast<double>().dot(summed_lx(light, {0.0, 0.0, 1.0}))) / sky,
        1.0, 0.02)
        << elevation;
  }
}

TEST(Daylight, HazeMovesLightFromTheSunToTheSky) {
  const auto sun_share = [](double turbidity) {
    const Daylight light({.turbidity = turbidity}, sun_at(60.0));
    return static_cast<double>(light.sun_lx().y() * light.to_sun_W().z() / light.total_lx().y());
  };
  // Diffuse shares of clear days are 10 to 15 %, of hazy ones 30 to 45 %.
  EXPECT_GT(sun_share(2.0), 0.82);
  EXPECT_LT(sun_share(6.0), 0.70);
  EXPECT_GT(sun_share(6.0), 0.45);
}

TEST(Daylight, TheSunReddensAndTheSkyIsBlue) {
  const Daylight low({}, sun_at(5.0));
  EXPECT_GT(low.sun_lx().x(), 2.0F * low.sun_lx().z());
  const Daylight high({}, sun_at(60.0));
  EXPECT_LT(high.sun_lx().x(), 1.3F * high.sun_lx().z());
  const Eigen::Vector3f zenith = high.luminance({0.0F, 0.0F, 1.0F});
  EXPECT_GT(zenith.z(), 1.3F * zenith.x());
  // Brightest around the sun.
  EXPECT_GT(high.luminance(sun_at(55.0).cast<float>()).y(), 2.0F * zenith.y());
}

TEST(Daylight, NoSkyIsPurple) {
  // Chromaticities by the inverse of IEC 61966-2-1: y no lower than the daylight locus.
  for (const double turbidity : {2.0, 3.0, 6.0}) {
    for (const double elevation : {8.0, 30.0, 60.0}) {
      const Daylight light({.turbidity = turbidity}, sun_at(elevation, 200.0));
      for (int azimuth = 0; azimuth < 360; azimuth += 15) {
        for (const double height : {3.0, 10.0, 40.0}) {
          const Eigen::Vector3f rgb = light.luminance(sun_at(height, azimuth).cast<float>());
          const float x = 0.4124F * rgb.x() + 0.3576F * rgb.y() + 0.1805F * rgb.z();
          const float y = 0.2126F * rgb.x() + 0.7152F * rgb.y() + 0.0722F * rgb.z();
          const float z = 0.0193F * rgb.x() + 0.1192F * rgb.y() + 0.9505F * rgb.z();
          const float chroma_x = x / (x + y + z);
          const float locus = -0.275F + chroma_x * (2.870F - 3.0F * chroma_x);
          EXPECT_GT(y / (x + y + z), locus - 2e-3F)
              << turbidity << ", " << elevation << ", " << azimuth << ", " << height;
        }
      }
    }
  }
}

TEST(Daylight, OvercastSkyIsThreeTimesAsBrightAtTheZenith) {
  const Daylight light({.cloud_cover = 1.0}, sun_at(40.0));
  EXPECT_FALSE(light.sun_shines());
  const float zenith = light.luminance({0.0F, 0.0F, 1.0F}).y();
  const float low = light.luminance({1.0F, 0.0F, 0.0F}).y();
  EXPECT_NEAR(zenith / low, 3.0F, 0.02F);
  // Kasten and Czeplak: a quarter of the clear day's light is left.
  EXPECT_NEAR(static_cast<double>(kLuminance.dot(light.total_lx())),
              0.25 * clear_sky_illuminance_lx(40.0 * kDegree),
              0.02 * clear_sky_illuminance_lx(40.0 * kDegree));
}

TEST(Daylight, NineHarmonicsAgreeWithTheSum) {
  for (const double elevation : {60.0, 15.0}) {
    const Daylight light({}, sun_at(elevation));
    const double total = static_cast<double>(light.sky_lx().y());
    for (const Eigen::Vector3d& normal :
         {Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Vector3d(0.0, 0.0, -1.0),
          Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(-0.6, 0.0, 0.8),
          Eigen::Vector3d(0.0, 1.0, 0.0), Eigen::Vector3d(0.48, -0.64, 0.6)}) {
      const double by_terms = static_cast<double>(light.diffuse_lx(normal.cast<float>()).y());
      EXPECT_NEAR(by_terms, summed_lx(light, normal).y(), 0.05 * total) << normal.transpose();
    }
  }
}

TEST(Daylight, NightComesGently) {
  double before = static_cast<double>(Daylight({}, sun_at(4.25)).total_lx().y());
  for (double elevation = 4.0; elevation >= -20.0; elevation -= 0.25) {
    const Daylight light({}, sun_at(elevation));
    const auto now = static_cast<double>(light.total_lx().y());
    EXPECT_GT(now, 0.0);
    EXPECT_LT(now, 1.001 * before) << elevation;
    EXPECT_GT(now, 0.5 * before) << elevation;
    before = now;
    if (elevation < 0.0) {
      EXPECT_FALSE(light.sun_shines());
    }
  }
}

TEST(Daylight, RefusesWhatIsNoDirection) {
  EXPECT_THROW(Daylight({}, Eigen::Vector3d(0.0, 0.0, 2.0)), std::invalid_argument);
  EXPECT_THROW(Daylight({}, Eigen::Vector3d(0.0, 0.0, std::numeric_limits<double>::quiet_NaN())),
               std::invalid_argument);
  EXPECT_THROW(Daylight({.turbidity = 1.0}, Eigen::Vector3d::UnitZ()), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
