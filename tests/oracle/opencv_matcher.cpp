#include "opencv_matcher.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "sim/camera/disparity_steps.h"

namespace rigwire::oracle {
namespace {

using sim::DisparityPicture;
using sim::StereoPair;

static_assert(sim::kDisparitySteps == cv::StereoMatcher::DISP_SCALE);

/// Rows of the picture that the way back takes together.
constexpr int kRowsTogether = 2;

int mode_of(OpenCvPaths paths) {
  switch (paths) {
    case OpenCvPaths::three:
      return cv::StereoSGBM::MODE_SGBM_3WAY;
    case OpenCvPaths::five:
      return cv::StereoSGBM::MODE_SGBM;
    case OpenCvPaths::eight:
      return cv::StereoSGBM::MODE_HH;
  }
  return cv::StereoSGBM::MODE_SGBM;
}

cv::Ptr<cv::StereoSGBM> matcher_of(const OpenCvMatcherParameters& p, OpenCvPaths paths,
                                   int speckle_px) {
  return cv::StereoSGBM::create(p.least_disparity, p.disparities, p.block_px, p.small_step_cost,
                                p.large_step_cost, p.left_right_difference, p.gradient_limit,
                                p.uniqueness_percent, speckle_px, p.speckle_difference,
                                mode_of(paths));
}

/// Computes on the calling thread: OpenCV does not split up what runs within one of its parallel
/// loops.
void compute(cv::StereoSGBM& matcher, const cv::Mat& left, const cv::Mat& right, cv::Mat& steps) {
  cv::parallel_for_(cv::Range(0, 1),
                    [&](const cv::Range&) { matcher.compute(left, right, steps); });
}

class OpenCvMatcher final : public sim::StereoMatcher {
 public:
  explicit OpenCvMatcher(const OpenCvMatcherParameters& p)
      : parameters_(p),
        matcher_(matcher_of(p, p.paths, p.speckle_px)),
        // Speckles are removed on the way there.
        back_matcher_(matcher_of(p, OpenCvPaths::three, 0)) {}

  [[nodiscard]] bool needs_truth() const override { return false; }

  void match(const StereoPair& pair, bool confidence, DisparityPicture& found) override {
    const cv::Mat left = picture(pair, pair.left);
    const cv::Mat right = picture(pair, pair.right);
    compute(*matcher_, left, right, forward_);
    CV_Assert(forward_.isContinuous());
    sim::take_steps({forward_.ptr<std::int16_t>(), forward_.total()}, parameters_.least_disparity,
                    found.disparity_px);
    found.confidence.clear();
    if (confidence) {
      match_back(left, right);
      judge(found);
    }
  }

 private:
  static cv::Mat picture(const StereoPair& pair, std::span<const std::uint8_t> pixels) {
    // cv::Mat has no form for constant memory; compute() only reads it.
    return {
        pair.height, pair.width, CV_8UC1,
        const_cast<std::uint8_t*>(pixels.data())};  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  }

  /// Matches the right picture against the left one: the same search in both pictures' mirror
  /// images, with a margin where the search of the outermost columns ends.
  void match_back(const cv::Mat& left, const cv::Mat& right) {
    const int margin = parameters_.least_disparity + parameters_.disparities;
    const auto mirrored = [&](const cv::Mat& from, cv::Mat& to) {
      cv::resize(from, low_, {from.cols, (from.rows + kRowsTogether - 1) / kRowsTogether}, 0.0, 0.0,
                 cv::INTER_AREA);
      cv::copyMakeBorder(low_, wide_, 0, 0, 0, margin, cv::BORDER_REPLICATE);
      cv::flip(wide_, to, 1);
    };
    mirrored(right, mirrored_right_);
    mirrored(left, mirrored_left_);
    compute(*back_matcher_, mirrored_right_, mirrored_left_, backward_);
  }

  /// Sets each pixel's confidence by how far it comes back from where its disparity leads.
  void judge(DisparityPicture& found) const {
    found.confidence.assign(found.disparity_px.size(), 0);
    const int last = backward_.cols - 1;
    auto to = found.confidence.begin();
    for (int row = 0; row < forward_.rows; ++row) {
      const auto* const steps = forward_.ptr<std::int16_t>(row);
      const auto* const back = backward_.ptr<std::int16_t>(row / kRowsTogether);
      for (int column = 0; column < forward_.cols; ++column, ++to) {
        const int right = sim::led_to(column, steps[column]);
        if (sim::found_at(steps[column], parameters_.least_disparity) && right >= 0 &&
            sim::found_at(back[last - right], parameters_.least_disparity)) {
          *to = static_cast<std::uint8_t>(sim::agreement(steps[column], back[last - right]));
        }
      }
    }
  }

  OpenCvMatcherParameters parameters_;
  cv::Ptr<cv::StereoSGBM> matcher_;
  cv::Ptr<cv::StereoSGBM> back_matcher_;
  cv::Mat forward_, backward_, low_, wide_, mirrored_left_, mirrored_right_;
};

}  // namespace

std::unique_ptr<sim::StereoMatcher> make_opencv_matcher(const OpenCvMatcherParameters& parameters) {
  return std::make_unique<OpenCvMatcher>(parameters);
}

}  // namespace rigwire::oracle
