#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "fake_sky.h"
#include "fields/constants.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/gnss/signal_path.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

class ColouredGnss : public testing::Test {
 protected:
  ColouredGnss() { parameters_.error_model = ErrorModel::coloured; }
  GnssSensor sensor(std::uint64_t seed = 1) const {
    return {parameters_, calendar_, frame_, seed, "gnss"};
  }
  Eigen::Vector3d error(const GnssSample& sample) const {
    return frame_.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m}) -
           antenna_.X_WL.translation();
  }
  /// CEP over receivers, each for six hours.
  double circular_error_m() {
    std::vector<double> horizontal;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      GnssSensor gnss = sensor(seed);
      for (int i = 0; i < 6 * 60; ++i) {
        horizontal.push_back(
            error(gnss.sample(kStart + i * 1min, antenna_, kOpen)).head<2>().norm());
      }
    }
    return quantile(horizontal, 0.5);
  }
  static int tracked(const GnssSample& sample) {
    return static_cast<int>(std::ranges::count(sample.satellites, true, &SatelliteView::tracked));
  }

  const FakeSky kOpen = open_sky();
  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  LocalFrame frame_{{49.42, 7.75, 280.0, 48.0}};
  GnssParameters parameters_;
  LinkMotion antenna_;
};

TEST_F(ColouredGnss, OpenSkyHasTheCircularErrorOfTheDataSheet) {
  const double alone_m = circular_error_m();  // u-blox 7: 2.5 m, with SBAS 2.0 m
  EXPECT_GT(alone_m, 2.0);
  EXPECT_LT(alone_m, 3.0);
  parameters_.corrections.kind = CorrectionKind::sbas;
  const double corrected_m = circular_error_m();
  EXPECT_GT(corrected_m, 1.5);
  EXPECT_LT(corrected_m, 2.3);
}

TEST_F(ColouredGnss, AccuracyFollowsTheErrorModelAndNotTheError) {
  double horizontal = 0.0;
  double vertical = 0.0;
  constexpr int kReceivers = 600;
  for (std::uint64_t seed = 1; seed <= kReceivers; ++seed) {
    GnssSensor gnss = sensor(seed);
    const GnssSample sample = gnss.sample(kStart, antenna_, kOpen);
    const Eigen::Vector3d e = error(sample);
    horizontal += e.head<2>().squaredNorm() / std::pow(sample.horizontal_accuracy_m, 2);
    vertical += e.z() * e.z() / std::pow(sample.vertical_accuracy_m, 2);
    const auto& c = sample.position_covariance_ned_m2;
    EXPECT_NEAR(std::sqrt(c[0] + c[3]), sample.horizontal_accuracy_m, 1e-9);
    EXPECT_NEAR(std::sqrt(c[5]), sample.vertical_accuracy_m, 1e-9);
  }
  EXPECT_NEAR(horizontal / kReceivers, 1.0, 0.12);
  // Neighbouring satellites share more of the ionosphere than the receiver reckons with.
  EXPECT_NEAR(vertical / kReceivers, 1.0, 0.35);
}

TEST_F(ColouredGnss, OneSatellitesSkyNeverShiftsAnothersNoise) {
  parameters_.raw_measurements = true;
  parameters_.multipath.enabled = false;
  GnssSensor seeing = sensor();
  GnssSensor losing = sensor();
  const GnssSample first = seeing.sample(kStart, antenna_, kOpen);
  (void)losing.sample(kStart, antenna_, kOpen);
  const SatelliteView lost = first.satellites[2];
  const Eigen::Vector3d there = direction(lost.azimuth_rad, lost.elevation_rad);
  const FakeSky one_hidden([&](const Eigen::Vector3d& d) { return d.dot(there) > 0.99; });
  for (int i = 1; i < 20; ++i) {
    const GnssSample all = seeing.sample(kStart + i * 1s, antenna_, kOpen);
    const GnssSample less = losing.sample(kStart + i * 1s, antenna_, one_hidden);
    EXPECT_LT(less.measurements.size(), all.measurements.size());
    for (const GnssMeasurement& measurement : less.measurements) {
      const auto same =
          std::ranges::find(all.measurements, measurement.number, &GnssMeasurement::number);
      ASSERT_NE(same, all.measurements.end());
      EXPECT_EQ(measurement.pseudorange_m, same->pseudorange_m);
    }
  }
}

TEST_F(ColouredGnss, WithoutErrorsThePositionIsTheTruth) {
  parameters_.errors = false;
  parameters_.raw_measurements = true;
  antenna_.X_WL.translation() << 300.0, -200.0, 15.0;
  antenna_.v_WL_W << 5.0, 3.0, -1.0;
  GnssSensor gnss = sensor();
  for (int i = 0; i < 5; ++i) {
    const GnssSample sample = gnss.sample(kStart + i * 1s, antenna_, kOpen);
    const Eigen::Vector3d moved = to_seconds(sample.measured_after) * antenna_.v_WL_W;
    EXPECT_LT((error(sample) - moved).norm(), 1e-6) << "where it is when the receiver measures";
    EXPECT_NEAR(sample.velocity_ned_mps.x, 3.0, 1e-3);
    EXPECT_NEAR(sample.velocity_ned_mps.y, 5.0, 1e-3);
    EXPECT_NEAR(sample.velocity_ned_mps.z, 1.0, 1e-3);
  }
}

/// Position and clock from pseudoranges by Gauss-Newton, all ranges alike: what a client computes.
struct ClientFix {
  Eigen::Vector3d position_E_m;
  double clock_m = 0.0;
};
ClientFix client_fix(const Constellation& constellation, const GnssSample& sample,
                     const GpsTime& time, Eigen::Vector3d p_E_m) {
  ClientFix fix{p_E_m, 0.0};
  const auto satellites = constellation.satellites();
  for (int round = 0; round < 8; ++round) {
    const auto n = static_cast<Eigen::Index>(sample.measurements.size());
    Eigen::MatrixXd g(n, 4);
    Eigen::VectorXd missing(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const GnssMeasurement& m = sample.measurements[static_cast<std::size_t>(i)];
      const auto index = static_cast<std::size_t>(
          std::ranges::find(satellites, Satellite{m.system, m.number}) - satellites.begin());
      const SignalPath path =
          signal_path(constellation, index,
                      {time, to_seconds(sample.measured_after), fix.position_E_m, {0, 0, 0}});
      g.row(i) << -path.direction_E.transpose(), 1.0;
      missing(i) =
          m.pseudorange_m - (path.range_m + fix.clock_m +
                             kLightSpeed_mps * (path.group_delay_s - path.satellite_clock_s));
    }
    const Eigen::VectorXd step = g.colPivHouseholderQr().solve(missing);
    fix.position_E_m += step.head<3>();
    fix.clock_m += step(3);
  }
  return fix;
}

TEST_F(ColouredGnss, PositionIsWhatAClientComputesFromThePseudoranges) {
  // Equal weights, so that the client need not know the receiver's.
  parameters_.ranges = {.orbit_clock_sigma_m = 6.0,
                        .ionosphere_sigma_m = 0.0,
                        .ionosphere_gradient_sigma_mpkm = 0.0,
                        .troposphere_sigma_m = 0.0,
                        .code_noise_m = 0.0,
                        .multipath_sigma_m = 0.0,
                        .weak_signal_sigma_mpdb = 0.0};
  parameters_.raw_measurements = true;
  parameters_.ionosphere = false;
  parameters_.troposphere = false;
  parameters_.sky.elevation_mask_deg = 0.0;
  parameters_.faults = {{{20s, 10s}, JumpFault{{40.0, -30.0, 5.0}}},
                        {{40s, 100s}, SpoofDriftFault{Eigen::Vector3d::UnitX(), 3.0}}};
  const GnssSystem gps = GnssSystem::gps;
  const auto constellation = make_nominal_constellation({&gps, 1});
  GnssSensor gnss(parameters_, constellation, calendar_, frame_, 3, "gnss");
  for (int i = 0; i < 8; ++i) {
    const SimTime now = kStart + i * 10s;
    const GnssSample sample = gnss.sample(now, antenna_, kOpen);
    ASSERT_GE(sample.measurements.size(), 5U);
    const ClientFix fix = client_fix(*constellation, sample, calendar_.gps(now),
                                     frame_.to_ecef(Eigen::Vector3d(10.0, 10.0, 10.0)));
    const Eigen::Vector3d reported_E = frame_.to_ecef(
        frame_.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m}));
    EXPECT_LT((fix.position_E_m - reported_E).norm(), 2e-3) << i;
    EXPECT_NEAR(fix.clock_m, kLightSpeed_mps * sample.clock_bias_s, 5e-3) << i;
  }
}

TEST_F(ColouredGnss, ThreeSatellitesHoldTheHeightOfTheLastFix) {
  GnssSensor gnss = sensor();
  const GnssSample full = gnss.sample(kStart, antenna_, kOpen);
  ASSERT_EQ(full.fix, GnssFix::three_d);
  for (std::size_t left = 4; left-- > 0;) {
    std::vector<Eigen::Vector3d> kept;
    for (const auto& satellite : full.satellites) {
      if (satellite.used && kept.size() < left) {
        kept.push_back(direction(satellite.azimuth_rad, satellite.elevation_rad));
      }
    }
    const FakeSky holes([&](const Eigen::Vector3d& d) {
      return std::ranges::none_of(kept, [&](const auto& k) { return k.dot(d) > 0.998; });
    });
    const GnssSample sample =
        gnss.sample(kStart + 1s * (10 - static_cast<int>(left)), antenna_, holes);
    EXPECT_EQ(sample.fix, fix_by_count(static_cast<int>(left))) << left;
    if (left == 3) {
      // The error is added in the tangent plane: d^2 / 2R for d metres.
      EXPECT_NEAR(sample.ellipsoid_height_m, full.ellipsoid_height_m, 1e-4);
      EXPECT_TRUE(std::isnan(sample.vertical_dilution));
      EXPECT_EQ(sample.velocity_ned_mps.z, 0.0);
    } else {
      EXPECT_TRUE(std::isnan(sample.position_dilution));
      EXPECT_TRUE(std::ranges::none_of(sample.satellites, &SatelliteView::used));
    }
  }
}

TEST_F(ColouredGnss, ASkyOfOnePlaneGivesNoPosition) {
  // Only a narrow strip of the sky from north over the zenith to south is open; over a day the
  // satellites in it are one to five, and all in one plane within a degree.
  const FakeSky strip([](const Eigen::Vector3d& d) { return std::abs(d.x()) > 0.02; });
  parameters_.sky.samples = SkySamples::one;
  parameters_.multipath.enabled = false;
  parameters_.systems = {.glonass = true, .galileo = true, .beidou = true};
  GnssSensor gnss = sensor();
  for (int i = 0; i < 200; ++i) {
    const GnssSample sample = gnss.sample(kStart + i * 5min, antenna_, strip);
    if (sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d) {
      EXPECT_LE(sample.position_dilution, 100.0);
      EXPECT_LT(error(sample).norm(), 3000.0);
    }
    EXPECT_TRUE(std::isfinite(sample.latitude_deg) && std::isfinite(sample.horizontal_accuracy_m));
  }
}

TEST_F(ColouredGnss, WorksAtThePolesInTheDeadSeaAndInTheHimalaya) {
  struct Place {
    double latitude_deg, longitude_deg, height_m;
  };
  for (const Place& place :
       {Place{90.0, 0.0, 10.0}, Place{-90.0, 0.0, 2800.0}, Place{31.5, 35.5, -400.0},
        Place{28.0, 86.9, 9000.0}, Place{0.0, 180.0, 5.0}, Place{-17.0, -180.0, 5.0}}) {
    frame_ = LocalFrame({place.latitude_deg, place.longitude_deg, place.height_m, 20.0});
    parameters_.raw_measurements = true;
    parameters_.systems.glonass = true;
    GnssSensor gnss = sensor();
    for (int i = 0; i < 24; ++i) {
      const GnssSample sample = gnss.sample(kStart + i * 1h, antenna_, kOpen);
      ASSERT_EQ(sample.fix, GnssFix::three_d) << place.latitude_deg;
      EXPECT_LT(error(sample).norm(), 60.0) << place.latitude_deg;
      EXPECT_GE(sample.longitude_deg, -180.0);
      EXPECT_LT(sample.longitude_deg, 180.0);
      for (const GnssMeasurement& measurement : sample.measurements) {
        EXPECT_TRUE(std::isfinite(measurement.pseudorange_m));
        EXPECT_TRUE(std::isfinite(measurement.carrier_phase_cycles));
      }
    }
  }
}

TEST_F(ColouredGnss, VelocityErrorScalesWithTheDilution) {
  GnssSensor gnss = sensor();
  double square = 0.0;
  double declared = 0.0;
  constexpr int kSamples = 3000;
  for (int i = 0; i < kSamples; ++i) {
    const GnssSample sample = gnss.sample(kStart + i * 100ms, antenna_, kOpen);
    const Vector3& v = sample.velocity_ned_mps;
    square += v.x * v.x + v.y * v.y + v.z * v.z;
    declared += sample.speed_accuracy_mps * sample.speed_accuracy_mps;
    EXPECT_NEAR(sample.speed_accuracy_mps, 0.05 * sample.position_dilution, 1e-9);
  }
  EXPECT_NEAR(square / declared, 1.0, 0.1);
}

// Recordings of NEO-7Ps: from one second to the next C/N0 changes by 0.4 to 1.5 dB at rest and
// by 2.3 to 5.2 dB on a drive through a town, 2.9 dB over all; ours changed by 0.6 dB.
TEST_F(ColouredGnss, CarrierToNoiseVariesAsOnADriveThroughATown) {
  const auto change_db = [&](double speed_mps) {
    GnssSensor gnss = sensor();
    antenna_.v_WL_W = Eigen::Vector3d(speed_mps, 0.0, 0.0);
    double square = 0.0;
    int count = 0;
    GnssSample before = gnss.sample(kStart, antenna_, kOpen);
    for (int i = 1; i <= 600; ++i) {
      const GnssSample now = gnss.sample(kStart + i * 1s, antenna_, kOpen);
      for (std::size_t k = 0; k < std::min(now.satellites.size(), before.satellites.size()); ++k) {
        const SatelliteView& a = before.satellites[k];
        const SatelliteView& b = now.satellites[k];
        if (a.system == b.system && a.number == b.number && a.tracked && b.tracked) {
          square += (b.cn0_dbhz - a.cn0_dbhz) * (b.cn0_dbhz - a.cn0_dbhz);
          ++count;
        }
      }
      before = now;
    }
    return std::sqrt(square / count);
  };
  const double at_rest_db = change_db(0.0);
  EXPECT_GT(at_rest_db, 0.4);
  EXPECT_LT(at_rest_db, 1.5);
  const double moving_db = change_db(10.0);
  EXPECT_GT(moving_db, 2.3);
  EXPECT_LT(moving_db, 5.2);
}

// 12 % of a recorded NEO-7P's measurements are below 25 dBHz; ours ended there.
TEST_F(ColouredGnss, WeakSatellitesAreTrackedAsFarDownAsByARealReceiver) {
  const FakeSky wood([](const Eigen::Vector3d&) { return false; },
                     [](const Eigen::Vector3d&) { return 20.0; });
  GnssSensor gnss = sensor();
  int weak = 0;
  int all = 0;
  for (int i = 0; i < 600; ++i) {
    for (const SatelliteView& view : gnss.sample(kStart + i * 1s, antenna_, wood).satellites) {
      if (view.tracked) {
        EXPECT_GE(view.cn0_dbhz, parameters_.sky.cn0_threshold_dbhz);
        ++all;
        weak += view.cn0_dbhz < 25.0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(weak, all / 10);
}

// EGNOS offers no ranges; its satellites are heard and bring corrections.
TEST_F(ColouredGnss, AugmentationIsHeardAndTakesNoPartInTheFix) {
  parameters_.systems.sbas = true;
  parameters_.corrections.kind = CorrectionKind::sbas;
  GnssSensor gnss = sensor();
  const GnssSample sample = gnss.sample(kStart + 30s, antenna_, kOpen);
  int heard = 0;
  for (const SatelliteView& view : sample.satellites) {
    if (view.system == GnssSystem::sbas) {
      EXPECT_TRUE(view.tracked || view.elevation_rad < 5.0 * kDegree);
      EXPECT_FALSE(view.used);
      heard += view.tracked ? 1 : 0;
    }
  }
  EXPECT_GE(heard, 2);
  EXPECT_TRUE(sample.differential);
}

TEST_F(ColouredGnss, FoliageWeakensAndLosesSatellites) {
  const auto wood = [](double metres) {
    return FakeSky([](const Eigen::Vector3d&) { return false; },
                   [metres](const Eigen::Vector3d&) { return metres; });
  };
  parameters_.sky.cn0_sigma_db = 0.0;
  GnssSensor gnss = sensor();
  const GnssSample open = gnss.sample(kStart, antenna_, kOpen);
  const GnssSample light = gnss.sample(kStart + 1s, antenna_, wood(8.0));
  EXPECT_GE(tracked(light) + 1, tracked(open)) << "but for one on the horizon";
  EXPECT_GT(light.horizontal_accuracy_m, open.horizontal_accuracy_m);
  const GnssSample dense = gnss.sample(kStart + 2s, antenna_, wood(30.0));
  EXPECT_LT(tracked(dense), tracked(open));
  EXPECT_EQ(tracked(gnss.sample(kStart + 3s, antenna_, wood(50.0))), 0);
}

// 5 to 8 dB of deviation under crowns. Before: what crowns take was the same at every moment.
TEST_F(ColouredGnss, LeavesFadeAboutWhatCrownsTake) {
  const FakeSky wood([](const Eigen::Vector3d&) { return false; },
                     [](const Eigen::Vector3d&) { return 10.0; });
  parameters_.sky.cn0_sigma_db = 0.0;
  double sum_db = 0.0;
  double square_db2 = 0.0;
  double count = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    GnssSensor gnss = sensor(seed);
    for (int i = 0; i < 60; ++i) {
      for (const SatelliteView& view : gnss.sample(kStart + i * 5s, antenna_, wood).satellites) {
        if (view.tracked && view.elevation_rad > 0.5) {
          const double lost_db =
              direct_cn0_dbhz(parameters_.sky, std::sin(view.elevation_rad), SkyArrival{}) -
              view.cn0_dbhz;
          EXPECT_GE(lost_db, -1e-9);
          sum_db += lost_db;
          square_db2 += lost_db * lost_db;
          count += 1.0;
        }
      }
    }
  }
  ASSERT_GT(count, 1000.0);
  const double mean_db = sum_db / count;
  EXPECT_NEAR(mean_db, 10.0, 1.0);
  const double deviation_db = std::sqrt(square_db2 / count - mean_db * mean_db);
  EXPECT_GT(deviation_db, 5.0);
  EXPECT_LT(deviation_db, 8.0);
}

TEST_F(ColouredGnss, RtkFixesUnderOpenSkyAndFallsBackIndoors) {
  parameters_.corrections.kind = CorrectionKind::assumed_rtk;
  GnssSensor gnss = sensor();
  std::vector<double> fixed_m;
  for (int i = 0; i < 400; ++i) {
    const GnssSample sample = gnss.sample(kStart + i * 1s, antenna_, kOpen);
    if (sample.carrier == CarrierSolution::fixed) {
      fixed_m.push_back(error(sample).head<2>().norm());
      EXPECT_NEAR(sample.horizontal_accuracy_m, 0.0105, 1e-4);
      EXPECT_TRUE(sample.differential);
      EXPECT_TRUE(sample.differential_age_s.has_value());
    }
  }
  EXPECT_GT(fixed_m.size(), 360U);
  EXPECT_LT(quantile(fixed_m, 0.95), 0.03);
  const FakeSky indoors = closed_sky();
  const GnssSample lost = gnss.sample(kStart + 401s, antenna_, indoors);
  EXPECT_EQ(lost.carrier, CarrierSolution::none);
  EXPECT_EQ(gnss.sample(kStart + 403s, antenna_, kOpen).fix, GnssFix::none);
  EXPECT_EQ(gnss.sample(kStart + 404s, antenna_, kOpen).carrier, CarrierSolution::floating);
}

TEST_F(ColouredGnss, MoreSystemsMeanMoreSatellitesAndLessError) {
  GnssSensor gps = sensor();
  parameters_.systems = {.glonass = true, .galileo = true, .beidou = true};
  parameters_.sky.maximum_channels = 72;
  GnssSensor all = sensor();
  const GnssSample few = gps.sample(kStart, antenna_, kOpen);
  const GnssSample many = all.sample(kStart, antenna_, kOpen);
  EXPECT_GT(tracked(many), 3 * tracked(few));
  EXPECT_LT(many.horizontal_dilution, few.horizontal_dilution);
  EXPECT_LT(many.horizontal_accuracy_m, few.horizontal_accuracy_m);
  parameters_.sky.maximum_channels = 10;
  GnssSensor narrow = sensor();
  EXPECT_EQ(tracked(narrow.sample(kStart, antenna_, kOpen)), 10);
}

}  // namespace
}  // namespace rigwire::sim
