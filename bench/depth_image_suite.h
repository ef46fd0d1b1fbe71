// The part of `rigwire bench lidar` that sets depth images beside rays.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

namespace rigwire::bench {

/// Writes tables to `text` and the same figures to the keys `depth_images`, `depth_image_motion`,
/// `depth_image_rings` and `rebasing` of `json`.
void bench_depth_images(std::ostream& text, nlohmann::json& json);

}  // namespace rigwire::bench
