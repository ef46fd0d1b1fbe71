// Terrain from measured heights: what a height map's file holds, laid into the scene.
#pragma once

#include "fields/rules.h"

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>

#include "sim/scene/height_field.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

/// Where a map's heights lie in the world.
enum class HeightMapPlace : std::uint8_t {
  centred,        ///< Middle of the map at (0, 0), its first row to the north.
  georeferenced,  ///< Where its tie point and coordinate system say, seen from the rig's origin.
};

struct HeightMapTerrain {
  static constexpr fields::Named kNamed{"height_map",
                                        "Measured heights, from an image or a GeoTIFF."};

  std::string file;
  HeightMapPlace place = HeightMapPlace::centred;
  double scale = 1.0;     ///< Metres for each unit of the file.
  double offset_m = 0.0;  ///< Added to all.
  /// Distance of the nodes, interpolated between those of the file; 0: as in the file.
  double cell_m = 0.0;
  /// Distance of the file's heights; 0: as the file says (GeoTIFF).
  double pixel_m = 0.0;
  double size_m = 0.0;  ///< Edge of the square around (0, 0) that is cut out; 0: all.
  /// Where the file has no height: the lowest of its heights. Otherwise such a file is refused.
  bool fill_gaps = false;
  Material material{.reflectance = 0.3, .label = "ground"};
  std::shared_ptr<const HeightField> heights;  ///< Heights of the file; null until it is loaded.
};
void visit(fields::Visitor& v, HeightMapTerrain& p);

/// Throws std::invalid_argument naming the key, the value and what is allowed. The heights may
/// still be missing.
void validate(const HeightMapTerrain& terrain);

/// The heights of its file, laid out as resampled() does. Throws as both, and when there are none.
[[nodiscard]] HeightField make_height_map(const HeightMapTerrain& terrain);

/// `loaded` laid out as the terrain asks: cut to size, bilinear at nodes `cell_m` apart. Throws
/// std::invalid_argument when the square is not within the map, or has more than 8193 nodes along a
/// side.
[[nodiscard]] HeightField resampled(const HeightField& loaded, double cell_m, double size_m);

}  // namespace rigwire::sim
