#include "sim/camera/stereo_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/camera/census_matcher.h"

namespace rigwire::sim {

using fields::IntegerRule;

namespace {

constexpr std::array<fields::Choice<MatchingMethod>, 2> kMethods{
    {{MatchingMethod::census, "census", "Semi-global matching by census on what the heads saw."},
     {MatchingMethod::truth, "truth", "The true depth, where both heads see the point."}}};
constexpr std::array<fields::Choice<MatchingPaths>, 2> kPaths{
    {{MatchingPaths::three, "three", "From the left, the right and above: the least time."},
     {MatchingPaths::five, "five", "Also from above left and above right."}}};

/// Depths that differ by less than this share are one surface.
constexpr float kSameSurface = 0.02F;

class TruthMatcher final : public StereoMatcher {
 public:
  explicit TruthMatcher(const StereoMatchingParameters& parameters) : parameters_(parameters) {}

  [[nodiscard]] bool needs_truth() const override { return true; }

  void match(const StereoPair& pair, bool confidence, DisparityPicture& found) override {
    const auto pixels = pair.left_depth_m.size();
    found.disparity_px.assign(pixels, DisparityPicture::kNone);
    found.confidence.assign(confidence ? pixels : 0, 0);
    const auto focal_baseline = static_cast<float>(pair.focal_baseline_px_m);
    const auto least = static_cast<float>(parameters_.least_disparity);
    const auto end = static_cast<float>(parameters_.least_disparity + parameters_.disparities);
    const auto width = static_cast<std::size_t>(pair.width);
    for (std::size_t at = 0; at < pixels; ++at) {
      const float depth_m = pair.left_depth_m[at];
      if (!(depth_m > 0.0F)) {
        continue;
      }
      // d = f B / Z; the point lies between two columns of the right picture, one of which shows
      // its surface unless something nearer hides it.
      const float disparity_px = focal_baseline / depth_m;
      const float column = static_cast<float>(at % width) - disparity_px;
      if (disparity_px < least || disparity_px >= end || column < 0.0F) {
        continue;
      }
      const std::size_t row = at / width * width;
      const auto before = static_cast<std::size_t>(column);
      const std::size_t after = std::min(before + 1, width - 1);
      const auto same = [&](std::size_t where) {
        const float other_m = pair.right_depth_m[row + where];
        return std::abs(other_m - depth_m) <= kSameSurface * depth_m;
      };
      if (same(before) || same(after)) {
        found.disparity_px[at] = disparity_px;
        if (confidence) {
          found.confidence[at] = 255;
        }
      }
    }
  }

 private:
  StereoMatchingParameters parameters_;
};

}  // namespace

void visit(fields::Visitor& v, StereoMatchingParameters& p) {
  v.choice("method", p.method, kMethods, "How a disparity is found.");
  v.integer("least_disparity", p.least_disparity, IntegerRule{0, 2048},
            "Pixels; farther surfaces are not found.");
  v.integer("disparities", p.disparities, IntegerRule{16, 1024},
            "How many are searched, a multiple of 16; nearer surfaces are not found.");
  v.only_if(p.method == MatchingMethod::census, "method", "method: census",
            [&p](fields::Visitor& keys) {
              keys.integer("small_step_bits", p.small_step_bits, IntegerRule{1, 50},
                           "P1, of a step by one pixel, in pairs of pixels that differ, of 31.");
              keys.integer("large_step_bits", p.large_step_bits, IntegerRule{2, 150},
                           "P2, of every larger step.");
              keys.choice("paths", p.paths, kPaths, "Directions from which costs are summed up.");
              keys.integer("uniqueness", p.uniqueness_percent, IntegerRule{0, 100},
                           "By how many % the best cost must be below the next one.");
              keys.integer("left_right_difference", p.left_right_difference, IntegerRule{0, 64},
                           "Pixels between both directions beyond which there is no disparity.");
              keys.integer("speckle", p.speckle_px, IntegerRule{0, 10000},
                           "Islands up to so many pixels are taken out; 0 = none.");
              keys.integer("speckle_difference", p.speckle_difference, IntegerRule{1, 64},
                           "A greater step than this, pixels, is an island's edge.");
            });
}

void validate(const StereoMatchingParameters& p) {
  fields::check(p);
  fields::require(p.disparities % 16 == 0, "disparities", std::to_string(p.disparities),
                  "multiples of 16");
  if (p.method == MatchingMethod::census) {
    fields::require(p.large_step_bits > p.small_step_bits, "large_step_bits",
                    std::to_string(p.large_step_bits),
                    "above small_step_bits, " + std::to_string(p.small_step_bits));
  }
}

std::unique_ptr<StereoMatcher> make_stereo_matcher(const StereoMatchingParameters& parameters,
                                                   int threads) {
  validate(parameters);
  if (parameters.method == MatchingMethod::truth) {
    return std::make_unique<TruthMatcher>(parameters);
  }
  return make_census_matcher(parameters, threads);
}

}  // namespace rigwire::sim
