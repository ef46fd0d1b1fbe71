#include "sim/scene/leaf_masks.h"

#include <cmath>
#include <cstdlib>

namespace rigwire::sim {
namespace {

constexpr std::size_t kTexels = 64;

/// opaque(u, v): u across the card from -1 to 1, v along the twig from 0 to 1.
template <class Opaque>
std::shared_ptr<const AlphaMask> drawn(const char* name, Opaque&& opaque) {
  auto mask = std::make_shared<AlphaMask>();
  mask->name = name;
  mask->columns = kTexels;
  mask->rows = kTexels;
  for (std::size_t r = 0; r < kTexels; ++r) {
    for (std::size_t c = 0; c < kTexels; ++c) {
      const double u = 2.0 * (static_cast<double>(c) + 0.5) / kTexels - 1.0;
      const double v = (static_cast<double>(r) + 0.5) / kTexels;
      mask->opacity.push_back(opaque(u, v) ? 255 : 0);
    }
  }
  return mask;
}

}  // namespace

std::shared_ptr<const AlphaMask> broad_leaves() {
  constexpr double kTwig = 0.03;
  return drawn("broad leaves", [](double u, double v) {
    if (std::abs(u) < kTwig) {
      return true;
    }
    // Ellipses that point outwards and on, in turn on the one side and on the other.
    constexpr int kLeaves = 7;
    for (int i = 0; i < kLeaves; ++i) {
      const double side = i % 2 == 0 ? 1.0 : -1.0;
      const double x = side * u - 0.48;
      const double y = 2.0 * (v - (0.12 + 0.125 * i));
      const double along = 0.8 * x + 0.6 * y;
      const double across = 0.8 * y - 0.6 * x;
      if (std::pow(along / 0.5, 2) + std::pow(across / 0.24, 2) < 1.0) {
        return true;
      }
    }
    return false;
  });
}

std::shared_ptr<const AlphaMask> needles() {
  constexpr double kTwig = 0.06;
  constexpr double kNeedlesAlong = 11.0;
  return drawn("needles", [](double u, double v) {
    const double across = std::abs(u);
    if (across < kTwig) {
      return true;
    }
    const double phase = kNeedlesAlong * (v - 0.25 * across);
    const double reach = 0.95 - 0.35 * v;
    return across < reach && phase - std::floor(phase) < 0.58;
  });
}

}  // namespace rigwire::sim
