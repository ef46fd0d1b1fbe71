#include "hil/files/height_map_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "hil/files/geotiff_file.h"
#include "hil/files/image_file.h"
#include "sim/scene/utm.h"

namespace rigwire::hil {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

bool is_png(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  return extension == ".png";
}

GeoRaster read_png_heights(const std::string& file, const std::string& who) {
  const Image image = read_png(file, who);
  GeoRaster raster;
  raster.columns = image.columns;
  raster.rows = image.rows;
  for (std::size_t r = 0; r < image.rows; ++r) {
    for (std::size_t c = 0; c < image.columns; ++c) {
      raster.values.push_back(image.sample(c, r, 0));
    }
  }
  return raster;
}

/// How a coordinate system's numbers become metres about the rig's origin.
struct Grid {
  double origin_x = 0.0;
  double origin_y = 0.0;
  double metres_x = 1.0;  ///< For each unit.
  double metres_y = 1.0;
};

Grid grid_at(int epsg, const OriginPlace& origin, const std::string& who) {
  const int family = epsg / 100;
  if (family == 326 || family == 327 || (family == 258 && epsg >= 25828)) {
    const auto place =
        sim::utm_place(origin.latitude_deg, origin.longitude_deg, epsg % 100, family != 327);
    return {place.easting_m, place.northing_m, 1.0 / place.grid_scale, 1.0 / place.grid_scale};
  }
  if (epsg == 4326 || epsg == 4258) {
    // Radii of the meridian and of the parallel on WGS 84.
    constexpr double kA_m = 6378137.0;
    constexpr double kE2 = 6.69437999014e-3;
    const double latitude = origin.latitude_deg * kRadiansPerDegree;
    const double w = std::sqrt(1.0 - kE2 * std::pow(std::sin(latitude), 2));
    return {origin.longitude_deg, origin.latitude_deg,
            kRadiansPerDegree * kA_m / w * std::cos(latitude),
            kRadiansPerDegree * kA_m * (1.0 - kE2) / std::pow(w, 3)};
  }
  throw std::invalid_argument(fmt::format(
      "{}its coordinate system is {}; georeferenced maps need EPSG 326zz, 327zz, 258zz (UTM), 4326 "
      "or 4258 (degrees)",
      who, epsg == 0 ? "not told" : fmt::format("EPSG {}", epsg)));
}

/// Heights that are missing become the lowest there are, or are refused.
void fill_gaps(const sim::HeightMapTerrain& map, const std::string& who, GeoRaster& raster) {
  double lowest = std::numeric_limits<double>::infinity();
  std::size_t gaps = 0;
  for (const double value : raster.values) {
    gaps += std::isfinite(value) ? 0U : 1U;
    lowest = std::isfinite(value) ? std::min(lowest, map.scale < 0.0 ? -value : value) : lowest;
  }
  if (gaps == raster.values.size()) {
    throw std::invalid_argument(who + "holds no height at all");
  }
  if (gaps > 0 && !map.fill_gaps) {
    throw std::invalid_argument(
        fmt::format("{}{} of {} pixels have no height; `fill_gaps: true` gives them the lowest",
                    who, gaps, raster.values.size()));
  }
  for (double& value : raster.values) {
    if (!std::isfinite(value)) {
      value = map.scale < 0.0 ? -lowest : lowest;
    }
  }
}

/// Size of a pixel, m, and where the middle of the south-western one lies.
struct Layout {
  double pixel_m = 0.0;
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();
};

Layout lay_out(const sim::HeightMapTerrain& map, const GeoRaster& raster, const OriginPlace& origin,
               const std::string& who) {
  const bool placed = map.place == sim::HeightMapPlace::georeferenced;
  if (placed && (!raster.tie_point || !raster.pixel)) {
    throw std::invalid_argument(who +
                                "has no place on Earth (tags 33550 and 33922); it can be "
                                "`place: centred`");
  }
  Grid grid;
  if (placed || (raster.epsg == 4326 || raster.epsg == 4258)) {
    grid = grid_at(raster.epsg, origin, who);
  }
  double pixel_x = map.pixel_m;
  double pixel_y = map.pixel_m;
  if (map.pixel_m == 0.0) {
    if (!raster.pixel) {
      throw std::invalid_argument(who + "does not tell the size of its pixels; give `pixel`");
    }
    pixel_x = std::abs(raster.pixel->first) * grid.metres_x;
    pixel_y = std::abs(raster.pixel->second) * grid.metres_y;
  }
  const double pixel_m = 0.5 * (pixel_x + pixel_y);
  const auto cells = static_cast<double>(std::max(raster.columns, raster.rows) - 1);
  if (!(pixel_m > 0.0) || std::abs(pixel_x - pixel_y) * cells > pixel_m) {
    throw std::invalid_argument(
        fmt::format("{}its pixels measure {} m by {} m; over the map both must agree to a pixel",
                    who, pixel_x, pixel_y));
  }
  const Eigen::Vector2d extent = pixel_m * Eigen::Vector2d(static_cast<double>(raster.columns - 1),
                                                           static_cast<double>(raster.rows - 1));
  if (!placed) {
    return {pixel_m, -0.5 * extent};
  }
  const double middle = raster.pixel_is_area ? 0.5 : 0.0;
  const GeoRaster::TiePoint& tie = *raster.tie_point;
  const double west = (tie.x - grid.origin_x) * grid.metres_x + (middle - tie.column) * pixel_m;
  const double north = (tie.y - grid.origin_y) * grid.metres_y - (middle - tie.row) * pixel_m;
  const Eigen::Vector2d lower(west, north - extent.y());
  if ((lower.array() > 0.0).any() || ((lower + extent).array() < 0.0).any()) {
    throw std::invalid_argument(fmt::format(
        "{}lies from {:.1f} to {:.1f} m east and {:.1f} to {:.1f} m north of the rig's origin "
        "({} deg, {} deg), which it must cover",
        who, lower.x(), lower.x() + extent.x(), lower.y(), lower.y() + extent.y(),
        origin.latitude_deg, origin.longitude_deg));
  }
  return {pixel_m, lower};
}

}  // namespace

std::shared_ptr<const sim::HeightField> load_height_map(const sim::HeightMapTerrain& map,
                                                        const OriginPlace& origin) {
  const std::string who = "height map '" + map.file + "': ";
  GeoRaster raster =
      is_png(map.file) ? read_png_heights(map.file, who) : read_geotiff(map.file, who);
  if (raster.columns < 2 || raster.rows < 2) {
    throw std::invalid_argument(fmt::format("{}has {} x {} pixels, allowed: 2 or more along a side",
                                            who, raster.columns, raster.rows));
  }
  fill_gaps(map, who, raster);
  const Layout layout = lay_out(map, raster, origin, who);
  auto field = std::make_shared<sim::HeightField>();
  field->cell_m = layout.pixel_m;
  field->origin_m = layout.origin_m;
  field->columns = raster.columns;
  field->rows = raster.rows;
  field->heights_m.reserve(raster.values.size());
  for (std::size_t r = raster.rows; r-- > 0;) {
    for (std::size_t c = 0; c < raster.columns; ++c) {
      field->heights_m.push_back(map.scale * raster.values[r * raster.columns + c] + map.offset_m);
    }
  }
  sim::validate(*field);
  return field;
}

}  // namespace rigwire::hil
