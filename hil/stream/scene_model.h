// A scene as viewers draw it: entities of foxglove.SceneUpdate whose models are binary glTF,
// fetched by their names ("rigwire:mesh/3", "rigwire:terrain/0/2/5/7").
//
// Terrain is cut into tiles; a tile that was dug gets a new name, and viewers fetch its new state.
// Each part shows at most kMostLeaves triangles of leaves that a scene models one by one, evenly
// chosen: the foliage that is drawn is thinner than the one that rays hit.
//
// Plain data: no thread of its own, no I/O.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/world/view.h"
#include "sim/scene/scene_contents.h"

namespace rigwire::hil {

class SceneModel {
 public:
  static constexpr std::size_t kMostLeaves = 400;
  static constexpr std::size_t kTileCells = 64;

  /// `start_unix_ns`: start of the run, for time stamps.
  SceneModel(const sim::SceneContents& contents, std::int64_t start_unix_ns);

  /// Returns a foxglove.SceneUpdate with everything as it is now, joined from texts that were made
  /// before.
  [[nodiscard]] std::string whole() const;
  /// Applies a change; returns a SceneUpdate of that alone.
  [[nodiscard]] std::string apply(const ViewChange& change);
  /// Returns a glTF file; null when there is none of that name.
  [[nodiscard]] std::shared_ptr<const std::string> asset(std::string_view uri) const;

  /// Returns the JSON Schema of its messages, as far as they have members.
  [[nodiscard]] static std::string schema();

 private:
  struct Entity {
    std::string id;
    std::string frame;
    std::string model;  ///< Name of the model.
    std::string label;  ///< Label of its first surface.
    Eigen::Isometry3d X_FE = Eigen::Isometry3d::Identity();
    double scale = 1.0;
  };
  struct Terrain {
    sim::HeightField field;
    std::vector<std::array<float, 3>> colours;  ///< By label; the last one is the material's.
    std::vector<std::uint8_t> cells;
    std::string label;
    std::size_t columns = 0;  ///< Tiles.
    std::size_t rows = 0;
    std::vector<unsigned> versions;
    std::vector<std::string> texts;  ///< JSON texts of the tiles, as they are sent.
  };
  void add_terrain(const sim::SceneContents::Terrain& terrain);
  void add_things(const sim::SceneContents& contents);
  [[nodiscard]] Entity tile_entity(std::size_t terrain, std::size_t row, std::size_t column) const;
  [[nodiscard]] std::shared_ptr<const std::string> tile(std::size_t terrain, std::size_t row,
                                                        std::size_t column) const;
  [[nodiscard]] std::string text_of(const Entity& entity) const;
  [[nodiscard]] static std::string update(std::span<const std::string* const> entities);
  void show_displaced(const sim::DisplacedThing& thing, std::vector<std::size_t>& changed);

  std::string stamp_;
  std::vector<Terrain> terrains_;
  std::vector<Entity> entities_;
  std::vector<std::string> texts_;  ///< JSON texts of the entities, as they are sent.
  std::map<std::string, std::shared_ptr<const std::string>, std::less<>> models_;
  std::map<std::size_t, std::vector<std::size_t>> of_body_;  ///< Entities of loose bodies.
  std::map<std::uint32_t, std::size_t> of_instance_;         ///< Entities of fixed things.
  /// Things whose pieces may leave, by instance.
  std::map<std::uint32_t, sim::SceneContents::Thing> fixed_;
  std::map<std::uint32_t, sim::SceneContents::Mesh> meshes_;  ///< Meshes of the things in fixed_.
  std::map<std::uint32_t, std::vector<sim::ScenePiece>> taken_out_;  ///< By instance.
  std::map<std::string, std::size_t> pieces_;                        ///< Entities of pieces.
};

}  // namespace rigwire::hil
