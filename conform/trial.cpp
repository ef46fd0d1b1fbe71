#include "conform/trial.h"

#include <algorithm>
#include <utility>

namespace rigwire::conform {

Trial::Trial(CaseIdentity identity, Clock clock)
    : identity_(std::move(identity)), clock_(std::move(clock)), began_(clock_()) {}

void Trial::keep(Step::Kind kind, std::span<const std::uint8_t> bytes, std::string words) {
  if (left_out_) {
    return;
  }
  if (steps_.size() >= kKeptSteps || kept_bytes_ >= kKeptBytes) {
    left_out_ = true;
    steps_.push_back({Step::Kind::note, since_begin(), {}, "further exchanges are not kept"});
    return;
  }
  if (bytes.size() > kKeptStepBytes) {
    words += " (the first " + std::to_string(kKeptStepBytes) + " of " +
             std::to_string(bytes.size()) + " bytes)";
    bytes = bytes.first(kKeptStepBytes);
  }
  kept_bytes_ += bytes.size();
  steps_.push_back({kind, since_begin(), {bytes.begin(), bytes.end()}, std::move(words)});
}

void Trial::note(std::string words) {
  keep(Step::Kind::note, {}, std::move(words));
}

void Trial::sent(std::span<const std::uint8_t> bytes, std::string words) {
  keep(Step::Kind::sent, bytes, std::move(words));
}

void Trial::received(std::span<const std::uint8_t> bytes, std::string words) {
  keep(Step::Kind::received, bytes, std::move(words));
}

void Trial::find(Verdict verdict, std::string expected, std::string got) {
  if (!found_) {
    found_ = verdict;
    expected_ = std::move(expected);
    got_ = std::move(got);
  }
}

bool Trial::expect(bool holds, std::string expected, std::string got) {
  if (holds) {
    if (std::ranges::find(all_, expected) == all_.end()) {
      all_.push_back(std::move(expected));
    }
    return true;
  }
  switch (identity_.strength) {
    case Strength::must:
      find(Verdict::fail, std::move(expected), std::move(got));
      break;
    case Strength::should:
      find(Verdict::lenient, std::move(expected), std::move(got));
      break;
    case Strength::observed:
      find(Verdict::informational, std::move(expected), std::move(got));
      break;
  }
  return false;
}

bool Trial::demand(bool holds, std::string expected, std::string got) {
  if (!holds) {
    find(Verdict::fail, std::move(expected), std::move(got));
  }
  return holds;
}

void Trial::observe(std::string value) {
  got_ = std::move(value);
  if (!found_ && identity_.strength == Strength::observed) {
    found_ = Verdict::informational;
  }
}

void Trial::not_applicable(std::string reason) {
  find(Verdict::not_applicable, "", std::move(reason));
}

void Trial::broken(std::string reason) {
  find(Verdict::error, "", std::move(reason));
}

void Trial::not_reached(std::string reason) {
  find(Verdict::not_reached, "", std::move(reason));
}

CaseResult Trial::result() const {
  CaseResult result{identity_, found_.value_or(Verdict::pass), expected_, got_, steps_};
  if (!found_) {
    for (const std::string& held : all_) {
      result.expected += (result.expected.empty() ? "" : "; ") + held;
    }
  }
  return result;
}

}  // namespace rigwire::conform
