#include "sim/gnss/gnss_sensor.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

class Sky final : public Visibility {
 public:
  explicit Sky(std::function<bool(const Eigen::Vector3d&)> hides) : hides_(std::move(hides)) {}
  bool blocked(const Eigen::Vector3d&, const Eigen::Vector3d& direction_W, double) const override {
    return hides_(direction_W);
  }

 private:
  std::function<bool(const Eigen::Vector3d&)> hides_;
};

const Sky kOpenSky([](const Eigen::Vector3d&) { return false; });
const Sky kIndoors([](const Eigen::Vector3d&) { return true; });

class GnssSensorTest : public testing::Test {
 protected:
  GnssSensor sensor(const GnssParameters& parameters, double latitude_deg = 49.42) const {
    return {parameters, calendar_, LocalFrame({latitude_deg, 7.75, 280.0, 48.0}), 1, "gnss"};
  }
  static GnssParameters paper() {
    GnssParameters parameters;
    parameters.error_model = ErrorModel::paper;
    return parameters;
  }
  static int used(const GnssSample& sample) {
    return static_cast<int>(std::ranges::count(sample.satellites, true, &SatelliteView::used));
  }
  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  LinkMotion antenna_;
};

TEST_F(GnssSensorTest, FixFollowsTheCount) {
  EXPECT_EQ(fix_by_count(0), GnssFix::none);
  EXPECT_EQ(fix_by_count(1), GnssFix::none);
  EXPECT_EQ(fix_by_count(2), GnssFix::bad);
  EXPECT_EQ(fix_by_count(3), GnssFix::two_d);
  EXPECT_EQ(fix_by_count(4), GnssFix::three_d);
}

TEST_F(GnssSensorTest, OpenSkyAtKaiserslauternShowsTheNominalCounts) {
  // 24 h of the nominal slots: 6 .. 10, mean 7.7 above 5 degrees; dilutions' medians 1.02, 1.47.
  GnssParameters parameters = paper();
  parameters.dilution = DilutionKind::geometric;
  GnssSensor gnss = sensor(parameters);
  std::vector<double> horizontal;
  std::vector<double> vertical;
  int least = 99;
  int most = 0;
  double sum = 0.0;
  constexpr int kSamples = 24 * 12;
  for (int i = 0; i < kSamples; ++i) {
    const GnssSample sample = gnss.sample(kStart + i * 5min, antenna_, kOpenSky);
    const int n = used(sample);
    least = std::min(least, n);
    most = std::max(most, n);
    sum += n;
    horizontal.push_back(sample.horizontal_dilution);
    vertical.push_back(sample.vertical_dilution);
  }
  std::ranges::sort(horizontal);
  std::ranges::sort(vertical);
  EXPECT_EQ(least, 6);
  EXPECT_EQ(most, 10);
  EXPECT_NEAR(sum / kSamples, 7.7, 0.1);
  EXPECT_NEAR(horizontal[kSamples / 2], 1.02, 0.03);
  EXPECT_NEAR(vertical[kSamples / 2], 1.47, 0.05);
}

TEST_F(GnssSensorTest, QuadrantRuleCostsAThirdOfTheDay) {
  calendar_ = Calendar(UtcTime{1993, 7, 1, 0, 0, 0, 0});  // the day of the nominal slots
  const auto share_2d = [&](QuadrantRule rule) {
    GnssParameters parameters = paper();
    parameters.error_model = ErrorModel::paper;
    parameters.quadrant_rule = rule;
    GnssSensor gnss = sensor(parameters);
    int flat = 0;
    constexpr int kSamples = 24 * 30;
    for (int i = 0; i < kSamples; ++i) {
      const GnssSample sample = gnss.sample(kStart + i * 2min, antenna_, kOpenSky);
      if (sample.fix == GnssFix::two_d) {
        ++flat;
        EXPECT_EQ(sample.position_dilution, 0.0);
      }
    }
    return double(flat) / kSamples;
  };
  EXPECT_EQ(share_2d(QuadrantRule::off), 0.0);
  EXPECT_NEAR(share_2d(QuadrantRule::cardinal), 0.35, 0.03);
  EXPECT_NEAR(share_2d(QuadrantRule::diagonal), 0.016, 0.01);
}

TEST_F(GnssSensorTest, NothingIsSeenIndoors) {
  GnssSensor gnss = sensor(paper());
  const GnssSample sample = gnss.sample(kStart, antenna_, kIndoors);
  EXPECT_EQ(sample.fix, GnssFix::none);
  EXPECT_TRUE(std::isnan(sample.horizontal_dilution));
  EXPECT_FALSE(sample.satellites.empty());  // above the horizon, but not tracked
  EXPECT_TRUE(std::ranges::none_of(sample.satellites, &SatelliteView::tracked));
}

TEST_F(GnssSensorTest, OneToFourHolesInTheRoof) {
  GnssSensor probe = sensor(paper());
  const GnssSample open = probe.sample(kStart, antenna_, kOpenSky);
  for (std::size_t holes = 1; holes <= 4; ++holes) {
    std::vector<Eigen::Vector3d> free;
    for (const auto& satellite : open.satellites) {
      if (satellite.used && free.size() < holes) {
        const double c = std::cos(satellite.elevation_rad);
        free.emplace_back(c * std::sin(satellite.azimuth_rad), c * std::cos(satellite.azimuth_rad),
                          std::sin(satellite.elevation_rad));
      }
    }
    const Sky roof([&](const Eigen::Vector3d& direction) {
      return std::ranges::none_of(free, [&](const auto& f) { return f.dot(direction) > 0.9999; });
    });
    GnssSensor gnss = sensor(paper());
    const GnssSample sample = gnss.sample(kStart, antenna_, roof);
    EXPECT_EQ(sample.fix, fix_by_count(static_cast<int>(holes))) << holes;
    EXPECT_EQ(used(sample), holes < 3 ? 0 : static_cast<int>(holes));
    if (holes < 3) {
      EXPECT_TRUE(std::isnan(sample.position_dilution));
    } else if (holes == 3) {
      EXPECT_EQ(sample.position_dilution, 0.0);
      EXPECT_EQ(sample.horizontal_dilution, 3.49);
    } else {
      EXPECT_EQ(sample.position_dilution, 2.31);
    }
  }
}

TEST_F(GnssSensorTest, ErrorHasTheSizeThatItDeclares) {
  GnssParameters parameters = paper();
  parameters.correlation_time_s = 0.0;
  GnssSensor gnss = sensor(parameters);
  const LocalFrame frame({49.42, 7.75, 280.0, 48.0});
  double horizontal = 0.0;
  double vertical = 0.0;
  constexpr int kSamples = 20'000;
  for (int i = 0; i < kSamples; ++i) {
    const GnssSample sample = gnss.sample(kStart + i * 10ms, antenna_, kOpenSky);
    const Eigen::Vector3d error =
        frame.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m});
    horizontal += error.head<2>().squaredNorm() / std::pow(sample.horizontal_accuracy_m, 2);
    vertical += error.z() * error.z() / std::pow(sample.vertical_accuracy_m, 2);
  }
  EXPECT_NEAR(horizontal / kSamples, 1.0, 0.03);
  EXPECT_NEAR(vertical / kSamples, 1.0, 0.05);
}

TEST_F(GnssSensorTest, ConsecutiveErrorsDoNotJump) {
  GnssSensor gnss = sensor(paper());
  const LocalFrame frame({49.42, 7.75, 280.0, 48.0});
  const auto position = [&](SimTime time) {
    const GnssSample s = gnss.sample(time, antenna_, kOpenSky);
    return frame.to_world({s.latitude_deg, s.longitude_deg, s.ellipsoid_height_m});
  };
  double square = 0.0;
  Eigen::Vector3d last = position(kStart);
  for (int i = 1; i <= 300; ++i) {
    const Eigen::Vector3d next = position(kStart + i * 100ms);
    square += (next - last).head<2>().squaredNorm();
    last = next;
  }
  // sigma sqrt(2 (1 - exp(-0.1 / 60))) with sigma near 3.4 m: 0.2 m, not 4.8 m.
  EXPECT_LT(std::sqrt(square / 300.0), 0.4);
  EXPECT_GT(std::sqrt(square / 300.0), 0.05);
}

TEST_F(GnssSensorTest, VelocityIsNorthEastDown) {
  GnssParameters parameters = paper();
  parameters.speed_sigma_mps = 0.0;
  GnssSensor gnss = sensor(parameters);
  antenna_.v_WL_W = {1.0, 2.0, 3.0};
  const GnssSample sample = gnss.sample(kStart, antenna_, kOpenSky);
  EXPECT_NEAR(sample.velocity_ned_mps.x, 2.0, 1e-9);
  EXPECT_NEAR(sample.velocity_ned_mps.y, 1.0, 1e-9);
  EXPECT_NEAR(sample.velocity_ned_mps.z, -3.0, 1e-9);
}

TEST_F(GnssSensorTest, SameSeedSameSamples) {
  GnssSensor one = sensor(paper());
  GnssSensor two = sensor(paper());
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(one.sample(kStart + i * 1s, antenna_, kOpenSky).latitude_deg,
              two.sample(kStart + i * 1s, antenna_, kOpenSky).latitude_deg);
  }
}

TEST_F(GnssSensorTest, WorksAtThePole) {
  GnssSensor gnss = sensor(paper(), 90.0);
  const GnssSample sample = gnss.sample(kStart, antenna_, kOpenSky);
  EXPECT_EQ(sample.fix, GnssFix::three_d);
  EXPECT_GT(sample.latitude_deg, 89.99);
  for (const auto& satellite : sample.satellites) {
    EXPECT_LT(satellite.elevation_rad, 50.0 * kDegree);  // orbits of 55 degrees never pass over it
  }
}

TEST_F(GnssSensorTest, RefusesStrangeParameters) {
  GnssParameters parameters = paper();
  parameters.circular_error_m = -1.0;
  EXPECT_THROW(validate(parameters), std::invalid_argument);
  parameters = {};
  parameters.sky.elevation_mask_deg = std::nan("");
  EXPECT_THROW(validate(parameters), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
