// Limits of a suite against a device that sends without end, or that never answers: how long the
// suite takes, how long a question waits, and how much is kept of what comes.
//
// Lines of bytes, buses and UDP ports that a suite opens are wrapped here (bounded()), so that no
// case has to look after it:
//
//   - A deadline is an instant. Behind it a question still takes what already waited in the
//     system's queue, since this machine may have been slow, and never more than that queue holds.
//   - What comes between one question and the next has a limit; beyond it the case ends, and fails
//     (TooMuch).
//   - Where this machine woke the suite up late, a case that did not pass is tried again
//   (try_case):
//     a device's time-out that expired meanwhile says nothing about the device.
//   - Behind the suite's limit no case begins. The case that runs then has kGrace to end and to put
//     back what it changed; then it is cut off (TimeIsUp).
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "conform/byte_line.h"
#include "conform/can_line.h"
#include "conform/conformance_case.h"
#include "conform/datagram_line.h"
#include "conform/endpoint.h"

namespace rigwire::conform {

/// A limit of this file was reached: says which and its value.
class BoundReached : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// The suite's limit of time.
class TimeIsUp : public BoundReached {
 public:
  using BoundReached::BoundReached;
};
/// The limit of what may come between two questions.
class TooMuch : public BoundReached {
 public:
  TooMuch(std::string allowed, const std::string& found)
      : BoundReached(found), allowed_(std::move(allowed)) {}
  [[nodiscard]] const std::string& allowed() const { return allowed_; }

 private:
  std::string allowed_;
};

/// Time of one suite, by the clock of its lines and by this machine's: the clock that has advanced
/// further counts, so that a device whose emulated time does not advance is bounded, too.
class Bounds {
 public:
  using Instant = std::chrono::steady_clock::time_point;
  /// Time from the limit until the running case is cut off.
  static constexpr std::chrono::seconds kGrace{10};

  explicit Bounds(std::chrono::nanoseconds limit = std::chrono::hours{24}) : limit_(limit) {}

  [[nodiscard]] std::chrono::nanoseconds limit() const { return limit_; }
  /// Starts the suite's time; the lines' clock starts with the next check().
  void begin();
  /// Starts a case: what came before is not counted against it.
  void begin_case() {
    ++case_;
    held_up_ = {};
  }
  /// Number of the case, from 0.
  [[nodiscard]] std::uint64_t current_case() const { return case_; }
  /// Takes how long after its deadline a question returned.
  void returned_late(std::chrono::nanoseconds late) { held_up_ = std::max(held_up_, late); }
  /// Longest of these delays in the current case.
  [[nodiscard]] std::chrono::nanoseconds held_up() const { return held_up_; }
  /// Checks with `now` of a line's clock. Throws TimeIsUp when limit and kGrace have passed.
  void check(Instant now);
  /// Checks by this machine's clock alone, before a line is open. Throws TimeIsUp as above.
  void check() const;
  /// Whether the limit has passed, so that no further case begins.
  [[nodiscard]] bool passed() const { return elapsed() > limit_; }
  /// "the suite's limit of 600 s has passed".
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] std::chrono::nanoseconds elapsed() const;

  std::chrono::nanoseconds limit_;
  Instant wall_begin_ = std::chrono::steady_clock::now();
  std::optional<Instant> line_begin_;
  std::chrono::nanoseconds line_elapsed_{};
  std::uint64_t case_ = 0;
  std::chrono::nanoseconds held_up_{};
};

/// What may come over a line between two questions, as costs: its bytes, and kItem_bytes for each
/// frame or datagram.
struct LineLimits {
  std::size_t question = 0;  ///< Between two questions, or from the begin of a case.
  std::size_t behind = 0;    ///< Behind a deadline: what the system's queue may hold.
};
inline constexpr std::size_t kItem_bytes = 64;
/// Limits of a line of bytes: 40 s of one of 921600 baud.
inline constexpr LineLimits kByteLimits{4U << 20U, 64U << 10U};
/// Limits of a bus: half a million frames, a minute of a full bus of 1 Mbit/s.
inline constexpr LineLimits kFrameLimits{500'000 * kItem_bytes, 4096 * kItem_bytes};
/// Limits of a UDP port: two seconds of a full network of 1 Gbit/s.
inline constexpr LineLimits kDatagramLimits{256U << 20U, 16U << 20U};

/// Each of these keeps `bounds`, and has the line's own clock. Preconditions: neither is null.
[[nodiscard]] std::unique_ptr<ByteLine> bounded(std::unique_ptr<ByteLine> line,
                                                std::shared_ptr<Bounds> bounds);
[[nodiscard]] std::unique_ptr<CanLine> bounded(std::unique_ptr<CanLine> line,
                                               std::shared_ptr<Bounds> bounds);
[[nodiscard]] std::unique_ptr<DatagramLine> bounded(std::unique_ptr<DatagramLine> line,
                                                    std::shared_ptr<Bounds> bounds);

/// What has waited is dropped for at most this long, however much comes.
inline constexpr std::chrono::milliseconds kDrain{500};

/// The result of a case that did not begin.
[[nodiscard]] CaseResult not_reached(const CaseIdentity& identity, const Bounds& bounds);

/// Tries a case once within the bounds (try_case).
template <class Make, class Run>
[[nodiscard]] CaseResult try_once(const CaseIdentity& identity, Bounds& bounds, const Make& make,
                                  const Run& run) {
  bounds.begin_case();
  try {
    auto trial = make();
    try {
      run(trial);
    } catch (const Unreachable& lost) {
      trial.broken(lost.what());
    } catch (const TooMuch& flood) {
      trial.demand(false, flood.allowed(), flood.what());
    } catch (const TimeIsUp& late) {
      trial.not_reached(late.what());
    }
    return trial.result();
  } catch (const Unreachable& lost) {
    return {identity, Verdict::error, "", lost.what(), {}};
  } catch (const TooMuch& flood) {
    return {identity, Verdict::fail, flood.allowed(), flood.what(), {}};
  } catch (const TimeIsUp&) {
    return not_reached(identity, bounds);
  }
}

/// A suite that woke up this much after a deadline was held up by its machine.
inline constexpr std::chrono::milliseconds kHeldUp{40};
/// How often a case is tried at most.
inline constexpr int kMaxTries = 3;

/// Whether the case did not pass in a try in which the suite was held up.
[[nodiscard]] bool proves_nothing(const CaseResult& result, const Bounds& bounds);
/// Adds to the result, at its begin, that the tries before it proved nothing.
void note_tries(CaseResult& result, int tries, std::chrono::nanoseconds held_up);

/// Tries a case within the bounds. `make` returns its trial, and `run` is given it. What is lost or
/// too much is in the result; nothing of it is thrown. A try that proves nothing is followed by
/// another one, as long as the bounds and kMaxTries allow.
template <class Make, class Run>
[[nodiscard]] CaseResult try_case(const CaseIdentity& identity, Bounds& bounds, const Make& make,
                                  const Run& run) {
  if (bounds.passed()) {
    return not_reached(identity, bounds);
  }
  CaseResult result = try_once(identity, bounds, make, run);
  for (int tries = 1; tries < kMaxTries && !bounds.passed() && proves_nothing(result, bounds);
       ++tries) {
    const auto held_up = bounds.held_up();
    result = try_once(identity, bounds, make, run);
    note_tries(result, tries, held_up);
  }
  return result;
}

/// Does what comes before a suite's first case. A limit that is reached there is found by the
/// cases.
template <class Prepare>
void prepare_suite(const Prepare& prepare) {
  try {
    prepare();
  } catch (const BoundReached&) {
    return;
  }
}

}  // namespace rigwire::conform
