#include "sim/contact/manifold.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kSamePoint_m = 1e-3;
constexpr double kParallel = 0.05;  // Sine, below which two lines share a stretch, not a crossing.

/// Places across the normal in x and y, heights along it in z.
struct Outline {
  std::array<Vector, 2 * kMostFeaturePoints> corners;
  std::size_t count = 0;

  void add(const Vector& corner) {
    if (count < corners.size()) {
      corners[count++] = corner;
    }
  }
};

double cross(const Vector& a, const Vector& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double area(const Outline& outline) {
  double sum = 0.0;
  for (std::size_t i = 0; i < outline.count; ++i) {
    sum += cross(outline.corners[i], outline.corners[(i + 1) % outline.count]);
  }
  return 0.5 * sum;
}

Outline seen(const PlacedShape& placed, const Vector& direction_W, const Eigen::Matrix3d& R_NW,
             const Vector& origin_W) {
  const Feature feature = placed.shape->feature(placed.X_WS.linear().transpose() * direction_W);
  Outline outline;
  for (std::size_t i = 0; i < feature.count; ++i) {
    outline.add(R_NW * (placed.X_WS * feature.points[i] - origin_W));
  }
  if (outline.count > 2 && area(outline) < 0.0) {
    std::reverse(outline.corners.begin(),
                 outline.corners.begin() + static_cast<std::ptrdiff_t>(outline.count));
  }
  return outline;
}

/// Height of the outline's plane (line, point) at a place; of a line by the place's foot on it.
double height(const Outline& outline, const Vector& place) {
  const Vector& first = outline.corners[0];
  if (outline.count == 1) {
    return first.z();
  }
  if (outline.count == 2) {
    const Vector way = outline.corners[1] - first;
    const double length2 = way.head<2>().squaredNorm();
    const double t = length2 > 0.0 ? (place - first).head<2>().dot(way.head<2>()) / length2 : 0.0;
    return first.z() + std::clamp(t, 0.0, 1.0) * way.z();
  }
  // Newell's normal of the polygon.
  Vector normal = Vector::Zero();
  for (std::size_t i = 0; i < outline.count; ++i) {
    const Vector& p = outline.corners[i];
    const Vector& q = outline.corners[(i + 1) % outline.count];
    normal += Vector((p.y() - q.y()) * (p.z() + q.z()), (p.z() - q.z()) * (p.x() + q.x()),
                     (p.x() - q.x()) * (p.y() + q.y()));
  }
  if (std::abs(normal.z()) < 1e-12) {
    return first.z();
  }
  return first.z() - (normal.head<2>().dot((place - first).head<2>())) / normal.z();
}

/// What of `subject` lies within the convex polygon (Sutherland and Hodgman, CACM 17 (1974) 32).
Outline clipped(Outline subject, const Outline& polygon) {
  for (std::size_t i = 0; i < polygon.count && subject.count > 0; ++i) {
    const Vector& from = polygon.corners[i];
    const Vector edge = polygon.corners[(i + 1) % polygon.count] - from;
    // A trunk's line runs exactly along the edge of a corner that it touches: it counts as inside,
    // by a millimetre.
    const double beside = kSamePoint_m * edge.head<2>().norm();
    const auto inside = [&](const Vector& p) { return cross(edge, p - from) + beside; };
    Outline next;
    const std::size_t sides = subject.count == 2 ? 1 : subject.count;
    for (std::size_t k = 0; k < sides; ++k) {
      const Vector& p = subject.corners[k];
      const Vector& q = subject.corners[(k + 1) % subject.count];
      const double at_p = inside(p);
      const double at_q = inside(q);
      if (at_p >= 0.0) {
        next.add(p);
      }
      if ((at_p >= 0.0) != (at_q >= 0.0)) {
        next.add(p + (at_p / (at_p - at_q)) * (q - p));
      }
      if (subject.count == 2 && at_q >= 0.0) {
        next.add(q);
      }
    }
    subject = next;
  }
  return subject;
}

/// Where two lines share: their crossing, or the ends of the stretch beside each other.
Outline shared(const Outline& a, const Outline& b) {
  Outline result;
  const Vector way_a = a.corners[1] - a.corners[0];
  const Vector way_b = b.corners[1] - b.corners[0];
  const double length_a = way_a.head<2>().norm();
  const double length_b = way_b.head<2>().norm();
  const double turn = cross(way_a, way_b);
  if (length_a == 0.0 || length_b == 0.0 || std::abs(turn) > kParallel * length_a * length_b) {
    const double t = turn == 0.0 ? 0.5 : cross(b.corners[0] - a.corners[0], way_b) / turn;
    result.add(a.corners[0] + std::clamp(t, 0.0, 1.0) * way_a);
    return result;
  }
  const auto place = [&](const Vector& p) {
    return (p - a.corners[0]).head<2>().dot(way_a.head<2>()) / (length_a * length_a);
  };
  double first = place(b.corners[0]);
  double last = place(b.corners[1]);
  if (first > last) {
    std::swap(first, last);
  }
  first = std::clamp(first, 0.0, 1.0);
  last = std::clamp(last, 0.0, 1.0);
  result.add(a.corners[0] + first * way_a);
  if (last > first) {
    result.add(a.corners[0] + last * way_a);
  }
  return result;
}

/// The deepest, the farthest from it, and the farthest to either side of the line through both.
void keep_four(Outline& outline, const std::array<double, 2 * kMostFeaturePoints>& gaps,
               std::array<std::size_t, kManifoldPoints>& kept) {
  const auto best = [&](auto&& score) {
    std::size_t found = 0;
    double most = -1e300;
    for (std::size_t i = 0; i < outline.count; ++i) {
      const double value = score(i);
      if (value > most) {
        most = value;
        found = i;
      }
    }
    return found;
  };
  const auto& p = outline.corners;
  kept[0] = best([&](std::size_t i) { return -gaps[i]; });
  kept[1] = best([&](std::size_t i) { return (p[i] - p[kept[0]]).head<2>().squaredNorm(); });
  const Vector line = p[kept[1]] - p[kept[0]];
  kept[2] = best([&](std::size_t i) { return cross(line, p[i] - p[kept[0]]); });
  kept[3] = best([&](std::size_t i) { return -cross(line, p[i] - p[kept[0]]); });
}

}  // namespace

Manifold manifold(const PlacedShape& a, const PlacedShape& b, const Separation& separation,
                  double reach_m) {
  const Vector& n = separation.normal_W;
  const Vector origin_W = a.support_W(-n);
  // Axes across the normal; any will do.
  const Vector helper = std::abs(n.x()) < 0.8 ? Vector::UnitX() : Vector::UnitY();
  Eigen::Matrix3d R_NW;
  R_NW.row(2) = n.transpose();
  R_NW.row(0) = n.cross(helper).normalized().transpose();
  R_NW.row(1) = n.cross(Vector(R_NW.row(0).transpose())).transpose();

  const Outline of_a = seen(a, -n, R_NW, origin_W);
  const Outline of_b = seen(b, n, R_NW, origin_W);
  Outline both;
  if (of_a.count == 1 || of_b.count == 1) {
    both.add(of_a.count == 1 ? of_a.corners[0] : of_b.corners[0]);
  } else if (of_a.count == 2 && of_b.count == 2) {
    both = shared(of_a, of_b);
  } else if (of_b.count == 2) {
    both = clipped(of_b, of_a);
  } else {
    both = clipped(of_a, of_b);
  }
  if (both.count == 0) {
    // Beside each other by rounding, or by a rim's polygon: the farthest point of A.
    both.add(Vector::Zero());
  }
  std::array<double, 2 * kMostFeaturePoints> gaps{};
  double least = 1e300;
  for (std::size_t i = 0; i < both.count; ++i) {
    gaps[i] = height(of_a, both.corners[i]) - height(of_b, both.corners[i]);
    least = std::min(least, gaps[i]);
  }
  // The minimum gap is set to the pair's: it differs where a polygon cuts a rim off, and for a lone
  // point beside a slope.
  for (std::size_t i = 0; i < both.count; ++i) {
    gaps[i] += separation.gap_m - least;
  }
  std::array<std::size_t, kManifoldPoints> kept{0, 1, 2, 3};
  std::size_t count = both.count;
  if (both.count > kManifoldPoints) {
    keep_four(both, gaps, kept);
    count = kManifoldPoints;
  }
  Manifold result;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = kept[i];
    const bool twice = std::find(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(i), k) !=
                       kept.begin() + static_cast<std::ptrdiff_t>(i);
    if (gaps[k] > std::max(reach_m, separation.gap_m) || twice) {
      continue;
    }
    // Half a gap below A's surface.
    const Vector place(both.corners[k].x(), both.corners[k].y(),
                       height(of_a, both.corners[k]) - 0.5 * gaps[k]);
    result.points[result.count++] = {origin_W + R_NW.transpose() * place, gaps[k]};
  }
  return result;
}

}  // namespace rigwire::sim
