#include "sim/camera/shadow_ceiling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/samples/wide_vectors.h"

namespace rigwire::sim {
namespace {

constexpr float kNoGround = -std::numeric_limits<float>::infinity();
constexpr float kClosed = std::numeric_limits<float>::infinity();
/// What rounding in Embree's coordinates may move, with room.
constexpr double kMargin_m = 0.02;
/// Margin of a cell's cosine of incidence, for the same reason.
constexpr float kFacingMargin = 0.005F;
/// What may be dug below the ground as it was laid out.
constexpr double kDeepest_m = 10.0;

/// For each cell between two rows of nodes: by how much the steepest of the triangles that its
/// nodes can make rises above the sun's rays, and the margin; 0 and more casts a shadow.
RIGWIRE_WIDE_VECTORS void rise(const float* south, const float* north, std::size_t cells,
                               float per_m, const std::array<float, 4>& facing, float* above) {
  const auto [east, north_share, up, margin] = facing;
#pragma GCC ivdep
  for (std::size_t c = 0; c < cells; ++c) {
    const float x0 = (south[c + 1] - south[c]) * per_m;
    const float x1 = (north[c + 1] - north[c]) * per_m;
    const float y0 = (north[c] - south[c]) * per_m;
    const float y1 = (north[c + 1] - south[c + 1]) * per_m;
    const float x = std::max(x0 * east, x1 * east);
    const float y = std::max(y0 * north_share, y1 * north_share);
    const float steep = std::max(std::abs(x0), std::abs(x1)) + std::max(std::abs(y0), std::abs(y1));
    above[c] = x + y + margin * (1.0F + steep) - up;
  }
}

RIGWIRE_WIDE_VECTORS void fall_by(const float* from, float less_m, std::size_t count, float* to) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const float fallen = from[i] - less_m;
    to[i] = to[i] > fallen ? to[i] : fallen;
  }
}

RIGWIRE_WIDE_VECTORS void close_unless(const int* first, const int* last, int place,
                                       std::size_t count, float* ceiling_m) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const bool open = (first[i] <= place) & (place <= last[i]);
    ceiling_m[i] = choose(open, ceiling_m[i], kClosed);
  }
}

}  // namespace

bool ShadowCeiling::keeps(const Scene::Internals& scene, const Eigen::Vector3f& to_sun_W,
                          double sun_radius_rad) const {
  return kept_.scene.lock() == scene.identity && kept_.placed == scene.placed.size() &&
         kept_.to_sun_W == to_sun_W && kept_.sun_radius_rad == sun_radius_rad;
}

void ShadowCeiling::prepare(const Scene::Internals& scene, const Eigen::Vector3f& to_sun_W,
                            double sun_radius_rad) {
  certain_ = scene.terrains.size() == 1 && to_sun_W.z() > std::sin(kLeastElevation_rad);
  if (!certain_) {
    return;
  }
  const Scene::Internals::Terrain& terrain = scene.terrains.front();
  if (!keeps(scene, to_sun_W, sun_radius_rad)) {
    kept_ = {scene.identity, scene.placed.size(), to_sun_W, sun_radius_rad};
    lay_out(terrain, to_sun_W, sun_radius_rad);
    raise_fixed(scene);
    if (terrain.tiles.empty()) {
      raise_terrain(terrain);
    }
    fixed_m_ = ceiling_m_;
  }
  std::ranges::copy(fixed_m_, ceiling_m_.begin());
  raise_moving(scene);
  if (!terrain.tiles.empty()) {
    raise_terrain(terrain);
  }
  fall();

  const Eigen::Vector2d origin_m = scene.origin_W.head<2>();
  const Eigen::Vector2d across(-along_.y(), along_.x());
  to_along_ = {static_cast<float>(along_.x() / cell_m_), static_cast<float>(along_.y() / cell_m_),
               static_cast<float>((origin_m.dot(along_) - corner_m_.x()) / cell_m_)};
  to_across_ = {static_cast<float>(across.x() / cell_m_), static_cast<float>(across.y() / cell_m_),
                static_cast<float>((origin_m.dot(across) - corner_m_.y()) / cell_m_)};
  to_world_m_ = static_cast<float>(scene.origin_W.z());
}

void ShadowCeiling::lay_out(const Scene::Internals::Terrain& terrain,
                            const Eigen::Vector3f& to_sun_W, double sun_radius_rad) {
  const HeightField& field = terrain.field;
  const Eigen::Vector3d to_sun = to_sun_W.cast<double>();
  const double level = to_sun.head<2>().norm();
  along_ = level > 1e-6 ? Eigen::Vector2d(to_sun.head<2>() / level) : Eigen::Vector2d::UnitX();
  const double elevation_rad = std::atan2(to_sun.z(), level);
  const double lowest_rad = elevation_rad - sun_radius_rad;
  facing_ = {static_cast<float>(along_.x() * level), static_cast<float>(along_.y() * level),
             static_cast<float>(to_sun.z()), kFacingMargin + static_cast<float>(sun_radius_rad)};
  fall_ = std::tan(lowest_rad);
  spread_ = sun_radius_rad / std::sin(lowest_rad);
  lowest_m_ = *std::ranges::min_element(field.heights_m) - kDeepest_m;

  // The terrain's corners, along and across.
  const Eigen::Vector2d across(-along_.y(), along_.x());
  const Eigen::Vector2d size_m =
      field.cell_m *
      Eigen::Vector2d(static_cast<double>(field.columns - 1), static_cast<double>(field.rows - 1));
  const double middle_along = (field.origin_m + 0.5 * size_m).dot(along_);
  const double middle_across = (field.origin_m + 0.5 * size_m).dot(across);
  const double half_along = 0.5 * size_m.dot(along_.cwiseAbs());
  const double half_across = 0.5 * size_m.dot(across.cwiseAbs());
  cell_m_ = std::max(kLeastCell_m, 2.0 * std::max(half_along, half_across) / kMostAcross);
  // One cell more on each side, which is closed.
  length_ = static_cast<int>(std::ceil(2.0 * half_along / cell_m_)) + 2;
  width_ = static_cast<int>(std::ceil(2.0 * half_across / cell_m_)) + 2;
  corner_m_ << middle_along - half_along - cell_m_, middle_across - half_across - cell_m_;
  ceiling_m_.assign(static_cast<std::size_t>(length_) * static_cast<std::size_t>(width_),
                    kNoGround);

  // Cells with all corners over the terrain: a run along, for each place across.
  first_open_.assign(static_cast<std::size_t>(width_), length_);
  last_open_.assign(static_cast<std::size_t>(width_), -1);
  const Eigen::Array2d low = field.origin_m.array() + kMargin_m;
  const Eigen::Array2d high = (field.origin_m + size_m).array() - kMargin_m;
  const auto inside = [&](int i, int j) {
    const Eigen::Vector2d place = corner_m_ + cell_m_ * Eigen::Vector2d(i, j);
    const Eigen::Array2d p = (place.x() * along_ + place.y() * across).array();
    return (p >= low).all() && (p <= high).all();
  };
  for (int j = 0; j < width_; ++j) {
    for (int i = 0; i < length_; ++i) {
      if (inside(i, j) && inside(i + 1, j) && inside(i, j + 1) && inside(i + 1, j + 1)) {
        int& first = first_open_[static_cast<std::size_t>(j)];
        first = std::min(first, i);
        last_open_[static_cast<std::size_t>(j)] = i;
      }
    }
  }
}

void ShadowCeiling::raise(const Caster& caster) {
  double top_m = caster.top_m + kMargin_m;
  const double aside_m = kMargin_m + spread_ * std::max(0.0, top_m - lowest_m_);
  const auto cell = [this](double place_m) {
    return static_cast<int>(std::clamp(std::floor(place_m / cell_m_), -1e9, 1e9));
  };
  // A point at the near side of the next cell may look at it, too.
  int first = cell(caster.begin_m - aside_m) - 1;
  int last = cell(caster.end_m + aside_m);
  const int left = std::max(0, cell(caster.left_m - aside_m));
  const int right = std::min(width_ - 1, cell(caster.right_m + aside_m));
  if (first >= length_) {
    top_m -= (first - (length_ - 1)) * cell_m_ * fall_;
    first = length_ - 1;
  }
  first = std::max(first, 0);
  last = std::min(last, length_ - 1);
  const auto top = static_cast<float>(top_m);
  for (int i = first; i <= last; ++i) {
    float* row = ceiling_m_.data() + static_cast<std::size_t>(i) * static_cast<std::size_t>(width_);
    for (int j = left; j <= right; ++j) {
      row[j] = std::max(row[j], top);
    }
  }
}

void ShadowCeiling::raise_box(const Eigen::AlignedBox3f& bounds_M, double scale,
                              std::span<const Eigen::Isometry3d> poses_W) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Caster caster{kFar, -kFar, kFar, -kFar, -kFar};
  for (const Eigen::Isometry3d& X_WM : poses_W) {
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3d corner =
          bounds_M.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k)).cast<double>();
      const Eigen::Vector3d p = X_WM * (scale * corner);
      const double along_m = p.head<2>().dot(along_) - corner_m_.x();
      const double across_m = along_.x() * p.y() - along_.y() * p.x() - corner_m_.y();
      caster.begin_m = std::min(caster.begin_m, along_m);
      caster.end_m = std::max(caster.end_m, along_m);
      caster.left_m = std::min(caster.left_m, across_m);
      caster.right_m = std::max(caster.right_m, across_m);
      caster.top_m = std::max(caster.top_m, p.z());
    }
  }
  raise(caster);
}

void ShadowCeiling::raise_fixed(const Scene::Internals& scene) {
  const std::uint32_t ground = scene.instances[scene.terrains.front().instance].placed;
  for (std::uint32_t i = 0; i < scene.placed.size(); ++i) {
    const Scene::Internals::Placed& thing = scene.placed[i];
    if (thing.body == Scene::Internals::kFixed && thing.mask != 0 && i != ground) {
      raise_box(thing.bounds_M, thing.scale, {&thing.X_PM, 1});
    }
  }
}

void ShadowCeiling::raise_moving(const Scene::Internals& scene) {
  for (const std::uint32_t index : scene.on_bodies) {
    const Scene::Internals::Placed& thing = scene.placed[index];
    const BodyMotion& motion = scene.body_motions[thing.body];
    const std::array<Eigen::Isometry3d, 2> poses_W{motion.X_WB_start * thing.X_PM,
                                                   motion.X_WB_end * thing.X_PM};
    raise_box(thing.bounds_M, thing.scale, poses_W);
  }
  if (!scene.displaced) {
    return;
  }
  for (const DisplacedPiece& piece : *scene.displaced) {
    if (!piece.piece.canopy) {
      RTCBounds bounds{};
      rtcGetSceneBounds(piece.shape.get(), &bounds);
      raise_box({Eigen::Vector3f(bounds.lower_x, bounds.lower_y, bounds.lower_z),
                 Eigen::Vector3f(bounds.upper_x, bounds.upper_y, bounds.upper_z)},
                piece.scale, {&piece.X_WM, 1});
    }
  }
}

void ShadowCeiling::raise_terrain(const Scene::Internals::Terrain& terrain) {
  // Heights are Embree's floats above the terrain's centre, as the rays see them.
  const auto raise_rows = [&](std::size_t first_column, std::size_t first_row, std::size_t columns,
                              std::size_t rows, const auto& height) {
    const HeightField& field = terrain.field;
    south_.resize(columns);
    north_.resize(columns);
    above_.resize(columns);
    for (std::size_t c = 0; c < columns; ++c) {
      north_[c] = height(c, std::size_t{0});
    }
    const double half_m = 0.5 * field.cell_m * (std::abs(along_.x()) + std::abs(along_.y()));
    for (std::size_t r = 0; r + 1 < rows; ++r) {
      std::swap(south_, north_);
      for (std::size_t c = 0; c < columns; ++c) {
        north_[c] = height(c, r + 1);
      }
      rise(south_.data(), north_.data(), columns - 1, static_cast<float>(1.0 / field.cell_m),
           facing_, above_.data());
      for (std::size_t c = 0; c + 1 < columns; ++c) {
        if (above_[c] >= 0.0F) {
          const Eigen::Vector2d p =
              field.origin_m +
              field.cell_m * Eigen::Vector2d(static_cast<double>(first_column + c) + 0.5,
                                             static_cast<double>(first_row + r) + 0.5);
          const double along_m = p.dot(along_) - corner_m_.x();
          const double across_m = along_.x() * p.y() - along_.y() * p.x() - corner_m_.y();
          const float top = std::max({south_[c], south_[c + 1], north_[c], north_[c + 1]});
          raise({along_m - half_m, along_m + half_m, across_m - half_m, across_m + half_m,
                 terrain.centre_W.z() + static_cast<double>(top)});
        }
      }
    }
  };
  if (terrain.tiles.empty()) {
    raise_rows(0, 0, terrain.field.columns, terrain.field.rows, [&](std::size_t c, std::size_t r) {
      return static_cast<float>(terrain.field.node(c, r) - terrain.centre_W.z());
    });
  }
  for (const Scene::Internals::Tile& tile : terrain.tiles) {
    raise_rows(tile.first_column, tile.first_row, tile.columns, tile.rows,
               [&](std::size_t c, std::size_t r) {
                 return tile.vertices[3 * (r * tile.columns + c) + 2];
               });
  }
}

void ShadowCeiling::fall() {
  const auto width = static_cast<std::size_t>(width_);
  const auto less_m = static_cast<float>(cell_m_ * fall_);
  for (int i = length_ - 2; i >= 0; --i) {
    float* row = ceiling_m_.data() + static_cast<std::size_t>(i) * width;
    fall_by(row + width, less_m, width, row);
  }
  for (int i = 0; i < length_; ++i) {
    close_unless(first_open_.data(), last_open_.data(), i, width,
                 ceiling_m_.data() + static_cast<std::size_t>(i) * width);
  }
}

RIGWIRE_WIDE_VECTORS bool ShadowCeiling::doubt(const RTCRay8& rays,
                                               const std::array<int, kLanes>& active,
                                               std::array<int, kLanes>& doubtful) const {
  if (!certain_) {
    doubtful = active;
    return true;
  }
  const float* ceiling_m = ceiling_m_.data();
  const auto last_along = static_cast<float>(length_ - 1);
  const auto last_across = static_cast<float>(width_ - 1);
  const int width = width_;
  alignas(32) std::array<int, kLanes> cell;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float x = rays.org_x[i];
    const float y = rays.org_y[i];
    const float along = to_along_[0] * x + to_along_[1] * y + to_along_[2];
    const float across = to_across_[0] * x + to_across_[1] * y + to_across_[2];
    // The outermost cells are closed; NaN becomes the first of them.
    const float a = std::min(std::max(0.0F, along), last_along);
    const float b = std::min(std::max(0.0F, across), last_across);
    cell[i] = static_cast<int>(a) * width + static_cast<int>(b);
  }
  int any = 0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const int below = rays.org_z[i] + to_world_m_ > ceiling_m[cell[i]] ? 0 : -1;
    doubtful[i] = active[i] & below;
    any |= doubtful[i];
  }
  return any != 0;
}

}  // namespace rigwire::sim
