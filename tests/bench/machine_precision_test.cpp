#include "bench/machine_precision.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/machine_precision_json.h"

namespace rigwire::bench {
namespace {

/// One link on a line, x' = -x from x = 1, by explicit Euler. Exact: exp(-t). The commands do
/// nothing.
class Decay final : public sim::Machine {
 public:
  Decay(double step_s, double rate) : span_(from_seconds(step_s)), rate_(rate) {
    if (step_s > 0.011) {
      throw std::invalid_argument("step_s: found more than 0.011");
    }
    update();
  }

  void step(Duration span) override {
    for (; span > Duration{0}; span -= span_) {
      x_ -= to_seconds(span_) * rate_ * x_;
      time_ += span_;
      steps_ += 1;
    }
    if (!std::isfinite(x_)) {
      failure_ = sim::NonFinite{"position", "body", time_};
    }
    update();
  }
  [[nodiscard]] SimTime time() const override { return time_; }
  [[nodiscard]] std::span<const sim::LinkMotion> links() const override { return links_; }
  [[nodiscard]] std::span<const std::string_view> link_names() const override { return kNames; }
  [[nodiscard]] const std::optional<sim::NonFinite>& non_finite() const override {
    return failure_;
  }
  [[nodiscard]] std::span<const sim::StatusQuantity> status_quantities() const override {
    return {};
  }
  void read_status(std::span<double>) const override {}
  [[nodiscard]] std::span<const sim::TruthField> truth_fields() const override { return {}; }
  void read_truth(std::span<double>) const override {}

 private:
  static constexpr std::array<std::string_view, 1> kNames{"body"};
  void update() { links_[0].X_WL.translation().x() = x_; }

  Duration span_;
  double rate_;
  double x_ = 1.0;
  SimTime time_{};
  int steps_ = 0;
  std::array<sim::LinkMotion, 1> links_{};
  std::optional<sim::NonFinite> failure_;
};

MachineCase decay_case(double rate = 1.0) {
  return {.machine = "decay",
          .level = "",
          .scene = "",
          .make = [=](double step_s) { return std::make_unique<Decay>(step_s, rate); },
          .drive = [](sim::Machine&, SimTime) {},
          .span = std::chrono::seconds(1)};
}

TEST(MachinePrecision, ErrorOfEulerOnADecayIsTheClosedForm) {
  const MachinePrecision found = measure_machine_precision(decay_case());
  // Extrapolated at 2e-5: error h^2 times less than 1.
  EXPECT_LT(found.reference_gap_m, 1e-9);
  int compared = 0;
  for (const MachinePrecisionRow& row : found.rows) {
    if (row.method != "linearly_implicit_euler" || !row.refusal.empty()) {
      continue;
    }
    const double n = std::round(1.0 / row.step_s);
    const double exact = std::exp(-1.0) - std::pow(1.0 - row.step_s, n);
    EXPECT_NEAR(row.final_error_m, exact, 1e-9) << row.step_s;
    EXPECT_NEAR(row.greatest_error_m, exact, 1e-9) << "t exp(-t) grows until 1 s";
    ++compared;
  }
  EXPECT_EQ(compared, 7);
}

TEST(MachinePrecision, OrderIsTheMethodsAndRoundingDoesNotCount) {
  const MachinePrecision found = measure_machine_precision(decay_case());
  EXPECT_NEAR(measured_order(found, "linearly_implicit_euler").value(), 1.0, 0.01);
  EXPECT_NEAR(measured_order(found, "extrapolated_2").value(), 2.0, 0.02);
  EXPECT_FALSE(measured_order(found, "no such method").has_value());
}

TEST(MachinePrecision, RefusedAndDivergedRowsStay) {
  MachinePrecisionSettings settings;
  settings.steps_s = {1e-3, 1e-2, 2e-2};
  settings.reference_step_s = 1e-4;
  // Explicit Euler at rate 1000 grows by a factor of 9 per 10 ms step.
  const MachinePrecision found = measure_machine_precision(decay_case(1000.0), settings);
  ASSERT_EQ(found.rows.size(), 6U);
  EXPECT_FALSE(found.rows[0].diverged);
  EXPECT_TRUE(found.rows[1].diverged);
  EXPECT_TRUE(std::isinf(found.rows[1].greatest_error_m));
  EXPECT_NE(found.rows[2].refusal.find("step_s"), std::string::npos);
}

TEST(MachinePrecision, JsonHasTheDocumentedKeysAndNoErrorWhereThereIsNone) {
  MachinePrecisionSettings settings;
  settings.steps_s = {1e-3, 1e-2, 2e-2};
  settings.reference_step_s = 1e-4;
  const MachineCase of = decay_case(1000.0);
  const nlohmann::json json = precision_json(of, measure_machine_precision(of, settings));
  for (const char* key :
       {"machine", "level", "scene", "stiffness_factor", "span_s", "gap_m", "order", "rows"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  ASSERT_EQ(json["rows"].size(), 6U);
  for (const char* key :
       {"method", "step_s", "diverged", "final_error_m", "greatest_error_m", "us_per_step"}) {
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  }
  EXPECT_TRUE(json["rows"][1]["diverged"].get<bool>());
  EXPECT_TRUE(json["rows"][1]["greatest_error_m"].is_null());
  EXPECT_TRUE(json["rows"][2].contains("refusal"));
  EXPECT_FALSE(json["rows"][2].contains("diverged"));
  EXPECT_TRUE(json["order"]["linearly_implicit_euler"].is_null()) << "one point has no slope";
}

TEST(MachinePrecision, DistanceOfTwoMachinesIsTheirModels) {
  MachineCase slow = decay_case(1.0);
  MachineCase fast = decay_case(2.0);
  const MachineDistance apart = machine_distance(slow, fast, 1e-3);
  EXPECT_NEAR(apart.final_m, std::exp(-1.0) - std::exp(-2.0), 1e-3);
  EXPECT_NEAR(apart.greatest_m, 0.25, 1e-3) << "at ln 2";
  EXPECT_EQ(machine_distance(slow, slow, 1e-3).greatest_m, 0.0);
  EXPECT_GE(machine_step_us(slow), 0.0);
}

TEST(MachinePrecision, SettingsThatMeasureNothingAreRefused) {
  MachinePrecisionSettings settings;
  settings.steps_s = {3e-3};
  EXPECT_THROW((void)measure_machine_precision(decay_case(), settings), std::invalid_argument);
  settings = {};
  settings.reference_step_s = 5e-5;
  EXPECT_THROW((void)measure_machine_precision(decay_case(), settings), std::invalid_argument)
      << "only half of the finest step";
  settings = {};
  MachineCase odd = decay_case();
  odd.span = std::chrono::milliseconds(1010);
  EXPECT_THROW((void)measure_machine_precision(odd, settings), std::invalid_argument);
  MachineCase shorter = decay_case();
  shorter.span = std::chrono::milliseconds(500);
  EXPECT_THROW((void)machine_distance(decay_case(), shorter, 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::bench
