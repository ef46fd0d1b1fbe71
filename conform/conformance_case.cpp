#include "conform/conformance_case.h"

#include <algorithm>
#include <array>

namespace rigwire::conform {

std::string_view word(Strength strength) {
  constexpr std::array<std::string_view, 3> kWords{"must", "should", "observed"};
  return kWords[static_cast<std::size_t>(strength)];
}

std::string_view word(Danger danger) {
  constexpr std::array<std::string_view, 3> kWords{"none", "writes", "moves"};
  return kWords[static_cast<std::size_t>(danger)];
}

std::string_view word(Verdict verdict) {
  constexpr std::array<std::string_view, 8> kWords{"pass",          "lenient",        "fail",
                                                   "informational", "not applicable", "skipped",
                                                   "error",         "not reached"};
  return kWords[static_cast<std::size_t>(verdict)];
}

std::size_t SuiteResult::count(Verdict verdict) const {
  return static_cast<std::size_t>(std::ranges::count(cases, verdict, &CaseResult::verdict));
}

Citations::Citations(std::string suite, std::string document)
    : suite_(std::move(suite)), document_(std::move(document)) {}

CaseIdentity Citations::next(const std::string& section, std::string title, Strength strength,
                             Danger danger) {
  return next_in(section, std::move(title), document_ + ", " + section, strength, danger);
}

CaseIdentity Citations::next_in(const std::string& chapter, std::string title, std::string source,
                                Strength strength, Danger danger) {
  const int number = ++numbers_[chapter];
  return {suite_ + "/" + chapter + "/" + std::to_string(number), std::move(title),
          std::move(source), strength, danger};
}

bool is_wanted(std::string_view id, const std::vector<std::string>& wanted) {
  return wanted.empty() || std::ranges::any_of(wanted, [&](const std::string& prefix) {
           return id.starts_with(prefix) &&
                  (id.size() == prefix.size() || prefix.ends_with('/') || id[prefix.size()] == '/');
         });
}

std::string hex_text(const std::vector<std::uint8_t>& bytes, std::size_t most) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (std::size_t i = 0; i < std::min(bytes.size(), most); ++i) {
    text += text.empty() ? "" : " ";
    text += kDigits[bytes[i] >> 4U];
    text += kDigits[bytes[i] & 0xFU];
  }
  if (bytes.size() > most) {
    text += " ... (" + std::to_string(bytes.size()) + " bytes)";
  }
  return text;
}

}  // namespace rigwire::conform
