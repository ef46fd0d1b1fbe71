// From two rectified pictures to a disparity: one interface, three ways.
//
//   census       Semi-global matching of which pixels around are brighter, our own
//                (census_matcher.h): less than half of OpenCV's time at errors that are no greater
//                (table in docs/accuracy).
//   semi_global  OpenCV's StereoSGBM (H. Hirschmueller, "Stereo processing by semiglobal matching
//                and mutual information", IEEE PAMI 30(2), 2008, with the costs of S. Birchfield,
//                C. Tomasi, IEEE PAMI 20(4), 1998).
//   truth        Disparity of the true depth of each pixel's middle, none where the right camera
//                does not see the point: what matching is measured against. It needs the first rays
//                of both pictures and no light.
//
// They come with holes, fattened edges, streaks and pixel locking, from the matching of what the
// cameras saw.
//
// Confidence, 0 .. 255, is how well left and right agree: a pixel that comes back to itself within
// a sixteenth has 255, one that is off by kDisagreement_px or more has 0. Errors that both share
// (repeated patterns, pixel locking) do not show in it.
//   census       Both ways come from the same sums; and the nearer the next best disparity's
//                sum lies to the best one's, the less it is.
//   semi_global  The right picture is matched against the left one, too, from three directions in
//                pairs of rows taken together: a third of the cost of the same search in all rows,
//                and errors that the two have in common are fewer; things one row high come back
//                less surely.
//
// Threads share the census' strips; of OpenCV's two ways each has one. What is found is the same
// whatever these and OpenCV's own thread count.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "fields/rules.h"

namespace rigwire::sim {

enum class MatchingMethod : std::uint8_t { census, semi_global, truth };
/// Directions from which the costs of a pixel are summed up.
enum class MatchingPaths : std::uint8_t { three, five, eight };

/// Defaults are those that OpenCV's documentation advises for grey pictures and blocks of 5 pixels
/// (P1 = 8 b^2, P2 = 32 b^2, uniqueness 5 .. 15 %, speckles of 50 .. 200 pixels within 1 or 2); the
/// census' steps are the best of seven pairs for the pit of `bench camera`.
struct StereoMatchingParameters {
  MatchingMethod method = MatchingMethod::census;
  /// Disparities from `least_disparity` up to before `least_disparity + disparities` are searched.
  /// Nearer surfaces come out wrong or not at all, and so many columns on the left have none.
  int least_disparity = 0;
  int disparities = 128;
  MatchingPaths paths = MatchingPaths::three;
  int block_px = 5;               ///< Side of the square that is compared, odd.
  int small_step_cost = 200;      ///< P1, of a step by one between neighbours.
  int large_step_cost = 800;      ///< P2, of every larger one.
  int small_step_bits = 3;        ///< P1 of the census, pairs that differ.
  int large_step_bits = 20;       ///< P2 of it.
  int uniqueness_percent = 10;    ///< By which the best cost must be below the next one.
  int gradient_limit = 31;        ///< Gradients are cut off here before they are compared.
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

/// Of the left picture. A disparity of 0, at infinity, is none: it is what surfaces without texture
/// get.
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
