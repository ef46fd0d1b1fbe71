// Where samples come from: the simulated world, a recording, or another simulator. The executive
// and the emulators work alike with all of them.
//
// One thread at a time calls advance(): when paced the truth thread, and before that starts the
// caller's for the first lead; when free-running the wire thread. The caller owns requests and
// batches. After a fault advance() is not called again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/executive/shelves.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// All samples of one slice of simulated time. Reused from slice to slice so that its memory is
/// taken once.
struct SampleBatch {
  SimTime from{};
  SimTime
      until{};  ///< Samples lie in (from, until]; those of the very first slice in [from, until].
  Shelves samples;            ///< By station and type, on each shelf in order of time.
  std::vector<double> state;  ///< At `until`, in the order of TruthSource::state_quantities().

  void clear() {
    samples.clear();
    state.clear();
  }
};

/// What flows from the stations back to the truth: changed sample plans (SamplePlan) and what the
/// device commands, in the order in which a station asked.
using TruthRequests = Shelves;

/// One number of the machine's state for the status table.
struct StateQuantity {
  std::string name;
  std::string unit;
};

/// CPU seconds that the truth has spent, by stage.
struct TruthStages {
  double physics_s = 0.0;
  double ray_casting_s = 0.0;
  double sensors_s = 0.0;
};

class TruthSource {
 public:
  virtual ~TruthSource() = default;

  /// Called once, before the first advance(). `paced`: simulated time follows a clock; truth then
  /// waits for nothing that is computed beside it.
  virtual void begin(bool /*paced*/) {}

  /// Returns the length of one slice, in which truth is produced.
  [[nodiscard]] virtual Duration slice() const = 0;

  /// Takes the requests (they act from the present frontier on), then produces one more slice.
  /// Returns the text of a fault when truth can go no further (a state that is no number), else
  /// nullopt.
  virtual std::optional<std::string> advance(const TruthRequests& requests, SampleBatch& batch) = 0;

  /// What SampleBatch::state holds.
  [[nodiscard]] virtual const std::vector<StateQuantity>& state_quantities() const = 0;

  /// Read after the run.
  [[nodiscard]] virtual TruthStages stages() const = 0;
};

}  // namespace rigwire::hil
