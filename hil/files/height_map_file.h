// Heights from PNG images and GeoTIFF rasters.
//
// GeoTIFF: OGC 19-008r4, "OGC GeoTIFF Standard 1.1": ModelPixelScale (33550) and ModelTiepoint
// (33922), GeoKeys in 34735; GDAL's no-data value in 42113, as text. Rasters of 8, 16 or 32 bit
// integers or 32 or 64 bit floats, one sample to the pixel, strips or tiles, any compression that
// libtiff knows.
#pragma once

#include <memory>
#include <utility>

#include "sim/scene/height_map.h"

namespace rigwire::hil {

struct OriginPlace {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

/// The file's heights in the world of a rig with this origin, scaled and shifted, neither cut nor
/// interpolated; each pixel's middle is a node. A PNG (grey, 8 or 16 bit; of colours the first)
/// needs `pixel_m`; a GeoTIFF has its own, which `pixel_m` overrides.
///
/// A georeferenced map must have a coordinate system of the UTM zones on WGS 84 or ETRS 89 (EPSG
/// 326zz, 327zz, 258zz), or longitude and latitude in degrees (EPSG 4326, 4258), and cover the
/// origin. World coordinates are the differences of eastings and northings, divided by the grid's
/// scale; its convergence, up to 3 degrees at a zone's edge, is not turned back. Degrees are taken
/// by the ellipsoid's radii at the origin.
///
/// Throws std::invalid_argument naming the file and what is wrong with it: missing, damaged, of
/// another kind, fewer than 2 or more than 16384 pixels along a side, pixels of unknown or unequal
/// size, no heights somewhere without `fill_gaps`, no coordinate system, or an origin beyond its
/// edges.
[[nodiscard]] std::shared_ptr<const sim::HeightField> load_height_map(
    const sim::HeightMapTerrain& map, const OriginPlace& origin);

}  // namespace rigwire::hil
