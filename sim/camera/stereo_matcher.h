// From two rectified pictures to a disparity: one interface, two methods.
//
//   census  Semi-global matching of census pictures (census_matcher.h): less than half of the time
//           of OpenCV's StereoSGBM at errors that are no greater (table in docs/accuracy).
//           Disparities have holes, fattened edges, streaks and pixel locking, because they are
//           found in what the cameras saw.
//   truth   Disparity of the true depth of each pixel's middle, none where the right camera does
//           not see the point: what matching is measured against. It needs the first rays of both
//           pictures and no light.
//
// Confidence, 0 .. 255, is how well left and right agree: a pixel that comes back to itself within
// a sixteenth has 255, one that is off by more than kDisagreement_px has 0. Errors that both share
// (repeated patterns, pixel locking) do not show in it. The census takes both directions from the
// same sums, and lowers the confidence where the next best disparity's sum is near the best one's.
//
// Threads share the strips of the census. The number of threads does not change what is found.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "fields/rules.h"

namespace rigwire::sim {

enum class MatchingMethod : std::uint8_t { census, truth };
/// Directions from which the costs of a pixel are summed up.
enum class MatchingPaths : std::uint8_t { three, five };

/// Uniqueness and speckles are those that OpenCV's documentation advises (5 .. 15 %, 50 .. 200
/// pixels within 1 or 2); the steps are the best of seven pairs for the pit of `bench camera`.
struct StereoMatchingParameters {
  MatchingMethod method = MatchingMethod::census;
  /// Disparities from `least_disparity` up to before `least_disparity + disparities` are searched.
  /// Nearer surfaces come out wrong or not at all, and so many columns on the left have none.
  int least_disparity = 0;
  int disparities = 128;
  MatchingPaths paths = MatchingPaths::three;
  int small_step_bits = 3;        ///< P1, of a step by one pixel, in pairs that differ.
  int large_step_bits = 20;       ///< P2, of every larger step.
  int uniqueness_percent = 10;    ///< By which the best cost must be below the next one.
  int left_right_difference = 1;  ///< More than this between both directions: no disparity.
  int speckle_px = 100;           ///< Islands up to this size are taken out; 0: none.
  int speckle_difference = 2;     ///< An island's edge is a greater step than this.
};
void visit(fields::Visitor& v, StereoMatchingParameters& p);
/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const StereoMatchingParameters& parameters);

/// Two pictures whose rows are the same lines of sight, grey of 8 bits, row by row.
struct StereoPair {
  int width = 0;
  int height = 0;
  std::span<const std::uint8_t> left;
  std::span<const std::uint8_t> right;
  /// True depth along the axis, 0: nothing. Empty unless the matcher needs_truth().
  std::span<const float> left_depth_m;
  std::span<const float> right_depth_m;
  double focal_baseline_px_m = 0.0;  ///< Disparity = this over depth.
};

/// Disparities of the left picture. A disparity of 0, at infinity, counts as none, because surfaces
/// without texture get it.
struct DisparityPicture {
  static constexpr float kNone = -1.0F;
  std::vector<float> disparity_px;       ///< kNone where there is none.
  std::vector<std::uint8_t> confidence;  ///< 0 where there is none; empty unless asked for.
};

/// Between a disparity and the one that leads back to it: none is believed beyond.
inline constexpr int kDisagreement_px = 2;

class StereoMatcher {
 public:
  StereoMatcher() = default;
  virtual ~StereoMatcher() = default;
  StereoMatcher(const StereoMatcher&) = delete;
  StereoMatcher& operator=(const StereoMatcher&) = delete;

  [[nodiscard]] virtual bool needs_truth() const = 0;
  /// Memory of `found` is used again. The pictures must be wider than all disparities.
  virtual void match(const StereoPair& pair, bool confidence, DisparityPicture& found) = 0;
};

/// Throws std::invalid_argument as validate() does. `threads`: that may run, the caller included.
[[nodiscard]] std::unique_ptr<StereoMatcher> make_stereo_matcher(
    const StereoMatchingParameters& parameters, int threads = 1);

}  // namespace rigwire::sim
