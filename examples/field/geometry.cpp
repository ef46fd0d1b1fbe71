#include "field/geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace rigwire::field {

namespace {

constexpr double kSemiMajor_m = 6378137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);

}  // namespace

LocalPlane::LocalPlane(const LatLon& reference, double height_m)
    : reference_(reference), height_m_(height_m) {
  const double sine = std::sin(reference.latitude_deg * kDegree);
  const double w2 = 1.0 - kEccentricity2 * sine * sine;
  const double meridian_m = kSemiMajor_m * (1.0 - kEccentricity2) / (w2 * std::sqrt(w2));
  metres_per_degree_north_ = (meridian_m + height_m) * kDegree;
}

double LocalPlane::metres_per_degree_east(double latitude_deg) const {
  const double sine = std::sin(latitude_deg * kDegree);
  const double normal_m = kSemiMajor_m / std::sqrt(1.0 - kEccentricity2 * sine * sine);
  return (normal_m + height_m_) * std::cos(latitude_deg * kDegree) * kDegree;
}

PlanePosition LocalPlane::to_plane(const LatLon& point) const {
  return {
      (point.longitude_deg - reference_.longitude_deg) * metres_per_degree_east(point.latitude_deg),
      (point.latitude_deg - reference_.latitude_deg) * metres_per_degree_north_};
}

LatLon LocalPlane::to_geodetic(const PlanePosition& position) const {
  const double latitude_deg = reference_.latitude_deg + position.north_m / metres_per_degree_north_;
  return {latitude_deg,
          reference_.longitude_deg + position.east_m / metres_per_degree_east(latitude_deg)};
}

Polyline::Polyline(std::vector<PlanePosition> points, bool closed)
    : points_(std::move(points)), closed_(closed) {
  const std::size_t least = closed ? 3 : 2;
  if (points_.size() < least) {
    throw std::invalid_argument("path has " + std::to_string(points_.size()) +
                                " points, allowed: at least " + std::to_string(least));
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!std::isfinite(points_[i].east_m) || !std::isfinite(points_[i].north_m)) {
      throw std::invalid_argument("path: point " + std::to_string(i + 1) + " is not finite");
    }
  }
  constexpr double kLeast_m = 1e-3;
  for (std::size_t i = 0; i < pieces(); ++i) {
    along_m_.push_back(length_m_);
    const PlanePosition& from = points_[i];
    const PlanePosition& to = points_[(i + 1) % points_.size()];
    const double piece_m = std::hypot(to.east_m - from.east_m, to.north_m - from.north_m);
    if (piece_m < kLeast_m) {
      throw std::invalid_argument("path: points " + std::to_string(i + 1) + " and the next are " +
                                  std::to_string(piece_m) + " m apart, allowed: at least 0.001 m");
    }
    length_m_ += piece_m;
  }
}

double Polyline::normalised(double along_m) const {
  if (!closed_) {
    return along_m;
  }
  const double rest = std::fmod(along_m, length_m_);
  return rest < 0.0 ? rest + length_m_ : rest;
}

Polyline::Place Polyline::nearest(const PlanePosition& position, std::optional<double> near_m,
                                  double window_m) const {
  Place best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pieces(); ++i) {
    const PlanePosition& from = points_[i];
    const PlanePosition& to = points_[(i + 1) % points_.size()];
    const double dx = to.east_m - from.east_m;
    const double dy = to.north_m - from.north_m;
    const double piece_m = std::hypot(dx, dy);
    const double px = position.east_m - from.east_m;
    const double py = position.north_m - from.north_m;
    const double share = std::clamp((px * dx + py * dy) / (piece_m * piece_m), 0.0, 1.0);
    const double along = along_m_[i] + share * piece_m;
    if (near_m) {
      double apart = std::abs(along - normalised(*near_m));
      if (closed_) {
        apart = std::min(apart, length_m_ - apart);
      }
      if (apart > window_m) {
        continue;
      }
    }
    const double away = std::hypot(px - share * dx, py - share * dy);
    if (away < least) {
      least = away;
      best = {along, std::copysign(away, dx * py - dy * px)};
    }
  }
  return best;
}

PlanePosition Polyline::at(double along_m) const {
  const double along = normalised(along_m);
  const auto after = std::upper_bound(along_m_.begin(), along_m_.end(), along);
  const std::size_t i =
      after == along_m_.begin() ? 0 : static_cast<std::size_t>(after - along_m_.begin()) - 1;
  const PlanePosition& from = points_[i];
  const PlanePosition& to = points_[(i + 1) % points_.size()];
  const double piece_m = std::hypot(to.east_m - from.east_m, to.north_m - from.north_m);
  const double share = (along - along_m_[i]) / piece_m;
  return {from.east_m + share * (to.east_m - from.east_m),
          from.north_m + share * (to.north_m - from.north_m)};
}

double Polyline::direction_rad(double along_m) const {
  const PlanePosition before = at(along_m - 1.0);
  const PlanePosition after = at(along_m + 1.0);
  return std::atan2(after.north_m - before.north_m, after.east_m - before.east_m);
}

double Polyline::curvature_1pm(double along_m) const {
  return wrapped(direction_rad(along_m + 2.0) - direction_rad(along_m - 2.0)) / 4.0;
}

}  // namespace rigwire::field
