// A truth that is nothing but time, for what governs a run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/executive/truth_source.h"

namespace rigwire::hil::test {

/// Its one quantity is the time in seconds.
class Clockwork final : public TruthSource {
 public:
  [[nodiscard]] Duration slice() const override { return std::chrono::milliseconds{2}; }
  std::optional<std::string> advance(const TruthRequests& /*requests*/,
                                     SampleBatch& batch) override {
    batch.clear();
    batch.from = frontier_;
    frontier_ += slice();
    batch.until = frontier_;
    batch.state = {to_seconds(frontier_)};
    return std::nullopt;
  }
  [[nodiscard]] const std::vector<StateQuantity>& state_quantities() const override {
    return quantities_;
  }
  [[nodiscard]] TruthStages stages() const override { return {}; }

 private:
  SimTime frontier_ = kStart;
  std::vector<StateQuantity> quantities_{{"angle", "rad"}};
};

}  // namespace rigwire::hil::test
