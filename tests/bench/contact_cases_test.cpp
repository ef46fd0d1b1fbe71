// The figures of contact stay within their bounds, at the steps that rigs have.
#include "bench/contact_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rigwire::bench {
namespace {

TEST(ContactCases, NoContactAddsEnergyNorLetsAnythingThrough) {
  for (const ContactCase& each : contact_cases()) {
    SCOPED_TRACE(each.name);
    const ContactOutcome outcome = each.run(1e-3);
    EXPECT_TRUE(outcome.finite);
    EXPECT_GT(outcome.greatest_n, 0.0);
    EXPECT_LT(outcome.gave_j, std::max(1.0, 1e-3 * outcome.came_with_j));
    if (each.name.starts_with("bucket")) {
      EXPECT_LT(outcome.deepest_m, 0.005);
    }
    if (each.name.starts_with("Unimog")) {
      EXPECT_LT(outcome.deepest_m, 0.02);
      EXPECT_GT(outcome.dent_m, outcome.deepest_m);
    }
    if (!each.figure.empty()) {
      EXPECT_NEAR(outcome.found, each.closed_form, 0.01 * each.closed_form);
    }
  }
}

TEST(ContactCases, TheFinerTheStepTheNearerTheClosedForm) {
  for (const ContactCase& each : contact_cases()) {
    if (each.figure.empty()) {
      continue;
    }
    SCOPED_TRACE(each.name);
    EXPECT_LT(std::abs(each.run(5e-4).found - each.closed_form),
              std::abs(each.run(5e-3).found - each.closed_form) + 1e-3 * each.closed_form);
  }
}

TEST(ContactCases, LowSwingsOfTheShippedPitThrowNothing) {
  const ContactSweep sweep = sweep_pit(2);
  EXPECT_GT(sweep.runs, 36);
  EXPECT_GT(sweep.touched, 6);
  EXPECT_EQ(sweep.thrown, 0);
  EXPECT_TRUE(sweep.worst.finite);
  EXPECT_LT(sweep.worst.gave_j, 1.0);
  EXPECT_LT(sweep.worst.deepest_m, 0.005);
}

TEST(ContactCases, StraightDrivesOfTheShippedForestAreStoppedByItsTrunks) {
  const ContactSweep sweep = sweep_forest(sim::VehicleLevel::full, 8);
  EXPECT_EQ(sweep.runs, 8);
  EXPECT_GT(sweep.touched, 2);
  EXPECT_EQ(sweep.thrown, 0);
  EXPECT_TRUE(sweep.worst.finite);
  EXPECT_LT(sweep.worst.deepest_m, 0.02);
}

}  // namespace
}  // namespace rigwire::bench
