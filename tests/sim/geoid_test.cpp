#include "sim/geoid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>

#include "sim/local_frame.h"

namespace rigwire::sim {

/// For test names.
inline void PrintTo(GeoidInterpolation interpolation, std::ostream* out) {
  *out << (interpolation == GeoidInterpolation::bilinear ? "bilinear" : "bicubic");
}

namespace {

using ::testing::HasSubstr;

constexpr double kDegree = 0.017453292519943295;

/// A smooth field on the sphere, single-valued at the poles.
double smooth_m(double latitude_deg, double longitude_deg) {
  const double z = std::sin(latitude_deg * kDegree);
  const double x = std::cos(latitude_deg * kDegree) * std::cos(longitude_deg * kDegree);
  const double y = std::cos(latitude_deg * kDegree) * std::sin(longitude_deg * kDegree);
  return 10.0 + 30.0 * x - 20.0 * y + 15.0 * z + 8.0 * x * y;
}

GeoidGrid smooth_grid(const GeoidGridLayout& layout, GeoidInterpolation interpolation) {
  std::vector<float> heights;
  for (std::size_t row = 0; row < layout.rows; ++row) {
    for (std::size_t column = 0; column < layout.columns; ++column) {
      heights.push_back(static_cast<float>(
          smooth_m(layout.south_deg + static_cast<double>(row) * layout.latitude_step_deg,
                   layout.west_deg + static_cast<double>(column) * layout.longitude_step_deg)));
    }
  }
  return {layout, std::move(heights), interpolation};
}

const GeoidGridLayout kWorld{-90.0, -180.0, 2.0, 2.0, 91, 180};
constexpr double kFloat_m = 4e-6;

class GeoidGridOfTheWorld : public ::testing::TestWithParam<GeoidInterpolation> {
 protected:
  GeoidGrid grid = smooth_grid(kWorld, GetParam());
};

TEST_P(GeoidGridOfTheWorld, IsExactOnItsPoints) {
  for (double latitude = -90.0; latitude <= 90.0; latitude += 10.0) {
    for (double longitude = -180.0; longitude <= 180.0; longitude += 10.0) {
      EXPECT_NEAR(grid.separation_m(latitude, longitude), smooth_m(latitude, longitude), kFloat_m);
    }
  }
}

TEST_P(GeoidGridOfTheWorld, PoleHasOneHeightWhateverTheMeridian) {
  for (const double pole : {-90.0, 90.0}) {
    for (double longitude = -180.0; longitude < 360.0; longitude += 7.3) {
      EXPECT_NEAR(grid.separation_m(pole, longitude), smooth_m(pole, 0.0), kFloat_m);
    }
  }
}

TEST_P(GeoidGridOfTheWorld, ContinuesAcrossThePoleAlongTheOppositeMeridian) {
  // Half a millimetre of latitude on both sides: 1e-8 deg.
  for (const double pole : {-90.0, 90.0}) {
    const double near_pole = pole * (1.0 - 1e-10);
    for (double longitude = -180.0; longitude < 180.0; longitude += 11.0) {
      EXPECT_NEAR(grid.separation_m(near_pole, longitude),
                  grid.separation_m(near_pole, longitude + 180.0), kFloat_m);
    }
  }
}

TEST_P(GeoidGridOfTheWorld, LongitudeTurnsWithoutASeam) {
  for (double latitude = -88.7; latitude < 90.0; latitude += 13.1) {
    for (double longitude = 0.0; longitude < 360.0; longitude += 17.7) {
      const double height = grid.separation_m(latitude, longitude);
      EXPECT_NEAR(grid.separation_m(latitude, longitude - 360.0), height, 1e-9);
      EXPECT_NEAR(grid.separation_m(latitude, longitude + 360.0), height, 1e-9);
    }
    EXPECT_DOUBLE_EQ(grid.separation_m(latitude, -180.0), grid.separation_m(latitude, 180.0));
    EXPECT_NEAR(grid.separation_m(latitude, std::nextafter(180.0, 0.0)),
                grid.separation_m(latitude, -180.0), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, GeoidGridOfTheWorld,
                         ::testing::Values(GeoidInterpolation::bilinear,
                                           GeoidInterpolation::bicubic),
                         ::testing::PrintToStringParamName());

double worst_error_m(GeoidInterpolation interpolation) {
  const GeoidGrid grid = smooth_grid(kWorld, interpolation);
  double worst = 0.0;
  for (double latitude = -89.9; latitude < 90.0; latitude += 0.7) {
    for (double longitude = -180.0; longitude < 180.0; longitude += 1.3) {
      worst = std::max(
          worst, std::abs(grid.separation_m(latitude, longitude) - smooth_m(latitude, longitude)));
    }
  }
  return worst;
}

TEST(GeoidGrid, BilinearErrsByTheSecondDerivativeAndBicubicByTheThird) {
  // One axis: h^2/8 of the second derivative, at most 55 m; two axes.
  EXPECT_LT(worst_error_m(GeoidInterpolation::bilinear), 0.0168);
  EXPECT_LT(worst_error_m(GeoidInterpolation::bicubic), 5e-4);
}

TEST(GeoidGrid, EdgeCountsOutsideARegion) {
  const GeoidGridLayout region{40.0, 5.0, 1.0, 1.0, 2, 2};
  const GeoidGrid grid(region, {1.0F, 2.0F, 3.0F, 4.0F});
  EXPECT_DOUBLE_EQ(grid.separation_m(40.5, 5.5), 2.5);
  EXPECT_DOUBLE_EQ(grid.separation_m(50.0, 5.5), 3.5);
  EXPECT_DOUBLE_EQ(grid.separation_m(40.0, 7.0), 2.0);
  EXPECT_DOUBLE_EQ(grid.separation_m(40.0, 4.0), 1.0);
  EXPECT_TRUE(grid.covers(41.0, 6.0));
  EXPECT_TRUE(grid.covers(40.0, 365.0));
  EXPECT_FALSE(grid.covers(41.1, 5.5));
  EXPECT_FALSE(grid.covers(40.5, 6.5));
}

TEST(GeoidGrid, GivesNoNumberForNone) {
  const GeoidGrid grid(GeoidGridLayout{40.0, 5.0, 1.0, 1.0, 2, 2}, {1.0F, 2.0F, 3.0F, 4.0F});
  EXPECT_TRUE(std::isnan(grid.separation_m(std::numeric_limits<double>::quiet_NaN(), 5.0)));
  EXPECT_TRUE(std::isnan(grid.separation_m(40.0, std::numeric_limits<double>::infinity())));
}

std::string refusal(const GeoidGridLayout& layout, std::vector<float> heights_m) {
  try {
    const GeoidGrid grid(layout, std::move(heights_m));
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(GeoidGrid, RefusesWhatIsNoGrid) {
  const GeoidGridLayout good{40.0, 5.0, 1.0, 1.0, 2, 2};
  EXPECT_EQ(refusal(good, {1.0F, 2.0F, 3.0F, 4.0F}), "");
  EXPECT_THAT(refusal(good, {1.0F, 2.0F, 3.0F}), HasSubstr("3 heights, needed are 2 rows of 2"));
  EXPECT_THAT(refusal(good, {1.0F, 2.0F, 3.0F, 999.0F}), HasSubstr("row 1, column 1"));
  EXPECT_THAT(refusal(good, {1.0F, 2.0F, 3.0F, std::nanf("")}), HasSubstr("height in row 1"));
  GeoidGridLayout bad = good;
  bad.rows = 1;
  EXPECT_THAT(refusal(bad, {}), HasSubstr("rows is 1"));
  bad = good;
  bad.latitude_step_deg = 0.0;
  EXPECT_THAT(refusal(bad, {}), HasSubstr("latitude step, deg is 0"));
  bad = good;
  bad.south_deg = 89.5;
  EXPECT_THAT(refusal(bad, {}), HasSubstr("northern edge, deg is 90.5"));
  bad = good;
  bad.columns = 400;
  EXPECT_THAT(refusal(bad, {}), HasSubstr("width, deg is 399"));
  bad = good;
  bad.west_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(bad, {}), HasSubstr("western edge"));
}

TEST(LocalFrameWithAGeoid, LooksTheSeparationUpAtEachPoint) {
  const auto grid =
      std::make_shared<const GeoidGrid>(smooth_grid(kWorld, GeoidInterpolation::bicubic));
  const LocalFrame frame({49.0, 7.0, 200.0, 0.0}, grid);
  EXPECT_NEAR(frame.geoid_separation_m(), smooth_m(49.0, 7.0), 5e-4);
  EXPECT_NEAR(frame.geoid_separation_m(50.5, 8.5), smooth_m(50.5, 8.5), 5e-4);
}

TEST(LocalFrameWithAGeoid, RefusesAGridOfAnotherRegion) {
  const auto grid = std::make_shared<const GeoidGrid>(GeoidGridLayout{40.0, 5.0, 1.0, 1.0, 2, 2},
                                                      std::vector<float>(4, 1.0F));
  EXPECT_THROW(LocalFrame({49.0, 7.0, 200.0, 0.0}, grid), std::invalid_argument);
}

TEST(LocalFrameWithoutAGeoid, HasOneSeparationEverywhere) {
  const LocalFrame frame({49.0, 7.0, 200.0, 48.0});
  EXPECT_EQ(frame.geoid_separation_m(), 48.0);
  EXPECT_EQ(frame.geoid_separation_m(-12.0, 100.0), 48.0);
}

}  // namespace
}  // namespace rigwire::sim
