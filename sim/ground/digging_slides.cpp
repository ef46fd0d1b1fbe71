// The slides of DiggableTerrain.
#include <algorithm>
#include <array>

#include "sim/ground/diggable_terrain.h"

namespace rigwire::sim {
namespace {

// A slide of less is left lying, so that every slide ends: 0.1 mm.
constexpr std::int64_t kSlideLeast = 6871947;

struct Step {
  int column;
  int row;
};
constexpr std::array<Step, 8> kNeighbours{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {-1, 1}, {1, -1}}};

}  // namespace

void DiggableTerrain::push(std::size_t at) {
  if (queued_[at] == 0) {
    queued_[at] = 1;
    queue_[(queue_head_ + queue_length_) % queue_.size()] = static_cast<std::uint32_t>(at);
    ++queue_length_;
  }
}

void DiggableTerrain::disturb(std::size_t at) {
  push(at);
  const std::size_t column = at % columns_;
  const std::size_t row = at / columns_;
  for (const Step& step : kNeighbours) {
    const std::size_t c = column + static_cast<std::size_t>(step.column);
    const std::size_t r = row + static_cast<std::size_t>(step.row);
    if (inner(c, r)) {
      push(node(c, r));
    }
  }
}

void DiggableTerrain::settle() {
  for (std::size_t visit = 0; visit < parameters_.slide_visits && queue_length_ > 0; ++visit) {
    const std::size_t at = queue_[queue_head_];
    queue_head_ = (queue_head_ + 1) % queue_.size();
    --queue_length_;
    queued_[at] = 0;
    slide_from(at);
  }
}

void DiggableTerrain::slide_from(std::size_t at) {
  const std::size_t column = at % columns_;
  const std::size_t row = at / columns_;
  const SlopeLimits& repose = repose_[soil_[at]];
  std::array<std::size_t, 8> targets{};
  std::array<std::int64_t, 8> excess{};
  std::size_t count = 0;
  std::int64_t bank_excess = 0;
  for (const Step& step : kNeighbours) {
    const std::size_t c = column + static_cast<std::size_t>(step.column);
    const std::size_t r = row + static_cast<std::size_t>(step.row);
    if (!inner(c, r)) {
      continue;
    }
    // Over the repose slope of this soil (loose) and over the bank's slope (firm), per neighbour.
    const bool diagonal = step.column != 0 && step.row != 0;
    const std::int64_t drop = surface_[at] - surface_[node(c, r)];
    const std::int64_t over = drop - (diagonal ? repose.diagonal : repose.straight);
    if (over > kSlideLeast) {
      targets[count] = node(c, r);
      excess[count++] = over;
      bank_excess = std::max(bank_excess, drop - (diagonal ? bank_.diagonal : bank_.straight));
    }
  }
  if (count == 0) {
    return;
  }
  if (bank_excess > loose_[at]) {  // The firm soil under the loose stands too steep: it breaks.
    const std::int64_t firm = surface_[at] - loose_[at] - rock_[at];
    loose_[at] += std::clamp<std::int64_t>(firm, 0, bank_excess - loose_[at]);
  }
  // Each takes its part of the drop such that the node and one alone would just come to rest.
  const auto parts = static_cast<std::int64_t>(count) + 1;
  std::int64_t wanted = 0;
  for (std::size_t i = 0; i < count; ++i) {
    wanted += excess[i] / parts;
  }
  const double scale =
      wanted > loose_[at] ? static_cast<double>(loose_[at]) / static_cast<double>(wanted) : 1.0;
  std::int64_t moved = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t part = excess[i] / parts;
    const auto amount =
        std::min(static_cast<std::int64_t>(scale * static_cast<double>(part)), loose_[at]);
    if (amount <= 0) {
      continue;
    }
    loose_[at] -= amount;
    loose_[targets[i]] += amount;
    change(targets[i], surface_[targets[i]] + amount);
    moved += amount;
  }
  // A rest of less than a slide's least is not worth another visit.
  if (moved > 0) {
    change(at, surface_[at] - moved);
  }
  if (moved > kSlideLeast / 16) {
    disturb(at);
  }
}

}  // namespace rigwire::sim
