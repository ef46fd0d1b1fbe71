#include "sim/ground/obstacle_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

/// Nearest point of a hull to a point in front of one of its faces: on that face or its rim.
Vector nearest_on(const ConvexShape& hull, const Vector& p) {
  Vector best = p;
  double least = std::numeric_limits<double>::infinity();
  for (const ConvexShape::Face& face : hull.faces()) {
    const double height = face.normal.dot(p) - face.offset_m;
    if (height <= 0.0) {
      continue;
    }
    Vector foot = p - height * face.normal;
    bool within = true;
    const std::size_t corners = face.around.size();
    for (std::size_t i = 0; i < corners; ++i) {
      const Vector& from = face.around[i];
      const Vector edge = face.around[(i + 1) % corners] - from;
      if (face.normal.cross(edge).dot(foot - from) < 0.0) {
        within = false;
        const double t = std::clamp(edge.dot(p - from) / edge.squaredNorm(), 0.0, 1.0);
        const Vector on_edge = from + t * edge;
        if ((p - on_edge).squaredNorm() < least) {
          least = (p - on_edge).squaredNorm();
          best = on_edge;
        }
      }
    }
    if (within && height * height < least) {
      least = height * height;
      best = foot;
    }
  }
  return best;
}

/// Nearest point of the solid to p, both in the obstacle's frame.
Vector nearest(const Obstacle& obstacle, const Vector& p) {
  const Vector& half = obstacle.half_lengths_m;
  switch (obstacle.shape) {
    case ObstacleShape::box:
      return p.cwiseMax(-half).cwiseMin(half);
    case ObstacleShape::sphere: {
      const double distance = p.norm();
      return distance > half.x() ? Vector(p * (half.x() / distance)) : p;
    }
    case ObstacleShape::cylinder: {
      const double distance = std::hypot(p.x(), p.y());
      const double scale = distance > half.x() ? half.x() / distance : 1.0;
      return {scale * p.x(), scale * p.y(), std::clamp(p.z(), -half.z(), half.z())};
    }
    case ObstacleShape::hull:
      return nearest_on(*obstacle.hull, p);
  }
  return p;
}

/// Maximum coordinate of the solid along a direction, in the obstacle's frame.
double reach(const Obstacle& obstacle, const Vector& direction) {
  const Vector& half = obstacle.half_lengths_m;
  switch (obstacle.shape) {
    case ObstacleShape::box:
      return direction.cwiseAbs().dot(half);
    case ObstacleShape::sphere:
      return half.x() * direction.norm();
    case ObstacleShape::cylinder:
      return half.x() * std::hypot(direction.x(), direction.y()) +
             half.z() * std::abs(direction.z());
    case ObstacleShape::hull:
      return obstacle.hull->support(direction).dot(direction);
  }
  return 0.0;
}

/// Depth of a point inside below the nearest face and that face's outward normal, in the obstacle's
/// frame; negative depth outside.
struct Depth {
  double depth_m;
  Vector normal;
};

/// Returns the depth of p (obstacle's frame) below the nearest face: min over the faces of offset -
/// normal . p; for the sphere and the cylinder's side by the distance from centre or axis.
Depth depth_inside(const Obstacle& obstacle, const Vector& p) {
  const Vector& half = obstacle.half_lengths_m;
  const auto axis_depth = [&](Eigen::Index i) {
    Vector normal = Vector::Zero();
    normal[i] = p[i] < 0.0 ? -1.0 : 1.0;
    return Depth{half[i] - std::abs(p[i]), normal};
  };
  const auto lesser = [](const Depth& a, const Depth& b) { return b.depth_m < a.depth_m ? b : a; };
  switch (obstacle.shape) {
    case ObstacleShape::box:
      return lesser(axis_depth(2), lesser(axis_depth(0), axis_depth(1)));
    case ObstacleShape::sphere: {
      const double distance = p.norm();
      const Vector up = obstacle.X_WO.linear().transpose() * Vector::UnitZ();
      return {half.x() - distance, distance > 0.0 ? Vector(p / distance) : up};
    }
    case ObstacleShape::cylinder: {
      const double distance = std::hypot(p.x(), p.y());
      const Vector outward =
          distance > 0.0 ? Vector(p.x() / distance, p.y() / distance, 0.0) : Vector::UnitX();
      return lesser(axis_depth(2), {half.x() - distance, outward});
    }
    case ObstacleShape::hull: {
      Depth least{std::numeric_limits<double>::infinity(), Vector::UnitZ()};
      for (const ConvexShape::Face& face : obstacle.hull->faces()) {
        least = lesser(least, {face.offset_m - face.normal.dot(p), face.normal});
      }
      return least;
    }
  }
  return {-1.0, Vector::UnitZ()};
}

/// Shortens the span [t_in, t_out] of the line p + t d to |coordinate| <= half.
bool clip(double p, double d, double half, double& t_in, double& t_out) {
  if (d == 0.0) {
    return std::abs(p) <= half;
  }
  const double a = (-half - p) / d;
  const double b = (half - p) / d;
  t_in = std::max(t_in, std::min(a, b));
  t_out = std::min(t_out, std::max(a, b));
  return t_in <= t_out;
}

/// Shortens the span [t_in, t_out] of the line p + t d to the circle of that radius about the z
/// axis (d flat) or to the sphere about the origin.
bool clip_round(const Vector& p, const Vector& d, double radius, double& t_in, double& t_out) {
  const double a = d.squaredNorm();
  if (a == 0.0) {
    return p.squaredNorm() <= radius * radius;
  }
  // |p + t d|^2 = R^2 about the foot of the perpendicular.
  const double middle = -p.dot(d) / a;
  const double missing = radius * radius - (p + middle * d).squaredNorm();
  if (missing < 0.0) {
    return false;
  }
  const double span = std::sqrt(missing / a);
  t_in = std::max(t_in, middle - span);
  t_out = std::min(t_out, middle + span);
  return t_in <= t_out;
}

bool clip_line(const Obstacle& obstacle, const Vector& p, const Vector& d, double& t_in,
               double& t_out) {
  const Vector& half = obstacle.half_lengths_m;
  switch (obstacle.shape) {
    case ObstacleShape::box:
      return clip(p.x(), d.x(), half.x(), t_in, t_out) &&
             clip(p.y(), d.y(), half.y(), t_in, t_out) && clip(p.z(), d.z(), half.z(), t_in, t_out);
    case ObstacleShape::sphere:
      return clip_round(p, d, half.x(), t_in, t_out);
    case ObstacleShape::cylinder:
      return clip(p.z(), d.z(), half.z(), t_in, t_out) &&
             clip_round({p.x(), p.y(), 0.0}, {d.x(), d.y(), 0.0}, half.x(), t_in, t_out);
    case ObstacleShape::hull:
      for (const ConvexShape::Face& face : obstacle.hull->faces()) {
        // Behind the face's plane: normal . (p + t d) <= offset.
        const double rise = face.normal.dot(d);
        const double room = face.offset_m - face.normal.dot(p);
        if (rise > 0.0) {
          t_out = std::min(t_out, room / rise);
        } else if (rise < 0.0) {
          t_in = std::max(t_in, room / rise);
        } else if (room < 0.0) {
          return false;
        }
      }
      return t_in <= t_out;
  }
  return false;
}

/// The lambda at which nearest(c + lambda a) lies in the plane through c square to a. The offset
/// along a of that point grows with lambda (a projection onto a convex body is monotone), so a
/// bracket is widened and then closed by the Illinois rule.
double plane_multiplier(const Obstacle& obstacle, const Vector& c, const Vector& a) {
  const auto offset = [&](double lambda) { return a.dot(nearest(obstacle, c + lambda * a) - c); };
  const double at_zero = offset(0.0);
  const double tiny = 1e-14 * (1.0 + c.norm());
  if (std::abs(at_zero) <= tiny) {
    return 0.0;
  }
  double near = 0.0;
  double near_offset = at_zero;
  double far = -at_zero;
  double far_offset = offset(far);
  for (int i = 0; i < 60 && far_offset * at_zero > 0.0; ++i) {
    near = far;
    near_offset = far_offset;
    far *= 2.0;
    far_offset = offset(far);
  }
  for (int i = 0; i < 60 && std::abs(far_offset) > tiny; ++i) {
    // Regula falsi, the stale end's value halved (Illinois).
    const double gap = far_offset - near_offset;
    const double next = gap != 0.0 ? far - far_offset * (far - near) / gap : 0.5 * (near + far);
    const double next_offset = offset(next);
    if (next_offset * far_offset < 0.0) {
      near = far;
      near_offset = far_offset;
    } else {
      near_offset *= 0.5;
    }
    far = next;
    far_offset = next_offset;
  }
  return far;
}

}  // namespace

ConvexShape shape_of(const Obstacle& obstacle) {
  const Vector& half = obstacle.half_lengths_m;
  switch (obstacle.shape) {
    case ObstacleShape::box:
      break;
    case ObstacleShape::sphere:
      return ConvexShape::sphere(half.x());
    case ObstacleShape::cylinder:
      return ConvexShape::cylinder(half.x(), half.z());
    case ObstacleShape::hull:
      return *obstacle.hull;
  }
  return ConvexShape::box(half);
}

double top_m(const Obstacle& obstacle) {
  return obstacle.X_WO.translation().z() +
         reach(obstacle, obstacle.X_WO.linear().transpose().col(2));
}

ObstacleBounds bounds(const Obstacle& obstacle) {
  const Eigen::Matrix3d R_OW = obstacle.X_WO.linear().transpose();
  const Eigen::Vector2d upper(reach(obstacle, R_OW.col(0)), reach(obstacle, R_OW.col(1)));
  const Eigen::Vector2d lower(reach(obstacle, -R_OW.col(0)), reach(obstacle, -R_OW.col(1)));
  const Eigen::Vector2d middle = obstacle.X_WO.translation().head<2>();
  return {middle - lower, middle + upper};
}

std::optional<ObstacleTop> top(const Obstacle& obstacle, double x_m, double y_m) {
  const Eigen::Matrix3d R_OW = obstacle.X_WO.linear().transpose();
  const Vector& origin = obstacle.X_WO.translation();
  const Vector p = R_OW * Vector(x_m - origin.x(), y_m - origin.y(), 0.0);
  const Vector d = R_OW.col(2);
  double t_in = -std::numeric_limits<double>::infinity();
  double t_out = std::numeric_limits<double>::infinity();
  if (!clip_line(obstacle, p, d, t_in, t_out)) {
    return std::nullopt;
  }
  const Depth face = depth_inside(obstacle, p + t_out * d);
  return ObstacleTop{origin.z() + t_out, obstacle.X_WO.linear() * face.normal};
}

std::optional<Penetration> inside(const Obstacle& obstacle, const Vector& p_W) {
  const Vector p = obstacle.X_WO.linear().transpose() * (p_W - Vector(obstacle.X_WO.translation()));
  const Depth found = depth_inside(obstacle, p);
  if (!(found.depth_m > 0.0)) {
    return std::nullopt;
  }
  return Penetration{found.depth_m, obstacle.X_WO.linear() * found.normal, obstacle.friction};
}

std::optional<DiscOverlap> disc_overlap(const Obstacle& obstacle, const Vector& centre_W,
                                        const Vector& axis_W, double radius_m) {
  const Eigen::Matrix3d R_OW = obstacle.X_WO.linear().transpose();
  const Vector c = R_OW * (centre_W - Vector(obstacle.X_WO.translation()));
  const Vector a = R_OW * axis_W;
  // Out of reach of the sphere about the disc, or of the disc's plane.
  if ((nearest(obstacle, c) - c).squaredNorm() >= radius_m * radius_m ||
      std::abs(a.dot(c)) >= reach(obstacle, a)) {
    return std::nullopt;
  }
  const double lambda = plane_multiplier(obstacle, c, a);
  const Vector foot = nearest(obstacle, c + lambda * a);
  const double distance = (c - foot).norm();
  if (distance >= radius_m) {
    return std::nullopt;
  }
  const Vector outward = c + lambda * a - foot;
  const double length = outward.norm();
  if (length < 1e-9 * radius_m || distance < 1e-9 * radius_m) {
    // The disc's centre itself is inside.
    const Depth buried = depth_inside(obstacle, c);
    return DiscOverlap{radius_m + std::max(0.0, buried.depth_m),
                       obstacle.X_WO.linear() * buried.normal};
  }
  // Depth in the disc's plane times the cosine between that plane and the normal.
  return DiscOverlap{(radius_m - distance) * (distance / length),
                     obstacle.X_WO.linear() * (outward / length)};
}

}  // namespace rigwire::sim
