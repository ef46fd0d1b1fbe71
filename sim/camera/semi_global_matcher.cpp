#include "sim/camera/semi_global_matcher.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace rigwire::sim {
namespace {

/// Of OpenCV's disparities.
constexpr float kPerStep_px = 1.0F / static_cast<float>(cv::StereoMatcher::DISP_SCALE);

class SemiGlobalMatcher final : public StereoMatcher {
 public:
  explicit SemiGlobalMatcher(const StereoMatchingParameters& p)
      : parameters_(p),
        matcher_(cv::StereoSGBM::create(
            p.least_disparity, p.disparities, p.block_px, p.small_step_cost, p.large_step_cost,
            p.left_right_difference, p.gradient_limit, p.uniqueness_percent, p.speckle_px,
            p.speckle_difference,
            // Both run on one thread; OpenCV's third form cuts the picture into strips.
            p.paths == MatchingPaths::five ? cv::StereoSGBM::MODE_SGBM : cv::StereoSGBM::MODE_HH)) {
  }

  [[nodiscard]] bool needs_truth() const override { return false; }

  void match(const StereoPair& pair, bool confidence, DisparityPicture& found) override {
    const cv::Mat left = picture(pair, pair.left);
    const cv::Mat right = picture(pair, pair.right);
    matcher_->compute(left, right, forward_);
    found.disparity_px.resize(pair.left.size());
    for (int row = 0; row < pair.height; ++row) {
      const auto* const steps = forward_.ptr<short>(row);
      float* const to = found.disparity_px.data() + static_cast<std::ptrdiff_t>(row) * pair.width;
      for (int column = 0; column < pair.width; ++column) {
        const float disparity_px = static_cast<float>(steps[column]) * kPerStep_px;
        to[column] = found_at(disparity_px) ? disparity_px : DisparityPicture::kNone;
      }
    }
    found.confidence.clear();
    if (confidence) {
      match_back(left, right);
      judge(pair, found);
    }
  }

 private:
  /// Not at infinity, where surfaces without texture end up.
  [[nodiscard]] bool found_at(float disparity_px) const {
    return disparity_px > 0.0F && disparity_px >= static_cast<float>(parameters_.least_disparity);
  }
  static cv::Mat picture(const StereoPair& pair, std::span<const std::uint8_t> pixels) {
    // OpenCV has no matrix of what must not be changed; compute() only reads it.
    return {
        pair.height, pair.width, CV_8UC1,
        const_cast<std::uint8_t*>(pixels.data())};  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  }

  /// The right picture against the left one: the same search in both pictures' mirror images, with
  /// a margin where the search of the outermost columns ends.
  void match_back(const cv::Mat& left, const cv::Mat& right) {
    margin_ = parameters_.least_disparity + parameters_.disparities;
    const auto mirrored = [this](const cv::Mat& from, cv::Mat& to) {
      cv::copyMakeBorder(from, wide_, 0, 0, 0, margin_, cv::BORDER_REPLICATE);
      cv::flip(wide_, to, 1);
    };
    mirrored(right, mirrored_right_);
    mirrored(left, mirrored_left_);
    matcher_->compute(mirrored_right_, mirrored_left_, backward_);
  }

  /// How far each pixel comes back from where its disparity leads.
  void judge(const StereoPair& pair, DisparityPicture& found) const {
    found.confidence.assign(found.disparity_px.size(), 0);
    const int last = backward_.cols - 1;
    for (int row = 0; row < pair.height; ++row) {
      const auto* const back = backward_.ptr<short>(row);
      const std::size_t first =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(pair.width);
      for (int column = 0; column < pair.width; ++column) {
        const std::size_t at = first + static_cast<std::size_t>(column);
        const float disparity_px = found.disparity_px[at];
        const int led_to = column - static_cast<int>(std::lround(disparity_px));
        if (disparity_px < 0.0F || led_to < 0) {
          continue;
        }
        const float returned_px = static_cast<float>(back[last - led_to]) * kPerStep_px;
        if (!found_at(returned_px)) {
          continue;
        }
        const float apart_px = std::max(0.0F, std::abs(disparity_px - returned_px) - kPerStep_px);
        const float agreement = std::max(0.0F, 1.0F - apart_px / kDisagreement_px);
        found.confidence[at] = static_cast<std::uint8_t>(std::lround(255.0F * agreement));
      }
    }
  }

  StereoMatchingParameters parameters_;
  cv::Ptr<cv::StereoSGBM> matcher_;
  int margin_ = 0;
  cv::Mat forward_, backward_, wide_, mirrored_left_, mirrored_right_;
};

}  // namespace

std::unique_ptr<StereoMatcher> make_semi_global_matcher(
    const StereoMatchingParameters& parameters) {
  return std::make_unique<SemiGlobalMatcher>(parameters);
}

}  // namespace rigwire::sim
