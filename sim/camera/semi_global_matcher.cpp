#include "sim/camera/semi_global_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "sim/camera/disparity_steps.h"
#include "sim/lidar/worker_pool.h"

namespace rigwire::sim {
namespace {

static_assert(kDisparitySteps == cv::StereoMatcher::DISP_SCALE);

/// Rows of the picture that the way back takes together.
constexpr int kRowsTogether = 2;

int mode_of(MatchingPaths paths) {
  switch (paths) {
    case MatchingPaths::three:
      return cv::StereoSGBM::MODE_SGBM_3WAY;
    case MatchingPaths::five:
      return cv::StereoSGBM::MODE_SGBM;
    case MatchingPaths::eight:
      return cv::StereoSGBM::MODE_HH;
  }
  return cv::StereoSGBM::MODE_SGBM;
}

cv::Ptr<cv::StereoSGBM> matcher_of(const StereoMatchingParameters& p, MatchingPaths paths,
                                   int speckle_px) {
  return cv::StereoSGBM::create(p.least_disparity, p.disparities, p.block_px, p.small_step_cost,
                                p.large_step_cost, p.left_right_difference, p.gradient_limit,
                                p.uniqueness_percent, speckle_px, p.speckle_difference,
                                mode_of(paths));
}

/// On the calling thread: what runs within one of OpenCV's parallel loops is not split up again.
/// Its search from three directions would be, into strips that are the same for any number of
/// threads.
void compute(cv::StereoSGBM& matcher, const cv::Mat& left, const cv::Mat& right, cv::Mat& steps) {
  cv::parallel_for_(cv::Range(0, 1),
                    [&](const cv::Range&) { matcher.compute(left, right, steps); });
}

class SemiGlobalMatcher final : public StereoMatcher {
 public:
  SemiGlobalMatcher(const StereoMatchingParameters& p, int threads)
      : parameters_(p),
        pool_(std::min(threads, 2), PoolPriority::spare_time),
        matcher_(matcher_of(p, p.paths, p.speckle_px)),
        // Islands are taken out on the way there.
        back_matcher_(matcher_of(p, MatchingPaths::three, 0)) {}

  [[nodiscard]] bool needs_truth() const override { return false; }

  void match(const StereoPair& pair, bool confidence, DisparityPicture& found) override {
    const cv::Mat left = picture(pair, pair.left);
    const cv::Mat right = picture(pair, pair.right);
    // There and back need nothing of each other.
    std::array<std::exception_ptr, 2> failed;
    pool_.run(confidence ? 2 : 1, [&](std::size_t way) {
      try {
        if (way == 0) {
          compute(*matcher_, left, right, forward_);
        } else {
          match_back(left, right);
        }
      } catch (...) {
        failed[way] = std::current_exception();
      }
    });
    for (const std::exception_ptr& failure : failed) {
      if (failure) {
        std::rethrow_exception(failure);
      }
    }
    take_steps(forward_, parameters_.least_disparity, found.disparity_px);
    found.confidence.clear();
    if (confidence) {
      judge(found);
    }
  }

 private:
  static cv::Mat picture(const StereoPair& pair, std::span<const std::uint8_t> pixels) {
    // OpenCV has no matrix of what must not be changed; compute() only reads it.
    return {
        pair.height, pair.width, CV_8UC1,
        const_cast<std::uint8_t*>(pixels.data())};  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  }

  /// The right picture against the left one: the same search in both pictures' mirror images, with
  /// a margin where the search of the outermost columns ends.
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

  /// How far each pixel comes back from where its disparity leads.
  void judge(DisparityPicture& found) const {
    found.confidence.assign(found.disparity_px.size(), 0);
    const int last = backward_.cols - 1;
    auto to = found.confidence.begin();
    for (int row = 0; row < forward_.rows; ++row) {
      const auto* const steps = forward_.ptr<short>(row);
      const auto* const back = backward_.ptr<short>(row / kRowsTogether);
      for (int column = 0; column < forward_.cols; ++column, ++to) {
        const int right = led_to(column, steps[column]);
        if (found_at(steps[column], parameters_.least_disparity) && right >= 0 &&
            found_at(back[last - right], parameters_.least_disparity)) {
          *to = static_cast<std::uint8_t>(agreement(steps[column], back[last - right]));
        }
      }
    }
  }

  StereoMatchingParameters parameters_;
  WorkerPool pool_;
  cv::Ptr<cv::StereoSGBM> matcher_;
  cv::Ptr<cv::StereoSGBM> back_matcher_;
  cv::Mat forward_, backward_, low_, wide_, mirrored_left_, mirrored_right_;
};

}  // namespace

std::unique_ptr<StereoMatcher> make_semi_global_matcher(const StereoMatchingParameters& parameters,
                                                        int threads) {
  return std::make_unique<SemiGlobalMatcher>(parameters, threads);
}

}  // namespace rigwire::sim
