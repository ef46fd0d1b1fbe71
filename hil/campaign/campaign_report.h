// What came out of a campaign, for people: as text, and as one page without anything beside it.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "hil/campaign/collect.h"

namespace rigwire::hil {

/// Ends of the 95 % interval of a share of which `passed` of `all` were seen (E. B. Wilson, Journal
/// of the American Statistical Association 22 (1927)); 0 and 1 when none were.
struct ShareInterval {
  double lower = 0.0;
  double upper = 1.0;
};
[[nodiscard]] ShareInterval wilson_interval(std::size_t passed, std::size_t all);

/// Judged runs with a value of a parameter, or one of four classes of equal size of its numbers.
struct ValueClass {
  std::string parameter;
  std::string values;  ///< "2 .. 3.5 bar", or the word.
  std::size_t passed = 0;
  std::size_t judged = 0;
};
[[nodiscard]] std::vector<ValueClass> classes_of(const CampaignTable& table);

/// Failures with the same first event, the most frequent first.
struct FailureGroup {
  std::string criterion;  ///< Empty: crashed.
  std::string text;       ///< What crashed says, numbers as "#".
  std::vector<std::size_t> runs;
};
[[nodiscard]] std::vector<FailureGroup> failure_groups(const CampaignTable& table);

/// Runs that did not pass: crashed ones first, then those with most criteria failed, then by how
/// early. Ten at most.
[[nodiscard]] std::vector<const CampaignRow*> worst_runs(const CampaignTable& table);

/// The line that runs one again, elsewhere.
[[nodiscard]] std::string run_again(const CampaignPlan& plan, std::size_t index);

[[nodiscard]] std::string report_text(const CampaignTable& table);
/// With pictures: the drives from above, and the runs over two parameters that have numbers: those
/// named, else those by whose classes the pass rate differs most. Throws std::invalid_argument for
/// a parameter that is not there or has words.
[[nodiscard]] std::string report_page(const CampaignTable& table,
                                      const std::vector<std::string>& axes);

}  // namespace rigwire::hil
