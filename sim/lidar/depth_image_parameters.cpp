#include "sim/lidar/depth_image_parameters.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

constexpr double kWidestView_deg = 170.0;
constexpr int kMostCameras = 64;
constexpr int kMostPixels = 16384;
constexpr int kMostImages = 360;
constexpr int kMostParallaxSteps = 8;

template <class Number>
void require(const char* member, Number value, Number least, Number greatest) {
  if (!(value >= least && value <= greatest)) {
    throw std::invalid_argument("depth images: " + std::string(member) + " is " +
                                std::to_string(value) + ", allowed: " + std::to_string(least) +
                                " to " + std::to_string(greatest));
  }
}

}  // namespace

DepthImageParameters as_printed() {
  DepthImageParameters parameters;
  parameters.rows = RowRule::hyperbola_half_width;
  parameters.elevations = ElevationRule::pixels_per_beam;
  parameters.sampling = DepthSampling::nearest;
  parameters.parallax_steps = 0;
  return parameters;
}

double field_of_view_rad(const DepthImageParameters& parameters) {
  const double sector_deg = 360.0 / parameters.cameras;
  const double view_deg =
      parameters.field_of_view_deg == 0.0 ? sector_deg : parameters.field_of_view_deg;
  return view_deg * std::numbers::pi / 180.0;
}

void validate(const DepthImageParameters& parameters) {
  require("cameras", parameters.cameras, 3, kMostCameras);
  require("width_px", parameters.width_px, 8, kMostPixels);
  if (parameters.height_px != 0) {
    require("height_px", parameters.height_px, 8, kMostPixels);
  }
  if (parameters.field_of_view_deg != 0.0) {
    require("field_of_view_deg", parameters.field_of_view_deg, 360.0 / parameters.cameras,
            kWidestView_deg);
  }
  require("images_per_revolution", parameters.images_per_revolution, 1, kMostImages);
  require("near_plane_m", parameters.near_plane_m, 1e-3, 10.0);
  require("parallax_steps", parameters.parallax_steps, 0, kMostParallaxSteps);
  const bool exact = parameters.rows == RowRule::hyperbola_focal &&
                     parameters.columns == ColumnRule::resampled &&
                     parameters.elevations == ElevationRule::sensor_table;
  if (parameters.parallax_steps > 0 && !exact) {
    throw std::invalid_argument(
        "depth images: parallax_steps is " + std::to_string(parameters.parallax_steps) +
        ", allowed: 0 unless rows, columns and elevations all follow the exact rule");
  }
}

}  // namespace rigwire::sim
