#include "sim/scene/alpha_mask.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace rigwire::sim {
namespace {

/// Texel along one side, the coordinate repeated.
std::size_t texel(float coordinate, std::size_t count) {
  const float share = coordinate - std::floor(coordinate);
  return std::min(static_cast<std::size_t>(share * static_cast<float>(count)), count - 1);
}

}  // namespace

bool AlphaMask::opaque_at(float u, float v) const {
  return opacity[texel(v, rows) * columns + texel(u, columns)] >= cutoff;
}

double AlphaMask::coverage() const {
  const auto opaque =
      std::ranges::count_if(opacity, [this](std::uint8_t value) { return value >= cutoff; });
  return static_cast<double>(opaque) / static_cast<double>(opacity.size());
}

void validate(const AlphaMask& mask) {
  constexpr std::size_t kMostTexels = 16384;
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument("alpha mask '" + mask.name + "': " + what);
  };
  if (mask.columns < 1 || mask.columns > kMostTexels || mask.rows < 1 || mask.rows > kMostTexels) {
    refuse("is " + std::to_string(mask.columns) + " x " + std::to_string(mask.rows) +
           " texels, allowed: 1 to " + std::to_string(kMostTexels) + " along a side");
  }
  if (mask.opacity.size() != mask.columns * mask.rows) {
    refuse("has " + std::to_string(mask.opacity.size()) + " opacities for " +
           std::to_string(mask.columns * mask.rows) + " texels");
  }
}

}  // namespace rigwire::sim
