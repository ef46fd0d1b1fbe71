#include "sim/scene/mesh_repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace rigwire::sim {
namespace {

constexpr std::size_t kMostTriangles = 5'000'000;

enum class Fault { none, not_finite, too_far, no_area };

Fault fault(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const bool textured = !mesh.texture_coordinates.empty();
  for (const std::uint32_t i : triangle) {
    if (!mesh.vertices[i].allFinite() || (textured && !mesh.texture_coordinates[i].allFinite())) {
      return Fault::not_finite;
    }
  }
  for (const std::uint32_t i : triangle) {
    if (mesh.vertices[i].cast<double>().norm() > kFarthestVertex_m) {
      return Fault::too_far;
    }
  }
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3d ab = (mesh.vertices[b] - mesh.vertices[a]).cast<double>();
  const Eigen::Vector3d ac = (mesh.vertices[c] - mesh.vertices[a]).cast<double>();
  return ab.cross(ac).squaredNorm() > 0.0 ? Fault::none : Fault::no_area;
}

void forget_unused_vertices(TriangleMesh& mesh) {
  constexpr auto kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(mesh.vertices.size(), kUnused);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t i : triangle) {
      place[i] = 0;
    }
  }
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == kUnused) {
      continue;
    }
    mesh.vertices[next] = mesh.vertices[i];
    if (!mesh.texture_coordinates.empty()) {
      mesh.texture_coordinates[next] = mesh.texture_coordinates[i];
    }
    place[i] = next++;
  }
  mesh.vertices.resize(next);
  if (!mesh.texture_coordinates.empty()) {
    mesh.texture_coordinates.resize(next);
  }
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& i : triangle) {
      i = place[i];
    }
  }
}

/// Middles of the edges that are split, each made once.
class Middles {
 public:
  Middles(TriangleMesh& mesh, double longest_m) : mesh_(mesh), longest_m_(longest_m) {}

  [[nodiscard]] bool too_long(std::uint32_t i, std::uint32_t j) const {
    return static_cast<double>((mesh_.vertices[i] - mesh_.vertices[j]).norm()) > longest_m_;
  }
  std::uint32_t of(std::uint32_t i, std::uint32_t j) {
    const auto [low, high] = std::minmax(i, j);
    const std::uint64_t key = (static_cast<std::uint64_t>(low) << 32U) | high;
    const auto [entry, is_new] =
        made_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) {
      const Eigen::Vector3f middle = 0.5F * (mesh_.vertices[low] + mesh_.vertices[high]);
      mesh_.vertices.push_back(middle);
      if (!mesh_.texture_coordinates.empty()) {
        const Eigen::Vector2f uv =
            0.5F * (mesh_.texture_coordinates[low] + mesh_.texture_coordinates[high]);
        mesh_.texture_coordinates.push_back(uv);
      }
    }
    return entry->second;
  }

 private:
  TriangleMesh& mesh_;
  double longest_m_;
  std::unordered_map<std::uint64_t, std::uint32_t> made_;
};

}  // namespace

DroppedTriangles& DroppedTriangles::operator+=(const DroppedTriangles& other) {
  not_finite += other.not_finite;
  too_far += other.too_far;
  no_area += other.no_area;
  return *this;
}

DroppedTriangles drop_bad_triangles(TriangleMesh& mesh) {
  DroppedTriangles dropped;
  std::erase_if(mesh.triangles, [&](const auto& triangle) {
    const Fault found = fault(mesh, triangle);
    dropped.not_finite += found == Fault::not_finite ? 1U : 0U;
    dropped.too_far += found == Fault::too_far ? 1U : 0U;
    dropped.no_area += found == Fault::no_area ? 1U : 0U;
    return found != Fault::none;
  });
  forget_unused_vertices(mesh);
  return dropped;
}

void tessellate(TriangleMesh& mesh, double longest_m) {
  const auto refuse = [&] {
    throw std::invalid_argument("mesh '" + mesh.name + "': split into triangles of " +
                                std::to_string(longest_m) + " m it has more than " +
                                std::to_string(kMostTriangles) + " of them");
  };
  // No triangle with such edges is larger than the equilateral one.
  double twice_area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d ab = (mesh.vertices[b] - mesh.vertices[a]).cast<double>();
    const Eigen::Vector3d ac = (mesh.vertices[c] - mesh.vertices[a]).cast<double>();
    twice_area += ab.cross(ac).norm();
  }
  if (twice_area >
      0.5 * std::numbers::sqrt3 * longest_m * longest_m * static_cast<double>(kMostTriangles)) {
    refuse();
  }
  bool split = true;
  while (split) {
    split = false;
    Middles middles(mesh, longest_m);
    std::vector<std::array<std::uint32_t, 3>> finer;
    finer.reserve(mesh.triangles.size());
    for (auto [a, b, c] : mesh.triangles) {
      // Turn the triangle until its long edges come first: ab, then bc, then ca.
      int count = 0;
      for (int turn = 0; turn < 3; ++turn) {
        const bool ab = middles.too_long(a, b);
        const bool bc = middles.too_long(b, c);
        const bool ca = middles.too_long(c, a);
        count = (ab ? 1 : 0) + (bc ? 1 : 0) + (ca ? 1 : 0);
        if (count == 0 || count == 3 || (count == 1 && ab) || (count == 2 && ab && bc)) {
          break;
        }
        std::tie(a, b, c) = std::tuple(b, c, a);
      }
      split = split || count > 0;
      if (count == 0) {
        finer.push_back({a, b, c});
      } else if (count == 1) {
        const std::uint32_t ab = middles.of(a, b);
        finer.insert(finer.end(), {{a, ab, c}, {ab, b, c}});
      } else if (count == 2) {
        const std::uint32_t ab = middles.of(a, b);
        const std::uint32_t bc = middles.of(b, c);
        finer.insert(finer.end(), {{ab, b, bc}, {a, ab, bc}, {a, bc, c}});
      } else {
        const std::uint32_t ab = middles.of(a, b);
        const std::uint32_t bc = middles.of(b, c);
        const std::uint32_t ca = middles.of(c, a);
        finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
      }
      if (finer.size() > kMostTriangles) {
        refuse();
      }
    }
    mesh.triangles = std::move(finer);
  }
}

}  // namespace rigwire::sim
