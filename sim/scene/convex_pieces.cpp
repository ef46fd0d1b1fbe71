#include "sim/scene/convex_pieces.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kLeastSize_m = 0.1;
constexpr double kHalfThickness_m = 0.01;
constexpr std::size_t kMostPieces = 256;

/// Disjoint sets with path halving.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::size_t> parent_;
};

/// At most kMostHullPoints of them: the farthest along directions spread evenly over the sphere.
std::vector<Vector> outermost(const std::vector<Vector>& points) {
  if (points.size() <= kMostHullPoints) {
    return points;
  }
  std::vector<Vector> kept;
  const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t i = 0; i < kMostHullPoints; ++i) {
    // Fibonacci's spiral.
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / kMostHullPoints;
    const double angle = turn * static_cast<double>(i);
    const double level = std::sqrt(1.0 - z * z);
    const Vector direction(level * std::cos(angle), level * std::sin(angle), z);
    const Vector& farthest =
        *std::ranges::max_element(points, {}, [&](const Vector& p) { return p.dot(direction); });
    if (std::ranges::find(kept, farthest) == kept.end()) {
      kept.push_back(farthest);
    }
  }
  return kept;
}

/// Null for what is a line or a point.
std::shared_ptr<const ConvexShape> hull_of(const std::vector<Vector>& points) {
  Vector middle = Vector::Zero();
  for (const Vector& p : points) {
    middle += p / static_cast<double>(points.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector& p : points) {
    spread += (p - middle) * (p - middle).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const Vector extent = (axes.eigenvalues() / static_cast<double>(points.size())).cwiseMax(0.0);
  if (std::sqrt(extent[1]) < 1e-3) {
    return nullptr;
  }
  if (std::sqrt(extent[0]) < 1e-3) {
    // Flat: both sides of its plane.
    const Vector across = kHalfThickness_m * axes.eigenvectors().col(0);
    std::vector<Vector> thick;
    for (const Vector& p : points) {
      thick.push_back(p + across);
      thick.push_back(p - across);
    }
    return std::make_shared<const ConvexShape>(ConvexShape::hull(outermost(thick)));
  }
  return std::make_shared<const ConvexShape>(ConvexShape::hull(outermost(points)));
}

}  // namespace

std::vector<std::shared_ptr<const ConvexShape>> convex_pieces(std::span<const TriangleMesh> meshes,
                                                              double scale) {
  std::vector<Vector> points;
  std::map<std::array<float, 3>, std::size_t> places;
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const TriangleMesh& mesh : meshes) {
    std::vector<std::size_t> index;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      const auto [place, fresh] =
          places.try_emplace({vertex.x(), vertex.y(), vertex.z()}, points.size());
      if (fresh) {
        points.push_back(scale * vertex.cast<double>());
      }
      index.push_back(place->second);
    }
    for (const auto& triangle : mesh.triangles) {
      triangles.push_back({index[triangle[0]], index[triangle[1]], index[triangle[2]]});
    }
  }
  Sets sets(points.size());
  std::vector<bool> used(points.size(), false);
  for (const auto& triangle : triangles) {
    sets.join(triangle[0], triangle[1]);
    sets.join(triangle[1], triangle[2]);
    for (const std::size_t corner : triangle) {
      used[corner] = true;
    }
  }
  std::map<std::size_t, std::vector<Vector>> parts;
  std::vector<Vector> all;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (used[i]) {
      parts[sets.root(i)].push_back(points[i]);
      all.push_back(points[i]);
    }
  }
  std::erase_if(parts, [](const auto& part) {
    Vector least = part.second.front();
    Vector greatest = least;
    for (const Vector& p : part.second) {
      least = least.cwiseMin(p);
      greatest = greatest.cwiseMax(p);
    }
    return (greatest - least).norm() < kLeastSize_m;
  });
  std::vector<std::shared_ptr<const ConvexShape>> pieces;
  if (parts.size() > kMostPieces) {
    pieces.push_back(hull_of(all));
  } else {
    for (const auto& [root, part] : parts) {
      pieces.push_back(hull_of(part));
    }
  }
  std::erase(pieces, nullptr);
  return pieces;
}

}  // namespace rigwire::sim
