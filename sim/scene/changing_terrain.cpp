// The part of Scene and its internals that lets a terrain change.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

Scene::Internals::Terrain& Scene::Internals::terrain_of(std::uint32_t instance) {
  const auto found = std::ranges::find(terrains, instance, &Terrain::instance);
  if (found == terrains.end()) {
    throw std::invalid_argument("scene: instance " + std::to_string(instance) + " is no terrain");
  }
  return *found;
}

Scene::Internals::Tile Scene::Internals::make_tile(const Terrain& terrain, std::size_t first_column,
                                                   std::size_t first_row) {
  const HeightField& field = terrain.field;
  Tile tile;
  tile.first_column = first_column;
  tile.first_row = first_row;
  // One cell over the next tile: no ray along the border may pass between the two.
  tile.columns = std::min(terrain.tile_cells + 2, field.columns - first_column);
  tile.rows = std::min(terrain.tile_cells + 2, field.rows - first_row);
  tile.grid.reset(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_GRID));
  tile.vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(tile.grid.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), tile.columns * tile.rows));
  auto* grid = static_cast<RTCGrid*>(rtcSetNewGeometryBuffer(
      tile.grid.get(), RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), 1));
  check("terrain tile");
  float* vertex = tile.vertices;
  // The same floats as in the undivided terrain.
  for (std::size_t r = first_row; r < first_row + tile.rows; ++r) {
    for (std::size_t c = first_column; c < first_column + tile.columns; ++c) {
      *vertex++ = static_cast<float>(field.origin_m.x() - terrain.centre_W.x() +
                                     field.cell_m * static_cast<double>(c));
      *vertex++ = static_cast<float>(field.origin_m.y() - terrain.centre_W.y() +
                                     field.cell_m * static_cast<double>(r));
      *vertex++ = static_cast<float>(field.node(c, r) - terrain.centre_W.z());
    }
  }
  *grid = {.startVertexID = 0,
           .stride = static_cast<unsigned>(tile.columns),
           .width = static_cast<unsigned short>(tile.columns),
           .height = static_cast<unsigned short>(tile.rows)};
  rtcCommitGeometry(tile.grid.get());
  tile.inner.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(tile.inner.get(),
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  rtcAttachGeometry(tile.inner.get(), tile.grid.get());
  rtcCommitScene(tile.inner.get());
  tile.placed.reset(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(tile.placed.get(), tile.inner.get());
  rtcSetGeometryMask(tile.placed.get(), 1U);
  const Shading surface = shading[placed_of(terrain.instance).geometry_id];
  rtcAttachGeometryByID(moving.get(), tile.placed.get(), new_moving_id(terrain.instance, surface));
  check("terrain tile");
  return tile;
}

void Scene::Internals::refresh_terrains() {
  for (Terrain& terrain : terrains) {
    if (!terrain.staged || (terrain.shown && t0 - *terrain.shown < terrain_period)) {
      continue;
    }
    const NodeRectangle changed = *terrain.staged;
    for (Tile& tile : terrain.tiles) {
      const std::size_t first_column = std::max(changed.first_column, tile.first_column);
      const std::size_t first_row = std::max(changed.first_row, tile.first_row);
      const std::size_t end_column =
          std::min(changed.last_column + 1, tile.first_column + tile.columns);
      const std::size_t end_row = std::min(changed.last_row + 1, tile.first_row + tile.rows);
      if (first_column >= end_column || first_row >= end_row) {
        continue;
      }
      for (std::size_t r = first_row; r < end_row; ++r) {
        for (std::size_t c = first_column; c < end_column; ++c) {
          const std::size_t vertex = (r - tile.first_row) * tile.columns + (c - tile.first_column);
          tile.vertices[3 * vertex + 2] =
              static_cast<float>(terrain.field.node(c, r) - terrain.centre_W.z());
        }
      }
      rtcUpdateGeometryBuffer(tile.grid.get(), RTC_BUFFER_TYPE_VERTEX, 0);
      rtcCommitGeometry(tile.grid.get());
      rtcCommitScene(tile.inner.get());
      rtcCommitGeometry(tile.placed.get());
    }
    terrain.staged.reset();
    terrain.shown = t0;
  }
}

void Scene::make_changeable(InstanceId terrain) {
  Internals& in = *internals_;
  Internals::Terrain& changing = in.terrain_of(terrain);
  if (!changing.tiles.empty()) {
    return;
  }
  rtcDetachGeometry(in.fixed.get(), in.placed_of(terrain).geometry_id);
  // Small tiles are quick to rebuild; every slice pays for their number.
  constexpr std::size_t kLeastCells = 32;
  constexpr std::size_t kTilesAlong = 16;
  const std::size_t nodes = std::max(changing.field.columns, changing.field.rows);
  changing.tile_cells = std::max(kLeastCells, (nodes + kTilesAlong - 1) / kTilesAlong);
  for (std::size_t r = 0; r + 1 < changing.field.rows; r += changing.tile_cells) {
    for (std::size_t c = 0; c + 1 < changing.field.columns; c += changing.tile_cells) {
      changing.tiles.push_back(in.make_tile(changing, c, r));
    }
  }
  in.ground_moves = true;
  in.fixed_placed = false;
}

void Scene::set_terrain_period(Duration period) {
  internals_->terrain_period = period;
}

void Scene::update_terrain(InstanceId terrain, const HeightField& field,
                           const NodeRectangle& changed) {
  Internals::Terrain& changing = internals_->terrain_of(terrain);
  HeightField& staged = changing.field;
  if (changing.tiles.empty()) {
    throw std::invalid_argument("scene: terrain " + std::to_string(terrain) +
                                " was not made changeable");
  }
  if (field.columns != staged.columns || field.rows != staged.rows ||
      field.heights_m.size() != staged.heights_m.size() ||
      changed.first_column > changed.last_column || changed.first_row > changed.last_row ||
      changed.last_column >= field.columns || changed.last_row >= field.rows) {
    throw std::invalid_argument("scene: the changed nodes do not lie in terrain " +
                                std::to_string(terrain));
  }
  for (std::size_t r = changed.first_row; r <= changed.last_row; ++r) {
    for (std::size_t c = changed.first_column; c <= changed.last_column; ++c) {
      const double height_m = field.node(c, r);
      if (!std::isfinite(height_m)) {
        throw std::invalid_argument("scene: height at column " + std::to_string(c) + ", row " +
                                    std::to_string(r) + " is not a finite number");
      }
      staged.heights_m[r * staged.columns + c] = height_m;
    }
  }
  changing.staged = changing.staged ? changing.staged->joined(changed) : changed;
}

}  // namespace rigwire::sim
