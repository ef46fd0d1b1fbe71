#include "sim/scene/loose_rock.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

constexpr int kHullDirections = 48;

/// Evenly over the sphere, by Fibonacci's spiral.
Vector direction(int i) {
  const double z = 1.0 - (2.0 * i + 1.0) / kHullDirections;
  const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

ConvexShape hull_of(const TriangleMesh& mesh) {
  std::vector<Vector> points;
  for (int i = 0; i < kHullDirections; ++i) {
    const Eigen::Vector3f d = direction(i).cast<float>();
    const auto farthest =
        std::ranges::max_element(mesh.vertices, {}, [&](const auto& v) { return v.dot(d); });
    const Vector point = farthest->cast<double>();
    if (std::ranges::find(points, point) == points.end()) {
      points.push_back(point);
    }
  }
  return ConvexShape::hull(points);
}

}  // namespace

MassProperties mass_properties(const TriangleMesh& mesh) {
  MassProperties sum;
  Vector first = Vector::Zero();                     // Integral of r,
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // of r r^T.
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vector a = mesh.vertices[i].cast<double>();
    const Vector b = mesh.vertices[j].cast<double>();
    const Vector c = mesh.vertices[k].cast<double>();
    const double volume = a.dot(b.cross(c)) / 6.0;
    const Vector whole = a + b + c;
    sum.volume_m3 += volume;
    first += volume / 4.0 * whole;
    second +=
        volume / 20.0 *
        (a * a.transpose() + b * b.transpose() + c * c.transpose() + whole * whole.transpose());
  }
  sum.centre_m = first / sum.volume_m3;
  second -= sum.volume_m3 * sum.centre_m * sum.centre_m.transpose();
  sum.inertia_m5 = second.trace() * Eigen::Matrix3d::Identity() - second;
  return sum;
}

LooseRock loose_rock(const TriangleMesh& rock, const Eigen::Isometry3d& X_WM, double scale,
                     double density_kgpm3, std::string name) {
  const MassProperties unit = mass_properties(rock);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(unit.inertia_m5);
  Eigen::Isometry3d X_MB = Eigen::Isometry3d::Identity();
  X_MB.linear() = axes.eigenvectors();
  if (X_MB.linear().determinant() < 0.0) {
    X_MB.linear().col(2) *= -1.0;
  }
  X_MB.translation() = unit.centre_m;
  TriangleMesh mesh = rock;
  mesh.name = name;
  const Eigen::Isometry3d X_BM = X_MB.inverse();
  for (auto& vertex : mesh.vertices) {
    vertex = (scale * (X_BM * vertex.cast<double>())).cast<float>();
  }
  Eigen::Isometry3d X_WB = X_WM * X_MB;
  X_WB.translation() = X_WM * Vector(scale * unit.centre_m);
  LooseBody body{.name = std::move(name), .shape = hull_of(mesh)};
  body.mass_kg = density_kgpm3 * unit.volume_m3 * scale * scale * scale;
  body.inertia_kgm2 = density_kgpm3 * std::pow(scale, 5.0) * axes.eigenvalues();
  body.X_WB = X_WB;
  body.friction = 0.7;
  body.rolling_resistance = 0.15;  // An estimate: it comes to rest on less than some 8 degrees.
  return {std::move(body), std::move(mesh)};
}

}  // namespace rigwire::sim
