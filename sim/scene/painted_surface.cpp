#include "sim/scene/painted_surface.h"

#include <Eigen/Geometry>

namespace rigwire::sim {

std::shared_ptr<const PaintedSurface> painted_surface(const TriangleMesh& mesh) {
  auto surface = std::make_shared<PaintedSurface>();
  surface->colour = mesh.colour;
  if (!mesh.colour->texture) {
    return surface;
  }
  surface->triangles.reserve(mesh.triangles.size());
  for (const auto& [i, j, k] : mesh.triangles) {
    const Eigen::Vector2f at = mesh.texture_coordinates[i];
    const Eigen::Vector2f to_j = mesh.texture_coordinates[j] - at;
    const Eigen::Vector2f to_k = mesh.texture_coordinates[k] - at;
    // With edges a and b, n = a x b: the gradient of what grows by s along a and by t along b is
    // (s (b x n) + t (n x a)) / n^2.
    const Eigen::Vector3d a = (mesh.vertices[j] - mesh.vertices[i]).cast<double>();
    const Eigen::Vector3d b = (mesh.vertices[k] - mesh.vertices[i]).cast<double>();
    const Eigen::Vector3d n = a.cross(b);
    const double square = n.squaredNorm();
    const auto gradient = [&](float s, float t) {
      Eigen::Vector3d grown = Eigen::Vector3d::Zero();
      if (square > 0.0) {
        grown =
            (static_cast<double>(s) * b.cross(n) + static_cast<double>(t) * n.cross(a)) / square;
      }
      return std::array{static_cast<float>(grown.x()), static_cast<float>(grown.y()),
                        static_cast<float>(grown.z())};
    };
    surface->triangles.push_back({{at.x(), at.y(), to_j.x(), to_j.y(), to_k.x(), to_k.y()},
                                  gradient(to_j.x(), to_k.x()),
                                  gradient(to_j.y(), to_k.y())});
  }
  return surface;
}

}  // namespace rigwire::sim
