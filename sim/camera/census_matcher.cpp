#include "sim/camera/census_matcher.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "sim/camera/disparity_filters.h"
#include "sim/camera/disparity_steps.h"
#include "sim/lidar/worker_pool.h"
#include "sim/samples/wide_vectors.h"

namespace rigwire::sim {
namespace {

/// Half of the window's width and height.
constexpr int kAcross = 4;
constexpr int kDown = 3;
constexpr int kLines = 2 * kDown + 1;
static_assert(kCensusPairs == ((2 * kAcross + 1) * kLines - 1) / 2);
/// Eight pairs in each.
constexpr std::size_t kBytes = (kCensusPairs + 7) / 8;
/// Cost of a match beyond the other picture's edge: no pair agrees.
constexpr std::uint8_t kBeyond = kCensusPairs;
/// Above every sum.
template <class Sum>
constexpr Sum kNoSum = std::numeric_limits<Sum>::max();
constexpr std::int16_t kNotFound = -kDisparitySteps;
/// Bytes on each side of a pixel's path costs, so that the outermost disparities have neighbours.
constexpr std::size_t kMargin = 32;
/// Strips of the picture, shared by the threads; and the number of rows before a strip's own at
/// which its paths from above begin.
constexpr int kStrips = 4;
constexpr int kRunUp = 24;

/// All bits unless it holds, without a branch.
template <class Sum>
constexpr Sum unless(bool holds) {
  return static_cast<Sum>(static_cast<Sum>(holds) - 1U);
}

/// Census of a row's pixels: which pixel of each pair is brighter.
using CensusRow = std::array<std::vector<std::uint8_t>, kBytes>;
/// Lines of a picture around a row, kAcross pixels wider on each side.
using Lines = std::array<std::vector<std::uint8_t>, kLines>;

RIGWIRE_WIDE_VECTORS void take_census(const Lines& lines, int width, CensusRow& row) {
  std::size_t pair = 0;
  for (int dy = 0; dy <= kDown; ++dy) {
    for (int dx = dy == 0 ? 1 : -kAcross; dx <= kAcross; ++dx, ++pair) {
      const int below = kDown + dy;
      const int above = kDown - dy;
      const std::uint8_t* const one =
          lines[static_cast<std::size_t>(below)].data() + (kAcross + dx);
      const std::uint8_t* const other =
          lines[static_cast<std::size_t>(above)].data() + (kAcross - dx);
      std::uint8_t* const bits = row[pair / 8].data();
      const auto bit = static_cast<std::uint8_t>(1U << pair % 8);
      const auto keep = static_cast<std::uint8_t>(pair % 8 == 0 ? 0x00 : 0xFF);
#pragma GCC ivdep
      for (int x = 0; x < width; ++x) {
        const std::uint8_t brighter = one[x] > other[x] ? bit : std::uint8_t{0};
        bits[x] = static_cast<std::uint8_t>((bits[x] & keep) | brighter);
      }
    }
  }
}

/// In how many pairs a pixel differs from those of one disparity after the other, eight of which
/// are in a word: bits are counted in twos, fours and bytes.
inline __attribute__((always_inline)) void compare(
    const std::array<std::uint64_t, kBytes>& own,
    const std::array<const std::uint8_t*, kBytes>& others, int disparities, std::uint8_t* cost) {
  constexpr std::uint64_t kTwos = 0x5555555555555555ULL;
  constexpr std::uint64_t kFours = 0x3333333333333333ULL;
  constexpr std::uint64_t kEights = 0x0F0F0F0F0F0F0F0FULL;
  static_assert(kBytes == 4, "two counts of up to four bits each fit a half byte");
#pragma GCC ivdep
  for (int d = 0; d < disparities; d += 8) {
    std::array<std::uint64_t, kBytes> count;
    for (std::size_t k = 0; k < kBytes; ++k) {
      std::uint64_t differ;
      std::memcpy(&differ, others[k] + d, sizeof(differ));
      differ ^= own[k];
      differ -= differ >> 1U & kTwos;
      count[k] = (differ & kFours) + (differ >> 2U & kFours);
    }
    const std::uint64_t low = count[0] + count[1];
    const std::uint64_t high = count[2] + count[3];
    const std::uint64_t sum =
        (low & kEights) + (low >> 4U & kEights) + (high & kEights) + (high >> 4U & kEights);
    std::memcpy(cost + d, &sum, sizeof(sum));
  }
}

struct Penalties {
  std::uint8_t small;
  std::uint8_t large;
};

/// Advances a path by one pixel. `least`: minimum of `before`. Returns the minimum of `now`.
inline __attribute__((always_inline)) std::uint8_t go_on(const std::uint8_t* cost,
                                                         const std::uint8_t* before,
                                                         std::uint8_t least, Penalties penalties,
                                                         int disparities, std::uint8_t* now) {
  const auto jump = static_cast<std::uint8_t>(least + penalties.large);
  std::uint8_t lowest = 0xFF;
#pragma GCC ivdep
  for (int d = 0; d < disparities; ++d) {
    const auto below = static_cast<std::uint8_t>(before[d - 1] + penalties.small);
    const auto above = static_cast<std::uint8_t>(before[d + 1] + penalties.small);
    std::uint8_t best = before[d] < jump ? before[d] : jump;
    best = below < best ? below : best;
    best = above < best ? above : best;
    const auto sum = static_cast<std::uint8_t>(static_cast<std::uint8_t>(best - least) + cost[d]);
    now[d] = sum;
    lowest = sum < lowest ? sum : lowest;
  }
  return lowest;
}

/// What a row's pixels have on one path.
struct PathRow {
  std::vector<std::uint8_t> costs;
  std::vector<std::uint8_t> least;
};

/// What the rows of a picture are worked out in. Sums, and disparities beside them, have one byte
/// where both fit, else two: half of them fit a register.
template <class Sum>
struct Workplace {
  int width = 0;
  int disparities = 0;
  int least_disparity = 0;
  int uniqueness_percent = 0;
  Penalties penalties{};
  bool slanting = false;  ///< Also from above left and above right.

  Lines lines;
  CensusRow left;
  CensusRow right;  ///< From the right to the left: higher disparities come later.
  std::vector<std::uint8_t> costs;
  std::vector<Sum> sums;
  std::array<std::vector<std::uint8_t>, 2> along;    ///< Path costs of a pixel and the one before.
  std::array<std::array<PathRow, 2>, 3> from_above;  ///< Path costs of a row and the one before.
  std::vector<Sum> numbers;                          ///< 0, 1, 2 ...
  /// Lowest sum at each pixel of the right picture, from the right to the left, and its disparity.
  std::vector<Sum> right_sum;
  std::vector<Sum> right_disparity;

  [[nodiscard]] std::size_t stride() const {
    return static_cast<std::size_t>(disparities) + 2 * kMargin;
  }
  /// Returns the index in the right picture's rows of the match of column `x` at the first
  /// disparity.
  [[nodiscard]] std::size_t right_of(int x) const {
    const int from_right = width - 1 - x + least_disparity;
    return static_cast<std::size_t>(from_right);
  }
  void begin_along() {
    for (std::vector<std::uint8_t>& path : along) {
      std::fill_n(path.begin() + kMargin, disparities, std::uint8_t{0});
    }
  }
};

/// Costs of a row, and the paths that come from the left and from above.
template <class Sum>
inline __attribute__((always_inline)) void sum_rightwards(std::size_t row, Workplace<Sum>& w) {
  const int disparities = w.disparities;
  w.begin_along();
  std::uint8_t least = 0;
  for (int x = 0; x < w.width; ++x) {
    const auto at = static_cast<std::size_t>(x);
    std::array<std::uint64_t, kBytes> own;
    std::array<const std::uint8_t*, kBytes> others;
    for (std::size_t k = 0; k < kBytes; ++k) {
      own[k] = w.left[k][at] * 0x0101010101010101ULL;
      others[k] = w.right[k].data() + w.right_of(x);
    }
    std::uint8_t* const cost = w.costs.data() + at * static_cast<std::size_t>(disparities);
    compare(own, others, disparities, cost);
    for (int d = std::max(0, x + 1 - w.least_disparity); d < disparities; ++d) {
      cost[d] = kBeyond;
    }
    std::uint8_t* const path = w.along[at % 2].data() + kMargin;
    least =
        go_on(cost, w.along[1 - at % 2].data() + kMargin, least, w.penalties, disparities, path);
    const auto from_above = [&](std::size_t which) __attribute__((always_inline)) {
      PathRow& now = w.from_above[which][row % 2];
      const PathRow& before = w.from_above[which][1 - row % 2];
      // The pixels of a row have one more on each side.
      const std::size_t from = at + which;
      std::uint8_t* const to = now.costs.data() + (at + 1) * w.stride() + kMargin;
      now.least[at + 1] = go_on(cost, before.costs.data() + from * w.stride() + kMargin,
                                before.least[from], w.penalties, disparities, to);
      return to;
    };
    Sum* const sum = w.sums.data() + at * static_cast<std::size_t>(disparities);
    const std::uint8_t* const above = from_above(1);
    if (!w.slanting) {
#pragma GCC ivdep
      for (int d = 0; d < disparities; ++d) {
        sum[d] = static_cast<Sum>(path[d] + above[d]);
      }
      continue;
    }
    const std::uint8_t* const left_above = from_above(0);
    const std::uint8_t* const right_above = from_above(2);
#pragma GCC ivdep
    for (int d = 0; d < disparities; ++d) {
      sum[d] = static_cast<Sum>(path[d] + above[d] + left_above[d] + right_above[d]);
    }
  }
}

/// Offset of the minimum from the middle of three sums, in disparity steps.
inline int beside(int before, int middle, int after) {
  const int steep = std::max(before, after) - middle;
  return steep > 0 ? (before - after) * kDisparitySteps / (2 * steep) : 0;
}

/// The paths that come from the right, and what is best of the sums: for the left picture's pixels
/// steps and margins, for the right one's what leads to them.
template <class Sum>
inline __attribute__((always_inline)) void sum_leftwards(Workplace<Sum>& w, std::int16_t* steps,
                                                         std::uint8_t* margins) {
  const int disparities = w.disparities;
  w.begin_along();
  std::ranges::fill(w.right_sum, kNoSum<Sum>);
  const Sum* const number = w.numbers.data();
  std::uint8_t least = 0;
  for (int x = w.width - 1; x >= 0; --x) {
    const auto at = static_cast<std::size_t>(x);
    const std::uint8_t* const cost = w.costs.data() + at * static_cast<std::size_t>(disparities);
    Sum* const sum = w.sums.data() + at * static_cast<std::size_t>(disparities);
    std::uint8_t* const path = w.along[at % 2].data() + kMargin;
    least =
        go_on(cost, w.along[1 - at % 2].data() + kMargin, least, w.penalties, disparities, path);
    Sum lowest = kNoSum<Sum>;
#pragma GCC ivdep
    for (int d = 0; d < disparities; ++d) {
      const auto all = static_cast<Sum>(sum[d] + path[d]);
      sum[d] = all;
      lowest = all < lowest ? all : lowest;
    }
    Sum* const right_sum = w.right_sum.data() + w.right_of(x);
    Sum* const right_disparity = w.right_disparity.data() + w.right_of(x);
    Sum first = kNoSum<Sum>;
#pragma GCC ivdep
    for (int d = 0; d < disparities; ++d) {
      const Sum all = sum[d];
      const Sum known = right_sum[d];
      const Sum leads = right_disparity[d];
      right_sum[d] = all < known ? all : known;
      right_disparity[d] = all < known ? number[d] : leads;
      const auto here = static_cast<Sum>(number[d] | unless<Sum>(all == lowest));
      first = here < first ? here : first;
    }
    const int best = first;
    // The minimum over disparities other than the best and its neighbours.
    const auto before = static_cast<Sum>(best - 1);
    Sum next = kNoSum<Sum>;
#pragma GCC ivdep
    for (int d = 0; d < disparities; ++d) {
      const auto apart = static_cast<Sum>(number[d] - before);
      const auto other = static_cast<Sum>(sum[d] | unless<Sum>(apart > 2));
      next = other < next ? other : next;
    }
    margins[at] = static_cast<std::uint8_t>(255.0F * static_cast<float>(next - lowest) /
                                            static_cast<float>(std::max<int>(next, 1)));
    // Where the search leaves the right picture, what is best may not have been seen.
    const bool whole = x + 1 >= w.least_disparity + disparities;
    if (!whole || next * (100 - w.uniqueness_percent) <= lowest * 100) {
      steps[at] = kNotFound;
      continue;
    }
    int found = (best + w.least_disparity) * kDisparitySteps;
    if (best > 0 && best < disparities - 1) {
      found += beside(sum[best - 1], lowest, sum[best + 1]);
    }
    steps[at] = static_cast<std::int16_t>(found);
  }
}

RIGWIRE_WIDE_VECTORS void go_right(std::size_t row, Workplace<std::uint8_t>& w) {
  sum_rightwards(row, w);
}
RIGWIRE_WIDE_VECTORS void go_right(std::size_t row, Workplace<std::uint16_t>& w) {
  sum_rightwards(row, w);
}
RIGWIRE_WIDE_VECTORS void go_left(Workplace<std::uint8_t>& w, std::int16_t* steps,
                                  std::uint8_t* margins) {
  sum_leftwards(w, steps, margins);
}
RIGWIRE_WIDE_VECTORS void go_left(Workplace<std::uint16_t>& w, std::int16_t* steps,
                                  std::uint8_t* margins) {
  sum_leftwards(w, steps, margins);
}

/// Whether sums and disparities are below 255. A path's cost is at most kCensusPairs + P2.
bool fits_bytes(const StereoMatchingParameters& p) {
  const int paths = p.paths == MatchingPaths::five ? 5 : 3;
  return paths * (kCensusPairs + p.large_step_bits) < 255 && p.disparities < 255;
}

/// Returns how sure a disparity is, 0 .. 255, from the margin of its sum, 0 .. 255. A quarter of
/// the margin gives 160: in the pit of `bench camera` as many disparities then have 128 and more as
/// by two searches of OpenCV's StereoSGBM, there and back.
inline int sure_of(int margin) {
  constexpr int kQuarter = 64;
  return margin < kQuarter ? margin * 5 / 2 : 160 + (margin - kQuarter) * 95 / (255 - kQuarter);
}

template <class Sum>
class CensusMatcher final : public StereoMatcher {
 public:
  CensusMatcher(const StereoMatchingParameters& parameters, int threads)
      : parameters_(parameters), pool_(std::min(threads, kStrips), PoolPriority::spare_time) {}

  [[nodiscard]] bool needs_truth() const override { return false; }

  void match(const StereoPair& pair, bool confidence, DisparityPicture& found) override {
    prepare(pair);
    pool_.run(kStrips, [&](std::size_t strip) { search(pair, static_cast<int>(strip)); });
    median_.apply(searched_, pair.width, there_);
    if (parameters_.speckle_px > 0) {
      speckles_.apply(
          there_, pair.width,
          {parameters_.speckle_px, parameters_.speckle_difference * kDisparitySteps, kNotFound});
    }
    take_steps(there_, parameters_.least_disparity, found.disparity_px);
    found.confidence.clear();
    if (confidence) {
      judge(pair.width, found);
    }
  }

 private:
  void search(const StereoPair& pair, int strip) {
    Workplace<Sum>& w = work_[static_cast<std::size_t>(strip)];
    const int rows = (pair.height + kStrips - 1) / kStrips;
    const int first = strip * rows;
    const int end = std::min(pair.height, first + rows);
    for (int row = std::max(0, first - kRunUp); row < end; ++row) {
      take_lines(pair, pair.left, row, w.lines);
      take_census(w.lines, pair.width, w.left);
      take_lines(pair, pair.right, row, w.lines);
      take_census(w.lines, pair.width, w.right);
      for (std::vector<std::uint8_t>& bits : w.right) {
        std::reverse(bits.begin(), bits.begin() + pair.width);
      }
      go_right(static_cast<std::size_t>(row), w);
      if (row >= first) {
        const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(pair.width);
        go_left(w, searched_.data() + at, margins_.data() + at);
        come_back(w, back_.data() + at);
        hold_to_each_other(w.width, searched_.data() + at, back_.data() + at);
      }
    }
  }

  void prepare(const StereoPair& pair) {
    for (Workplace<Sum>& w : work_) {
      prepare(pair, w);
    }
    const std::size_t pixels = pair.left.size();
    searched_.resize(pixels);
    there_.resize(pixels);
    back_.resize(pixels);
    margins_.resize(pixels);
  }

  void prepare(const StereoPair& pair, Workplace<Sum>& w) const {
    w.width = pair.width;
    w.disparities = parameters_.disparities;
    w.least_disparity = parameters_.least_disparity;
    w.uniqueness_percent = parameters_.uniqueness_percent;
    w.penalties = {static_cast<std::uint8_t>(parameters_.small_step_bits),
                   static_cast<std::uint8_t>(parameters_.large_step_bits)};
    w.slanting = parameters_.paths == MatchingPaths::five;
    const auto width = static_cast<std::size_t>(w.width);
    const auto disparities = static_cast<std::size_t>(w.disparities);
    const std::size_t searched = w.right_of(0) + disparities;
    for (std::size_t k = 0; k < kBytes; ++k) {
      w.left[k].assign(width, 0);
      w.right[k].assign(searched, 0);
    }
    w.costs.resize(width * disparities);
    w.sums.resize(width * disparities);
    w.numbers.resize(disparities);
    for (std::size_t d = 0; d < disparities; ++d) {
      w.numbers[d] = static_cast<Sum>(d);
    }
    w.right_sum.resize(searched);
    w.right_disparity.assign(searched, 0);
    // No path comes from beyond the outermost disparities; all begin at a cost of 0.
    const auto none = static_cast<std::uint8_t>(0xFF - w.penalties.small);
    std::vector<std::uint8_t> beginning(w.stride(), none);
    std::fill_n(beginning.begin() + kMargin, disparities, std::uint8_t{0});
    w.along.fill(beginning);
    for (std::array<PathRow, 2>& rows : w.from_above) {
      for (PathRow& row : rows) {
        row.least.assign(width + 2, 0);
        row.costs.clear();
        for (std::size_t x = 0; x < width + 2; ++x) {
          row.costs.insert(row.costs.end(), beginning.begin(), beginning.end());
        }
      }
    }
    for (std::vector<std::uint8_t>& line : w.lines) {
      line.resize(width + 2 * kAcross);
    }
  }

  /// Around a row; beyond the edges as at them.
  static void take_lines(const StereoPair& pair, std::span<const std::uint8_t> pixels, int row,
                         Lines& lines) {
    const auto width = static_cast<std::size_t>(pair.width);
    for (int k = 0; k < kLines; ++k) {
      const auto from = static_cast<std::size_t>(std::clamp(row + k - kDown, 0, pair.height - 1));
      const auto line = pixels.subspan(from * width, width);
      std::vector<std::uint8_t>& to = lines[static_cast<std::size_t>(k)];
      std::fill_n(to.begin(), kAcross, line.front());
      std::ranges::copy(line, to.begin() + kAcross);
      std::fill_n(to.end() - kAcross, kAcross, line.back());
    }
  }

  /// What leads back from each of the right picture's pixels.
  static void come_back(const Workplace<Sum>& w, std::int16_t* back) {
    const auto sum = [&w](int x, int d) {
      return static_cast<int>(
          w.sums[static_cast<std::size_t>(x) * static_cast<std::size_t>(w.disparities) +
                 static_cast<std::size_t>(d)]);
    };
    for (int right = 0; right < w.width; ++right) {
      const auto at = static_cast<std::size_t>(w.width - 1 - right);
      if (w.right_sum[at] == kNoSum<Sum>) {
        back[right] = kNotFound;
        continue;
      }
      const int best = w.right_disparity[at];
      int found = (best + w.least_disparity) * kDisparitySteps;
      const int x = right + best + w.least_disparity;
      if (best > 0 && best < w.disparities - 1 && x + 1 < w.width) {
        found += beside(sum(x - 1, best - 1), sum(x, best), sum(x + 1, best + 1));
      }
      back[right] = static_cast<std::int16_t>(found);
    }
  }

  /// Takes out what both pixels that it leads between disagree with.
  void hold_to_each_other(int width, std::int16_t* there, const std::int16_t* back) const {
    const int most = parameters_.left_right_difference * kDisparitySteps + kDisparitySteps / 2;
    for (int x = 0; x < width; ++x) {
      const int steps = there[x];
      const auto disagrees = [&](int disparity) {
        const int led_to = x - disparity;
        return led_to >= 0 && back[led_to] >= 0 && std::abs(back[led_to] - steps) > most;
      };
      if (steps >= 0 && disagrees(steps / kDisparitySteps) &&
          disagrees((steps + kDisparitySteps - 1) / kDisparitySteps)) {
        there[x] = kNotFound;
      }
    }
  }

  void judge(int width, DisparityPicture& found) const {
    found.confidence.assign(found.disparity_px.size(), 0);
    auto to = found.confidence.begin();
    for (std::size_t first = 0; first < there_.size(); first += static_cast<std::size_t>(width)) {
      const std::int16_t* const steps = there_.data() + first;
      const std::int16_t* const back = back_.data() + first;
      const std::uint8_t* const margins = margins_.data() + first;
      for (int column = 0; column < width; ++column, ++to) {
        const int right = led_to(column, steps[column]);
        if (found_at(steps[column], parameters_.least_disparity) && right >= 0 &&
            found_at(back[right], parameters_.least_disparity)) {
          const int sure = sure_of(margins[column]);
          *to =
              static_cast<std::uint8_t>((sure * agreement(steps[column], back[right]) + 127) / 255);
        }
      }
    }
  }

  StereoMatchingParameters parameters_;
  WorkerPool pool_;
  std::array<Workplace<Sum>, kStrips> work_;
  MedianFilter median_;
  SpeckleFilter speckles_;
  /// Steps of the left picture as the search finds them, and filtered; steps of the right picture.
  std::vector<std::int16_t> searched_, there_, back_;
  std::vector<std::uint8_t> margins_;
};

}  // namespace

std::unique_ptr<StereoMatcher> make_census_matcher(const StereoMatchingParameters& parameters,
                                                   int threads) {
  if (fits_bytes(parameters)) {
    return std::make_unique<CensusMatcher<std::uint8_t>>(parameters, threads);
  }
  return std::make_unique<CensusMatcher<std::uint16_t>>(parameters, threads);
}

}  // namespace rigwire::sim
