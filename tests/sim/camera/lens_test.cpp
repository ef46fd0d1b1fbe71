#include "sim/camera/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

constexpr double kPitch_m = 5e-6;
constexpr int kWidth = 640;
constexpr int kHeight = 480;

LensParameters pinhole(double focal_px = 400.0) {
  LensParameters lens;
  lens.focal_length_m = focal_px * kPitch_m;
  return lens;
}

LensParameters barrel() {
  LensParameters lens = pinhole(380.0);
  lens.k1 = -0.28;
  lens.k2 = 0.09;
  lens.p1 = 0.0008;
  lens.p2 = -0.0005;
  lens.k3 = -0.012;
  lens.principal_offset_px = {7.25, -4.5};
  return lens;
}

LensParameters fisheye() {
  LensParameters lens;
  lens.model = LensModel::kannala_brandt;
  lens.focal_length_m = 150.0 * kPitch_m;
  lens.k1 = 0.02;
  lens.k2 = -0.006;
  lens.k3 = 0.0009;
  lens.k4 = -0.00005;
  lens.image_circle_rad = 100.0 * std::numbers::pi / 180.0;
  return lens;
}

/// Worst distance in pixels between a pixel and where its direction is seen.
double worst_round_trip(const Lens& lens) {
  double worst = 0.0;
  int seen = 0;
  for (double y = -0.5; y <= kHeight; y += 3.7) {
    for (double x = -0.5; x <= kWidth; x += 3.3) {
      const auto direction = lens.direction({x, y});
      if (!direction) {
        continue;
      }
      EXPECT_NEAR(direction->norm(), 1.0, 1e-14);
      // From any distance along the ray.
      const auto back = lens.project(*direction * (1.0 + x));
      if (!back) {
        ADD_FAILURE() << "nothing at " << x << ", " << y;
        return 1e9;
      }
      worst = std::max(worst, (*back - Eigen::Vector2d(x, y)).norm());
      ++seen;
    }
  }
  EXPECT_GT(seen, 1000);
  return worst;
}

template <class Make>
std::string refusal(const Make& make) {
  try {
    make();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Lens, DirectionsComeBackToTheirPixels) {
  EXPECT_LT(worst_round_trip(Lens(pinhole(), kPitch_m, kWidth, kHeight)), 1e-9);
  EXPECT_LT(worst_round_trip(Lens(barrel(), kPitch_m, kWidth, kHeight)), 1e-9);
  EXPECT_LT(worst_round_trip(Lens(fisheye(), kPitch_m, kWidth, kHeight)), 1e-9);
  LensParameters pincushion = pinhole(900.0);
  pincushion.k1 = 0.3;
  pincushion.k2 = 0.2;
  EXPECT_LT(worst_round_trip(Lens(pincushion, kPitch_m, kWidth, kHeight)), 1e-9);
}

TEST(Lens, BrownConradyPutsPointsWhereItsPolynomialDoes) {
  // By hand: x = 0.3, y = -0.2, r^2 = 0.13.
  const LensParameters p = barrel();
  const double s = 0.13;
  const double radial = 1.0 + p.k1 * s + p.k2 * s * s + p.k3 * s * s * s;
  const double x = 0.3 * radial + 2.0 * p.p1 * 0.3 * -0.2 + p.p2 * (s + 2.0 * 0.09);
  const double y = -0.2 * radial + p.p1 * (s + 2.0 * 0.04) + 2.0 * p.p2 * 0.3 * -0.2;
  const auto pixel = Lens(p, kPitch_m, kWidth, kHeight).project({0.6, -0.4, 2.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 319.5 + 7.25 + 380.0 * x, 1e-9);
  EXPECT_NEAR(pixel->y(), 239.5 - 4.5 + 380.0 * y, 1e-9);
}

TEST(Lens, KannalaBrandtSeesBehindItself) {
  LensParameters equidistant;
  equidistant.model = LensModel::kannala_brandt;
  equidistant.focal_length_m = 100.0 * kPitch_m;
  equidistant.image_circle_rad = 110.0 * std::numbers::pi / 180.0;
  const Lens lens(equidistant, kPitch_m, kWidth, kHeight);
  // 100 degrees to the right of the axis: the radius is f theta.
  const double theta = 100.0 * std::numbers::pi / 180.0;
  const auto pixel = lens.project({std::sin(theta), 0.0, std::cos(theta)});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 319.5 + 100.0 * theta, 1e-9);
  EXPECT_NEAR(pixel->y(), 239.5, 1e-9);
  const auto direction = lens.direction(*pixel);
  ASSERT_TRUE(direction);
  EXPECT_NEAR(direction->z(), std::cos(theta), 1e-12);
  // Beyond the image circle there is nothing, either way.
  EXPECT_FALSE(lens.project({std::sin(2.0), 0.0, std::cos(2.0)}));
  EXPECT_FALSE(lens.direction({0.0, 0.0}));
}

TEST(Lens, RefusesAModelThatFoldsOverInThePicture) {
  LensParameters folding = pinhole(300.0);
  folding.k1 = -0.6;
  const std::string text = refusal([&] { Lens(folding, kPitch_m, kWidth, kHeight); });
  EXPECT_NE(text.find("folds over"), std::string::npos) << text;
  EXPECT_NE(text.find("-0.6"), std::string::npos) << text;
  // With a longer lens the same numbers do not matter.
  folding.focal_length_m = 1200.0 * kPitch_m;
  EXPECT_NO_THROW(Lens(folding, kPitch_m, kWidth, kHeight));

  LensParameters fish = fisheye();
  fish.k1 = -0.3;
  EXPECT_NE(refusal([&] { Lens(fish, kPitch_m, kWidth, kHeight); }), "");
  fish = fisheye();
  fish.image_circle_rad = 0.0;
  fish.k1 = fish.k2 = fish.k3 = fish.k4 = 0.0;
  fish.focal_length_m = 100.0 * kPitch_m;  // corners at 229 degrees
  EXPECT_NE(refusal([&] { Lens(fish, kPitch_m, kWidth, kHeight); }), "");
}

TEST(Lens, BrownConradyStopsAt120Degrees) {
  const double f120 = 320.0 / std::tan(std::numbers::pi / 3.0);
  EXPECT_NO_THROW(Lens(pinhole(f120), kPitch_m, kWidth, kHeight));
  const std::string text = refusal([&] { Lens(pinhole(0.9 * f120), kPitch_m, kWidth, kHeight); });
  EXPECT_NE(text.find("kannala_brandt"), std::string::npos) << text;
}

TEST(Lens, EquirectangularPicturesAreAngles) {
  // A full turn, 60 degrees up and 30 down: the horizon is two thirds down.
  LensParameters p;
  p.model = LensModel::equirectangular;
  constexpr double kPerRad = 1440.0 / (2.0 * std::numbers::pi);
  p.focal_length_m = kPerRad * 4.8e-6;
  p.principal_offset_px = {0.0, 60.0};
  const Lens lens(p, 4.8e-6, 1440, 360);
  // Pixel (c, r): azimuth (c + 0.5) / 4 - 180 degrees to the right, elevation 60 - (r + 0.5) / 4.
  for (const auto& [column, row] : {std::pair{0, 0}, {719, 239}, {1080, 100}, {1439, 359}}) {
    const double right = ((column + 0.5) / 4.0 - 180.0) * std::numbers::pi / 180.0;
    const double up = (60.0 - (row + 0.5) / 4.0) * std::numbers::pi / 180.0;
    const Eigen::Vector3d expected(std::cos(up) * std::sin(right), -std::sin(up),
                                   std::cos(up) * std::cos(right));
    const auto direction = lens.direction(Eigen::Vector2d(column, row));
    ASSERT_TRUE(direction);
    EXPECT_LT((*direction - expected).norm(), 1e-12) << column;
    EXPECT_LT((*lens.project(*direction) - Eigen::Vector2d(column, row)).norm(), 1e-9);
    EXPECT_EQ(lens.falloff(*direction), 1.0);
  }
  EXPECT_THROW(Lens(p, 4.8e-6, 1448, 360), std::invalid_argument);  // more than once round
  p.principal_offset_px.y() = 190.0;                                // beyond the upper pole
  EXPECT_THROW(Lens(p, 4.8e-6, 1440, 360), std::invalid_argument);
  p.principal_offset_px.y() = -190.0;
  EXPECT_THROW(Lens(p, 4.8e-6, 1440, 360), std::invalid_argument);
  p.principal_offset_px.y() = 0.0;
  EXPECT_NO_THROW(Lens(p, 4.8e-6, 1440, 720));  // the whole sphere
}

TEST(Lens, RefusesWhatIsNoNumber) {
  LensParameters bad = pinhole();
  bad.k1 = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Lens(bad, kPitch_m, kWidth, kHeight), std::invalid_argument);
  EXPECT_THROW(Lens(pinhole(), std::numeric_limits<double>::quiet_NaN(), kWidth, kHeight),
               std::invalid_argument);
  EXPECT_THROW(Lens(pinhole(), kPitch_m, 0, kHeight), std::invalid_argument);
  const Lens lens(pinhole(), kPitch_m, kWidth, kHeight);
  EXPECT_FALSE(lens.direction({std::numeric_limits<double>::quiet_NaN(), 0.0}));
  EXPECT_FALSE(lens.project({0.0, std::numeric_limits<double>::infinity(), 1.0}));
  EXPECT_FALSE(lens.project({0.0, 0.0, 0.0}));
  EXPECT_FALSE(lens.project({0.1, 0.0, -1.0}));
}

TEST(Lens, LightFallsOffWithTheFourthPowerOfTheCosine) {
  LensParameters lens = pinhole();
  const double c = 0.8;
  const Eigen::Vector3d direction(0.6, 0.0, c);
  EXPECT_NEAR(Lens(lens, kPitch_m, kWidth, kHeight).falloff(direction), c * c * c * c, 1e-12);
  lens.vignetting = 0.0;
  EXPECT_EQ(Lens(lens, kPitch_m, kWidth, kHeight).falloff(direction), 1.0);
}

}  // namespace
}  // namespace rigwire::sim
