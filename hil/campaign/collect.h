// The rows of a campaign, from its folders, and the tables that are made of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/campaign/campaign_folder.h"
#include "hil/campaign/judge.h"

namespace rigwire::hil {

enum class Outcome {
  passed,
  failed,
  crashed,     ///< Was not judged; `what` says why.
  unfinished,  ///< Has a folder and neither result nor DONE: it runs, or was killed.
  missing,     ///< Was never begun.
};
inline constexpr std::array<std::string_view, 5> kOutcomes{"passed", "failed", "crashed",
                                                           "unfinished", "missing"};

/// One run, whatever became of it.
struct CampaignRow {
  std::size_t index = 0;
  std::uint64_t seed = 0;
  std::vector<std::string> values;  ///< In the order of CampaignPlan::parameters, as text.
  Outcome outcome = Outcome::missing;
  std::string what;
  std::optional<std::string> first_failure;  ///< A criterion.
  std::map<std::string, Verdict> verdicts;
  std::optional<double> sim_s;
  std::vector<std::array<double, 3>> track;  ///< Judgement::track
};

struct CampaignTable {
  CampaignPlan plan;
  std::vector<CampaignRow> rows;  ///< One for each run of the plan, by index.
  [[nodiscard]] std::size_t count(Outcome outcome) const;
};

/// Throws std::invalid_argument for a folder without plan or table. A result that cannot be read is
/// a row that crashed.
[[nodiscard]] CampaignTable read_rows(const std::filesystem::path& folder);

/// A value as SQLite and axes have it: its number, and the unit apart. Nothing: it is a word.
struct NumericValue {
  double number = 0.0;
  std::string unit;
};
[[nodiscard]] std::optional<NumericValue> numeric(const std::string& value);

/// FOLDER/results.csv and FOLDER/results.sqlite, made anew and put in place whole. SQLite's tables:
/// runs (run, seed, outcome, what, first_failure, sim_s, and each parameter by its name, numbers
/// without unit), criteria (run, name, passed, at_s, text, detail), parameters (name, unit). Throws
/// drivers::EndpointError.
void write_tables(const std::filesystem::path& folder, const CampaignTable& table);

}  // namespace rigwire::hil
