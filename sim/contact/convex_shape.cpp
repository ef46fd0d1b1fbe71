#include "sim/contact/convex_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kFlat_m = 1e-9;      // Points this near a face's plane belong to it.
constexpr int kRimPoints = 8;         // Corners of the polygon that approximates a cap.
constexpr double kSameNormal = 1e-9;  // 1 - cosine.

void check_length(double length_m, const char* what) {
  if (!std::isfinite(length_m) || !(length_m > 0.0)) {
    throw std::invalid_argument(std::string("convex shape: ") + what + " is " +
                                std::to_string(length_m) + " m, allowed: finite, greater than 0");
  }
}

/// Unit in the plane of x and y; x where the direction has no part there.
Vector radial(const Vector& direction) {
  const double length = std::hypot(direction.x(), direction.y());
  return length > 1e-300 ? Vector(direction.x() / length, direction.y() / length, 0.0)
                         : Vector::UnitX();
}

}  // namespace

ConvexShape::ConvexShape(Kind kind, const Vector& size) : kind_(kind), size_(size) {}

ConvexShape ConvexShape::box(const Vector& half_lengths_m) {
  for (const double half : half_lengths_m) {
    check_length(half, "half length");
  }
  ConvexShape shape(Kind::box, half_lengths_m);
  shape.measure();
  return shape;
}

ConvexShape ConvexShape::cylinder(double radius_m, double half_length_m) {
  check_length(radius_m, "radius");
  check_length(half_length_m, "half length");
  ConvexShape shape(Kind::cylinder, {radius_m, radius_m, half_length_m});
  shape.measure();
  return shape;
}

ConvexShape ConvexShape::sphere(double radius_m) {
  check_length(radius_m, "radius");
  ConvexShape shape(Kind::sphere, Vector::Constant(radius_m));
  shape.measure();
  return shape;
}

ConvexShape ConvexShape::hull(std::span<const Vector> points) {
  if (points.size() < 4 || points.size() > kMostHullPoints) {
    throw std::invalid_argument("convex shape: hull of " + std::to_string(points.size()) +
                                " points, allowed: 4 .. " + std::to_string(kMostHullPoints));
  }
  ConvexShape shape(Kind::hull, Vector::Zero());
  for (const Vector& point : points) {
    if (!point.allFinite()) {
      throw std::invalid_argument("convex shape: a point of the hull is not finite");
    }
    shape.points_.push_back(point);
  }
  shape.find_faces();
  if (shape.faces_.size() < 4) {
    throw std::invalid_argument("convex shape: the hull's points lie in one plane");
  }
  // Points inside the hull are on no face.
  std::erase_if(shape.points_, [&](const Vector& p) {
    return std::ranges::none_of(shape.faces_, [&](const Face& face) {
      return std::ranges::any_of(face.around, [&](const Vector& q) { return q == p; });
    });
  });
  shape.measure();
  return shape;
}

void ConvexShape::find_faces() {
  // Every plane through three points that has none in front of it: n^4, at set-up only.
  const std::size_t n = points_.size();
  const double scale =
      std::ranges::max(points_, {}, [](const Vector& p) { return p.cwiseAbs().maxCoeff(); })
          .cwiseAbs()
          .maxCoeff();
  const double flat = kFlat_m * std::max(1.0, scale);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        Vector normal = (points_[j] - points_[i]).cross(points_[k] - points_[i]);
        const double area = normal.norm();
        if (!(area > flat * flat)) {
          continue;
        }
        normal /= area;
        double offset = normal.dot(points_[i]);
        double front = 0.0;
        double behind = 0.0;
        for (const Vector& p : points_) {
          const double height = normal.dot(p) - offset;
          front = std::max(front, height);
          behind = std::max(behind, -height);
        }
        if (front > flat && behind > flat) {
          continue;
        }
        if (front <= flat && behind <= flat) {
          return;  // All in one plane.
        }
        if (front > flat) {
          normal = -normal;
          offset = -offset;
        }
        if (std::ranges::any_of(faces_, [&](const Face& face) {
              return face.normal.dot(normal) > 1.0 - kSameNormal &&
                     std::abs(face.offset_m - offset) <= 2.0 * flat;
            })) {
          continue;
        }
        Face face{normal, offset, {}};
        Vector middle = Vector::Zero();
        for (const Vector& p : points_) {
          if (normal.dot(p) - offset > -2.0 * flat) {
            face.around.push_back(p);
            middle += p;
          }
        }
        middle /= static_cast<double>(face.around.size());
        // Corners left about the normal by their angle about the face's middle.
        const Vector x = (face.around.front() - middle).normalized();
        const Vector y = normal.cross(x);
        std::ranges::sort(face.around, {}, [&](const Vector& p) {
          return std::atan2(y.dot(p - middle), x.dot(p - middle));
        });
        faces_.push_back(std::move(face));
      }
    }
  }
}

void ConvexShape::measure() {
  Vector least;
  Vector greatest;
  for (Eigen::Index i = 0; i < 3; ++i) {
    greatest[i] = support(Vector::Unit(i))[i];
    least[i] = support(-Vector::Unit(i))[i];
  }
  middle_ = 0.5 * (greatest + least);
  half_ = 0.5 * (greatest - least);
  switch (kind_) {
    case Kind::box:
      reach_ = size_.norm();
      break;
    case Kind::cylinder:
      reach_ = std::hypot(size_.x(), size_.z());
      break;
    case Kind::sphere:
      reach_ = size_.x();
      break;
    case Kind::hull:
      for (const Vector& p : points_) {
        reach_ = std::max(reach_, p.norm());
      }
      break;
  }
}

Vector ConvexShape::support(const Vector& direction) const {
  switch (kind_) {
    case Kind::box:
      return {std::copysign(size_.x(), direction.x()), std::copysign(size_.y(), direction.y()),
              std::copysign(size_.z(), direction.z())};
    case Kind::cylinder: {
      Vector p = size_.x() * radial(direction);
      p.z() = std::copysign(size_.z(), direction.z());
      return p;
    }
    case Kind::sphere:
      return size_.x() * direction.normalized();
    case Kind::hull:
      break;
  }
  const Vector* farthest = &points_.front();
  double most = farthest->dot(direction);
  for (const Vector& p : points_) {
    const double along = p.dot(direction);
    if (along > most) {
      most = along;
      farthest = &p;
    }
  }
  return *farthest;
}

Vector ConvexShape::core_support(const Vector& direction) const {
  return kind_ == Kind::sphere ? Vector(Vector::Zero()) : support(direction);
}

Feature ConvexShape::feature(const Vector& direction) const {
  Feature result;
  switch (kind_) {
    case Kind::box: {
      Eigen::Index i = 0;
      direction.cwiseAbs().maxCoeff(&i);
      const Eigen::Index j = (i + 1) % 3;
      const Eigen::Index k = (i + 2) % 3;
      Vector corner;
      corner[i] = std::copysign(size_[i], direction[i]);
      for (const auto& [a, b] : {std::pair{1.0, 1.0}, {-1.0, 1.0}, {-1.0, -1.0}, {1.0, -1.0}}) {
        corner[j] = a * size_[j];
        corner[k] = b * size_[k];
        result.add(corner);
      }
      return result;
    }
    case Kind::cylinder: {
      const Vector out = radial(direction);
      const Vector across(-out.y(), out.x(), 0.0);
      const double end = std::copysign(size_.z(), direction.z());
      if (std::abs(direction.z()) > std::hypot(direction.x(), direction.y())) {
        // The cap, its rim from the farthest point on.
        for (int i = 0; i < kRimPoints; ++i) {
          const double turn = 2.0 * std::numbers::pi * i / kRimPoints;
          Vector p = size_.x() * (std::cos(turn) * out + std::sin(turn) * across);
          p.z() = end;
          result.add(p);
        }
      } else {
        // The line of the side that looks there.
        result.add(size_.x() * out + Vector(0.0, 0.0, end));
        result.add(size_.x() * out - Vector(0.0, 0.0, end));
      }
      return result;
    }
    case Kind::sphere:
      result.add(support(direction));
      return result;
    case Kind::hull:
      break;
  }
  const Face* best = &faces_.front();
  double most = best->normal.dot(direction);
  const Vector farthest = support(direction);
  // Among the faces at the farthest point, choose the one that faces `direction` most.
  bool about = false;
  for (const Face& face : faces_) {
    const bool touches = face.offset_m - face.normal.dot(farthest) <= 2.0 * kFlat_m;
    const double along = face.normal.dot(direction);
    if ((touches && !about) || (touches == about && along > most)) {
      best = &face;
      most = along;
      about = touches;
    }
  }
  for (const Vector& p : best->around) {
    result.add(p);
  }
  return result;
}

double ConvexShape::cut_m2(const Vector& normal, double depth_m) const {
  if (kind_ != Kind::box) {
    const double radius = half_.mean();
    const double depth = std::min(depth_m, radius);
    return std::numbers::pi * depth * (2.0 * radius - depth);
  }
  // So far the plane reaches along each edge from the lowest corner; each face counts as it looks
  // along the normal.
  Vector edge;
  for (Eigen::Index i = 0; i < 3; ++i) {
    edge[i] = depth_m < 2.0 * half_[i] * std::abs(normal[i]) ? depth_m / std::abs(normal[i])
                                                             : 2.0 * half_[i];
  }
  return std::abs(normal.x()) * edge.y() * edge.z() + std::abs(normal.y()) * edge.z() * edge.x() +
         std::abs(normal.z()) * edge.x() * edge.y();
}

std::vector<Vector> ConvexShape::surface(double spacing_m) const {
  if (kind_ != Kind::box) {
    return outline();
  }
  const Eigen::Array3d steps = (2.0 * size_.array() / spacing_m).ceil();
  std::vector<Vector> result;
  for (double x = 0.0; x <= steps.x(); ++x) {
    for (double y = 0.0; y <= steps.y(); ++y) {
      const bool side = x == 0.0 || x == steps.x() || y == 0.0 || y == steps.y();
      for (double z = 0.0; z <= steps.z(); z += side ? 1.0 : steps.z()) {
        result.emplace_back(size_.array() * (2.0 * Eigen::Array3d(x, y, z) / steps - 1.0));
      }
    }
  }
  return result;
}

std::vector<Vector> ConvexShape::outline() const {
  std::vector<Vector> result;
  switch (kind_) {
    case Kind::box:
      for (int i = 0; i < 8; ++i) {
        result.emplace_back((i & 1) != 0 ? size_.x() : -size_.x(),
                            (i & 2) != 0 ? size_.y() : -size_.y(),
                            (i & 4) != 0 ? size_.z() : -size_.z());
      }
      break;
    case Kind::cylinder:
      for (const double end : {-size_.z(), size_.z()}) {
        for (int i = 0; i < kRimPoints; ++i) {
          const double turn = 2.0 * std::numbers::pi * i / kRimPoints;
          result.emplace_back(size_.x() * std::cos(turn), size_.x() * std::sin(turn), end);
        }
      }
      break;
    case Kind::sphere:
      for (Eigen::Index i = 0; i < 3; ++i) {
        result.push_back(size_.x() * Vector::Unit(i));
        result.push_back(-size_.x() * Vector::Unit(i));
      }
      break;
    case Kind::hull:
      result = points_;
      break;
  }
  return result;
}

}  // namespace rigwire::sim
