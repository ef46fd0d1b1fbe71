// Numbers that were recorded from time to time, as functions of time: linear in between, states
// (a gear) as they were before. Before the first and after the last record as those.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/samples/time.h"

namespace rigwire::sim {

class RecordedNumbers {
 public:
  RecordedNumbers() = default;
  /// For each number whether it is a state.
  explicit RecordedNumbers(std::vector<bool> steps) : steps_(std::move(steps)) {}

  /// Instants must rise; as many numbers as there are.
  void add(SimTime time, std::span<const double> numbers);
  [[nodiscard]] bool empty() const { return times_.empty(); }
  [[nodiscard]] std::size_t width() const { return steps_.size(); }
  /// Preconditions: not empty; as many places as numbers.
  void read(SimTime time, std::span<double> numbers) const;

 private:
  std::vector<bool> steps_;
  std::vector<SimTime> times_;
  std::vector<double> rows_;
};

}  // namespace rigwire::sim
