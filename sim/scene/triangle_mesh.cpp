#include "sim/scene/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "sim/scene/colour_texture.h"

namespace rigwire::sim {
namespace {

[[noreturn]] void refuse(const TriangleMesh& mesh, const std::string& what) {
  throw std::invalid_argument("mesh '" + mesh.name + "': " + what);
}

/// Icosahedron with every triangle split into four, twice, on the unit sphere.
TriangleMesh make_sphere(std::string name) {
  TriangleMesh mesh;
  mesh.name = std::move(name);
  const float g = std::numbers::phi_v<float>;
  for (const float a : {-1.0F, 1.0F}) {
    for (const float b : {-g, g}) {
      mesh.vertices.insert(mesh.vertices.end(), {{a, b, 0.0F}, {0.0F, a, b}, {b, 0.0F, a}});
    }
  }
  // Faces of the icosahedron: the triples whose corners are one edge (2) apart, facing outwards.
  const auto adjacent = [&](std::uint32_t i, std::uint32_t j) {
    return std::abs((mesh.vertices[i] - mesh.vertices[j]).norm() - 2.0F) < 1e-3F;
  };
  for (std::uint32_t i = 0; i < 12; ++i) {
    for (std::uint32_t j = i + 1; j < 12; ++j) {
      for (std::uint32_t k = j + 1; k < 12; ++k) {
        if (!adjacent(i, j) || !adjacent(j, k) || !adjacent(i, k)) {
          continue;
        }
        const Eigen::Vector3f& a = mesh.vertices[i];
        const bool outward = (mesh.vertices[j] - a).cross(mesh.vertices[k] - a).dot(a) > 0.0F;
        mesh.triangles.push_back(outward ? std::array{i, j, k} : std::array{i, k, j});
      }
    }
  }
  for (int level = 0; level < 2; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t i, std::uint32_t j) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(i, j), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) {
        const Eigen::Vector3f centre = 0.5F * (mesh.vertices[i] + mesh.vertices[j]);
        mesh.vertices.push_back(centre);
      }
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto ab = middle(a, b);
      const auto bc = middle(b, c);
      const auto ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (auto& vertex : mesh.vertices) {
    vertex.normalize();
  }
  return mesh;
}

}  // namespace

void validate(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) {
    refuse(mesh, "has no triangle");
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!mesh.vertices[i].allFinite()) {
      refuse(mesh, "vertex " + std::to_string(i) + " is not a finite number");
    }
  }
  bool any_area = false;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t index : mesh.triangles[i]) {
      if (index >= mesh.vertices.size()) {
        refuse(mesh, "triangle " + std::to_string(i) + " names vertex " + std::to_string(index) +
                         ", there are " + std::to_string(mesh.vertices.size()));
      }
    }
    const auto& [a, b, c] = mesh.triangles[i];
    any_area = any_area || (mesh.vertices[b] - mesh.vertices[a])
                                   .cross(mesh.vertices[c] - mesh.vertices[a])
                                   .squaredNorm() > 0.0F;
  }
  if (!any_area) {
    refuse(mesh, "all triangles have zero area");
  }
  const bool textured = mesh.colour && mesh.colour->texture;
  if (mesh.alpha) {
    validate(*mesh.alpha);
  } else if (!textured) {
    return;
  }
  if (mesh.texture_coordinates.size() != mesh.vertices.size()) {
    refuse(mesh, std::string("has a ") + (mesh.alpha ? "mask" : "texture") + " and " +
                     std::to_string(mesh.texture_coordinates.size()) + " texture coordinates for " +
                     std::to_string(mesh.vertices.size()) + " vertices");
  }
  for (std::size_t i = 0; i < mesh.texture_coordinates.size(); ++i) {
    if (!mesh.texture_coordinates[i].allFinite()) {
      refuse(mesh, "texture coordinate " + std::to_string(i) + " is not a finite number");
    }
  }
}

TriangleMesh make_box(std::string name, const Eigen::Vector3d& lengths_m) {
  TriangleMesh mesh;
  mesh.name = std::move(name);
  if (!lengths_m.allFinite() || lengths_m.minCoeff() <= 0.0) {
    refuse(mesh, "a box needs positive lengths");
  }
  const Eigen::Vector3f half = (0.5 * lengths_m).cast<float>();
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices.emplace_back((corner & 1) != 0 ? half.x() : -half.x(),
                               (corner & 2) != 0 ? half.y() : -half.y(),
                               (corner & 4) != 0 ? half.z() : -half.z());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh make_rock(std::string name, RandomStream& random) {
  TriangleMesh mesh = make_sphere(std::move(name));
  constexpr int kCuts = 14;
  for (int cut = 0; cut < kCuts; ++cut) {
    const Eigen::Vector3f normal =
        Eigen::Vector3d(random.gaussian(), random.gaussian(), random.gaussian())
            .normalized()
            .cast<float>();
    const auto distance = static_cast<float>(random.uniform(0.6, 0.9));
    for (auto& vertex : mesh.vertices) {
      // Cuts by a plane: vertices beyond it are drawn in along their rays.
      const float height = vertex.dot(normal);
      if (height > distance) {
        vertex *= distance / height;
      }
    }
  }
  for (auto& vertex : mesh.vertices) {
    // Roughness of 3 % at most, inwards.
    vertex *= static_cast<float>(random.uniform(0.97, 1.0));
  }
  return mesh;
}

}  // namespace rigwire::sim
