#include "sim/replay/recorded_numbers.h"

#include <algorithm>
#include <cassert>

namespace rigwire::sim {

void RecordedNumbers::add(SimTime time, std::span<const double> numbers) {
  assert(numbers.size() == width() && (times_.empty() || times_.back() < time));
  times_.push_back(time);
  rows_.insert(rows_.end(), numbers.begin(), numbers.end());
}

void RecordedNumbers::read(SimTime time, std::span<double> numbers) const {
  assert(!empty() && numbers.size() == width());
  const auto next = std::upper_bound(times_.begin(), times_.end(), time);
  const auto upper = static_cast<std::size_t>(next - times_.begin());
  const std::size_t before = upper == 0 ? 0 : upper - 1;
  const std::size_t after = std::min(upper, times_.size() - 1);
  const double share = before == after ? 0.0
                                       : to_seconds(time - times_[before]) /
                                             to_seconds(times_[after] - times_[before]);
  for (std::size_t i = 0; i < width(); ++i) {
    const double a = rows_[before * width() + i];
    const double b = rows_[after * width() + i];
    numbers[i] = steps_[i] || share == 0.0 ? a : (1.0 - share) * a + share * b;
  }
}

}  // namespace rigwire::sim
