// The result of a request to a run, whatever its origin.
#pragma once

#include <string>

namespace rigwire::hil {

/// A request's outcome, with its answer or the reason of a refusal.
struct Reply {
  enum class Outcome {
    done,
    wrong,    ///< The request is malformed.
    refused,  ///< Not now, or not with this run.
    ended,    ///< The run ended before.
  };
  Outcome outcome = Outcome::done;
  /// A JSON object: `ok`, `time_ns` (simulated, of the answer), `paused`, and the verb's result; of
  /// a refusal `what`, and where known `path`, `found` and `allowed`.
  std::string json;
};

}  // namespace rigwire::hil
