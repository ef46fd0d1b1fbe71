#include "sim/scene/track.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/random.h"
#include "sim/scene/noise_field.h"
#include "sim/scene/range_checks.h"

namespace rigwire::sim {

using fields::in;

namespace {

/// Barry and Goldman's pyramid between b and c, u = 0 .. 1; knots by the square root of the chord.
Eigen::Vector2d between(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                        const Eigen::Vector2d& c, const Eigen::Vector2d& d, double u) {
  const double tb = std::sqrt((b - a).norm());
  const double tc = tb + std::sqrt((c - b).norm());
  const double td = tc + std::sqrt((d - c).norm());
  const double t = std::lerp(tb, tc, u);
  const Eigen::Vector2d ab = a + (b - a) * (t / tb);
  const Eigen::Vector2d bc = b + (c - b) * ((t - tb) / (tc - tb));
  const Eigen::Vector2d cd = c + (d - c) * ((t - tc) / (td - tc));
  const Eigen::Vector2d abc = ab + (bc - ab) * (t / tc);
  const Eigen::Vector2d bcd = bc + (cd - bc) * ((t - tb) / (td - tb));
  return abc + (bcd - abc) * ((t - tb) / (tc - tb));
}

/// The curve as a fine chain of points, evenly in the parameter.
std::vector<Eigen::Vector2d> fine_chain(const Track& track) {
  constexpr int kPiecesPerSpan = 64;
  const auto count = static_cast<std::ptrdiff_t>(track.points.size());
  const auto point = [&](std::ptrdiff_t i) -> Eigen::Vector2d {
    const auto at = [&](std::ptrdiff_t k) {
      return track.points[static_cast<std::size_t>(k)].at_m;
    };
    if (track.closed) {
      return at((i + count) % count);
    }
    if (i < 0) {
      return 2.0 * at(0) - at(1);
    }
    return i < count ? at(i) : Eigen::Vector2d(2.0 * at(count - 1) - at(count - 2));
  };
  std::vector<Eigen::Vector2d> chain{point(0)};
  const std::ptrdiff_t spans = track.closed ? count : count - 1;
  for (std::ptrdiff_t span = 0; span < spans; ++span) {
    for (int piece = 1; piece <= kPiecesPerSpan; ++piece) {
      chain.push_back(between(point(span - 1), point(span), point(span + 1), point(span + 2),
                              static_cast<double>(piece) / kPiecesPerSpan));
    }
  }
  return chain;
}

double smoothstep(double t) {
  const double u = std::clamp(t, 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

/// Heights of the ground along the line, averaged by a Gaussian.
std::vector<double> graded_heights(const HeightField& field, const Track& track,
                                   const TrackLine& line) {
  std::vector<double> raw;
  raw.reserve(line.points_m.size());
  for (const Eigen::Vector2d& p : line.points_m) {
    raw.push_back(field.height_m(p.x(), p.y()));
  }
  const double deviation = track.grading_m / kTrackSpacing_m;
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3.0 * deviation));
  const auto count = static_cast<std::ptrdiff_t>(raw.size());
  std::vector<double> graded(raw.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    double sum = 0.0;
    double weights = 0.0;
    for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
      std::ptrdiff_t j = i + k;
      if (line.closed) {
        j = ((j % count) + count) % count;
      } else if (j < 0 || j >= count) {
        continue;
      }
      // Gaussian weights, renormalised where the line ends.
      const double z = static_cast<double>(k) / std::max(deviation, 1e-9);
      const double weight = std::exp(-0.5 * z * z);
      sum += weight * raw[static_cast<std::size_t>(j)];
      weights += weight;
    }
    graded[static_cast<std::size_t>(i)] = sum / weights;
  }
  return graded;
}

}  // namespace

void visit(fields::Visitor& v, TrackPoint& p) {
  v.vector2("at", p.at_m, in("m").between(-4000, 4000), "[east, north] of the point.");
}

void visit(fields::Visitor& v, Track& p) {
  v.text("name", p.name, "Name of the track; soil regions name it.");
  v.list("points", p.points, "The centre line passes smoothly through each.");
  v.boolean("closed", p.closed, "Whether the last point joins the first.");
  v.number("width", p.width_m, in("m").between(0.5, 100), "Width that is level across.");
  v.number("shoulder", p.shoulder_m, in("m").between(0, 100),
           "Width on each side over which it blends into the ground.");
  v.number("grading", p.grading_m, in("m").between(0, 500),
           "Waves of the ground much shorter than this are cut and filled.");
  v.number("roughness", p.roughness_m, in("mm").between(0, 1000),
           "Standard deviation of the heights on the track.");
  v.text("soil", p.soil, "Name of its soil; empty = as around it.");
}

void validate(const Track& track) {
  fields::check(track);
  const std::string of_track = "track '" + track.name + "': ";
  require_within(static_cast<double>(track.points.size()), track.closed ? 3 : 2, 10'000, "",
                 "points", of_track + "number of points");
  for (std::size_t i = track.closed ? 0 : 1; i < track.points.size(); ++i) {
    const std::size_t before = i > 0 ? i - 1 : track.points.size() - 1;
    require_within((track.points[i].at_m - track.points[before].at_m).norm(), 0.1, 8000.0, "m",
                   "points." + std::to_string(i), of_track + "distance of neighbours");
  }
}

TrackLine track_line(const Track& track) {
  validate(track);
  const std::vector<Eigen::Vector2d> chain = fine_chain(track);
  TrackLine line;
  line.closed = track.closed;
  line.points_m.push_back(chain.front());
  double next = kTrackSpacing_m;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const Eigen::Vector2d piece = chain[i] - chain[i - 1];
    const double length = piece.norm();
    for (; next <= line.length_m + length; next += kTrackSpacing_m) {
      line.points_m.push_back(chain[i - 1] + piece * ((next - line.length_m) / length));
    }
    line.length_m += length;
  }
  constexpr double kSame_m = 1e-6;
  if ((line.points_m.back() - chain.back()).norm() > kSame_m && !track.closed) {
    line.points_m.push_back(chain.back());
  } else if (track.closed && (line.points_m.back() - chain.front()).norm() < kSame_m) {
    line.points_m.pop_back();
  }
  return line;
}

TrackLine::Nearest TrackLine::nearest(const Eigen::Vector2d& p_m) const {
  Nearest best{std::numeric_limits<double>::infinity(), 0.0};
  const std::size_t pieces = closed ? points_m.size() : points_m.size() - 1;
  for (std::size_t i = 0; i < pieces; ++i) {
    const Eigen::Vector2d& from = points_m[i];
    const Eigen::Vector2d piece = points_m[(i + 1) % points_m.size()] - from;
    // Foot of the perpendicular, held to the piece's ends.
    const double share = std::clamp((p_m - from).dot(piece) / piece.squaredNorm(), 0.0, 1.0);
    const double distance = (p_m - from - share * piece).norm();
    if (distance < best.distance_m) {
      best = {distance, kTrackSpacing_m * static_cast<double>(i) + share * piece.norm()};
    }
  }
  return best;
}

void carve(HeightField& field, const Track& track, std::uint64_t seed) {
  const TrackLine line = track_line(track);
  const std::vector<double> graded = graded_heights(field, track, line);
  const double reach_m = 0.5 * track.width_m + track.shoulder_m;

  // Each node takes the height of the nearest point of the line within reach.
  std::vector<double> distance_m(field.heights_m.size(), std::numeric_limits<double>::infinity());
  std::vector<double> level_m(field.heights_m.size(), 0.0);
  const auto index = [&](double coordinate, double origin, std::size_t nodes) {
    return static_cast<std::size_t>(
        std::clamp((coordinate - origin) / field.cell_m, 0.0, static_cast<double>(nodes - 1)));
  };
  const std::size_t pieces = line.closed ? line.points_m.size() : line.points_m.size() - 1;
  for (std::size_t i = 0; i < pieces; ++i) {
    const std::size_t j = (i + 1) % line.points_m.size();
    const Eigen::Vector2d from = line.points_m[i];
    const Eigen::Vector2d piece = line.points_m[j] - from;
    const Eigen::Vector2d low = from.cwiseMin(line.points_m[j]).array() - reach_m;
    const Eigen::Vector2d high = from.cwiseMax(line.points_m[j]).array() + reach_m + field.cell_m;
    for (std::size_t r = index(low.y(), field.origin_m.y(), field.rows);
         r <= index(high.y(), field.origin_m.y(), field.rows); ++r) {
      for (std::size_t c = index(low.x(), field.origin_m.x(), field.columns);
           c <= index(high.x(), field.origin_m.x(), field.columns); ++c) {
        const Eigen::Vector2d p =
            field.origin_m +
            field.cell_m * Eigen::Vector2d(static_cast<double>(c), static_cast<double>(r));
        const double share = std::clamp((p - from).dot(piece) / piece.squaredNorm(), 0.0, 1.0);
        const double distance = (p - from - share * piece).norm();
        const std::size_t node = r * field.columns + c;
        if (distance <= reach_m && distance < distance_m[node]) {
          distance_m[node] = distance;
          level_m[node] = std::lerp(graded[i], graded[j], share);
        }
      }
    }
  }

  constexpr double kLongestWave_m = 3.0;
  constexpr int kOctaves = 4;
  const NoiseField noise(RandomStream(seed, "scene/track/" + track.name).bits(), kLongestWave_m,
                         kOctaves);
  for (std::size_t node = 0; node < distance_m.size(); ++node) {
    if (!std::isfinite(distance_m[node])) {
      continue;
    }
    const std::size_t column = node % field.columns;
    const std::size_t row = node / field.columns;
    const double x = field.origin_m.x() + field.cell_m * static_cast<double>(column);
    const double y = field.origin_m.y() + field.cell_m * static_cast<double>(row);
    // Graded way, over the shoulder back into the natural ground.
    const double beside = distance_m[node] - 0.5 * track.width_m;
    const double natural =
        track.shoulder_m > 0.0 ? smoothstep(beside / track.shoulder_m) : (beside > 0.0 ? 1.0 : 0.0);
    const double way = level_m[node] + track.roughness_m * noise.at(x, y);
    field.heights_m[node] = std::lerp(way, field.heights_m[node], natural);
  }
}

}  // namespace rigwire::sim
