// One case while it runs: what went over the wire, and whether what was expected was seen.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "conform/conformance_case.h"

namespace rigwire::conform {

class Trial {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  /// Its steps have the time of `clock`, from now on.
  explicit Trial(CaseIdentity identity, Clock clock = std::chrono::steady_clock::now);

  /// Exchanges of a case that are kept. A device that sends without end does not fill the memory
  /// and the report; what is left out is noted once.
  static constexpr std::size_t kKeptSteps = 20'000;
  static constexpr std::size_t kKeptBytes = 4U << 20U;
  static constexpr std::size_t kKeptStepBytes = 64U << 10U;

  void note(std::string words);
  void sent(std::span<const std::uint8_t> bytes, std::string words);
  void received(std::span<const std::uint8_t> bytes, std::string words);

  /// Checks a requirement that the case cites. The first that does not hold decides: fail, lenient
  /// or informational, by the strength of the case. Returns `holds`.
  bool expect(bool holds, std::string expected, std::string got);
  /// Checks what every answer has to fulfil: the case fails if it does not hold, whatever its
  /// strength. Returns `holds`.
  bool demand(bool holds, std::string expected, std::string got);
  /// Records a value that was seen; it is the result of an observed case.
  void observe(std::string value);
  /// Records that the case cannot be run here, although the claims said so.
  void not_applicable(std::string reason);
  /// Records a failure of the connection to the device.
  void broken(std::string reason);
  /// Records that the suite's time limit passed while the case ran, before anything had gone wrong.
  void not_reached(std::string reason);

  /// Nothing has gone wrong so far.
  [[nodiscard]] bool fine() const { return !found_; }
  [[nodiscard]] CaseResult result() const;

 protected:
  /// The case begins now, and not when it was made.
  void restart_clock() { began_ = clock_(); }

 private:
  void find(Verdict verdict, std::string expected, std::string got);
  void keep(Step::Kind kind, std::span<const std::uint8_t> bytes, std::string words);
  [[nodiscard]] std::chrono::nanoseconds since_begin() const { return clock_() - began_; }

  CaseIdentity identity_;
  Clock clock_;
  std::chrono::steady_clock::time_point began_;
  std::optional<Verdict> found_;
  std::string expected_;
  std::string got_;
  std::vector<std::string> all_;  ///< Expectations that held.
  std::vector<Step> steps_;
  std::size_t kept_bytes_ = 0;  ///< Bytes kept in the steps.
  bool left_out_ = false;       ///< Further steps are not kept, which is noted.
};

}  // namespace rigwire::conform
