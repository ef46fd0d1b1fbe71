#include "sim/camera/disparity_steps.h"

namespace rigwire::sim {

void take_steps(const cv::Mat& steps, int least_disparity, std::vector<float>& disparity_px) {
  disparity_px.resize(steps.total());
  auto to = disparity_px.begin();
  for (int row = 0; row < steps.rows; ++row) {
    const auto* const from = steps.ptr<short>(row);
    for (int column = 0; column < steps.cols; ++column, ++to) {
      *to = found_at(from[column], least_disparity) ? static_cast<float>(from[column]) * kPerStep_px
                                                    : DisparityPicture::kNone;
    }
  }
}

}  // namespace rigwire::sim
