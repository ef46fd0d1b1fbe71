// What becomes of a request to a run, whichever door it came through.
#pragma once

#include <string>

namespace rigwire::hil {

/// What was done, or why not.
struct Reply {
  enum class Outcome {
    done,
    wrong,    ///< The request is none.
    refused,  ///< Not now, or not with this run.
    ended,    ///< The run ended before.
  };
  Outcome outcome = Outcome::done;
  /// A JSON object: `ok`, `time_ns` (simulated, of the answer), `paused`, and what the verb tells;
  /// of what is not done `what`, and where known `path`, `found` and `allowed`.
  std::string json;
};

}  // namespace rigwire::hil
