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
  bool in_degrees = false;
};

/// Metres in a degree of the meridian and of the parallel on WGS 84.
struct DegreeLengths {
  double along_meridian_m = 0.0;
  double along_parallel_m = 0.0;
};
DegreeLengths degree_at(double latitude_deg) {
  constexpr double kA_m = 6378137.0;
  constexpr double kE2 = 6.69437999014e-3;
  const double latitude = latitude_deg * kRadiansPerDegree;
  const double w = std::sqrt(1.0 - kE2 * std::pow(std::sin(latitude), 2));
  return {kRadiansPerDegree * kA_m * (1.0 - kE2) / std::pow(w, 3),
          kRadiansPerDegree * kA_m / w * std::cos(latitude)};
}

Grid grid_at(int epsg, const OriginPlace& origin, const std::string& who) {
  const int family = epsg / 100;
  if (family == 326 || family == 327 || (family == 258 && epsg >= 25828)) {
    const auto place =
        sim::utm_place(origin.latitude_deg, origin.longitude_deg, epsg % 100, family != 327);
    return {place.easting_m, place.northing_m, 1.0 / place.grid_scale, 1.0 / place.grid_scale,
            false};
  }
  if (epsg == 4326 || epsg == 4258) {
    const DegreeLengths degree = degree_at(origin.latitude_deg);
    return {origin.longitude_deg, origin.latitude_deg, degree.along_parallel_m,
            degree.along_meridian_m, true};
  }
  throw std::invalid_argument(fmt::format(
      "{}its coordinate system is {}; georeferenced maps need EPSG 326zz, 327zz, 258zz (UTM), 4326 "
      "or 4258 (degrees)",
      who, epsg == 0 ? "unknown" : fmt::format("EPSG {}", epsg)));
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
  Eigen::Vector2d pixel_m = Eigen::Vector2d::Zero();  ///< East, north.
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();
  bool in_degrees = false;
  bool is_square = false;  ///< Over the whole map both sides of a pixel agree to a pixel.
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
      throw std::invalid_argument(who + "has no size of its pixels; give `pixel`");
    }
    pixel_x = std::abs(raster.pixel->first) * grid.metres_x;
    pixel_y = std::abs(raster.pixel->second) * grid.metres_y;
  }
  if (!(pixel_x > 0.0 && pixel_y > 0.0)) {
    throw std::invalid_argument(
        fmt::format("{}its pixels measure {} m by {} m, allowed above 0", who, pixel_x, pixel_y));
  }
  const auto cells = static_cast<double>(std::max(raster.columns, raster.rows) - 1);
  const double mean = 0.5 * (pixel_x + pixel_y);
  Layout layout;
  layout.in_degrees = grid.in_degrees && placed;
  layout.is_square = std::abs(pixel_x - pixel_y) * cells <= mean;
  layout.pixel_m =
      layout.is_square ? Eigen::Vector2d(mean, mean) : Eigen::Vector2d(pixel_x, pixel_y);
  const Eigen::Vector2d extent = layout.pixel_m.cwiseProduct(Eigen::Vector2d(
      static_cast<double>(raster.columns - 1), static_cast<double>(raster.rows - 1)));
  if (!placed) {
    layout.origin_m = -0.5 * extent;
    return layout;
  }
  const double middle = raster.pixel_is_area ? 0.5 : 0.0;
  const GeoRaster::TiePoint& tie = *raster.tie_point;
  const double west =
      (tie.x - grid.origin_x) * grid.metres_x + (middle - tie.column) * layout.pixel_m.x();
  const double north =
      (tie.y - grid.origin_y) * grid.metres_y - (middle - tie.row) * layout.pixel_m.y();
  const Eigen::Vector2d lower(west, north - extent.y());
  if ((lower.array() > 0.0).any() || ((lower + extent).array() < 0.0).any()) {
    throw std::invalid_argument(fmt::format(
        "{}lies from {:.1f} to {:.1f} m east and {:.1f} to {:.1f} m north of the rig's origin "
        "({} deg, {} deg), which it must cover",
        who, lower.x(), lower.x() + extent.x(), lower.y(), lower.y() + extent.y(),
        origin.latitude_deg, origin.longitude_deg));
  }
  layout.origin_m = lower;
  return layout;
}

/// A grid of square cells, as wide as a pixel's shorter side, from a map whose pixels are none
/// (equal steps in degrees are 0.65 as wide as high at 50 degrees north). Bilinear between the
/// pixels' middles; of a map in degrees each row counts the length of its own parallel.
GeoRaster with_square_cells(const GeoRaster& raster, const Layout& layout,
                            const OriginPlace& origin, const std::string& who) {
  constexpr double kMost = 32768.0;
  const double cell_m = layout.pixel_m.minCoeff();
  const Eigen::Vector2d cells =
      layout.pixel_m.cwiseProduct(Eigen::Vector2d(static_cast<double>(raster.columns - 1),
                                                  static_cast<double>(raster.rows - 1))) /
      cell_m;
  if (cells.maxCoeff() >= kMost) {
    throw std::invalid_argument(fmt::format(
        "{}needs {:.0f} by {:.0f} square cells of {:.3f} m, allowed {:.0f} along a side", who,
        cells.x(), cells.y(), cell_m, kMost));
  }
  GeoRaster square = raster;
  square.columns = static_cast<std::size_t>(cells.x() + 1e-6) + 1;
  square.rows = static_cast<std::size_t>(cells.y() + 1e-6) + 1;
  square.values.clear();
  square.values.reserve(square.columns * square.rows);
  const DegreeLengths at_origin = degree_at(origin.latitude_deg);
  const auto last_column = static_cast<double>(raster.columns - 1);
  const auto last_row = static_cast<double>(raster.rows - 1);
  const auto north_edge_m = layout.origin_m.y() + layout.pixel_m.y() * last_row;
  const auto south_edge_m = layout.origin_m.y();
  for (std::size_t r = 0; r < square.rows; ++r) {  // from the north, as the raster
    const double north_m = south_edge_m + cell_m * static_cast<double>(square.rows - 1 - r);
    const double widening =
        layout.in_degrees
            ? at_origin.along_parallel_m /
                  degree_at(origin.latitude_deg + north_m / at_origin.along_meridian_m)
                      .along_parallel_m
            : 1.0;
    const double row = std::clamp((north_edge_m - north_m) / layout.pixel_m.y(), 0.0, last_row);
    const auto r0 = std::min(static_cast<std::size_t>(row), raster.rows - 2);
    const double down = row - static_cast<double>(r0);
    for (std::size_t c = 0; c < square.columns; ++c) {
      const double east_m = layout.origin_m.x() + cell_m * static_cast<double>(c);
      const double column = std::clamp(
          (east_m * widening - layout.origin_m.x()) / layout.pixel_m.x(), 0.0, last_column);
      const auto c0 = std::min(static_cast<std::size_t>(column), raster.columns - 2);
      const double right = column - static_cast<double>(c0);
      const auto value = [&](std::size_t dr, std::size_t dc) {
        return raster.values[(r0 + dr) * raster.columns + c0 + dc];
      };
      square.values.push_back((1.0 - down) * ((1.0 - right) * value(0, 0) + right * value(0, 1)) +
                              down * ((1.0 - right) * value(1, 0) + right * value(1, 1)));
    }
  }
  return square;
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
  if (!layout.is_square) {
    raster = with_square_cells(raster, layout, origin, who);
  }
  auto field = std::make_shared<sim::HeightField>();
  field->cell_m = layout.pixel_m.minCoeff();
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
