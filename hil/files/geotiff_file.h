// Rasters with a place on Earth, as far as heights need them (hil/files/height_map_file.h has the
// tags).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rigwire::hil {

struct GeoRaster {
  /// Where a place of the raster lies in the coordinate system.
  struct TiePoint {
    double column = 0.0;
    double row = 0.0;
    double x = 0.0;
    double y = 0.0;
  };

  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<double> values;  ///< Row 0 first, the northernmost as a rule; NaN: no data.
  std::optional<std::pair<double, double>> pixel;  ///< Size along columns and rows.
  std::optional<TiePoint> tie_point;
  bool pixel_is_area = true;  ///< Whole numbers of column and row are a pixel's corner.
  int epsg = 0;               ///< EPSG code of the coordinate system; 0: not given.
};

/// Throws std::invalid_argument beginning with `who` when the file cannot be read, is damaged, has
/// several samples to a pixel or of an unknown format, or over 16384 pixels along a side.
[[nodiscard]] GeoRaster read_geotiff(const std::filesystem::path& file, const std::string& who);

}  // namespace rigwire::hil
