#include "sim/gnss/error_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fake_sky.h"
#include "sim/gnss/gnss_sensor.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;

constexpr double kEarth_m = 6'371e3;
const Vector3d kPlace_E_m(kEarth_m, 0.0, 0.0);
const Vector3d kUp_E(1.0, 0.0, 0.0);

Vector3d north_of(const Vector3d& p_E_m, double distance_m) {
  return (p_E_m + Vector3d(0.0, 0.0, distance_m)).normalized() * kEarth_m;
}

constexpr std::array<Satellite, 3> kSatellites{
    {{GnssSystem::gps, 1}, {GnssSystem::gps, 2}, {GnssSystem::galileo, 7}}};

/// Over many rigs: mean of a product.
template <class Product>
double expected(Product product) {
  double sum = 0.0;
  constexpr int kRigs = 3000;
  for (std::uint64_t seed = 1; seed <= kRigs; ++seed) {
    sum += product(ErrorField(kSatellites, seed));
  }
  return sum / kRigs;
}

TEST(ErrorField, EveryPartHasVarianceOne) {
  EXPECT_NEAR(expected([](const ErrorField& f) {
                return std::pow(f.satellite(1, 100.0, 7200.0, kUp_E), 2);
              }),
              1.0, 0.08);
  EXPECT_NEAR(expected([](const ErrorField& f) {
                return std::pow(f.ionosphere(100.0, 2400.0, 1e6, kPlace_E_m, kUp_E), 2);
              }),
              1.0, 0.08);
  EXPECT_NEAR(expected([](const ErrorField& f) {
                return std::pow(f.troposphere(100.0, 1800.0, kPlace_E_m), 2);
              }),
              1.0, 0.08);
}

TEST(ErrorField, ItForgetsInTimeByTheTimeConstant) {
  for (const double lag : {0.25, 1.0, 3.0}) {
    EXPECT_NEAR(expected([&](const ErrorField& f) {
                  return f.ionosphere(0.0, 2400.0, 1e6, kPlace_E_m, kUp_E) *
                         f.ionosphere(lag * 2400.0, 2400.0, 1e6, kPlace_E_m, kUp_E);
                }),
                std::exp(-lag), 0.09)
        << lag;
  }
}

// Differences between receivers: what a baseline sees (1.5 m and 1.5 mm/km of ionosphere, 50 mm and
// 500 km of troposphere, 0.8 m of orbit and clock).
TEST(ErrorField, ItDecorrelatesWithDistanceAsSatellitesAndAirDo) {
  for (const double km : {1.0, 10.0, 50.0}) {
    const Vector3d there = north_of(kPlace_E_m, km * 1e3);
    const double ionosphere_m =
        1.5 * std::sqrt(expected([&](const ErrorField& f) {
          return std::pow(f.ionosphere(0.0, 2400.0, 1e6, there, kUp_E) -
                              f.ionosphere(0.0, 2400.0, 1e6, kPlace_E_m, kUp_E),
                          2);
        }));
    EXPECT_NEAR(ionosphere_m, 1.5e-3 * km, 0.2 * 1.5e-3 * km) << km;
    const double troposphere_m =
        0.05 * std::sqrt(expected([&](const ErrorField& f) {
          return std::pow(
              f.troposphere(0.0, 1800.0, there) - f.troposphere(0.0, 1800.0, kPlace_E_m), 2);
        }));
    // sigma sqrt(2 (1 - exp(-d / L))), below it near by: waves shorter than 5 km are held there.
    const double whole_m = 0.05 * std::sqrt(2.0 * (1.0 - std::exp(-km / 500.0)));
    EXPECT_LT(troposphere_m, 1.2 * whole_m) << km;
    EXPECT_GT(troposphere_m, 0.2 * whole_m) << km;
    // From there the satellite's direction is turned by d / 20 000 km.
    const Vector3d turned = (kUp_E + Vector3d(0.0, 0.0, km / 20'000.0)).normalized();
    const double orbit_m =
        0.8 * std::sqrt(expected([&](const ErrorField& f) {
          return std::pow(f.satellite(0, 0.0, 7200.0, turned) - f.satellite(0, 0.0, 7200.0, kUp_E),
                          2);
        }));
    EXPECT_LT(orbit_m, 0.8 * km / 20'000.0);
    EXPECT_GT(orbit_m, 0.3 * km / 20'000.0);
  }
}

TEST(ErrorField, OneSatelliteMoreChangesNoOther) {
  const ErrorField all(kSatellites, 5);
  const ErrorField one{std::span(kSatellites).last(1), 5};
  EXPECT_EQ(all.satellite(2, 30.0, 7200.0, kUp_E), one.satellite(0, 30.0, 7200.0, kUp_E));
  EXPECT_NE(all.satellite(0, 30.0, 7200.0, kUp_E), all.satellite(1, 30.0, 7200.0, kUp_E));
  EXPECT_EQ(all.troposphere(30.0, 1800.0, kPlace_E_m), one.troposphere(30.0, 1800.0, kPlace_E_m));
}

TEST(ErrorField, WithoutTimeOrLengthItIsStillANumber) {
  const ErrorField field(kSatellites, 1);
  EXPECT_TRUE(std::isfinite(field.satellite(0, 1e6, 0.0, kUp_E)));
  EXPECT_TRUE(std::isfinite(field.ionosphere(1e6, 0.0, 0.0, kPlace_E_m, kUp_E)));
}

// Both receivers have the same sky: their errors are alike but for noise and reflections.
TEST(ErrorField, TwoReceiversOfARigHaveTheErrorsOfTheirSatellitesInCommon) {
  GnssParameters parameters;
  parameters.raw_measurements = true;
  parameters.ranges.code_noise_m = 0.0;
  parameters.ranges.multipath_sigma_m = 0.0;
  parameters.ranges.rate_noise_mps = 0.0;
  parameters.ranges.rate_multipath_mps = 0.0;
  const Calendar calendar{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  const LocalFrame frame({49.42, 7.75, 280.0, 48.0});
  const FakeSky open = open_sky();
  const auto error = [&](std::uint64_t seed, const char* name, double east_m) {
    GnssSensor gnss(parameters, calendar, frame, seed, name);
    LinkMotion antenna;
    antenna.X_WL.translation().x() = east_m;
    GnssSample sample;
    for (int i = 0; i < 20; ++i) {
      sample = gnss.sample(kStart + i * 1s, antenna, open);
    }
    return Vector3d(
        frame.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m}) -
        antenna.X_WL.translation());
  };
  const Vector3d here = error(1, "left", 0.0);
  EXPECT_GT(here.norm(), 0.3);
  EXPECT_LT((error(1, "right", 4.0) - here).norm(), 0.15) << "weights differ a little";
  EXPECT_GT((error(2, "left", 0.0) - here).norm(), 0.3) << "another rig";
}

}  // namespace
}  // namespace rigwire::sim
