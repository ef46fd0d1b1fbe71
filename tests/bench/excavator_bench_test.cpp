#include "bench/excavator_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace rigwire::bench {
namespace {

using sim::IntegrationScheme;

TEST(ExcavatorBench, ReferenceRunEndsInSimbodysPose) {
  EXPECT_LT(reference_pose_error_rad(), 6e-10);
}

TEST(ExcavatorBench, RowsShowEachSchemesErrorAndKeepTheDivergedOnes) {
  WorkPrecisionSettings settings;
  settings.stiffness_factors = {1.0, 100.0};
  settings.steps_s = {1e-3, 1e-2};
  settings.repetitions = 1;
  const auto rows = measure_work_precision(settings);
  ASSERT_EQ(rows.size(), 12u);
  const auto row = [&](IntegrationScheme scheme, double factor, double step_s) {
    return *std::find_if(rows.begin(), rows.end(), [&](const WorkPrecisionRow& r) {
      return r.scheme == scheme && r.stiffness_factor == factor && r.step_s == step_s;
    });
  };
  // Research table 3.3; each bound is its figure or less.
  EXPECT_LT(row(IntegrationScheme::linearly_implicit_euler, 1.0, 1e-3).final_error_m, 1.3e-4);
  EXPECT_GT(row(IntegrationScheme::linearly_implicit_euler, 1.0, 1e-3).final_error_m, 1e-5);
  EXPECT_LT(row(IntegrationScheme::rosenbrock2, 1.0, 1e-2).final_error_m, 3.0e-5);
  EXPECT_LT(row(IntegrationScheme::runge_kutta4, 1.0, 1e-2).final_error_m, 6.6e-6);
  EXPECT_TRUE(row(IntegrationScheme::runge_kutta4, 100.0, 1e-2).diverged);
  EXPECT_FALSE(row(IntegrationScheme::linearly_implicit_euler, 100.0, 1e-2).diverged);
  for (const WorkPrecisionRow& r : rows) {
    EXPECT_GE(r.greatest_error_m, r.final_error_m);
    EXPECT_GE(r.microseconds_per_step, 0.0);
  }
}

TEST(ExcavatorBench, StiffestAllowedDriveIsStableAtOneMillisecondAndBeyondIsRefused) {
  for (const StiffestDrive& drive : measure_stiffest_drives()) {
    SCOPED_TRACE(name_of(drive.scheme));
    EXPECT_NE(drive.refusal.find("stiffnesses"), std::string::npos) << drive.refusal;
    ASSERT_GT(drive.factor, 0.0);
    EXPECT_TRUE(drive.machine_stable);
    EXPECT_FALSE(drive.row.diverged);
    EXPECT_LT(drive.row.greatest_error_m, 1e-3);
  }
}

TEST(ExcavatorBench, SettingsThatMeasureNothingAreRefused) {
  WorkPrecisionSettings settings;
  settings.steps_s = {3e-3};
  EXPECT_THROW((void)measure_work_precision(settings), std::invalid_argument);
  settings = {};
  settings.repetitions = 0;
  EXPECT_THROW((void)measure_work_precision(settings), std::invalid_argument);
  EXPECT_THROW((void)measure_excavator_step(0), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::bench
