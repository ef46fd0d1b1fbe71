#include "sim/camera/disparity_steps.h"

namespace rigwire::sim {

void take_steps(std::span<const std::int16_t> steps, int least_disparity,
                std::vector<float>& disparity_px) {
  disparity_px.resize(steps.size());
  std::ranges::transform(steps, disparity_px.begin(), [least_disparity](std::int16_t step) {
    return found_at(step, least_disparity) ? static_cast<float>(step) * kPerStep_px
                                           : DisparityPicture::kNone;
  });
}

}  // namespace rigwire::sim
