// Values of a campaign's runs: closed forms, and Sobol's sequence against SciPy's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "child_process.h"
#include "fields/check.h"
#include "hil/campaign/design.h"
#include "hil/campaign/sobol.h"
#include "hil/campaign/spread.h"

namespace rigwire::hil {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

CampaignParameter spread(decltype(CampaignParameter::spread) spread) {
  return {std::move(spread), {"a.key"}};
}

Campaign campaign_of(CampaignDesign design, std::map<std::string, CampaignParameter> parameters,
                     std::uint32_t runs = 0) {
  Campaign campaign;
  campaign.rig = "rig";
  campaign.design = design;
  campaign.runs = runs;
  campaign.parameters = std::move(parameters);
  return campaign;
}

std::vector<double> column(const std::vector<PlannedRun>& runs, std::size_t parameter) {
  std::vector<double> numbers;
  for (const PlannedRun& run : runs) {
    numbers.push_back(std::stod(run.values[parameter].value()));
  }
  return numbers;
}

TEST(Spread, values_are_quantiles_with_the_unit_of_the_file) {
  EXPECT_EQ(value_at(spread(UniformSpread{"-2 deg", "6 deg"}), 0.25), "0 deg");
  EXPECT_EQ(value_at(spread(LogUniformSpread{"0.1 m", "10 m"}), 0.5), "1 m");
  EXPECT_EQ(value_at(spread(NormalSpread{"4", "2", "", ""}), 0.5), "4");
  EXPECT_EQ(value_at(spread(WeightedChoice{{"a", "b", "c"}, {1, 2, 1}}), 0.24), "a");
  EXPECT_EQ(value_at(spread(WeightedChoice{{"a", "b", "c"}, {1, 2, 1}}), 0.25), "b");
  EXPECT_EQ(value_at(spread(WeightedChoice{{"a", "b", "c"}, {1, 2, 1}}), 0.999), "c");
}

TEST(Spread, quantiles_of_the_normal_distribution_are_those_of_tables) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(normal_quantile(0.001), -3.090232306167813, 1e-11);
  EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-12);
}

TEST(Spread, a_normal_distribution_is_cut_off_where_it_is_told) {
  const CampaignParameter cut = spread(NormalSpread{"0 m", "1 m", "-0.5 m", "2 m"});
  EXPECT_NEAR(std::stod(value_at(cut, 0.0)), -0.5, 1e-8);
  EXPECT_NEAR(std::stod(value_at(cut, 1.0 - 1e-12)), 2.0, 1e-6);
}

TEST(Spread, a_range_has_its_end_when_steps_lead_there) {
  EXPECT_THAT(listed_values(spread(SteppedRange{"0 m", "0.3 m", "0.1 m"})).value(),
              ElementsAre("0 m", "0.1 m", "0.2 m", "0.3 m"));
  EXPECT_THAT(listed_values(spread(SteppedRange{"1", "2", "0.6"})).value(),
              ElementsAre("1", "1.6"));
}

TEST(Spread, what_spans_nothing_is_refused_by_key) {
  const auto refusal = [](const CampaignParameter& parameter) -> std::string {
    try {
      validate(parameter);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal(spread(UniformSpread{"2 m", "1 m"})), HasSubstr("to: found \"1 m\""));
  EXPECT_THAT(refusal(spread(UniformSpread{"1 m", "2 km"})), HasSubstr("allowed a number in m"));
  EXPECT_THAT(refusal(spread(UniformSpread{"much", "2"})), HasSubstr("from: found \"much\""));
  EXPECT_THAT(refusal(spread(LogUniformSpread{"0 m", "1 m"})), HasSubstr("above 0"));
  EXPECT_THAT(refusal(spread(SteppedRange{"0", "1", "0"})), HasSubstr("step: found \"0\""));
  EXPECT_THAT(refusal(spread(SteppedRange{"0", "1", "1e-9"})), HasSubstr("a million values"));
  EXPECT_THAT(refusal(spread(NormalSpread{"0", "1", "60", ""})), HasSubstr("above 60"));
  EXPECT_THAT(refusal(spread(WeightedChoice{{"a", "b"}, {1}})), HasSubstr("weights"));
  EXPECT_THAT(refusal(spread(ListedValues{})), HasSubstr("values"));
  EXPECT_EQ(refusal(spread(NormalSpread{"0", "1", "-1", "1"})), "");
}

TEST(Design, a_grid_has_every_value_with_every_other) {
  const auto runs =
      plan_runs(campaign_of(CampaignDesign::grid, {{"a", spread(ListedValues{{"1", "2"}})},
                                                   {"b", spread(ListedValues{{"x", "y", "z"}})}}));
  ASSERT_EQ(runs.size(), 6u);
  std::set<std::string> pairs;
  for (const PlannedRun& run : runs) {
    pairs.insert(*run.values[0] + *run.values[1]);
  }
  EXPECT_THAT(pairs, ElementsAre("1x", "1y", "1z", "2x", "2y", "2z"));
  EXPECT_EQ(*runs[1].values[1], "y") << "the last parameter changes first";
}

TEST(Design, one_at_a_time_begins_with_the_rig_as_it_is) {
  const auto runs =
      plan_runs(campaign_of(CampaignDesign::one_at_a_time, {{"a", spread(ListedValues{{"1", "2"}})},
                                                            {"b", spread(ListedValues{{"x"}})}}));
  ASSERT_EQ(runs.size(), 4u);
  EXPECT_EQ(runs[0].values, (std::vector<std::optional<std::string>>{std::nullopt, std::nullopt}));
  EXPECT_EQ(runs[2].values, (std::vector<std::optional<std::string>>{"2", std::nullopt}));
  EXPECT_EQ(runs[3].values, (std::vector<std::optional<std::string>>{std::nullopt, "x"}));
}

TEST(Design, a_latin_hypercube_has_each_layer_of_each_parameter_once) {
  constexpr std::size_t kRuns = 97;
  const auto runs = plan_runs(campaign_of(
      CampaignDesign::latin_hypercube,
      {{"a", spread(UniformSpread{"0", "97"})}, {"b", spread(UniformSpread{"0", "97"})}}, kRuns));
  std::vector<std::vector<double>> columns{column(runs, 0), column(runs, 1)};
  EXPECT_NE(columns[0], columns[1]);
  for (std::vector<double>& numbers : columns) {
    EXPECT_FALSE(std::ranges::is_sorted(numbers));
    std::ranges::sort(numbers);
    for (std::size_t layer = 0; layer < kRuns; ++layer) {
      EXPECT_EQ(std::floor(numbers[layer]), static_cast<double>(layer));
    }
  }
}

TEST(Design, sobol_points_are_evenly_spread_in_pairs_of_parameters) {
  constexpr std::size_t kRuns = 64;
  const auto runs = plan_runs(campaign_of(
      CampaignDesign::sobol,
      {{"a", spread(UniformSpread{"0", "8"})}, {"b", spread(UniformSpread{"0", "8"})}}, kRuns));
  // A (0, 6, 2)-net, shifted or not: one point in each of the 8 x 8 cells.
  std::set<std::pair<int, int>> cells;
  for (const PlannedRun& run : runs) {
    cells.emplace(static_cast<int>(std::stod(*run.values[0])),
                  static_cast<int>(std::stod(*run.values[1])));
  }
  EXPECT_EQ(cells.size(), kRuns);
}

TEST(Design, more_runs_continue_random_and_sobol) {
  for (const CampaignDesign design : std::array{CampaignDesign::random, CampaignDesign::sobol}) {
    const std::map<std::string, CampaignParameter> parameters{
        {"a", spread(UniformSpread{"0", "1"})}};
    const auto few = plan_runs(campaign_of(design, parameters, 8));
    const auto many = plan_runs(campaign_of(design, parameters, 32));
    for (std::size_t i = 0; i < few.size(); ++i) {
      EXPECT_EQ(few[i].values, many[i].values);
      EXPECT_EQ(few[i].seed, many[i].seed);
    }
  }
}

TEST(Design, another_parameter_beside_it_changes_no_value) {
  const auto alone = plan_runs(
      campaign_of(CampaignDesign::latin_hypercube, {{"b", spread(UniformSpread{"0", "1"})}}, 16));
  const auto beside = plan_runs(campaign_of(
      CampaignDesign::latin_hypercube,
      {{"a", spread(UniformSpread{"0", "1"})}, {"b", spread(UniformSpread{"0", "1"})}}, 16));
  EXPECT_EQ(column(alone, 0), column(beside, 1));
}

TEST(Design, seeds_differ_from_run_to_run_and_fit_into_53_bits) {
  std::set<std::uint64_t> seeds;
  for (const PlannedRun& run : plan_runs(
           campaign_of(CampaignDesign::random, {{"a", spread(UniformSpread{"0", "1"})}}, 10'000))) {
    seeds.insert(run.seed);
  }
  EXPECT_EQ(seeds.size(), 10'000u);
  EXPECT_LT(*seeds.rbegin(), std::uint64_t{1} << 53);
}

TEST(Design, a_grid_beyond_a_million_runs_is_refused) {
  const CampaignParameter thousand = spread(SteppedRange{"0", "1000", "1"});
  EXPECT_THROW(
      (void)plan_runs(campaign_of(CampaignDesign::grid, {{"a", thousand}, {"b", thousand}})),
      fields::Refused);
}

TEST(Sobol, coordinates_are_those_of_scipy) {
  namespace fs = std::filesystem;
  const fs::path output =
      fs::temp_directory_path() / ("rigwire-sobol-" + std::to_string(::getpid()));
  constexpr std::uint32_t kPoints = 1024;
  // SciPy's unscrambled points are whole multiples of 2^-30 (its own default of 30 bits).
  test::ChildProcess scipy({"/usr/bin/python3", "-c",
                            "from scipy.stats import qmc\n"
                            "for point in qmc.Sobol(21, scramble=False).random(1024):\n"
                            "  print(*(int(x * 2**30) for x in point))\n"},
                           output);
  ASSERT_EQ(scipy.wait(std::chrono::seconds{120}).value_or(-1), 0) << scipy.output();
  std::istringstream told(scipy.output());
  for (std::uint32_t point = 0; point < kPoints; ++point) {
    for (std::size_t dimension = 0; dimension < kSobolDimensions; ++dimension) {
      std::uint32_t theirs = 0;
      ASSERT_TRUE(told >> theirs);
      ASSERT_EQ(sobol_coordinate(dimension, point) >> 2, theirs)
          << "point " << point << " dimension " << dimension;
    }
  }
  fs::remove(output);
}

}  // namespace
}  // namespace rigwire::hil
