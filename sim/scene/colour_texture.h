// Pictures on surfaces: albedos that a mesh repeats, averaged over what a pixel sees of them.
//
// A pyramid of levels, each the mean of the one before it over areas twice as long (L. Williams,
// "Pyramidal parametrics", SIGGRAPH 1983), of any number of texels: where that is odd, a texel
// takes its share of three. Means are of light, so levels keep linear albedos, 16 bits each: the
// mean of a level is that of the picture within 1/65535 per level. Between texels and levels it is
// linear. Along the slant of a surface up to kMostProbes places are averaged, each as wide as the
// pixel is across (J. McCormack et al., "Feline", SIGGRAPH 1999, without its Gaussian weights), so
// that down to 1/16 of the cosine nothing is blurred across for the sake of its length.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace rigwire::sim {

/// Linear albedo of a value of sRGB, both 0 .. 1 (IEC 61966-2-1:1999, 5.2).
[[nodiscard]] double linear_of_srgb(double value);

/// What lies beyond a picture's edge.
enum class TextureEdge : std::uint8_t { repeats, mirrors, stays };

/// Linear red, green, blue, 65535 is 1; and how much the texel counts for means: 0 where the
/// surface has a hole.
using Texel = std::array<std::uint16_t, 4>;

/// A pixel's footprint on a surface, in the picture's coordinates: the axes of a parallelogram.
/// Where the coordinates shear the surface, the longer axis determines its length.
struct TextureFootprint {
  float across_u = 0.0F, across_v = 0.0F;
  float along_u = 0.0F, along_v = 0.0F;
};

class ColourTexture {
 public:
  static constexpr std::size_t kMostTexels = 8192;  ///< Along a side.
  static constexpr int kMostProbes = 16;
  /// White paint is no whiter: texels above it are it, so that means are of what is seen near by.
  static constexpr double kMostAlbedo = 0.9;

  /// `texels` row by row; row 0 is at v = 0, texel (c, r) covers u from c / columns to
  /// (c + 1) / columns. Texels that do not count get the colour of those around them. Takes 8/3 of
  /// the memory that 32 bit texels would. Throws std::invalid_argument naming the picture when a
  /// side is 0 or over kMostTexels, or the number of texels does not match.
  ColourTexture(std::string name, std::size_t columns, std::size_t rows, std::vector<Texel> texels);

  [[nodiscard]] std::size_t columns() const { return levels_.front().columns; }
  [[nodiscard]] std::size_t rows() const { return levels_.front().rows; }
  [[nodiscard]] std::size_t memory_bytes() const;

  /// Linear albedo around (u, v). Anything finite goes; does not allocate.
  [[nodiscard]] std::array<float, 3> mean(float u, float v, const TextureFootprint& seen,
                                          TextureEdge edge_u, TextureEdge edge_v) const;

 private:
  struct Level {
    std::size_t columns = 0;
    std::size_t rows = 0;
    std::vector<Texel> texels;
  };
  struct Place {
    float u, v;
    TextureEdge edge_u, edge_v;
  };
  static Level coarser(const Level& fine);
  static void add(const Level& level, const Place& place, float weight, std::array<float, 3>& sum);

  std::vector<Level> levels_;  ///< The picture first, one texel last.
};

/// What cameras see on a mesh in place of what its material's label says.
struct MeshColour {
  std::shared_ptr<const ColourTexture> texture;   ///< Null: the factor alone.
  std::array<float, 3> factor{1.0F, 1.0F, 1.0F};  ///< Linear; times the texture.
  TextureEdge edge_u = TextureEdge::repeats;
  TextureEdge edge_v = TextureEdge::repeats;
};

}  // namespace rigwire::sim
