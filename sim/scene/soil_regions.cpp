#include "sim/scene/soil_regions.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/scene/range_checks.h"

namespace rigwire::sim {

using fields::in;

namespace {

[[noreturn]] void refuse_name(const std::string& what, const std::string& name,
                              const std::string& known) {
  throw std::invalid_argument("there is no " + what + " '" + name + "'; there are: " + known);
}

template <class Items, class Name>
std::size_t find(const Items& items, const std::string& wanted, const std::string& what,
                 const Name& name_of) {
  std::string known;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (name_of(items[i]) == wanted) {
      return i;
    }
    known += (known.empty() ? "" : ", ") + name_of(items[i]);
  }
  refuse_name(what, wanted, known.empty() ? "none" : known);
}

/// Paints all cells whose middle is in.
template <class Inside>
void paint(SoilMap& map, const HeightField& field, std::size_t soil, const Inside& inside) {
  const std::size_t columns = field.columns - 1;
  for (std::size_t r = 0; r + 1 < field.rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      const Eigen::Vector2d middle =
          field.origin_m + field.cell_m * Eigen::Vector2d(static_cast<double>(c) + 0.5,
                                                          static_cast<double>(r) + 0.5);
      if (inside(middle)) {
        map.cells[r * columns + c] = static_cast<std::uint8_t>(soil);
      }
    }
  }
}

/// Paints a stretch of a track, looking only at cells beside the line.
void paint_track(SoilMap& map, const HeightField& field, std::size_t soil, const LaidTrack& laid,
                 double from_m, double to_m) {
  const double half_m = 0.5 * laid.track.width_m;
  const std::size_t columns = field.columns - 1;
  const auto& points = laid.line.points_m;
  const auto index = [&](double coordinate, double origin, std::size_t cells) {
    return static_cast<std::size_t>(
        std::clamp((coordinate - origin) / field.cell_m, 0.0, static_cast<double>(cells - 1)));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double along = kTrackSpacing_m * static_cast<double>(i);
    if (along < from_m || along > to_m) {
      continue;
    }
    const double reach_m = half_m + kTrackSpacing_m;
    for (std::size_t r = index(points[i].y() - reach_m, field.origin_m.y(), field.rows - 1);
         r <= index(points[i].y() + reach_m, field.origin_m.y(), field.rows - 1); ++r) {
      for (std::size_t c = index(points[i].x() - reach_m, field.origin_m.x(), columns);
           c <= index(points[i].x() + reach_m, field.origin_m.x(), columns); ++c) {
        const Eigen::Vector2d middle =
            field.origin_m + field.cell_m * Eigen::Vector2d(static_cast<double>(c) + 0.5,
                                                            static_cast<double>(r) + 0.5);
        if ((middle - points[i]).norm() <= half_m) {
          map.cells[r * columns + c] = static_cast<std::uint8_t>(soil);
        }
      }
    }
  }
}

}  // namespace

void visit(fields::Visitor& v, SoilDisc& p) {
  v.vector2("centre", p.centre_m, in("m").between(-8000, 8000), "[east, north] of the disc.");
  v.number("radius", p.radius_m, in("m").above(0).at_most(8000), "Radius of the disc.");
}

void visit(fields::Visitor& v, SoilRectangle& p) {
  v.vector2("centre", p.centre_m, in("m").between(-8000, 8000), "[east, north] of the rectangle.");
  v.vector2("size", p.size_m, in("m").above(0).at_most(8000), "Full lengths along its own axes.");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360),
           "Direction of its first axis, left from east.");
}

void visit(fields::Visitor& v, SoilStretch& p) {
  v.required("track");
  v.text("track", p.track, "Name of the track.");
  v.number("from", p.from_m, in("m").between(0, 1e6),
           "Where the stretch begins, along the track from its first point.");
  v.number("to", p.to_m, in("m").between(0, 1e6),
           "Where the stretch ends, along the track from its first point.");
}

void visit(fields::Visitor& v, SoilRegion& p) {
  v.required("soil");
  v.text("soil", p.soil, "Name of the soil there.");
  v.required("type");
  v.variant("type", p.shape, "Shape of the region.");
}

void validate(const SoilStretch& stretch) {
  fields::check(stretch);
  require_within(stretch.to_m, stretch.from_m, 1e6, "m", "to", "not before `from`");
}

void validate(const SoilRegion& region) {
  fields::check(region);
}

SoilMap make_soil_map(const HeightField& field, std::vector<SoilParameters> soils,
                      std::span<const LaidTrack> tracks, std::span<const SoilRegion> regions) {
  constexpr std::size_t kMostSoils = 256;
  if (soils.empty() || soils.size() > kMostSoils) {
    throw std::invalid_argument("the scene has " + std::to_string(soils.size()) +
                                " soils, allowed: 1 to " + std::to_string(kMostSoils));
  }
  SoilMap map{std::move(soils), {}};
  const bool painted = !regions.empty() || std::ranges::any_of(tracks, [](const LaidTrack& laid) {
    return !laid.track.soil.empty();
  });
  if (!painted) {
    return map;
  }
  map.cells.assign((field.columns - 1) * (field.rows - 1), 0);
  const auto soil_index = [&](const std::string& name) {
    return find(map.soils, name, "soil", [](const SoilParameters& soil) { return soil.name; });
  };
  for (const LaidTrack& laid : tracks) {
    if (!laid.track.soil.empty()) {
      paint_track(map, field, soil_index(laid.track.soil), laid, 0.0, laid.line.length_m);
    }
  }
  for (const SoilRegion& region : regions) {
    validate(region);
    const std::size_t soil = soil_index(region.soil);
    if (const auto* disc = std::get_if<SoilDisc>(&region.shape)) {
      paint(map, field, soil, [&](const Eigen::Vector2d& p) {
        return (p - disc->centre_m).norm() <= disc->radius_m;
      });
    } else if (const auto* rectangle = std::get_if<SoilRectangle>(&region.shape)) {
      const Eigen::Vector2d along(std::cos(rectangle->yaw_rad), std::sin(rectangle->yaw_rad));
      const Eigen::Vector2d across(-along.y(), along.x());
      paint(map, field, soil, [&](const Eigen::Vector2d& p) {
        const Eigen::Vector2d d = p - rectangle->centre_m;
        return std::abs(d.dot(along)) <= 0.5 * rectangle->size_m.x() &&
               std::abs(d.dot(across)) <= 0.5 * rectangle->size_m.y();
      });
    } else {
      const auto& stretch = std::get<SoilStretch>(region.shape);
      const std::size_t track = find(tracks, stretch.track, "track",
                                     [](const LaidTrack& laid) { return laid.track.name; });
      paint_track(map, field, soil, tracks[track], stretch.from_m, stretch.to_m);
    }
  }
  return map;
}

}  // namespace rigwire::sim
