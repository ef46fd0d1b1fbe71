// The dig cycle in the rig that everybody sees first, in simulated time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pit_run.h"
#include "sanitized.h"

namespace rigwire::dig_cycle {
namespace {

using ::testing::HasSubstr;

const std::string kRig = std::string(RIGWIRE_SOURCE_DIR) + "/configs/rigs/excavator_pit.yaml";
constexpr double kKgPerM3 = 1700.0;  // Density of the pit's gravel.

/// Ends the run with the bucket emptied: what is on its way is in neither account.
void finish_cycle(PitRun& run) {
  while (run.cycle().phase() != Phase::approach && !run.over()) {
    run.tick();
  }
}

// It put 36 % of its load into the truck, the rest between truck and machine, and dug where nothing
// was left: 1.1 t in 130 s, where a machine of its class moves 7 to 9 t.
class DigCycleInThePit : public testing::TestWithParam<int> {};

TEST_P(DigCycleInThePit, LoadsTheTruckAndNotTheGroundBesideIt) {
  PitRun run(kRig, {"seed=" + std::to_string(GetParam())}, {});
  const double span_s = kSanitized ? 30.0 : 130.0;
  while (run.seconds() < span_s && !run.over()) {
    run.tick();
  }
  ASSERT_FALSE(run.over()) << run.cycle().fault().value_or(run.cycle().finished().value_or(""));
  const double tonnes = 1e-3 * kKgPerM3 * run.in_truck_m3();
  EXPECT_GT(tonnes, 3.5 * span_s / 130.0 - (kSanitized ? 0.5 : 0.0));
  finish_cycle(run);
  EXPECT_GE(run.in_truck_m3(), 0.95 * run.lifted_m3());
  // What it believes of its work.
  EXPECT_NEAR(run.cycle().loaded_kg(), kKgPerM3 * run.lifted_m3(),
              0.1 * kKgPerM3 * run.lifted_m3());
}

INSTANTIATE_TEST_SUITE_P(Seeds, DigCycleInThePit, testing::Range(1, 6));

TEST(DigCyclePit, GoesOnToWhereThereIsSoilUntilTheTruckIsFull) {
  PitRun run(kRig, {}, {.truck_load_kg = kSanitized ? 1e3 : 12e3});
  double least_rad = 0.0;
  double greatest_rad = 0.0;
  while (!run.over() && run.seconds() < 600.0) {
    run.tick();
    if (run.cycle().phase() == Phase::dig) {
      least_rad = std::min(least_rad, run.angles_rad()[swing]);
      greatest_rad = std::max(greatest_rad, run.angles_rad()[swing]);
    }
  }
  ASSERT_TRUE(run.cycle().done()) << run.cycle().fault().value_or("not in 600 s");
  EXPECT_THAT(*run.cycle().finished(), HasSubstr("the truck is full: "));
  if (!kSanitized) {
    EXPECT_GT(greatest_rad - least_rad, 15.0 * kDegree);
    EXPECT_GT(1e-3 * kKgPerM3 * run.in_truck_m3(), 11.0);
  }
}

}  // namespace
}  // namespace rigwire::dig_cycle
