#include "sim/gnss/multipath.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;

namespace {

constexpr double kChip_m = 293.05;  // C/A code, 1.023 MHz
/// Two hits are of one wall when their planes agree so well.
constexpr double kSameNormal = 0.996;  // 5 degrees
constexpr double kSameOffset_m = 0.5;
/// Flatter incidence than this is a graze, not a reflection.
constexpr double kLeastIncidence = 0.05;
/// Offset from the wall, so that the shadow ray does not hit the wall itself.
constexpr double kOffWall_m = 0.02;
constexpr std::size_t kMostPlanes = 24;

struct RingOfRays {
  double elevation_deg;
  int count;
};
constexpr std::array kRings{RingOfRays{2.0, 12}, RingOfRays{20.0, 12}, RingOfRays{45.0, 8}};
constexpr std::size_t kDirections = 32;

std::array<Eigen::Vector3d, kDirections> make_directions() {
  std::array<Eigen::Vector3d, kDirections> directions;
  std::size_t next = 0;
  for (const RingOfRays& ring : kRings) {
    const double elevation = ring.elevation_deg * kDegree;
    for (int i = 0; i < ring.count; ++i) {
      const double azimuth = 2.0 * std::numbers::pi * (i + 0.5) / ring.count;
      directions[next++] = {std::cos(elevation) * std::sin(azimuth),
                            std::cos(elevation) * std::cos(azimuth), std::sin(elevation)};
    }
  }
  return directions;
}

}  // namespace

void visit(fields::Visitor& v, MultipathParameters& p) {
  v.boolean("enabled", p.enabled, "Reflections are searched by rays.");
  v.only_if(p.enabled, "enabled", "enabled: true", [&p](fields::Visitor& w) {
    w.number("reach", p.reach_m, in("m").between(0.1, 500),
             "Surfaces farther away are not searched for reflections.");
    w.number("reflection_loss", p.reflection_loss_db, in("dB").between(0, 40),
             "Loss of a reflected against the direct signal.");
    w.number("correlator_spacing", p.correlator_spacing_m, in("m").between(1, 300),
             "From the early to the late correlator.");
    w.number("search_distance", p.search_distance_m, in("m").between(0, 1000),
             "Motion after which reflections are searched again.");
    w.number("search_period", p.search_period_s, in("s").between(0, 86'400),
             "Time after which reflections are searched again; 0 = every epoch.");
    w.number("scatter", p.scatter_m, in("m").between(0, 1000),
             "By how much a signal that only a wall's reflection brings is longer than a mirror "
             "would make it, on average.");
    w.number("scatter_length", p.scatter_length_m, in("m").between(0.1, 1e6),
             "Motion after which another part of the wall reflects, on average.");
    w.number("scatter_period", p.scatter_period_s, in("s").between(0.1, 1e6),
             "Time after which another part of the wall reflects, on average.");
  });
}

void validate(const MultipathParameters& p) {
  fields::check(p);
}

double multipath_envelope_m(const MultipathParameters& parameters, double extra_path_m) {
  if (extra_path_m >= 1.5 * kChip_m) {
    return 0.0;
  }
  // Amplitude ratio times delay, at most half the correlator spacing (Braasch 1996).
  const double ratio = std::pow(10.0, -parameters.reflection_loss_db / 20.0);
  return ratio * std::min(extra_path_m, 0.5 * parameters.correlator_spacing_m);
}

void ReflectionSearch::find_planes(const Eigen::Vector3d& p_W, const Visibility& visibility,
                                   double clearance_m) {
  static const std::array<Eigen::Vector3d, kDirections> kDirectionsAround = make_directions();
  planes_.clear();
  for (const Eigen::Vector3d& direction : kDirectionsAround) {
    const auto hit = visibility.surface(p_W, direction, clearance_m, parameters_.reach_m);
    ++rays_;
    if (!hit) {
      continue;
    }
    const double offset_m = hit->normal_W.dot(p_W + hit->range_m * direction);
    const bool known = std::ranges::any_of(planes_, [&](const Plane& plane) {
      return plane.normal_W.dot(hit->normal_W) > kSameNormal &&
             std::abs(plane.offset_m - offset_m) < kSameOffset_m;
    });
    if (!known && planes_.size() < kMostPlanes) {
      planes_.push_back({hit->normal_W, offset_m});
    }
  }
}

void ReflectionSearch::find_paths(const Satellite& satellite, const Eigen::Vector3d& p_W,
                                  const Visibility& visibility, double clearance_m) {
  Path& path = paths_[satellite.id];
  path.known = true;
  path.planes.clear();
  for (std::uint32_t i = 0; i < planes_.size(); ++i) {
    const Plane& plane = planes_[i];
    const double incidence = satellite.direction_W.dot(plane.normal_W);
    if (incidence < kLeastIncidence) {
      continue;
    }
    // Image theory: the reflection comes from the direction mirrored at the wall, s - 2 (s . n) n.
    const Eigen::Vector3d mirrored = satellite.direction_W - 2.0 * incidence * plane.normal_W;
    const auto wall = visibility.surface(p_W, mirrored, clearance_m, parameters_.reach_m);
    ++rays_;
    if (!wall || wall->normal_W.dot(plane.normal_W) < kSameNormal) {
      continue;
    }
    const Eigen::Vector3d specular = p_W + wall->range_m * mirrored;
    if (std::abs(plane.normal_W.dot(specular) - plane.offset_m) > kSameOffset_m) {
      continue;  // the wall has ended; this is another one
    }
    ++rays_;
    if (!visibility.sky_path(specular + kOffWall_m * plane.normal_W, satellite.direction_W, 0.0)
             .blocked) {
      path.planes.push_back(i);
    }
  }
}

void ReflectionSearch::update(SimTime time, const Eigen::Vector3d& p_W,
                              std::span<const Satellite> satellites, std::uint32_t ids,
                              const Visibility& visibility, double clearance_m) {
  if (!parameters_.enabled) {
    return;
  }
  const bool due = searched_ == kNever ||
                   to_seconds(time - searched_) >= parameters_.search_period_s ||
                   (p_W - searched_at_W_).norm() >= parameters_.search_distance_m;
  if (due) {
    searched_ = time;
    searched_at_W_ = p_W;
    paths_.resize(ids);
    for (Path& path : paths_) {
      path.known = false;
      path.planes.clear();
    }
    find_planes(p_W, visibility, clearance_m);
  }
  for (const Satellite& satellite : satellites) {
    if (!paths_[satellite.id].known) {
      find_paths(satellite, p_W, visibility, clearance_m);
    }
  }
}

std::optional<double> ReflectionSearch::extra_path_m(std::uint32_t id, const Eigen::Vector3d& p_W,
                                                     const Eigen::Vector3d& direction_W) const {
  std::optional<double> shortest_m;
  if (id >= paths_.size()) {
    return shortest_m;
  }
  for (const std::uint32_t i : paths_[id].planes) {
    const Plane& plane = planes_[i];
    const double distance_m = plane.normal_W.dot(p_W) - plane.offset_m;
    // Longer by 2 D (s . n), D the antenna's distance from the wall.
    const double extra_m = 2.0 * distance_m * plane.normal_W.dot(direction_W);
    if (extra_m >= 0.0 && (!shortest_m || extra_m < *shortest_m)) {
      shortest_m = extra_m;
    }
  }
  return shortest_m;
}

}  // namespace rigwire::sim
