#include "sim/scene/revolution.h"

#include <Eigen/Geometry>
#include <cmath>

#include "fields/constants.h"

namespace rigwire::sim {
void add_revolution(TriangleMesh& mesh, const Eigen::Vector3d& foot_m, double yaw_rad, int sides,
                    std::span<const Ring> rings) {
  std::uint32_t below = 0;
  bool first = true;
  const auto count = static_cast<std::uint32_t>(sides);
  for (const Ring& ring : rings) {
    const auto start = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int side = 0; side < sides; ++side) {
      const double angle = yaw_rad + kTurn * side / sides;
      mesh.vertices.push_back((foot_m + Eigen::Vector3d(ring.radius_m * std::cos(angle),
                                                        ring.radius_m * std::sin(angle), ring.z_m))
                                  .cast<float>());
    }
    for (std::uint32_t side = 0; side < count && !first; ++side) {
      const std::uint32_t next = (side + 1) % count;
      mesh.triangles.push_back({below + side, below + next, start + next});
      mesh.triangles.push_back({below + side, start + next, start + side});
    }
    below = start;
    first = false;
  }
}

void add_tube(TriangleMesh& mesh, std::span<const TubePoint> points, int sides) {
  const Eigen::Vector3d along = (points.back().centre_m - points.front().centre_m).normalized();
  const Eigen::Vector3d across = along.unitOrthogonal();
  const Eigen::Vector3d other = along.cross(across);
  const auto count = static_cast<std::uint32_t>(sides);
  std::uint32_t below = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto start = static_cast<std::uint32_t>(mesh.vertices.size());
    const TubePoint& point = points[i];
    const bool tip = point.radius_m <= 0.0;
    for (int side = 0; side < (tip ? 1 : sides); ++side) {
      const double angle = kTurn * side / sides;
      mesh.vertices.push_back(
          (point.centre_m + point.radius_m * (std::cos(angle) * across + std::sin(angle) * other))
              .cast<float>());
    }
    for (std::uint32_t side = 0; side < count && i > 0; ++side) {
      const std::uint32_t next = (side + 1) % count;
      if (tip) {
        mesh.triangles.push_back({below + side, below + next, start});
      } else {
        mesh.triangles.push_back({below + side, below + next, start + next});
        mesh.triangles.push_back({below + side, start + next, start + side});
      }
    }
    below = start;
  }
}

}  // namespace rigwire::sim
