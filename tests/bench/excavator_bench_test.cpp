#include "bench/excavator_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace rigwire::bench {
namespace {

TEST(ExcavatorBench, ReferenceRunEndsInSimbodysPose) {
  EXPECT_LT(reference_pose_error_rad(), 6e-10);
}

TEST(ExcavatorBench, RowsShowEachMethodsErrorAtEachStiffness) {
  WorkPrecisionSettings settings;
  settings.stiffness_factors = {1.0, 100.0};
  settings.steps_s = {1e-3, 1e-2};
  settings.repetitions = 1;
  const auto rows = measure_work_precision(settings);
  ASSERT_EQ(rows.size(), 12u);
  const auto row = [&](int order, double factor, double step_s) {
    return *std::find_if(rows.begin(), rows.end(), [&](const WorkPrecisionRow& r) {
      return r.method.order == order && r.stiffness_factor == factor && r.step_s == step_s;
    });
  };
  // Research table 3.3; the bound is its figure or less.
  EXPECT_LT(row(1, 1.0, 1e-3).final_error_m, 1.3e-4);
  EXPECT_GT(row(1, 1.0, 1e-3).final_error_m, 1e-5);
  for (const double factor : settings.stiffness_factors) {
    EXPECT_NEAR(row(1, factor, 1e-2).greatest_error_m / row(1, factor, 1e-3).greatest_error_m, 9.0,
                2.0);
    EXPECT_LT(row(2, factor, 1e-3).greatest_error_m, 0.05 * row(1, factor, 1e-3).greatest_error_m);
    EXPECT_LT(row(4, factor, 1e-3).greatest_error_m, 0.05 * row(2, factor, 1e-3).greatest_error_m);
  }
  for (const WorkPrecisionRow& r : rows) {
    EXPECT_FALSE(r.diverged);
    EXPECT_GE(r.greatest_error_m, r.final_error_m);
    EXPECT_GE(r.microseconds_per_step, 0.0);
  }
}

TEST(ExcavatorBench, StiffestAllowedDriveIsStableAtOneMillisecondAndBeyondIsRefused) {
  const StiffestDrive drive = measure_stiffest_drive();
  EXPECT_NE(drive.refusal.find("stiffnesses"), std::string::npos) << drive.refusal;
  EXPECT_GT(drive.factor, 1e4);
  EXPECT_TRUE(drive.machine_stable);
  EXPECT_FALSE(drive.row.diverged);
  EXPECT_LT(drive.row.greatest_error_m, 1e-3);
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
