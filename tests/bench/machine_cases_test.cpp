#include "bench/machine_cases.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "bench/registry.h"

namespace rigwire::bench {
namespace {

TEST(MachineCases, EveryMachineHasEveryLevelInBothScenes) {
  std::map<std::string, std::set<std::string>> levels;
  for (const MachineCase& each : machine_cases()) {
    levels[each.machine + ", " + each.scene].insert(each.level);
  }
  const std::set<std::string> arm{"kinematic", "quasi_static", "dynamic", "chambers"};
  const std::set<std::string> wheels{"kinematic", "planar", "full"};
  const std::set<std::string> drums{"kinematic", "dynamic"};
  for (const char* scene : {"smooth", "switches"}) {
    const std::string in = std::string(", ") + scene;
    EXPECT_EQ(levels["excavator" + in], arm);
    EXPECT_EQ(levels["excavator on tyres" + in], std::set<std::string>{"dynamic"});
    EXPECT_EQ(levels["Unimog" + in], wheels);
    EXPECT_EQ(levels["Gator" + in], wheels);
    EXPECT_EQ(levels["roller" + in], drums);
  }
  EXPECT_EQ(levels.size(), 10U);
}

TEST(MachineCases, DynamicLevelsHaveThreeStiffnesses) {
  std::map<std::string, std::set<double>> factors;
  for (const MachineCase& each : machine_cases()) {
    factors[each.machine + " " + each.level].insert(each.stiffness_factor);
  }
  const std::set<double> three{1.0, 100.0, 1e4};
  for (const char* which : {"excavator dynamic", "Unimog full", "Gator full", "roller dynamic"}) {
    EXPECT_EQ(factors[which], three) << which;
  }
}

TEST(MachineCases, EveryCaseRunsAMomentOrSaysWhyNot) {
  for (MachineCase each : machine_cases()) {
    SCOPED_TRACE(each.machine + ' ' + each.level + ' ' + each.scene);
    each.span = std::chrono::milliseconds(40);
    MachinePrecisionSettings settings;
    settings.steps_s = {2e-3};
    settings.reference_step_s = 2e-4;
    settings.most_repetitions = 1;
    for (const MachinePrecisionRow& row : measure_machine_precision(each, settings).rows) {
      EXPECT_FALSE(row.diverged) << row.method;
      if (row.refusal.empty()) {
        EXPECT_LT(row.greatest_error_m, 0.1) << row.method;
      } else {
        EXPECT_NE(row.refusal.find("step"), std::string::npos) << row.refusal;
      }
    }
  }
}

TEST(MachineCases, SmoothScenesShowFirstOrderAtEveryLevel) {
  for (MachineCase each : machine_cases()) {
    if (each.scene != "smooth" || each.stiffness_factor != 1.0 || each.machine == "roller" ||
        each.machine == "excavator on tyres") {  // Settles for 5 s, at every step.
      continue;
    }
    SCOPED_TRACE(each.machine + ' ' + each.level);
    each.span = std::chrono::milliseconds(400);
    MachinePrecisionSettings settings;
    settings.steps_s = {5e-4, 1e-3, 2e-3};
    settings.reference_step_s = 1e-4;
    settings.most_repetitions = 1;
    const auto order =
        measured_order(measure_machine_precision(each, settings), "linearly_implicit_euler");
    ASSERT_TRUE(order.has_value());
    EXPECT_NEAR(*order, 1.0, 0.2);
  }
}

TEST(MachineCases, VariedMachinesDifferFromTheNominalOnes) {
  const auto variations = machine_variations();
  EXPECT_GE(variations.size(), 6U);
  for (MachineVariation each : variations) {
    SCOPED_TRACE(each.nominal.machine + ' ' + each.quantity);
    each.nominal.span = each.varied.span = std::chrono::milliseconds(600);
    const double apart_m = machine_distance(each.nominal, each.varied, 2e-3).greatest_m;
    EXPECT_GT(apart_m, 1e-9);
    EXPECT_LT(apart_m, 1.0);
  }
}

TEST(MachineCases, SuiteIsRegisteredUnderItsName) {
  bool found = false;
  for (const BenchSuite& suite : bench_suites()) {
    found = found || suite.name == std::string_view("dynamics");
  }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace rigwire::bench
