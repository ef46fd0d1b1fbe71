// What the tests of all suites ask of a result, and of a suite's table.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "conform/conformance_case.h"

namespace rigwire::conform {

inline bool is_wrong(const CaseResult& result) {
  return result.verdict == Verdict::fail || result.verdict == Verdict::lenient ||
         result.verdict == Verdict::error;
}

/// Identities of the cases that do not pass.
inline std::vector<std::string> wrong_ids(const SuiteResult& result) {
  std::vector<std::string> wrong;
  for (const CaseResult& each : result.cases) {
    if (is_wrong(each)) {
      wrong.push_back(each.identity.id);
    }
  }
  return wrong;
}

/// Identity and title of the cases that do not pass, with what was expected and seen.
inline std::vector<std::string> wrong_in(const SuiteResult& result) {
  std::vector<std::string> wrong;
  for (const CaseResult& each : result.cases) {
    if (is_wrong(each)) {
      wrong.push_back(each.identity.id + " " + each.identity.title + ": expected " + each.expected +
                      ", got " + each.got);
    }
  }
  return wrong;
}

/// Each case has an identity of its own and a source; at least so many.
template <class Cases>
void expect_identities(const Cases& cases, std::size_t least) {
  std::set<std::string> ids;
  for (const auto& each : cases) {
    EXPECT_TRUE(ids.insert(each.identity.id).second) << each.identity.id;
    EXPECT_FALSE(each.identity.source.empty()) << each.identity.id;
  }
  EXPECT_GE(ids.size(), least);
}

}  // namespace rigwire::conform
