#include "find_rocks/stereo_picture.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <string>

namespace rigwire::find_rocks {

StereoGeometry StereoGeometry::read(
    const std::function<std::optional<double>(std::string_view)>& feature) {
  const auto need = [&feature](std::string_view name, double above) {
    const auto value = feature(name);
    if (!value || !(*value > above) || !std::isfinite(*value)) {
      throw std::invalid_argument("the camera's " + std::string(name) + " is " +
                                  (value ? std::to_string(*value) : "missing") +
                                  ", allowed above " + std::to_string(above));
    }
    return *value;
  };
  constexpr double kAny = -1e9;
  StereoGeometry geometry;
  geometry.focal_px = need("Scan3dFocalLength", 0.0);
  geometry.baseline_m = need("Scan3dBaseline", 0.0);
  geometry.principal_u_px = need("Scan3dPrincipalPointU", kAny);
  geometry.principal_v_px = need("Scan3dPrincipalPointV", kAny);
  geometry.scale_px = need("Scan3dCoordinateScale", 0.0);
  geometry.offset_px = feature("Scan3dCoordinateOffset").value_or(0.0);
  if (feature("Scan3dInvalidDataFlag").value_or(0.0) != 0.0) {
    geometry.invalid = static_cast<std::uint16_t>(
        std::clamp(feature("Scan3dInvalidDataValue").value_or(0.0), 0.0, 65535.0));
  }
  return geometry;
}

StereoPicture::StereoPicture(const StereoGeometry& geometry, int width, int height,
                             std::span<const std::uint8_t> pixels,
                             std::span<const std::uint8_t> confidence,
                             std::uint8_t least_confidence)
    : geometry_(geometry), width_(width), height_(height) {
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  assert(pixels.size() == 2 * count && (confidence.empty() || confidence.size() == count));
  disparity_px_.resize(count, kNone);
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = static_cast<std::uint16_t>(pixels[2 * i] | (pixels[2 * i + 1] << 8U));
    const bool doubtful = !confidence.empty() && confidence[i] < least_confidence;
    if (geometry.invalid != value && !doubtful) {
      const double disparity = geometry.offset_px + geometry.scale_px * value;
      disparity_px_[i] = disparity > 0.0 ? static_cast<float>(disparity) : kNone;
    }
  }
}

std::size_t StereoPicture::pixels_with_disparity() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(disparity_px_, [](float d) { return d > kNone; }));
}

}  // namespace rigwire::find_rocks
