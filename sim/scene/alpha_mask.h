// Holes in a surface, from the alpha channel of its texture.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rigwire::sim {

/// An image of opacities that a surface repeats. Texel (c, r) covers u from c / columns to (c + 1)
/// / columns and v from r / rows to (r + 1) / rows: row 0 is at v = 0. A ray passes where the texel
/// that it hits is less opaque than the cutoff (alpha mode MASK of Khronos, glTF 2.0, 3.9.4);
/// texels are not blended.
struct AlphaMask {
  std::string name;  ///< For messages.
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<std::uint8_t> opacity;  ///< 0 clear .. 255 opaque, row by row.
  std::uint8_t cutoff = 128;

  [[nodiscard]] bool opaque_at(float u, float v) const;
  /// Share of the texels that stop a ray.
  [[nodiscard]] double coverage() const;
};

/// Throws std::invalid_argument naming the mask when a side is 0 or over 16384, or the count of
/// opacities does not match.
void validate(const AlphaMask& mask);

}  // namespace rigwire::sim
