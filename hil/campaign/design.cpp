#include "hil/campaign/design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "fields/check.h"
#include "hil/campaign/sobol.h"
#include "hil/campaign/spread.h"
#include "sim/random.h"

namespace rigwire::hil {

namespace {

constexpr std::size_t kMostRuns = 1'000'000;

using Values = std::vector<std::optional<std::string>>;
/// One of each parameter.
using Columns = std::vector<std::vector<std::string>>;

std::vector<Values> grid(const Columns& columns) {
  std::size_t runs = 1;
  for (const auto& column : columns) {
    runs *= column.size();
    fields::require(runs <= kMostRuns, "design", "a grid of more runs", "1000000 at most");
  }
  std::vector<Values> rows(runs);
  for (std::size_t run = 0; run < runs; ++run) {
    // The last parameter changes from run to run.
    std::size_t rest = run;
    rows[run].resize(columns.size());
    for (std::size_t i = columns.size(); i-- > 0; rest /= columns[i].size()) {
      rows[run][i] = columns[i][rest % columns[i].size()];
    }
  }
  return rows;
}

std::vector<Values> one_at_a_time(const Columns& columns) {
  std::vector<Values> rows{Values(columns.size())};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (const std::string& value : columns[i]) {
      rows.emplace_back(columns.size())[i] = value;
    }
  }
  fields::require(rows.size() <= kMostRuns, "design", std::to_string(rows.size()) + " runs",
                  "1000000 at most");
  return rows;
}

std::vector<double> random_places(std::size_t runs, std::uint64_t seed, const std::string& name) {
  sim::RandomStream stream(seed, "parameter " + name);
  std::vector<double> places(runs);
  for (double& place : places) {
    place = stream.uniform();
  }
  return places;
}

/// A random permutation of the layers (Fisher and Yates), a random place in each (M. D. McKay,
/// R. J. Beckman, W. J. Conover, Technometrics 21(2), 1979).
std::vector<double> layered_places(std::size_t runs, std::uint64_t seed, const std::string& name) {
  sim::RandomStream stream(seed, "parameter " + name);
  std::vector<std::size_t> layers(runs);
  std::iota(layers.begin(), layers.end(), std::size_t{0});
  const auto count = static_cast<double>(runs);
  for (std::size_t i = runs; i > 1; --i) {
    std::swap(layers[i - 1],
              layers[static_cast<std::size_t>(stream.uniform() * static_cast<double>(i))]);
  }
  std::vector<double> places(runs);
  for (std::size_t run = 0; run < runs; ++run) {
    places[run] = std::min((static_cast<double>(layers[run]) + stream.uniform()) / count,
                           std::nextafter(1.0, 0.0));
  }
  return places;
}

/// A random digital shift keeps how evenly the points lie, and makes none of them a corner
/// (R. Cranley, T. N. L. Patterson, 1976, in base 2).
std::vector<double> sobol_places(std::size_t runs, std::uint64_t seed, const std::string& name,
                                 std::size_t dimension) {
  sim::RandomStream stream(seed, "parameter " + name);
  const auto shift = static_cast<std::uint32_t>(stream.bits() >> 32);
  constexpr double kUnit = 1.0 / 4294967296.0;
  std::vector<double> places(runs);
  for (std::size_t run = 0; run < runs; ++run) {
    const std::uint32_t point = sobol_coordinate(dimension, static_cast<std::uint32_t>(run));
    places[run] = (static_cast<double>(point ^ shift) + 0.5) * kUnit;
  }
  return places;
}

std::vector<Values> sampled(const Campaign& campaign) {
  const std::size_t runs = campaign.runs;
  std::vector<Values> rows(runs, Values(campaign.parameters.size()));
  std::size_t dimension = 0;
  for (const auto& [name, parameter] : campaign.parameters) {
    const std::vector<double> places = campaign.design == CampaignDesign::random
                                           ? random_places(runs, campaign.seed, name)
                                       : campaign.design == CampaignDesign::sobol
                                           ? sobol_places(runs, campaign.seed, name, dimension)
                                           : layered_places(runs, campaign.seed, name);
    const auto list = listed_values(parameter);
    for (std::size_t run = 0; run < runs; ++run) {
      rows[run][dimension] =
          list ? element_at(*list, places[run]) : value_at(parameter, places[run]);
    }
    ++dimension;
  }
  return rows;
}

}  // namespace

std::vector<PlannedRun> plan_runs(const Campaign& campaign) {
  fields::require(
      campaign.design != CampaignDesign::sobol || campaign.parameters.size() <= kSobolDimensions,
      "parameters", std::to_string(campaign.parameters.size()),
      fmt::format("{} at most with design: sobol", kSobolDimensions));
  std::vector<Values> rows;
  if (is_sampled(campaign.design)) {
    rows = sampled(campaign);
  } else {
    Columns columns;
    for (const auto& [name, parameter] : campaign.parameters) {
      columns.push_back(listed_values(parameter).value());
    }
    rows = campaign.design == CampaignDesign::grid ? grid(columns) : one_at_a_time(columns);
  }
  std::vector<PlannedRun> runs;
  for (Values& values : rows) {
    const std::size_t index = runs.size();
    sim::RandomStream stream(campaign.seed, fmt::format("run {}", index));
    runs.push_back({index, stream.bits() >> 11, std::move(values)});
  }
  return runs;
}

}  // namespace rigwire::hil
