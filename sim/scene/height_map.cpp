#include "sim/scene/height_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/scene/range_checks.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr double kMostCells = 8192.0;

double bilinear(const HeightField& field, double x_m, double y_m) {
  const double c = std::clamp((x_m - field.origin_m.x()) / field.cell_m, 0.0,
                              static_cast<double>(field.columns - 1));
  const double r = std::clamp((y_m - field.origin_m.y()) / field.cell_m, 0.0,
                              static_cast<double>(field.rows - 1));
  const std::size_t column = std::min(static_cast<std::size_t>(c), field.columns - 2);
  const std::size_t row = std::min(static_cast<std::size_t>(r), field.rows - 2);
  const double a = c - static_cast<double>(column);
  const double b = r - static_cast<double>(row);
  return (1.0 - b) * ((1.0 - a) * field.node(column, row) + a * field.node(column + 1, row)) +
         b * ((1.0 - a) * field.node(column, row + 1) + a * field.node(column + 1, row + 1));
}

constexpr std::array<fields::Choice<HeightMapPlace>, 2> kHeightMapPlaces{
    {{HeightMapPlace::centred, "centred", "The map's middle at (0, 0)."},
     {HeightMapPlace::georeferenced, "georeferenced",
      "Where the file says, seen from the rig's origin."}}};

}  // namespace

void visit(fields::Visitor& v, HeightMapTerrain& p) {
  v.required("file");
  v.file("file", p.file, fields::FileKind::height_map,
         "PNG of 8 or 16 bit, or GeoTIFF; relative to this file.");
  v.choice("place", p.place, kHeightMapPlaces, "Where the map lies.");
  v.number("scale", p.scale, plain().between(-1e4, 1e4), "Metres for each unit of the file.");
  v.number("offset", p.offset_m, in("m").between(-1e5, 1e5), "Added to all heights.");
  v.number("pixel", p.pixel_m, in("m").between(0, 1000),
           "Distance of the file's heights; 0 = as it says itself.");
  v.number("cell", p.cell_m, in("m").between(0, 1000),
           "Distance between two heights of the scene; 0 = a pixel.");
  v.number("size", p.size_m, in("m").between(0, 100'000),
           "Edge of the square around (0, 0); 0 = all.");
  v.boolean("fill_gaps", p.fill_gaps, "Whether missing heights become the lowest.");
  v.section("material", p.material, "Surface of the ground.");
}

void validate(const HeightMapTerrain& terrain) {
  fields::check(terrain);
}

HeightField make_height_map(const HeightMapTerrain& terrain) {
  validate(terrain);
  if (!terrain.heights) {
    throw std::invalid_argument("terrain: the height map '" + terrain.file + "' is not loaded");
  }
  validate(*terrain.heights);
  return resampled(*terrain.heights, terrain.cell_m, terrain.size_m);
}

HeightField resampled(const HeightField& loaded, double cell_m, double size_m) {
  const double cell = cell_m > 0.0 ? cell_m : loaded.cell_m;
  const Eigen::Vector2d extent_m =
      loaded.cell_m * Eigen::Vector2d(static_cast<double>(loaded.columns - 1),
                                      static_cast<double>(loaded.rows - 1));
  Eigen::Vector2d lower = loaded.origin_m;
  Eigen::Vector2d length = extent_m;
  if (size_m > 0.0) {
    const Eigen::Vector2d upper = lower + extent_m;
    if (-0.5 * size_m < lower.maxCoeff() || 0.5 * size_m > upper.minCoeff()) {
      throw std::invalid_argument(
          "terrain.size: found " + fields::shortest(size_m) + " m, but the map reaches from " +
          std::to_string(lower.x()) + " to " + std::to_string(upper.x()) + " m east and from " +
          std::to_string(lower.y()) + " to " + std::to_string(upper.y()) + " m north");
    }
    lower.setConstant(-0.5 * size_m);
    length.setConstant(size_m);
  }
  // A last part of a cell is left out.
  constexpr double kRounding = 1e-9;
  const Eigen::Vector2d cells = (length / cell).array() + kRounding;
  require_within(cells.minCoeff(), 1.0, kMostCells, "", "terrain.cell",
                 "cells along the map's shorter side");
  require_within(cells.maxCoeff(), 1.0, kMostCells, "", "terrain.cell",
                 "cells along the map's longer side");
  HeightField field;
  field.origin_m = lower;
  field.cell_m = cell;
  field.columns = static_cast<std::size_t>(cells.x()) + 1;
  field.rows = static_cast<std::size_t>(cells.y()) + 1;
  field.heights_m.reserve(field.columns * field.rows);
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      field.heights_m.push_back(bilinear(loaded, lower.x() + cell * static_cast<double>(c),
                                         lower.y() + cell * static_cast<double>(r)));
    }
  }
  return field;
}

}  // namespace rigwire::sim
