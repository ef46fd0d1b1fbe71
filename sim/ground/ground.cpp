#include "sim/ground/ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "sim/contact/loose_bodies.h"
#include "sim/ground/disc_cut.h"
#include "sim/ground/obstacle_shapes.h"

namespace rigwire::sim {
namespace {

constexpr double kSmallestBin_m = 4.0;
constexpr double kMostBinsPerSide = 512.0;
constexpr double kBorder_m = 0.5;      // between soils: about a tyre's contact
constexpr double kLeastReach_m = 0.3;  // beyond what a wheel presses under itself

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("ground: " + what);
}

void check_obstacle(const Obstacle& obstacle, std::size_t index) {
  const std::string name = "obstacle " + std::to_string(index);
  const Eigen::Matrix3d R_WO = obstacle.X_WO.linear();
  if (!obstacle.X_WO.matrix().allFinite() ||
      !(R_WO.transpose() * R_WO).isApprox(Eigen::Matrix3d::Identity(), 1e-9)) {
    refuse(name + ": X_WO is not a finite pose");
  }
  if ((obstacle.shape == ObstacleShape::hull) != (obstacle.hull != nullptr)) {
    refuse(name + ": a hull needs its shape, and no other has one");
  }
  if (!(obstacle.strength_nm > 0.0)) {
    refuse(name + ": strength_nm is " + std::to_string(obstacle.strength_nm) +
           ", allowed: greater than 0");
  }
  if (!std::isfinite(obstacle.stiffness_npm) || obstacle.stiffness_npm < 0.0) {
    refuse(name + ": stiffness_npm is " + std::to_string(obstacle.stiffness_npm) +
           ", allowed: finite and at least 0");
  }
  // A sphere has one length, a cylinder two, a hull none.
  for (const Eigen::Index i : {0, 1, 2}) {
    const bool used = obstacle.shape != ObstacleShape::hull &&
                      (i == 0 || obstacle.shape == ObstacleShape::box ||
                       (i == 2 && obstacle.shape == ObstacleShape::cylinder));
    const double half = obstacle.half_lengths_m[i];
    if (used && (!std::isfinite(half) || !(half > 0.0))) {
      refuse(name + ": half_lengths_m[" + std::to_string(i) + "] is " + std::to_string(half) +
             ", allowed: finite and greater than 0");
    }
  }
  if (!(obstacle.friction >= 0.0 && obstacle.friction <= 2.0)) {
    refuse(name + ": friction is " + std::to_string(obstacle.friction) + ", allowed: 0 .. 2");
  }
}

std::size_t bin_index(double coordinate_m, double origin_m, double bin_m, std::size_t count) {
  const double position = (coordinate_m - origin_m) / bin_m;
  return static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(count) - 1.0));
}

}  // namespace

Ground::Ground() : plane_(true) {}

Ground::Ground(HeightField field, SoilMap soils, std::vector<Obstacle> obstacles)
    : field_(std::move(field)), soils_(std::move(soils)), obstacles_(std::move(obstacles)) {
  validate(field_);
  if (soils_.soils.empty() || soils_.soils.size() > 256) {
    refuse("has " + std::to_string(soils_.soils.size()) + " soils, allowed: 1 .. 256");
  }
  for (const SoilParameters& soil : soils_.soils) {
    validate(soil);
  }
  const std::size_t cells = (field_.columns - 1) * (field_.rows - 1);
  if (!soils_.cells.empty() && soils_.cells.size() != cells) {
    refuse("soil map has " + std::to_string(soils_.cells.size()) + " cells, allowed: none or " +
           std::to_string(cells) + ", one for each cell of the terrain");
  }
  for (std::size_t i = 0; i < soils_.cells.size(); ++i) {
    if (soils_.cells[i] >= soils_.soils.size()) {
      refuse("soil map's cell " + std::to_string(i) + " is soil " +
             std::to_string(soils_.cells[i]) + ", allowed: 0 .. " +
             std::to_string(soils_.soils.size() - 1));
    }
  }
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    check_obstacle(obstacles_[i], i);
    shapes_.push_back(shape_of(obstacles_[i]));
    tops_m_.push_back(top_m(obstacles_[i]));
  }
  fill_bins();
  remember_ruts();
}

Ground Ground::plane(const Eigen::Vector3d& normal_W, const SoilParameters& soil) {
  validate(soil);
  if (!normal_W.allFinite() || !(normal_W.z() > 0.0)) {
    refuse("plane's normal must be finite and point upward, its z is " +
           std::to_string(normal_W.z()));
  }
  Ground ground;
  ground.plane_normal_ = normal_W.normalized();
  ground.soils_.soils = {soil};
  ground.remember_ruts();
  return ground;
}

void Ground::remember_ruts() {
  soft_ = std::ranges::any_of(soils_.soils, &SoilParameters::soft);
  if (soft_) {
    ruts_ = Ruts(Ruts::kPages);
  }
}

void Ground::fill_bins() {
  if (obstacles_.empty()) {
    return;
  }
  std::vector<ObstacleBounds> boxes;
  boxes.reserve(obstacles_.size());
  for (const Obstacle& obstacle : obstacles_) {
    boxes.push_back(bounds(obstacle));
  }
  Eigen::Vector2d lower = boxes.front().lower_m;
  Eigen::Vector2d upper = boxes.front().upper_m;
  for (const ObstacleBounds& box : boxes) {
    lower = lower.cwiseMin(box.lower_m);
    upper = upper.cwiseMax(box.upper_m);
  }
  bin_m_ = std::max(kSmallestBin_m, (upper - lower).maxCoeff() / kMostBinsPerSide);
  bin_origin_m_ = lower;
  bin_columns_ = static_cast<std::size_t>((upper.x() - lower.x()) / bin_m_) + 1;
  bin_rows_ = static_cast<std::size_t>((upper.y() - lower.y()) / bin_m_) + 1;

  const auto for_each_bin = [this](const ObstacleBounds& box, auto&& visit) {
    const auto column = [this](double x) {
      return bin_index(x, bin_origin_m_.x(), bin_m_, bin_columns_);
    };
    const auto row = [this](double y) {
      return bin_index(y, bin_origin_m_.y(), bin_m_, bin_rows_);
    };
    for (std::size_t r = row(box.lower_m.y()); r <= row(box.upper_m.y()); ++r) {
      for (std::size_t c = column(box.lower_m.x()); c <= column(box.upper_m.x()); ++c) {
        visit(r * bin_columns_ + c);
      }
    }
  };
  // Counts, then starts, then places: one array for all bins.
  bin_starts_.assign(bin_columns_ * bin_rows_ + 1, 0);
  for (const ObstacleBounds& box : boxes) {
    for_each_bin(box, [this](std::size_t bin) { ++bin_starts_[bin + 1]; });
  }
  for (std::size_t i = 1; i < bin_starts_.size(); ++i) {
    bin_starts_[i] += bin_starts_[i - 1];
  }
  bin_obstacles_.assign(bin_starts_.back(), 0);
  std::vector<std::uint32_t> next(bin_starts_.begin(), bin_starts_.end() - 1);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for_each_bin(boxes[i], [&](std::size_t bin) {
      bin_obstacles_[next[bin]++] = static_cast<std::uint32_t>(i);
    });
  }
}

template <class Visit>
void Ground::near_obstacles(const Eigen::Vector2d& lower_m, const Eigen::Vector2d& upper_m,
                            Visit&& visit) const {
  for (std::size_t i = 0; i < lying_count_; ++i) {
    const Lying& lying = lying_[i];
    if ((lower_m.array() <= lying.upper_m.array()).all() &&
        (upper_m.array() >= lying.lower_m.array()).all()) {
      visit(obstacles_[lying.obstacle]);
    }
  }
  const Eigen::Vector2d end =
      bin_origin_m_ +
      bin_m_ * Eigen::Vector2d(static_cast<double>(bin_columns_), static_cast<double>(bin_rows_));
  if (bin_columns_ == 0 || !((lower_m.array() <= end.array()).all() &&
                             (upper_m.array() >= bin_origin_m_.array()).all())) {
    return;
  }
  const std::size_t c_end = bin_index(upper_m.x(), bin_origin_m_.x(), bin_m_, bin_columns_);
  const std::size_t r_end = bin_index(upper_m.y(), bin_origin_m_.y(), bin_m_, bin_rows_);
  for (std::size_t r = bin_index(lower_m.y(), bin_origin_m_.y(), bin_m_, bin_rows_); r <= r_end;
       ++r) {
    for (std::size_t c = bin_index(lower_m.x(), bin_origin_m_.x(), bin_m_, bin_columns_);
         c <= c_end; ++c) {
      const std::size_t bin = r * bin_columns_ + c;
      for (std::uint32_t i = bin_starts_[bin]; i < bin_starts_[bin + 1]; ++i) {
        visit(obstacles_[bin_obstacles_[i]]);
      }
    }
  }
}

bool Ground::rises_above(std::size_t obstacle, const Eigen::Vector3d& p_W) const {
  if (tops_m_[obstacle] <= p_W.z()) {
    return false;
  }
  const auto under = top(obstacles_[obstacle], p_W.x(), p_W.y());
  return !under || under->height_m > p_W.z();
}

bool Ground::too_high(std::size_t obstacle, const Eigen::Vector3d& centre_W) const {
  return obstacles_[obstacle].shape != ObstacleShape::sphere && rises_above(obstacle, centre_W);
}

bool Ground::lay(std::size_t obstacle, const Eigen::Isometry3d& X_WO) const {
  if (lying_count_ == lying_.size()) {
    return false;
  }
  Obstacle& fallen = obstacles_[obstacle];
  fallen.X_WO = X_WO;
  fallen.strength_nm = std::numeric_limits<double>::infinity();
  fallen.stiffness_npm = 0.0;
  tops_m_[obstacle] = top_m(fallen);
  const ObstacleBounds box = bounds(fallen);
  lying_[lying_count_++] = {obstacle, box.lower_m, box.upper_m};
  if (loose_) {
    loose_->ground_changed(box.lower_m, box.upper_m);
  }
  return true;
}

void Ground::obstacles_near(const Eigen::Vector2d& lower_m, const Eigen::Vector2d& upper_m,
                            std::vector<std::uint32_t>& found) const {
  near_obstacles(lower_m, upper_m, [&](const Obstacle& obstacle) {
    found.push_back(static_cast<std::uint32_t>(&obstacle - obstacles_.data()));
  });
}

Ground::TerrainPoint Ground::terrain(double x_m, double y_m) const {
  if (plane_) {
    const double slope_x = -plane_normal_.x() / plane_normal_.z();
    const double slope_y = -plane_normal_.y() / plane_normal_.z();
    return {slope_x * x_m + slope_y * y_m, slope_x, slope_y, 0};
  }
  const double u_all = (x_m - field_.origin_m.x()) / field_.cell_m;
  const double v_all = (y_m - field_.origin_m.y()) / field_.cell_m;
  const double u = std::clamp(u_all, 0.0, static_cast<double>(field_.columns - 1));
  const double v = std::clamp(v_all, 0.0, static_cast<double>(field_.rows - 1));
  const std::size_t c = std::min(static_cast<std::size_t>(u), field_.columns - 2);
  const std::size_t r = std::min(static_cast<std::size_t>(v), field_.rows - 2);
  const double fx = u - static_cast<double>(c);
  const double fy = v - static_cast<double>(r);
  const double south_east = field_.node(c + 1, r);
  const double north_west = field_.node(c, r + 1);
  double height = 0.0;
  double rise_x = 0.0;
  double rise_y = 0.0;
  // Each cell is two triangles, parted from south-east to north-west (height_field.h).
  if (fx + fy <= 1.0) {
    const double south_west = field_.node(c, r);
    rise_x = south_east - south_west;
    rise_y = north_west - south_west;
    height = south_west + fx * rise_x + fy * rise_y;
  } else {
    const double north_east = field_.node(c + 1, r + 1);
    rise_x = north_east - north_west;
    rise_y = north_east - south_east;
    height = north_east - (1.0 - fx) * rise_x - (1.0 - fy) * rise_y;
  }
  // Beyond an edge the surface goes on level, away from it.
  return {height, u == u_all ? rise_x / field_.cell_m : 0.0,
          v == v_all ? rise_y / field_.cell_m : 0.0, r * (field_.columns - 1) + c};
}

std::uint8_t Ground::soil_of(const TerrainPoint& point) const {
  return soils_.cells.empty() ? std::uint8_t{0} : soils_.cells[point.cell];
}

double Ground::height_m(double x_m, double y_m) const {
  return terrain(x_m, y_m).height_m;
}

GroundPoint Ground::terrain_at(double x_m, double y_m) const {
  const TerrainPoint point = terrain(x_m, y_m);
  GroundPoint result;
  result.height_m = point.height_m;
  result.normal_W = Eigen::Vector3d(-point.slope_x, -point.slope_y, 1.0).normalized();
  result.soil = soil_of(point);
  result.friction = soils_.soils[result.soil].friction;
  return result;
}

void Ground::set_loose(std::vector<LooseBody> bodies) {
  loose_ = bodies.empty() ? nullptr : std::make_shared<LooseBodies>(std::move(bodies), *this);
}

GroundPoint Ground::at(double x_m, double y_m, double ceiling_m) const {
  GroundPoint result = terrain_at(x_m, y_m);
  const Eigen::Vector2d place(x_m, y_m);
  near_obstacles(place, place, [&](const Obstacle& obstacle) {
    const std::optional<ObstacleTop> found = top(obstacle, x_m, y_m);
    if (found && found->height_m <= ceiling_m && found->height_m > result.height_m) {
      result.height_m = found->height_m;
      result.normal_W = found->normal_W;
      result.obstacle = true;
      result.friction = obstacle.friction;
    }
  });
  return result;
}

std::optional<Penetration> Ground::terrain_penetration(const Eigen::Vector3d& p_W) const {
  const TerrainPoint point = terrain(p_W.x(), p_W.y());
  if (p_W.z() < point.height_m) {
    const Eigen::Vector3d normal =
        Eigen::Vector3d(-point.slope_x, -point.slope_y, 1.0).normalized();
    // Distance to the tangent plane: vertical depth times the normal's z.
    return Penetration{(point.height_m - p_W.z()) * normal.z(), normal,
                       soils_.soils[soil_of(point)].friction};
  }
  return std::nullopt;
}

std::optional<Penetration> Ground::penetration(const Eigen::Vector3d& p_W) const {
  std::optional<Penetration> deepest = terrain_penetration(p_W);
  const Eigen::Vector2d place = p_W.head<2>();
  near_obstacles(place, place, [&](const Obstacle& obstacle) {
    const std::optional<Penetration> found = inside(obstacle, p_W);
    if (found && (!deepest || found->depth_m > deepest->depth_m)) {
      deepest = found;
    }
  });
  return deepest;
}

const SoilParameters& Ground::soil(std::uint8_t index) const {
  return soils_.soils[std::min<std::size_t>(index, soils_.soils.size() - 1)];
}

void Ground::set_node(std::size_t column, std::size_t row, double height_m) {
  if (column < field_.columns && row < field_.rows && std::isfinite(height_m)) {
    field_.heights_m[row * field_.columns + column] = height_m;
    const Eigen::Vector2d node =
        field_.origin_m +
        field_.cell_m * Eigen::Vector2d(static_cast<double>(column), static_cast<double>(row));
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5 * field_.cell_m);
    ruts_.forget(node - half, node + half);
    if (loose_) {
      const Eigen::Vector2d cell = Eigen::Vector2d::Constant(field_.cell_m);
      loose_->ground_changed(node - cell, node + cell);
    }
  }
}

// --- soft soil -----------------------------------------------------------------------------------

void SoftSoils::add(const SoilParameters& soft, double of_contact) {
  if (!soft.soft || !(of_contact > 0.0)) {
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (soil[i] == &soft) {
      share[i] += of_contact;
      return;
    }
  }
  if (count < kMost) {
    soil[count] = &soft;
    share[count++] = of_contact;
  }
}

double SoftSoils::whole_share() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    sum += share[i];
  }
  return sum;
}

SoftSoils Ground::soft_soils(const Eigen::Vector2d& p_W, double terrain_share) const {
  SoftSoils result;
  if (soils_.cells.empty()) {
    result.add(soils_.soils.front(), terrain_share);
  } else {
    // Along each axis the cell, and its nearer neighbour where the border between them is near: its
    // share falls from a half to nothing over half of the border.
    const std::size_t columns = field_.columns - 1;
    const std::size_t rows = field_.rows - 1;
    const double half_border = 0.5 * std::min(kBorder_m, field_.cell_m) / field_.cell_m;
    struct Side {
      std::size_t cell, neighbour;
      double share;
    };
    const auto side = [&](double coordinate, double origin, std::size_t count) {
      const double u =
          std::clamp((coordinate - origin) / field_.cell_m, 0.0, static_cast<double>(count));
      const std::size_t cell = std::min(static_cast<std::size_t>(u), count - 1);
      const double within = u - static_cast<double>(cell);
      const bool upper = within > 0.5;
      const double distance = upper ? 1.0 - within : within;
      const bool none = upper ? cell + 1 >= count : cell == 0;
      if (none || distance >= half_border) {
        return Side{cell, cell, 0.0};
      }
      return Side{cell, upper ? cell + 1 : cell - 1, 0.5 * (1.0 - distance / half_border)};
    };
    const Side x = side(p_W.x(), field_.origin_m.x(), columns);
    const Side y = side(p_W.y(), field_.origin_m.y(), rows);
    const auto add = [&](std::size_t column, std::size_t row, double share) {
      if (share > 0.0) {
        result.add(soils_.soils[soils_.cells[row * columns + column]], share * terrain_share);
      }
    };
    add(x.cell, y.cell, (1.0 - x.share) * (1.0 - y.share));
    add(x.neighbour, y.cell, x.share * (1.0 - y.share));
    add(x.cell, y.neighbour, (1.0 - x.share) * y.share);
    add(x.neighbour, y.neighbour, x.share * y.share);
  }
  return result;
}

WheelFooting Ground::footing(const WheelContact& contact, const Eigen::Vector3d& way_W,
                             double reach_m) const {
  WheelFooting result;
  if (!soft_) {
    return result;
  }
  const Eigen::Vector2d place = contact.point_W.head<2>();
  result.under = soft_soils(place, contact.terrain_share);
  result.under.pressed_m = result.under.count > 0 ? ruts_.depth_m(place) : 0.0;
  if (result.under.count > 0 && reach_m > 0.0) {
    const Eigen::Vector2d way = way_W.head<2>().normalized();
    result.reach_m = std::max(kLeastReach_m, reach_m);
    result.pressed_ahead_m = ruts_.depth_m(place + result.reach_m * way);
    result.next = soft_soils(place + WheelFooting::kNext_m * way, contact.terrain_share);
    result.next.pressed_m = result.under.pressed_m;
  }
  return result;
}

void Ground::press(const WheelContact& contact, const Eigen::Vector3d& forward_W, double width_m,
                   double depth_m) const {
  // Half a cell more than what depth_m() reads, so that the wheel finds its own depth under it.
  ruts_.press(contact.point_W.head<2>(), forward_W.head<2>().normalized(), 1.5 * Ruts::kCell_m,
              0.5 * width_m, depth_m);
}

// --- wheels --------------------------------------------------------------------------------------

std::optional<Penetration> Ground::disc_on_terrain(const Eigen::Vector3d& centre_W,
                                                   const Eigen::Vector3d& up_W,
                                                   const Eigen::Vector3d& forward_W,
                                                   double radius_m) const {
  // Profile under the disc's lowest point, along its horizontal direction; side slope across it.
  const Eigen::Vector2d ahead = forward_W.head<2>();
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  const Eigen::Vector2d below = centre_W.head<2>() - radius_m * up_W.head<2>();
  const double lean = up_W.head<2>().dot(left);  // sine of the disc's lean, to the left
  const auto height = [&](double along, double across) {
    const Eigen::Vector2d place = below + along * ahead + across * left;
    return terrain(place.x(), place.y()).height_m - centre_W.z();
  };
  constexpr double kReachAcross = 0.3;  // of the radius: about half a tyre's width
  const double across = kReachAcross * radius_m;
  const double side_slope = (height(0.0, across) - height(0.0, -across)) / (2.0 * across);
  // A point of the disc at (x ahead, y up its plane) lies y + radius further left by the lean.
  const double rise = up_W.z() - side_slope * lean;
  if (rise < 0.05) {
    return std::nullopt;
  }
  std::array<Eigen::Vector2d, kProfilePoints> profile;
  for (std::size_t i = 0; i < kProfilePoints; ++i) {
    const double along = kProfilePlaces[i] * radius_m;
    profile[i] = {along, (height(along, 0.0) + side_slope * radius_m * lean) / rise};
  }
  const std::optional<DiscCut> cut = cut_disc(profile, radius_m);
  if (!cut) {
    return std::nullopt;
  }
  const Eigen::Vector3d in_plane = cut->normal.x() * forward_W + cut->normal.y() * up_W;
  // The surface's normal is square to the cut's chord in the disc and to the slope across it.
  const Eigen::Vector3d chord = cut->normal.y() * forward_W - cut->normal.x() * up_W;
  const Eigen::Vector3d normal =
      chord.cross(Eigen::Vector3d(left.x(), left.y(), side_slope)).normalized();
  return Penetration{cut->depth_m * std::max(0.0, normal.dot(in_plane)), normal, 0.0};
}

std::optional<WheelContact> Ground::wheel_contact(const Eigen::Vector3d& centre_W,
                                                  const Eigen::Vector3d& axis_W,
                                                  double radius_m) const {
  const Eigen::Vector3d upright = Eigen::Vector3d::UnitZ() - axis_W.z() * axis_W;
  const double steepness = upright.norm();
  if (!(steepness > 1e-3)) {
    return std::nullopt;
  }
  const Eigen::Vector3d up = upright / steepness;
  const Eigen::Vector3d forward = axis_W.cross(up);  // horizontal

  constexpr std::size_t kMost = 5;
  std::array<Penetration, kMost> overlaps;
  std::size_t count = 0;
  bool on_terrain = false;
  if (plane_) {
    const double sine =
        std::sqrt(std::max(0.0, 1.0 - plane_normal_.dot(axis_W) * plane_normal_.dot(axis_W)));
    // Disc's lowest point against the plane: R sin(angle of axis and normal) - n . centre.
    const double depth = radius_m * sine - plane_normal_.dot(centre_W);
    if (depth > 0.0) {
      overlaps[count++] = {depth, plane_normal_, 0.0};
      on_terrain = true;
    }
  } else if (const auto found = disc_on_terrain(centre_W, up, forward, radius_m)) {
    overlaps[count++] = *found;
    on_terrain = true;
  }
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(radius_m);
  near_obstacles(
      centre_W.head<2>() - reach, centre_W.head<2>() + reach, [&](const Obstacle& obstacle) {
        if (too_high(static_cast<std::size_t>(&obstacle - obstacles_.data()), centre_W)) {
          return;
        }
        const auto found = disc_overlap(obstacle, centre_W, axis_W, radius_m);
        if (found && count < kMost) {
          overlaps[count++] = {found->depth_m, found->normal_W, obstacle.friction};
        }
      });
  if (count == 0) {
    return std::nullopt;
  }

  WheelContact contact;
  Escape way;
  if (count == 1) {
    way.way_W = overlaps[0].depth_m * overlaps[0].normal_W;
    way.shares[0] = 1.0;
    contact.depth_m = overlaps[0].depth_m;
    contact.normal_W = overlaps[0].normal_W;
  } else {
    way = shortest_escape(std::span(overlaps).first(count));
    contact.depth_m = way.way_W.norm();
    contact.normal_W = way.way_W / contact.depth_m;
  }
  // Contact point: along the normal's part in the disc, R less the depth as seen in its plane.
  const Eigen::Vector3d in_plane = contact.normal_W - contact.normal_W.dot(axis_W) * axis_W;
  const double cosine = in_plane.norm();
  contact.point_W = centre_W - in_plane * ((radius_m - contact.depth_m / std::max(cosine, 1e-3)) /
                                           std::max(cosine, 1e-3));

  const TerrainPoint under = terrain(contact.point_W.x(), contact.point_W.y());
  GroundPoint& ground = contact.ground;
  ground.height_m = contact.point_W.z();
  ground.normal_W = contact.normal_W;
  ground.soil = soil_of(under);
  // Where terrain and obstacles share the wheel, so does their friction.
  double friction = 0.0;
  double total = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool terrain_share = on_terrain && i == 0;
    friction +=
        way.shares[i] * (terrain_share ? soils_.soils[ground.soil].friction : overlaps[i].friction);
    total += way.shares[i];
  }
  ground.friction = friction / total;
  contact.terrain_share = on_terrain ? way.shares[0] / total : 0.0;
  ground.obstacle = 2.0 * contact.terrain_share < 1.0;
  return contact;
}

}  // namespace rigwire::sim
