// A synthetic street canyon against what was measured in a real one: UrbanNav, Tsim Sha Tsui,
// 2019-04-28, GPS L1 single point positions of a u-blox M8T by RTKLIB: 5.8 of 9.0 satellites
// tracked, count changes 0.35 per second, horizontal error of 4 .. 10 m (median) and 20 .. 50 m
// (95 %) by number of satellites, correlated over about 10 s while driving with stops.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "fake_sky.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

constexpr double kWidth_m = 24.0;
constexpr double kHeight_m = 22.0;
constexpr double kSpeed_mps = 7.0;
constexpr int kDrive_s = 12;  // then as long at a light
constexpr int kEpochs = 485;
constexpr double kLongest_m = kSpeed_mps * kEpochs + 60.0;

/// Blocks of 20 .. 60 m along both sides of the x axis, some with alleys between them.
void build_street(Scene& scene, const Eigen::Isometry3d& X_WS, RandomStream& random) {
  constexpr double kDepth_m = 12.0;
  for (const double side : {-1.0, 1.0}) {
    for (double x = -30.0; x < kLongest_m;) {
      const double length = random.uniform(20.0, 60.0);
      const double height = kHeight_m * random.uniform(0.5, 1.5);
      const double alley = random.uniform() < 0.5 ? random.uniform(3.0, 15.0) : 0.0;
      Eigen::Isometry3d X_SB = Eigen::Isometry3d::Identity();
      X_SB.translation() << x + 0.5 * length, side * 0.5 * (kWidth_m + kDepth_m), 0.5 * height;
      scene.add_object(scene.add_mesh(make_box("block", {length, kDepth_m, height})), X_WS * X_SB,
                       1.0, {.reflectance = 0.5, .label = "building"});
      x += length + alley;
    }
  }
}

struct Statistics {
  double tracked_of_above = 0.0;
  double changes_per_s = 0.0;
  double fixes = 0.0;
  std::vector<double> horizontal_m;
  std::vector<std::vector<Eigen::Vector2d>> errors_m;  ///< Per drive.
  /// Sums over the satellites tracked, by 15 degrees of elevation.
  std::array<double, 6> strength_dbhz{};
  std::array<double, 6> strengths{};
};

void drive(std::uint64_t seed, Statistics& statistics) {
  Eigen::Isometry3d X_WS = Eigen::Isometry3d::Identity();
  X_WS.linear() =
      Eigen::AngleAxisd(1.0 + static_cast<double>(seed), Eigen::Vector3d::UnitZ()).matrix();
  Scene scene;
  RandomStream random(seed, "street");
  build_street(scene, X_WS, random);
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  const LocalFrame frame({49.42, 7.75, 280.0, 48.0});
  GnssParameters parameters;
  parameters.error_model = ErrorModel::coloured;
  put_car_antenna(parameters.sky);
  GnssSensor gnss(parameters, calendar, frame, seed, "gnss");
  double way_m = 0.0;
  int before = -1;
  auto& errors = statistics.errors_m.emplace_back();
  for (int t = 0; t < kEpochs; ++t) {
    const double speed_mps = t % (2 * kDrive_s) < kDrive_s ? 0.0 : kSpeed_mps;
    way_m += speed_mps;
    LinkMotion antenna;
    antenna.X_WL.translation() = X_WS * Eigen::Vector3d(way_m, -2.0, 2.0);
    antenna.v_WL_W = X_WS.linear() * Eigen::Vector3d(speed_mps, 0.0, 0.0);
    const SimTime now = kStart + static_cast<int>(seed) * 1h + t * 1s;
    scene.begin_slice(now, now + 1ms, antenna.X_WL.translation(), {});
    const GnssSample sample = gnss.sample(now, antenna, scene);
    int above = 0;
    int tracked = 0;
    for (const SatelliteView& satellite : sample.satellites) {
      const bool high = satellite.elevation_rad > 5.0 * std::numbers::pi / 180.0;
      above += high ? 1 : 0;
      tracked += high && satellite.tracked ? 1 : 0;
      if (satellite.tracked) {
        constexpr double kBand_rad = 15.0 * std::numbers::pi / 180.0;
        const auto band = static_cast<std::size_t>(satellite.elevation_rad / kBand_rad);
        statistics.strength_dbhz[band] += satellite.cn0_dbhz;
        statistics.strengths[band] += 1.0;
      }
    }
    statistics.tracked_of_above += static_cast<double>(tracked) / above;
    statistics.changes_per_s += before < 0 ? 0.0 : std::abs(tracked - before);
    before = tracked;
    if (sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d) {
      const Eigen::Vector3d error =
          frame.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m}) -
          antenna.X_WL.translation();
      EXPECT_TRUE(error.allFinite());
      statistics.fixes += 1.0;
      statistics.horizontal_m.push_back(error.head<2>().norm());
      errors.emplace_back(error.head<2>());
    } else {
      errors.emplace_back(Eigen::Vector2d::Constant(std::nan("")));
    }
  }
}

/// Over drives and both axes; single wild epochs are held at 30 m.
double autocorrelation(const std::vector<std::vector<Eigen::Vector2d>>& drives, std::size_t lag) {
  double product = 0.0;
  double square = 0.0;
  for (const auto& errors : drives) {
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<double> known;
      for (const auto& error : errors) {
        if (error.allFinite()) {
          known.push_back(error(axis));
        }
      }
      std::ranges::sort(known);
      const double middle = known[known.size() / 2];
      const auto held = [&](std::size_t i) {
        return std::clamp(errors[i](axis) - middle, -30.0, 30.0);
      };
      for (std::size_t i = 0; i + lag < errors.size(); ++i) {
        if (errors[i].allFinite() && errors[i + lag].allFinite()) {
          product += held(i) * held(i + lag);
          square += held(i) * held(i);
        }
      }
    }
  }
  return product / square;
}

TEST(StreetCanyon, StatisticsAreThoseOfARealStreet) {
  Statistics statistics;
  constexpr int kDrives = 8;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    drive(seed, statistics);
  }
  constexpr double kAll = kDrives * kEpochs;
  EXPECT_GT(statistics.tracked_of_above / kAll, 0.4);
  EXPECT_LT(statistics.tracked_of_above / kAll, 0.7);
  EXPECT_GT(statistics.changes_per_s / kAll, 0.1);
  EXPECT_LT(statistics.changes_per_s / kAll, 0.4);
  EXPECT_GT(statistics.fixes / kAll, 0.9);
  auto& horizontal = statistics.horizontal_m;
  std::ranges::sort(horizontal);
  const double median_m = horizontal[horizontal.size() / 2];
  const double p95_m = horizontal[horizontal.size() * 95 / 100];
  EXPECT_GT(median_m, 4.0);
  EXPECT_LT(median_m, 10.0);
  EXPECT_GT(p95_m, 20.0);
  EXPECT_LT(p95_m, 50.0);
  // Correlated over 5 .. 15 s: 1/e is passed between.
  EXPECT_GT(autocorrelation(statistics.errors_m, 5), std::exp(-1.0));
  EXPECT_LT(autocorrelation(statistics.errors_m, 15), std::exp(-1.0));
  RecordProperty("tracked", std::to_string(statistics.tracked_of_above / kAll));
  RecordProperty("median_m", std::to_string(median_m));
  RecordProperty("p95_m", std::to_string(p95_m));
}

// Two NEO-7Ps on a drive through a town, GSV at 1 Hz, means at rest and in motion: 0 to 15 degrees
// 26.6 to 28.8 dBHz, then 34.8 to 38.1, 39.4 to 42.5, 43.2 to 45.9, 43.9 to 48.3. Walls and
// reflections make the low ones weak here, too.
TEST(StreetCanyon, MeanStrengthsByElevationAreThoseOfATown) {
  Statistics statistics;
  constexpr int kDrives = 8;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    drive(seed, statistics);
  }
  struct StreetCanyonBand {
    double least;
    double greatest;
  };
  constexpr std::array kBands{StreetCanyonBand{25.0, 31.0}, StreetCanyonBand{34.0, 38.5},
                              StreetCanyonBand{38.5, 43.0}, StreetCanyonBand{42.5, 46.5},
                              StreetCanyonBand{43.5, 48.5}};
  for (std::size_t i = 0; i < kBands.size(); ++i) {
    ASSERT_GT(statistics.strengths[i], 500.0);
    const double mean_dbhz = statistics.strength_dbhz[i] / statistics.strengths[i];
    EXPECT_GT(mean_dbhz, kBands[i].least) << 15 * i << " degrees";
    EXPECT_LT(mean_dbhz, kBands[i].greatest) << 15 * i << " degrees";
    RecordProperty("mean_dbhz_" + std::to_string(15 * i), std::to_string(mean_dbhz));
  }
}

}  // namespace
}  // namespace rigwire::sim
