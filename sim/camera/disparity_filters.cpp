#include "sim/camera/disparity_filters.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "sim/samples/wide_vectors.h"

namespace rigwire::sim {
namespace {

inline __attribute__((always_inline)) std::int16_t lower_step(std::int16_t a, std::int16_t b) {
  return a < b ? a : b;
}
inline __attribute__((always_inline)) std::int16_t higher_step(std::int16_t a, std::int16_t b) {
  return a < b ? b : a;
}
inline __attribute__((always_inline)) std::int16_t middle_step(std::int16_t a, std::int16_t b,
                                                               std::int16_t c) {
  return higher_step(lower_step(a, b), lower_step(higher_step(a, b), c));
}

/// Sorts the three pixels of each column.
RIGWIRE_WIDE_VECTORS void sort_columns(const std::int16_t* above, const std::int16_t* row,
                                       const std::int16_t* below, int width, std::int16_t* low,
                                       std::int16_t* middle, std::int16_t* high) {
#pragma GCC ivdep
  for (int x = 0; x < width; ++x) {
    low[x] = lower_step(lower_step(above[x], row[x]), below[x]);
    middle[x] = middle_step(above[x], row[x], below[x]);
    high[x] = higher_step(higher_step(above[x], row[x]), below[x]);
  }
}

/// The median of nine from three sorted columns: the middle one of the highest low, the middle
/// middle and the lowest high.
RIGWIRE_WIDE_VECTORS void take_median(const std::int16_t* low, const std::int16_t* middle,
                                      const std::int16_t* high, int width, std::int16_t* median) {
#pragma GCC ivdep
  for (int x = 0; x < width; ++x) {
    const std::int16_t of_low = higher_step(higher_step(low[x - 1], low[x]), low[x + 1]);
    const std::int16_t of_middle = middle_step(middle[x - 1], middle[x], middle[x + 1]);
    const std::int16_t of_high = lower_step(lower_step(high[x - 1], high[x]), high[x + 1]);
    median[x] = middle_step(of_low, of_middle, of_high);
  }
}

}  // namespace

void MedianFilter::apply(std::span<const std::int16_t> picture, int width,
                         std::span<std::int16_t> filtered) {
  if (picture.empty()) {
    return;
  }
  const auto columns = static_cast<std::size_t>(width);
  for (std::vector<std::int16_t>* sorted : {&low_, &middle_, &high_}) {
    sorted->resize(columns + 2);
  }
  const std::size_t last = picture.size() - columns;
  for (std::size_t at = 0; at <= last; at += columns) {
    const std::int16_t* const row = picture.data() + at;
    const std::int16_t* const above = at == 0 ? row : row - columns;
    const std::int16_t* const below = at == last ? row : row + columns;
    sort_columns(above, row, below, width, low_.data() + 1, middle_.data() + 1, high_.data() + 1);
    for (std::vector<std::int16_t>* sorted : {&low_, &middle_, &high_}) {
      sorted->front() = (*sorted)[1];
      sorted->back() = (*sorted)[columns];
    }
    take_median(low_.data() + 1, middle_.data() + 1, high_.data() + 1, width, filtered.data() + at);
  }
}

std::size_t SpeckleFilter::root_of(std::size_t run) {
  while (runs_[run].parent != run) {
    runs_[run].parent = runs_[runs_[run].parent].parent;
    run = runs_[run].parent;
  }
  return run;
}

void SpeckleFilter::join(std::size_t one, std::size_t other) {
  one = root_of(one);
  other = root_of(other);
  if (one == other) {
    return;
  }
  // The larger island keeps its root, so that ways to a root stay short.
  if (runs_[one].pixels < runs_[other].pixels) {
    std::swap(one, other);
  }
  runs_[other].parent = one;
  runs_[one].pixels += runs_[other].pixels;
}

void SpeckleFilter::add_runs(std::span<const std::int16_t> row, int index,
                             const SpeckleRule& rule) {
  const auto at = [&row](int x) { return row[static_cast<std::size_t>(x)]; };
  const auto width = static_cast<int>(row.size());
  for (int x = 0; x < width;) {
    if (at(x) == rule.none) {
      ++x;
      continue;
    }
    const int begin = x;
    do {
      ++x;
    } while (x < width && at(x) != rule.none && std::abs(at(x) - at(x - 1)) <= rule.max_difference);
    runs_.push_back({index, begin, x, runs_.size(), x - begin});
  }
}

void SpeckleFilter::apply(std::span<std::int16_t> picture, int width, const SpeckleRule& rule) {
  runs_.clear();
  const auto columns = static_cast<std::size_t>(width);
  const std::size_t rows = picture.empty() ? 0 : picture.size() / columns;
  std::size_t first_above = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    const std::span<const std::int16_t> pixels = picture.subspan(row * columns, columns);
    const std::size_t first = runs_.size();
    add_runs(pixels, static_cast<int>(row), rule);
    // Both rows' runs are in the order of their columns: one pass finds all that overlap.
    const std::int16_t* const above_pixels = pixels.data() - (row > 0 ? columns : 0);
    const auto meets = [&](int x) {
      return std::abs(pixels[static_cast<std::size_t>(x)] - above_pixels[x]) <= rule.max_difference;
    };
    std::size_t above = first_above;
    for (std::size_t run = first; run < runs_.size(); ++run) {
      while (above < first && runs_[above].end <= runs_[run].begin) {
        ++above;
      }
      for (std::size_t k = above; k < first && runs_[k].begin < runs_[run].end; ++k) {
        const int end = std::min(runs_[k].end, runs_[run].end);
        for (int x = std::max(runs_[k].begin, runs_[run].begin); x < end; ++x) {
          if (meets(x)) {
            join(run, k);
            break;
          }
        }
      }
    }
    first_above = first;
  }
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    if (runs_[root_of(run)].pixels <= rule.max_pixels) {
      std::int16_t* const row = picture.data() + static_cast<std::size_t>(runs_[run].row) * columns;
      std::fill(row + runs_[run].begin, row + runs_[run].end, rule.none);
    }
  }
}

}  // namespace rigwire::sim
