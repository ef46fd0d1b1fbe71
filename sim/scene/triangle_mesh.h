// Triangle meshes: what rocks, trucks and machine links are made of.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/random.h"
#include "sim/scene/alpha_mask.h"

namespace rigwire::sim {

/// colour_texture.h
struct MeshColour;

/// Metres in the mesh's own frame M, which should have its origin near the body: vertices are
/// floats, good for 0.01 mm within 100 m.
struct TriangleMesh {
  std::string name;  ///< For messages.
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// Where each vertex lies in mask and texture; empty without either.
  std::vector<Eigen::Vector2f> texture_coordinates{};
  /// Holes of the surface; null: none. Meshes share it.
  std::shared_ptr<const AlphaMask> alpha{};
  /// What its file calls the surface; empty: nothing. Meshes of one name and several materials make
  /// up one object.
  std::string material{};
  /// What cameras see; null: what the look of its material's label says. No ray minds it.
  std::shared_ptr<const MeshColour> colour{};
};

/// Throws std::invalid_argument naming the mesh when it has no triangle, a vertex that is not a
/// finite number, an index past the last vertex, triangles of which not one has an area, or a mask
/// or a texture without a finite texture coordinate for each vertex.
void validate(const TriangleMesh& mesh);

/// A box of the given full lengths, centred on the origin, 12 triangles facing outwards. Throws
/// std::invalid_argument unless all lengths are positive and finite.
[[nodiscard]] TriangleMesh make_box(std::string name, const Eigen::Vector3d& lengths_m);

/// A boulder of 162 vertices within 0.55 to 1 m of the origin: a sphere cut by random planes, as
/// broken rock is, and slightly rough. Scale it by instancing.
[[nodiscard]] TriangleMesh make_rock(std::string name, RandomStream& random);

}  // namespace rigwire::sim
