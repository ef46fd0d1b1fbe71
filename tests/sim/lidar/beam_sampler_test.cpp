#include "sim/lidar/beam_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace rigwire::sim {
namespace {

/// Half angles of 1, so that places are in half angles.
constexpr LaserBeam kUnitBeam{.horizontal_divergence_rad = 0.002, .vertical_divergence_rad = 0.002};
constexpr double kHalf_rad = 0.001;

/// Share of the Gaussian beam on the near side of a straight line at `distance` half angles.
double gaussian_share(double distance) {
  return 0.5 * std::erfc(-distance * std::numbers::sqrt2);
}

struct EdgeError {
  double rms = 0.0;
  double rms_upright_and_level = 0.0;
  double worst_upright_and_level = 0.0;
};

EdgeError edge_error(const std::vector<SubRay>& rays) {
  EdgeError error;
  int count = 0;
  int straight_count = 0;
  for (int degree = 0; degree < 180; ++degree) {
    const double angle = std::numbers::pi * degree / 180.0;
    for (int step = -125; step <= 125; ++step) {
      const double distance = 0.01 * step;
      double share = 0.0;
      for (const SubRay& ray : rays) {
        const double along =
            (ray.right_rad * std::cos(angle) + ray.up_rad * std::sin(angle)) / kHalf_rad;
        share += along < distance ? ray.weight : 0.0;
      }
      const double wrong = std::abs(share - gaussian_share(distance));
      error.rms += wrong * wrong;
      ++count;
      if (degree % 90 == 0) {
        error.rms_upright_and_level += wrong * wrong;
        ++straight_count;
        error.worst_upright_and_level = std::max(error.worst_upright_and_level, wrong);
      }
    }
  }
  error.rms = std::sqrt(error.rms / count);
  error.rms_upright_and_level = std::sqrt(error.rms_upright_and_level / straight_count);
  return error;
}

TEST(BeamSampler, WeightsAddUpToThePulseAndTheMiddleStaysInTheMiddle) {
  for (const int count : {1, 5, 19, 1000}) {
    const std::vector<SubRay> rays = sample_beam(kUnitBeam, count);
    ASSERT_EQ(rays.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(rays[0].right_rad, 0.0);
    EXPECT_EQ(rays[0].up_rad, 0.0);
    double sum = 0.0;
    double right = 0.0;
    double up = 0.0;
    for (const SubRay& ray : rays) {
      EXPECT_GT(ray.weight, 0.0);
      sum += ray.weight;
      right += ray.weight * ray.right_rad / kHalf_rad;
      up += ray.weight * ray.up_rad / kHalf_rad;
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_NEAR(right, 0.0, count == 1000 ? 2e-3 : 1e-12);
    EXPECT_NEAR(up, 0.0, count == 1000 ? 2e-3 : 1e-12);
  }
}

TEST(BeamSampler, EnergyBesideAnEdgeIsAsNearToTheGaussianBeamAsStated) {
  struct Stated {
    int count;
    double rms;
    double rms_straight;
    double worst_straight;
  };
  for (const Stated& stated :
       {Stated{1, 0.217, 0.217, 0.5001}, Stated{5, 0.073, 0.054, 0.126},
        Stated{19, 0.030, 0.020, 0.0465}, Stated{1000, 0.0016, 0.0017, 0.006}}) {
    const EdgeError error = edge_error(sample_beam(kUnitBeam, stated.count));
    EXPECT_LT(error.rms, stated.rms) << stated.count;
    EXPECT_LT(error.rms_upright_and_level, stated.rms_straight) << stated.count;
    EXPECT_LT(error.worst_upright_and_level, stated.worst_straight) << stated.count;
  }
}

TEST(BeamSampler, NoTwoSubRaysStandAboveOrBesideEachOther) {
  for (const int count : {5, 19}) {
    const std::vector<SubRay> rays = sample_beam(kUnitBeam, count);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_GT(std::abs(rays[i].right_rad - rays[j].right_rad), 0.01 * kHalf_rad) << i << j;
        EXPECT_GT(std::abs(rays[i].up_rad - rays[j].up_rad), 0.01 * kHalf_rad) << i << j;
      }
    }
  }
}

TEST(BeamSampler, AnEllipticalBeamIsWideWhereItsDivergenceIsWide) {
  const LaserBeam beam{.horizontal_divergence_rad = 0.003, .vertical_divergence_rad = 0.0015};
  double right2 = 0.0;
  double up2 = 0.0;
  for (const SubRay& ray : sample_beam(beam, 1000)) {
    right2 += ray.weight * ray.right_rad * ray.right_rad;
    up2 += ray.weight * ray.up_rad * ray.up_rad;
  }
  // A Gaussian of half angle a at 1/e2 has the standard deviation a / 2.
  EXPECT_NEAR(std::sqrt(right2), 0.25 * 0.003, 0.01 * 0.25 * 0.003);
  EXPECT_NEAR(std::sqrt(up2), 0.25 * 0.0015, 0.01 * 0.25 * 0.0015);
}

TEST(BeamSampler, OtherNumbersAndBeamsThatAreNoneAreRefused) {
  EXPECT_THROW(sample_beam(kUnitBeam, 0), std::invalid_argument);
  EXPECT_THROW(sample_beam(kUnitBeam, 7), std::invalid_argument);
  LaserBeam beam;
  beam.vertical_divergence_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(sample_beam(beam, 5), std::invalid_argument);
  beam.vertical_divergence_rad = -0.001;
  EXPECT_THROW(sample_beam(beam, 5), std::invalid_argument);
}

TEST(BeamSampler, ScatteredLightIsEvenAllRound) {
  const std::vector<SubRay> halo = sample_halo(0.01, 1e-3);
  double sum = 0.0;
  for (const SubRay& ray : halo) {
    EXPECT_NEAR(std::hypot(ray.right_rad, ray.up_rad), 0.01, 1e-12);
    sum += ray.weight;
  }
  EXPECT_NEAR(sum, 1e-3, 1e-15);
}

}  // namespace
}  // namespace rigwire::sim
