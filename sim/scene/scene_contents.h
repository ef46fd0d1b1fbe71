// The contents of a scene as plain lists, for renderers other than the ray caster.
//
// It is a copy of the scene at the time of the call; terrain has its staged heights. Canopies,
// which only radio signals hit, and masks of leaves are left out: a card of leaves is drawn whole.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/height_field.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

struct MeshColour;

struct SceneContents {
  /// Surface of one material.
  struct Part {
    std::vector<float> vertices_m;       ///< x y z each, in the mesh's frame M.
    std::vector<std::uint32_t> corners;  ///< Three for each triangle.
  };
  struct Mesh {
    std::string name;
    std::vector<Part> parts;
  };
  struct Surface {
    Material material;
    std::shared_ptr<const MeshColour> colour;  ///< Colour of its own; null: as its label looks.
  };
  struct Thing {
    Scene::InstanceId instance = 0;  ///< Its first.
    std::string name;
    std::size_t mesh = 0;               ///< In `meshes`.
    std::vector<Surface> surfaces;      ///< One for each of the mesh's parts.
    std::optional<Scene::BodyId> body;  ///< Body that carries it; empty: it is fixed.
    Eigen::Isometry3d X_PM = Eigen::Isometry3d::Identity();  ///< In the world, or in its body.
    double scale = 1.0;
  };
  struct Terrain {
    Scene::InstanceId instance = 0;
    HeightField field;
    Material material;
    std::vector<std::string> labels;  ///< Labels of its cover; empty: its material everywhere.
    std::vector<std::uint8_t> cells;  ///< Index in `labels` for each cell, row by row.
  };
  struct Body {
    std::string name;
    bool loose = false;  ///< Not of the machine.
  };

  std::vector<Mesh> meshes;
  std::vector<Thing> things;
  std::vector<Terrain> terrains;
  std::vector<Body> bodies;
};

[[nodiscard]] SceneContents contents_of(const Scene& scene);

/// A piece of something fixed that has left its place (Scene::displace()).
struct DisplacedThing {
  ScenePiece piece;
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
};
/// Returns those that rays hit, without those that only radio signals hit.
[[nodiscard]] std::vector<DisplacedThing> displaced_things(const ScenePlacement& placement);

}  // namespace rigwire::sim
