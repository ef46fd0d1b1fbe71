// What one check of a suite is, and what came of it. A suite is a table of cases; each is a
// citation (document, section), a thing to do, and what must, should or may be seen.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::conform {

/// Strength of the requirement that a case cites.
enum class Strength : std::uint8_t {
  must,     ///< Fails if it does not hold.
  should,   ///< Lenient if it does not hold.
  observed  ///< Nothing is required: the value seen is reported.
};

/// What a case does to the device.
enum class Danger : std::uint8_t {
  none,    ///< Reads, or asks for what has to be refused.
  writes,  ///< Changes what the profile says may be changed, and puts it back.
  moves    ///< A machine may move by it, or a device be left that has to be switched off and on.
};

/// Short names for the rows of the suites.
inline constexpr auto kMust = Strength::must;
inline constexpr auto kShould = Strength::should;
inline constexpr auto kObserved = Strength::observed;
inline constexpr auto kNone = Danger::none;
inline constexpr auto kWrites = Danger::writes;

enum class Verdict : std::uint8_t {
  pass,
  lenient,  ///< Accepted or answered otherwise than the document recommends.
  fail,
  informational,   ///< A value was observed.
  not_applicable,  ///< The device does not claim what the case needs.
  skipped,         ///< Not asked for: too dangerous without an option.
  error,           ///< The tool or the way to the device, not the device.
  not_reached      ///< The suite's limit of time had passed: nothing is known.
};

[[nodiscard]] std::string_view word(Strength strength);
[[nodiscard]] std::string_view word(Danger danger);
[[nodiscard]] std::string_view word(Verdict verdict);

/// Identity of a case. `id` is a citation: suite, section, number: "modbus/6.3/4".
struct CaseIdentity {
  std::string id;
  std::string title;
  std::string source;  ///< Document, revision and section.
  Strength strength = Strength::must;
  Danger danger = Danger::none;
};

/// Gives the cases of a suite their identities, numbered within each chapter in the order of the
/// calls: "modbus/6.3/1", "modbus/6.3/2".
class Citations {
 public:
  Citations(std::string suite, std::string document);

  /// Returns the identity of the next case of a section, which is its chapter; its source is the
  /// document and the section.
  [[nodiscard]] CaseIdentity next(const std::string& section, std::string title,
                                  Strength strength = Strength::must, Danger danger = Danger::none);
  /// Returns the identity of the next case of a chapter that the document does not have.
  [[nodiscard]] CaseIdentity next_in(const std::string& chapter, std::string title,
                                     std::string source, Strength strength = Strength::must,
                                     Danger danger = Danger::none);

 private:
  std::string suite_;
  std::string document_;
  std::map<std::string, int> numbers_;  ///< Last number given, by chapter.
};

/// One message on the wire, or a note.
struct Step {
  enum class Kind : std::uint8_t { sent, received, note };
  Kind kind = Kind::note;
  std::chrono::nanoseconds at{};  ///< From the begin of the case.
  std::vector<std::uint8_t> bytes;
  std::string words;  ///< The fields of the bytes by name, or the note.
};

struct CaseResult {
  CaseIdentity identity;
  Verdict verdict = Verdict::pass;
  std::string expected;  ///< First expectation that did not hold; if passed, all expectations.
  std::string got;       ///< What was found instead, or observed, or why the case was skipped.
  std::vector<Step> steps;
};

/// Result of a run of a suite, in the order of its table.
struct SuiteResult {
  std::string suite;
  std::string endpoint;
  std::string profile_hash;  ///< Hash of the claims as they were read.
  std::vector<CaseResult> cases;

  [[nodiscard]] std::size_t count(Verdict verdict) const;
};

/// Whether `id` is asked for: any of `wanted` is it or a prefix of it at a slash; all without any.
[[nodiscard]] bool is_wanted(std::string_view id, const std::vector<std::string>& wanted);

/// "0A 1B", the first `most` of them.
[[nodiscard]] std::string hex_text(const std::vector<std::uint8_t>& bytes, std::size_t most = 64);

}  // namespace rigwire::conform
