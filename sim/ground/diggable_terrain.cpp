#include "sim/ground/diggable_terrain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;

namespace {

constexpr double kUnitsPerMetre = 68719476736.0;  // 2^36: exact in a double up to 131 km.
std::int64_t to_units(double height_m) {
  return std::llround(height_m * kUnitsPerMetre);
}
double to_metres(std::int64_t units) {
  return static_cast<double>(units) / kUnitsPerMetre;
}

/// A convex polygon of the few corners that a clipped square can have.
class Polygon {
 public:
  void add(const Eigen::Vector2d& corner) { corners_[count_++] = corner; }

  /// The part in which normal . p <= limit.
  [[nodiscard]] Polygon clipped(const Eigen::Vector2d& normal, double limit) const {
    Polygon result;
    for (std::size_t i = 0; i < count_; ++i) {
      const Eigen::Vector2d& a = corners_[i];
      const Eigen::Vector2d& b = corners_[(i + 1) % count_];
      const double over_a = normal.dot(a) - limit;
      const double over_b = normal.dot(b) - limit;
      if (over_a <= 0.0) {
        result.add(a);
      }
      if ((over_a < 0.0 && over_b > 0.0) || (over_a > 0.0 && over_b < 0.0)) {
        // Sutherland and Hodgman: the point where the side crosses the line.
        result.add(a + over_a / (over_a - over_b) * (b - a));
      }
    }
    return result;
  }

  [[nodiscard]] double area() const {
    // Shoelace formula.
    double twice = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Eigen::Vector2d& a = corners_[i];
      const Eigen::Vector2d& b = corners_[(i + 1) % count_];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    return 0.5 * twice;
  }

 private:
  std::array<Eigen::Vector2d, 12> corners_{};
  std::size_t count_ = 0;
};

void require(bool good, const char* quantity, double found, const char* allowed) {
  if (!good) {
    throw std::invalid_argument("diggable terrain: " + std::string(quantity) + " is " +
                                std::to_string(found) + ", allowed: " + allowed);
  }
}

// A slide of less is left lying, so that every slide ends: 0.1 mm.
constexpr std::int64_t kSlideLeast = 6871947;

struct Step {
  int column;
  int row;
};
constexpr std::array<Step, 8> kNeighbours{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {-1, 1}, {1, -1}}};

}  // namespace

void visit(fields::Visitor& v, DiggableTerrainParameters& p) {
  v.number("depth_max", p.depth_max_m, in("m").between(0, 1000),
           "Depth below the ground as it was from which on there is rock.");
  v.number("loose_initial", p.loose_initial_m, in("m").between(0, 1000),
           "Loose soil on top at the start.");
  v.number("bank", p.bank_rad, in("deg").between(0.01, 89.5),
           "Steepest bank of firm soil near where is dug.");
  v.integer("slide_visits", p.slide_visits, IntegerRule{1, 1000000},
            "Nodes looked at for slides in each inner step.");
}

void validate(const DiggableTerrainParameters& p) {
  fields::check(p);
}

DiggableTerrain::DiggableTerrain(Ground& ground, const DiggableTerrainParameters& parameters)
    : ground_(ground),
      parameters_(parameters),
      columns_(ground.field().columns),
      rows_(ground.field().rows),
      unit_m3_(ground.field().cell_m * ground.field().cell_m / kUnitsPerMetre),
      floor_(ground.field()) {
  validate(parameters);
  require(columns_ >= 4 && rows_ >= 4, "nodes along a side",
          static_cast<double>(std::min(columns_, rows_)), "at least 4");
  const HeightField& field = ground.field();
  const std::size_t nodes = columns_ * rows_;
  surface_.resize(nodes);
  loose_.resize(nodes);
  rock_.resize(nodes);
  soil_.resize(nodes);
  std::size_t soils = 0;
  for (std::size_t row = 0; row < rows_; ++row) {
    for (std::size_t column = 0; column < columns_; ++column) {
      const std::size_t at = node(column, row);
      const double x_m = field.origin_m.x() + field.cell_m * static_cast<double>(column);
      const double y_m = field.origin_m.y() + field.cell_m * static_cast<double>(row);
      require(std::abs(field.heights_m[at]) <= 1e5, "height", field.heights_m[at],
              "within 100 km of the map origin");
      soil_[at] = ground.at(x_m, y_m, -1e9).soil;  // Under the obstacles.
      soils = std::max<std::size_t>(soils, soil_[at] + std::size_t{1});
      const double depth_m = ground.soil(soil_[at]).soft ? parameters.depth_max_m : 0.0;
      surface_[at] = to_units(field.heights_m[at]);
      rock_[at] = surface_[at] - to_units(depth_m);
      loose_[at] = to_units(std::min(depth_m, parameters.loose_initial_m));
      floor_.heights_m[at] = field.heights_m[at] - depth_m;
    }
  }
  initial_ = surface_;
  for (std::size_t i = 0; i < soils; ++i) {
    const SoilParameters& soil = ground.soil(static_cast<std::uint8_t>(i));
    repose_.push_back(limits_for(soil.repose_rad));
    density_greatest_kgpm3_ = std::max(density_greatest_kgpm3_, soil.density_kgpm3);
  }
  bank_ = limits_for(parameters.bank_rad);
  queue_.resize(nodes);
  queued_.resize(nodes);
}

DiggableTerrain::SlopeLimits DiggableTerrain::limits_for(double slope_rad) const {
  // Maximum drop to a neighbour: tan(slope) times one cell, or its diagonal.
  const double rise = std::tan(std::clamp(slope_rad, 0.0, 1.56)) * cell_m();
  return {to_units(rise), to_units(rise * std::numbers::sqrt2)};
}

std::int64_t DiggableTerrain::units(double volume_m3) const {
  return volume_m3 > 0.0 ? static_cast<std::int64_t>(volume_m3 / unit_m3_) : 0;
}

std::size_t DiggableTerrain::nearest_inner(double coordinate, double origin,
                                           std::size_t nodes) const {
  const double position = std::round((coordinate - origin) / cell_m());
  return static_cast<std::size_t>(
      position > 1.0 ? std::min(position, static_cast<double>(nodes - 2)) : 1.0);
}

const SoilParameters& DiggableTerrain::soil_at(double x_m, double y_m) const {
  const HeightField& field = ground_.field();
  return ground_.soil(soil_[node(nearest_inner(x_m, field.origin_m.x(), columns_),
                                 nearest_inner(y_m, field.origin_m.y(), rows_))]);
}

std::int64_t DiggableTerrain::gained_units() const {
  std::int64_t gained = 0;
  for (std::size_t at = 0; at < surface_.size(); ++at) {
    gained += surface_[at] - initial_[at];
  }
  return gained;
}

std::optional<NodeRectangle> DiggableTerrain::take_changes() {
  std::optional<NodeRectangle> result = changes_;
  changes_.reset();
  return result;
}

void DiggableTerrain::change(std::size_t at, std::int64_t surface_units) {
  surface_[at] = surface_units;
  const std::size_t column = at % columns_;
  const std::size_t row = at / columns_;
  ground_.set_node(column, row, to_metres(surface_units));
  const NodeRectangle here{column, row, column, row};
  changes_ = changes_ ? changes_->joined(here) : here;
}

CutSoil DiggableTerrain::cut(const CuttingEdge& from, const CuttingEdge& to,
                             const Eigen::Vector3d& forward_W) {
  CutSoil soil;
  const Eigen::Vector3d along = to.left_W - to.right_W;
  const double width_m = along.head<2>().norm();
  const Eigen::Vector3d start = from.middle_W();
  const Eigen::Vector3d way = to.middle_W() - start;
  if (!(width_m > 0.0) || !way.allFinite() || !start.allFinite() || !forward_W.allFinite()) {
    return soil;
  }
  Eigen::Vector2d left = along.head<2>() / width_m;
  double rise = along.z() / width_m;  // Rise of the edge towards its left.
  // Forward is to the right of `left`, turned round when the edge looks the other way.
  if (left.y() * forward_W.x() - left.x() * forward_W.y() < 0.0) {
    left = -left;
    rise = -rise;
  }
  // Way of the edge's middle square to the edge, seen from above.
  const double advance_m = left.y() * way.x() - left.x() * way.y();
  if (!(advance_m > 0.0)) {
    return soil;
  }
  // Steps of at most half a cell: a column's height must not change much while it is crossed. No
  // edge of a machine moves kilometres in a step.
  const double pieces = std::ceil(std::min(advance_m / (0.5 * cell_m()), 1000.0));
  Eigen::Vector3d before = start;
  for (double piece = 1.0; piece <= pieces; piece += 1.0) {
    const Eigen::Vector3d after = start + piece / pieces * way;
    cut_straight(before, after, left, 0.5 * width_m, rise, soil);
    before = after;
  }
  return soil;
}

void DiggableTerrain::cut_straight(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W,
                                   const Eigen::Vector2d& left, double half_width_m, double rise,
                                   CutSoil& soil) {
  const HeightField& field = ground_.field();
  const double cell = field.cell_m;
  const Eigen::Vector2d forward(left.y(), -left.x());
  const Eigen::Vector2d middle = to_W.head<2>();
  const double reach_x = std::abs(left.x()) * half_width_m + cell;
  const double reach_y = std::abs(left.y()) * half_width_m + cell;
  const auto first = [&](double low, double origin) {
    const double position = std::ceil((low - origin) / cell);
    return position > 1.0 ? position : 1.0;
  };
  const auto last = [&](double high, double origin, std::size_t nodes) {
    return std::min(std::floor((high - origin) / cell), static_cast<double>(nodes - 2));
  };
  const double last_column = last(middle.x() + reach_x, field.origin_m.x(), columns_);
  const double last_row = last(middle.y() + reach_y, field.origin_m.y(), rows_);
  for (double r = first(middle.y() - reach_y, field.origin_m.y()); r <= last_row; r += 1.0) {
    for (double c = first(middle.x() - reach_x, field.origin_m.x()); c <= last_column; c += 1.0) {
      const std::size_t at = node(static_cast<std::size_t>(c), static_cast<std::size_t>(r));
      // The column as seen from the edge's middle.
      const Eigen::Vector2d centre = field.origin_m + cell * Eigen::Vector2d(c, r) - middle;
      const double lateral = std::clamp(left.dot(centre), -half_width_m, half_width_m);
      const double end_m = to_W.z() + rise * lateral;
      const std::int64_t above = surface_[at] - std::max(to_units(end_m), rock_[at]);
      if (above <= 0) {
        continue;
      }
      const double half = 0.5 * cell;
      Polygon square;
      square.add(centre + Eigen::Vector2d(-half, -half));
      square.add(centre + Eigen::Vector2d(half, -half));
      square.add(centre + Eigen::Vector2d(half, half));
      square.add(centre + Eigen::Vector2d(-half, half));
      const Polygon strip = square.clipped(left, half_width_m).clipped(-left, half_width_m);
      const double area = cell * cell;
      const double behind_after = strip.clipped(forward, 0.0).area() / area;
      const double behind_before =
          strip.clipped(forward, forward.dot(from_W.head<2>() - middle)).area() / area;
      // What lies behind the edge is down already; so this step's share is of what is left.
      const double swept = behind_after - behind_before;
      const double left_over = 1.0 - behind_before;
      if (!(swept > 1e-12)) {
        continue;
      }
      const double share = swept < left_over ? swept / left_over : 1.0;
      const auto taken =
          std::min(above, static_cast<std::int64_t>(std::ceil(share * static_cast<double>(above))));
      loose_[at] -= std::min(loose_[at], taken);
      change(at, surface_[at] - taken);
      disturb(at);
      soil.units += taken;
      soil.mass_kg += static_cast<double>(taken) * unit_m3_ * ground_.soil(soil_[at]).density_kgpm3;
    }
  }
}

void DiggableTerrain::pour(double x_m, double y_m, double radius_m, std::int64_t units) {
  if (units <= 0) {
    return;
  }
  const HeightField& field = ground_.field();
  const std::size_t column = nearest_inner(x_m, field.origin_m.x(), columns_);
  const std::size_t row = nearest_inner(y_m, field.origin_m.y(), rows_);
  const auto nearest = node(column, row);
  const double reach = radius_m > 0.0 ? std::min(radius_m / cell_m(), 32.0) : 0.0;
  const auto span = static_cast<std::size_t>(reach) + 1;
  const double u = (x_m - field.origin_m.x()) / cell_m();
  const double v = (y_m - field.origin_m.y()) / cell_m();
  const auto weight = [&](std::size_t c, std::size_t r) {
    const double distance = std::hypot(static_cast<double>(c) - u, static_cast<double>(r) - v);
    // A cone: weight falls linearly to the radius.
    return distance < reach ? 1.0 - distance / reach : 0.0;
  };
  const auto for_each_near = [&](auto&& visit) {
    for (std::size_t r = row > span ? row - span : 1; r <= std::min(row + span, rows_ - 2); ++r) {
      for (std::size_t c = column > span ? column - span : 1;
           c <= std::min(column + span, columns_ - 2); ++c) {
        visit(c, r);
      }
    }
  };
  const auto lay = [&](std::size_t at, std::int64_t amount) {
    loose_[at] += amount;
    change(at, surface_[at] + amount);
    disturb(at);
  };
  double sum = 0.0;
  for_each_near([&](std::size_t c, std::size_t r) { sum += weight(c, r); });
  std::int64_t rest = units;
  if (sum > 0.0) {
    for_each_near([&](std::size_t c, std::size_t r) {
      const auto amount = std::min(
          rest, static_cast<std::int64_t>(static_cast<double>(units) * weight(c, r) / sum));
      if (amount > 0) {
        lay(node(c, r), amount);
        rest -= amount;
      }
    });
  }
  if (rest > 0) {
    lay(nearest, rest);
  }
}

// The slides of DiggableTerrain.

void DiggableTerrain::push(std::size_t at) {
  if (queued_[at] == 0) {
    queued_[at] = 1;
    queue_[(queue_head_ + queue_length_) % queue_.size()] = static_cast<std::uint32_t>(at);
    ++queue_length_;
  }
}

void DiggableTerrain::disturb(std::size_t at) {
  push(at);
  const std::size_t column = at % columns_;
  const std::size_t row = at / columns_;
  for (const Step& step : kNeighbours) {
    const std::size_t c = column + static_cast<std::size_t>(step.column);
    const std::size_t r = row + static_cast<std::size_t>(step.row);
    if (inner(c, r)) {
      push(node(c, r));
    }
  }
}

void DiggableTerrain::settle() {
  for (std::size_t visit = 0; visit < parameters_.slide_visits && queue_length_ > 0; ++visit) {
    const std::size_t at = queue_[queue_head_];
    queue_head_ = (queue_head_ + 1) % queue_.size();
    --queue_length_;
    queued_[at] = 0;
    slide_from(at);
  }
}

void DiggableTerrain::slide_from(std::size_t at) {
  const std::size_t column = at % columns_;
  const std::size_t row = at / columns_;
  const SlopeLimits& repose = repose_[soil_[at]];
  std::array<std::size_t, 8> targets{};
  std::array<std::int64_t, 8> excess{};
  std::size_t count = 0;
  std::int64_t bank_excess = 0;
  for (const Step& step : kNeighbours) {
    const std::size_t c = column + static_cast<std::size_t>(step.column);
    const std::size_t r = row + static_cast<std::size_t>(step.row);
    if (!inner(c, r)) {
      continue;
    }
    // Over the repose slope of this soil (loose) and over the bank's slope (firm), per neighbour.
    const bool diagonal = step.column != 0 && step.row != 0;
    const std::int64_t drop = surface_[at] - surface_[node(c, r)];
    const std::int64_t over = drop - (diagonal ? repose.diagonal : repose.straight);
    if (over > kSlideLeast) {
      targets[count] = node(c, r);
      excess[count++] = over;
      bank_excess = std::max(bank_excess, drop - (diagonal ? bank_.diagonal : bank_.straight));
    }
  }
  if (count == 0) {
    return;
  }
  if (bank_excess > loose_[at]) {  // The firm soil below the loose soil is too steep: it breaks.
    const std::int64_t firm = surface_[at] - loose_[at] - rock_[at];
    loose_[at] += std::clamp<std::int64_t>(firm, 0, bank_excess - loose_[at]);
  }
  // Each takes its part of the drop such that the node and one alone would just come to rest.
  const auto parts = static_cast<std::int64_t>(count) + 1;
  std::int64_t wanted = 0;
  for (std::size_t i = 0; i < count; ++i) {
    wanted += excess[i] / parts;
  }
  const double scale =
      wanted > loose_[at] ? static_cast<double>(loose_[at]) / static_cast<double>(wanted) : 1.0;
  std::int64_t moved = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t part = excess[i] / parts;
    const auto amount =
        std::min(static_cast<std::int64_t>(scale * static_cast<double>(part)), loose_[at]);
    if (amount <= 0) {
      continue;
    }
    loose_[at] -= amount;
    loose_[targets[i]] += amount;
    change(targets[i], surface_[targets[i]] + amount);
    moved += amount;
  }
  // A move far below the minimum of a slide is not worth another visit.
  if (moved > 0) {
    change(at, surface_[at] - moved);
  }
  if (moved > kSlideLeast / 16) {
    disturb(at);
  }
}

}  // namespace rigwire::sim
