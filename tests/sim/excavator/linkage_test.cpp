#include "sim/excavator/linkage.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/published_arm.h"

namespace rigwire::sim {
namespace {

using namespace bench;  // published_arm.h

TEST(Linkage, AnglesAtTheStrokeEndsAreTheResearchTables) {
  const Linkages linkages(published_set());
  EXPECT_NEAR(linkages.range(0).q_retracted_rad / kDegree, -35.3, 0.05);
  EXPECT_NEAR(linkages.range(0).q_extended_rad / kDegree, 61.5, 0.05);
  EXPECT_NEAR(linkages.range(1).q_retracted_rad / kDegree, -30.5, 0.05);
  EXPECT_NEAR(linkages.range(1).q_extended_rad / kDegree, -160.8, 0.05);
  EXPECT_NEAR(linkages.range(2).q_retracted_rad / kDegree, 140.4, 0.05);
  EXPECT_NEAR(linkages.range(2).q_extended_rad / kDegree, -38.9, 0.05);
}

TEST(Linkage, LeversOverTheStrokeAreTheResearchTables) {
  const Linkages linkages(published_set());
  const double retracted[] = {0.353, 0.459, 0.225};
  const double mid_stroke[] = {0.711, 0.673, 0.432};
  const double extended[] = {0.532, 0.167, 0.071};
  for (int joint = 0; joint < 3; ++joint) {
    const WorkingRange& range = linkages.range(joint);
    EXPECT_NEAR(std::abs(linkages.at(joint, range.q_retracted_rad).lever_m), retracted[joint],
                6e-4);
    EXPECT_NEAR(std::abs(linkages.at(joint, range.q_extended_rad).lever_m), extended[joint], 6e-4);
    const double middle = linkages.angle_at(joint, 0.5 * (range.length_min_m + range.length_max_m));
    EXPECT_NEAR(std::abs(linkages.at(joint, middle).lever_m), mid_stroke[joint], 1e-2)
        << joint << ": the table does not say where its middle is";
  }
}

TEST(Linkage, LeverIsTheDerivativeOfTheLength) {
  const Linkages linkages{ExcavatorParameters{}};
  for (int joint = 0; joint < 3; ++joint) {
    const WorkingRange& range = linkages.range(joint);
    for (int i = 0; i <= 50; ++i) {
      const double q = range.q_min_rad() + 0.02 * i * (range.q_max_rad() - range.q_min_rad());
      const double h = 1e-6;
      const double slope =
          (linkages.at(joint, q + h).length_m - linkages.at(joint, q - h).length_m) / (2.0 * h);
      EXPECT_NEAR(linkages.at(joint, q).lever_m, slope, 1e-8) << joint << " at " << q;
    }
  }
}

TEST(Linkage, LengthAndAngleAreEachOthersInverse) {
  const Linkages linkages{ExcavatorParameters{}};
  for (int joint = 0; joint < 3; ++joint) {
    const WorkingRange& range = linkages.range(joint);
    for (int i = 0; i <= 100; ++i) {
      const double length =
          range.length_min_m + 0.01 * i * (range.length_max_m - range.length_min_m);
      const double q = linkages.angle_at(joint, length);
      EXPECT_NEAR(linkages.at(joint, q).length_m, length, 1e-12);
      EXPECT_GE(q, range.q_min_rad() - 1e-12);
      EXPECT_LE(q, range.q_max_rad() + 1e-12);
    }
  }
}

// Research case 1.
TEST(Linkage, BucketDeadCentreIsTheLargestReachableLength) {
  const ExcavatorParameters parameters = published_set();
  const BucketLinkage bucket(parameters.bucket_linkage, parameters.stick_length_m);
  const double q = bucket.dead_centre(0.0);
  EXPECT_NEAR(q / kDegree, -161.3, 0.05);
  EXPECT_NEAR(bucket.at(q).length_m, 2.289209, 5e-7);
  EXPECT_NEAR(bucket.at(q).lever_m, 0.0, 1e-9);
}

TEST(Linkage, LengthsOutOfReachSaturateInsteadOfTurningIntoNan) {
  const Linkages linkages{ExcavatorParameters{}};
  for (int joint = 0; joint < 3; ++joint) {
    for (const double length : {-1.0, 0.0, 0.5, 2.4, 9.0, 1e9}) {
      EXPECT_TRUE(std::isfinite(linkages.angle_at(joint, length)));
    }
  }
  for (double q = -10.0; q <= 10.0; q += 0.01) {
    const CylinderGeometry geometry = linkages.bucket().at(q);
    ASSERT_TRUE(std::isfinite(geometry.length_m) && std::isfinite(geometry.lever_m)) << q;
  }
}

TEST(Linkage, TheDiggingBucketOpensPastTheStickAndCurlsUnderIt) {
  const Linkages linkages{ExcavatorParameters{}};
  EXPECT_NEAR(linkages.range(2).q_retracted_rad / kDegree, 40.4, 0.05);
  EXPECT_NEAR(linkages.range(2).q_extended_rad / kDegree, -138.9, 0.05);
}

TEST(Linkage, IdlerAndLinkKeepTheirLengths) {
  const ExcavatorParameters parameters;
  const BucketLinkage bucket(parameters.bucket_linkage, parameters.stick_length_m);
  const Linkages linkages(parameters);
  const WorkingRange& range = linkages.range(2);
  for (int i = 0; i <= 100; ++i) {
    const double q = range.q_min_rad() + 0.01 * i * (range.q_max_rad() - range.q_min_rad());
    const Eigen::Vector2d joint = bucket.idler_joint_m(q);
    const double psi = q + parameters.bucket_linkage.lug_angle_rad;
    const Eigen::Vector2d lug(parameters.stick_length_m + 0.42 * std::cos(psi),
                              0.42 * std::sin(psi));
    EXPECT_NEAR((joint - parameters.bucket_linkage.idler_pivot_m).norm(), 0.52, 1e-14);
    EXPECT_NEAR((joint - lug).norm(), 0.50, 1e-14);
  }
}

}  // namespace
}  // namespace rigwire::sim
