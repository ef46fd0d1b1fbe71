// A convex solid for contact: its extent in a direction, and the part of its surface that faces
// that way.
//
// Each shape has its own frame S, with the shape about its origin. Boxes, cylinders (axis z) and
// spheres are exact, hulls are those of at most kMostHullPoints points. Queries allocate nothing.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace rigwire::sim {

inline constexpr std::size_t kMostHullPoints = 64;
inline constexpr std::size_t kMostFeaturePoints = 24;

/// A flat part of a shape's surface: one point, a segment, or a polygon in order.
struct Feature {
  std::array<Eigen::Vector3d, kMostFeaturePoints> points;
  std::size_t count = 0;

  void add(const Eigen::Vector3d& point) {
    if (count < kMostFeaturePoints) {
      points[count++] = point;
    }
  }
};

class ConvexShape {
 public:
  /// Lengths in m, finite and greater than 0; else std::invalid_argument.
  [[nodiscard]] static ConvexShape box(const Eigen::Vector3d& half_lengths_m);
  [[nodiscard]] static ConvexShape cylinder(double radius_m, double half_length_m);
  [[nodiscard]] static ConvexShape sphere(double radius_m);
  /// Builds the convex hull of at least four points that do not lie in one plane; else throws
  /// std::invalid_argument.
  [[nodiscard]] static ConvexShape hull(std::span<const Eigen::Vector3d> points);

  /// The shape's farthest point along `direction` (any length but 0).
  [[nodiscard]] Eigen::Vector3d support(const Eigen::Vector3d& direction) const;

  /// Returns the support point of the shape shrunk by `rounding_m` on all sides: a sphere becomes
  /// its middle. Algorithms for corners (closest.h) use it, so that they see no ball.
  [[nodiscard]] Eigen::Vector3d core_support(const Eigen::Vector3d& direction) const;
  [[nodiscard]] double rounding_m() const { return kind_ == Kind::sphere ? size_.x() : 0.0; }

  /// The face (side line, cap, point) that looks best along `direction`, with the farthest point in
  /// it. Where the direction turns from one face to the next, what both share stays.
  [[nodiscard]] Feature feature(const Eigen::Vector3d& direction) const;

  /// A flat face of a hull; other shapes have none in their list.
  struct Face {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Unit, outward.
    double offset_m = 0.0;                              ///< normal . p of its points.
    std::vector<Eigen::Vector3d> around;                ///< Its corners, left about the normal.
  };
  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }

  /// Middle and half lengths of the box about it in S.
  [[nodiscard]] const Eigen::Vector3d& middle_m() const { return middle_; }
  [[nodiscard]] const Eigen::Vector3d& half_lengths_m() const { return half_; }
  [[nodiscard]] double least_width_m() const { return 2.0 * half_.minCoeff(); }
  /// Radius of the sphere about S's origin that contains the shape.
  [[nodiscard]] double reach_m() const { return reach_; }

  /// Returns points of the surface for contact with the terrain: a box's corners, both rims of a
  /// cylinder, a hull's points.
  [[nodiscard]] std::vector<Eigen::Vector3d> outline() const;
  /// Returns outline(); for a box, also points all over its faces, at most `spacing_m` apart.
  [[nodiscard]] std::vector<Eigen::Vector3d> surface(double spacing_m) const;

  /// Returns the area, m2, of the section by a plane that has cut off `depth_m` of the shape on the
  /// side opposite to the unit normal. Exact for faces and edges of a box, twice the exact area for
  /// its corners; for all other shapes that of a sphere as wide as the box about them.
  [[nodiscard]] double cut_m2(const Eigen::Vector3d& normal, double depth_m) const;

 private:
  enum class Kind : std::uint8_t { box, cylinder, sphere, hull };

  ConvexShape(Kind kind, const Eigen::Vector3d& size);
  void measure();
  void find_faces();

  Kind kind_;
  Eigen::Vector3d size_;  ///< Half lengths; radius, -, half length; radius.
  std::vector<Eigen::Vector3d> points_;
  std::vector<Face> faces_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_ = Eigen::Vector3d::Zero();
  double reach_ = 0.0;
};

}  // namespace rigwire::sim
