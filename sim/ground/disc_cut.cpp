#include "sim/ground/disc_cut.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigwire::sim {
namespace {

using Point = Eigen::Vector2d;

double cross(const Point& a, const Point& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Sums over the pieces of a polyline inside the disc.
struct Inside {
  double radius_m;
  double area_m2 = 0.0;
  Point chord = Point::Zero();

  /// The piece from p to q; open_start and open_end: goes on for ever there.
  void add(const Point& p, const Point& q, bool open_start, bool open_end) {
    const Point d = q - p;
    const double a = d.squaredNorm();
    const double middle = -p.dot(d) / a;
    // Distance of the line from the centre by the cross product: no cancellation.
    const double distance = cross(p, d) / std::sqrt(a);
    const double missing = (radius_m - distance) * (radius_m + distance);
    if (!(missing > 0.0)) {
      return;
    }
    const double half = std::sqrt(missing / a);
    const double start = open_start ? middle - half : std::max(0.0, middle - half);
    const double end = open_end ? middle + half : std::min(1.0, middle + half);
    if (!(start < end)) {
      return;
    }
    const Point from = p + start * d;
    const Point to = p + end * d;
    // Circle's segment: sector R^2 atan2(cross, dot) / 2 less the triangle cross / 2.
    const double turned = cross(from, to);
    area_m2 += 0.5 * (radius_m * radius_m * std::atan2(turned, from.dot(to)) - turned);
    chord += to - from;
  }
};

}  // namespace

double straight_cut_depth_m(double area_m2, double radius_m) {
  const double half_disc = 0.5 * std::numbers::pi * radius_m * radius_m;
  if (!(area_m2 > 0.0)) {
    return 0.0;
  }
  if (area_m2 >= half_disc) {
    return radius_m;
  }
  // Newton's rule from the shallow limit A = 4/3 sqrt(2 R) d^(3/2); A is convex in d there, so the
  // iteration falls to the root from above after one step.
  double depth = std::pow(0.75 * area_m2 / std::sqrt(2.0 * radius_m), 2.0 / 3.0);
  for (int i = 0; i < 8; ++i) {
    depth = std::min(depth, radius_m);
    // Segment of depth d: A = R^2 atan2(c, R - d) - (R - d) c, c = sqrt(d (2 R - d)), dA/dd = 2 c.
    const double half_chord = std::sqrt(depth * (2.0 * radius_m - depth));
    const double rest = radius_m - depth;
    const double area =
        radius_m * radius_m * std::atan2(half_chord, rest) - rest * half_chord - area_m2;
    const double change = area / (2.0 * half_chord);
    depth -= change;
    if (std::abs(change) < 1e-15 * radius_m) {
      break;
    }
  }
  return std::clamp(depth, 0.0, radius_m);
}

std::optional<DiscCut> cut_disc(const std::array<Point, kProfilePoints>& profile, double radius_m) {
  const Point& middle = profile[kProfilePoints / 2];
  if (middle.y() >= 0.0) {
    // The centre is below the surface: out along the profile's mean normal.
    const Point chord = profile.back() - profile.front();
    const Point normal = Point(-chord.y(), chord.x()).normalized();
    return DiscCut{radius_m + middle.y() * normal.y(), normal};
  }
  Inside inside{radius_m};
  for (std::size_t i = 0; i + 1 < kProfilePoints; ++i) {
    inside.add(profile[i], profile[i + 1], i == 0, i + 2 == kProfilePoints);
  }
  const double length = inside.chord.norm();
  if (!(inside.area_m2 > 0.0) || !(length > 0.0)) {
    return std::nullopt;
  }
  const Point normal = Point(-inside.chord.y(), inside.chord.x()) / length;
  // Depth d |T| / T(d), d of the straight cut of the same area: keeps a potential (disc_cut.h).
  const double depth = straight_cut_depth_m(inside.area_m2, radius_m);
  const double straight = 2.0 * std::sqrt(depth * (2.0 * radius_m - depth));
  return DiscCut{depth * length / straight, normal};
}

Escape shortest_escape(std::span<const Penetration> overlaps) {
  const auto short_of = [&](const Eigen::Vector3d& way) {
    double worst = 0.0;
    for (const Penetration& overlap : overlaps) {
      worst = std::max(worst, overlap.depth_m - overlap.normal_W.dot(way));
    }
    return worst;
  };
  Escape best;
  double best_short = 0.0;
  double best_length = 0.0;
  bool found = false;
  const auto offer = [&](const Eigen::Vector3d& way, std::size_t i, double share_i, std::size_t j,
                         double share_j) {
    const double lacking = short_of(way);
    const double length = way.norm();
    const double slack = 1e-12 * (1.0 + length);
    const bool better = !found || (lacking <= slack ? best_short > slack || length < best_length
                                                    : lacking < best_short);
    if (better) {
      found = true;
      best.way_W = way;
      best.shares.fill(0.0);
      best.shares[i] = share_i;
      best.shares[j] += share_j;
      best_short = lacking;
      best_length = length;
    }
  };
  for (std::size_t i = 0; i < overlaps.size(); ++i) {
    const Penetration& a = overlaps[i];
    offer(a.depth_m * a.normal_W, i, a.depth_m, i, 0.0);
    for (std::size_t j = i + 1; j < overlaps.size(); ++j) {
      const Penetration& b = overlaps[j];
      const double cosine = a.normal_W.dot(b.normal_W);
      const double sine2 = 1.0 - cosine * cosine;
      if (sine2 < 1e-9) {
        continue;
      }
      // Both planes bind: n_a . way = d_a, n_b . way = d_b in the span of the normals.
      const double share_a = (a.depth_m - cosine * b.depth_m) / sine2;
      const double share_b = (b.depth_m - cosine * a.depth_m) / sine2;
      if (share_a >= 0.0 && share_b >= 0.0) {
        offer(share_a * a.normal_W + share_b * b.normal_W, i, share_a, j, share_b);
      }
    }
  }
  return best;
}

}  // namespace rigwire::sim
