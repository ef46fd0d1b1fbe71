#include "find_rocks/ground_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace rigwire::find_rocks {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr float kNoHeight = std::numeric_limits<float>::infinity();

// Parameters of the search for the plane.
constexpr int kPlaneStride_px = 8;
constexpr int kTriples = 400;
constexpr std::size_t kLeastSamples = 200;
constexpr double kPlaneTolerance_px = 1.0;
constexpr double kLeastShare = 0.08;  ///< Minimum share of the samples near a plane.
constexpr int kRefinements = 3;

// Parameters of the cells.
constexpr int kCellStride_px = 2;
constexpr std::size_t kLeastPoints = 4;
constexpr double kLowQuantile = 0.3;  ///< Quantile that a cell's height is.
/// A cell that is below its neighbours by more than this and three times its deviation is a wrong
/// disparity.
constexpr double kHole_m = 0.25;
/// Height up to which rough ground counts as ground.
constexpr double kRoughness_m = 0.06;

// Parameters of the membrane: tension against a height known to 1 cm.
constexpr float kTension = 40.0F;
/// Tension towards hidden cells: guessed heights must not bend measured ones.
constexpr float kUnknownLink = 0.1F;
constexpr int kRelaxations = 80;
constexpr float kOverRelaxation = 1.6F;

struct Sample {
  double u = 0.0;
  double v = 0.0;
  double disparity = 0.0;
};
using Vector3 = std::array<double, 3>;

/// Solves three equations; nothing when they are none.
std::optional<Vector3> solve(std::array<Vector3, 3> a, Vector3 b) {
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < 3; ++i) {
      pivot = std::abs(a[i][k]) > std::abs(a[pivot][k]) ? i : pivot;
    }
    if (std::abs(a[pivot][k]) < 1e-12) {
      return std::nullopt;
    }
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < 3; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < 3; ++j) {
        a[i][j] -= factor * a[k][j];
      }
      b[i] -= factor * b[k];
    }
  }
  Vector3 x{};
  for (std::size_t k = 3; k-- > 0;) {
    x[k] = b[k];
    for (std::size_t j = k + 1; j < 3; ++j) {
      x[k] -= a[k][j] * x[j];
    }
    x[k] /= a[k][k];
  }
  return x;
}

double off_plane(const Vector3& plane, const Sample& s) {
  return s.disparity - (plane[0] * s.u + plane[1] * s.v + plane[2]);
}

/// Least squares over the samples near the plane.
std::optional<Vector3> refined(const Vector3& plane, const std::vector<Sample>& samples) {
  std::array<Vector3, 3> a{};
  Vector3 b{};
  for (const Sample& s : samples) {
    if (std::abs(off_plane(plane, s)) > kPlaneTolerance_px) {
      continue;
    }
    const Vector3 row{s.u, s.v, 1.0};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        a[i][j] += row[i] * row[j];
      }
      b[i] += row[i] * s.disparity;
    }
  }
  return solve(a, b);
}

}  // namespace

GroundSurface::GroundSurface(const GroundSettings& settings, double focal_baseline)
    : settings_(settings),
      focal_baseline_(focal_baseline),
      rows_(static_cast<int>(std::ceil(settings.farthest_m / settings.cell_m))),
      columns_(static_cast<int>(std::ceil(2.0 * settings.aside_m / settings.cell_m))) {}

std::optional<GroundSurface> GroundSurface::find(const StereoPicture& picture,
                                                 const GroundSettings& settings) {
  GroundSurface ground(settings, picture.geometry().focal_baseline());
  if (!ground.find_plane(picture) || !ground.lay_surface(picture)) {
    return std::nullopt;
  }
  return ground;
}

// --- The plane. ------------------------------------------------------------------------------

bool GroundSurface::find_plane(const StereoPicture& picture) {
  // Coordinates from the principal point, in units of the focal length: sights.
  std::vector<Sample> samples;
  for (int v = kPlaneStride_px / 2; v < picture.height(); v += kPlaneStride_px) {
    for (int u = kPlaneStride_px / 2; u < picture.width(); u += kPlaneStride_px) {
      const double disparity = picture.disparity_px(u, v);
      if (disparity * settings_.farthest_m > focal_baseline_) {
        const Point sight = picture.sight(u, v);
        samples.push_back({sight.x, sight.y, disparity});
      }
    }
  }
  if (samples.size() < kLeastSamples) {
    return false;
  }
  // With n.P = -h the disparity of a sight r is -f B (n.r) / h: the plane's normal is along
  // (a, b, c), upward is against y.
  const double least_b = std::cos(settings_.tilt_limit_deg * kDegree);
  const auto possible = [&](const Vector3& p) {
    const double length = std::hypot(p[0], p[1], p[2]);
    if (!settings_.mount) {
      return p[1] >= least_b * length;
    }
    const CameraMount& mount = *settings_.mount;
    const double pitch = mount.pitch_deg * kDegree;
    const double along = (p[1] * std::cos(pitch) + p[2] * std::sin(pitch)) / length;
    return along >= std::cos(CameraMount::kTiltTolerance_deg * kDegree) &&
           std::abs(focal_baseline_ / length - mount.height_m) <=
               CameraMount::kHeightTolerance * mount.height_m;
  };
  std::mt19937 random(1);
  const auto any = [&random, &samples] { return samples[random() % samples.size()]; };
  std::optional<Vector3> best;
  std::size_t most = 0;
  for (int i = 0; i < kTriples; ++i) {
    const std::array<Sample, 3> three{any(), any(), any()};
    std::array<Vector3, 3> a{};
    Vector3 b{};
    for (std::size_t k = 0; k < 3; ++k) {
      a[k] = {three[k].u, three[k].v, 1.0};
      b[k] = three[k].disparity;
    }
    const auto plane = solve(a, b);
    if (!plane || !possible(*plane)) {
      continue;
    }
    const auto near =
        static_cast<std::size_t>(std::ranges::count_if(samples, [&plane](const Sample& s) {
          return std::abs(off_plane(*plane, s)) < kPlaneTolerance_px;
        }));
    if (near > most) {
      most = near;
      best = plane;
    }
  }
  if (!best || static_cast<double>(most) < kLeastShare * static_cast<double>(samples.size())) {
    return false;
  }
  // Uneven ground may pull the plane beyond what the mount permits: that far it is not followed.
  for (int i = 0; i < kRefinements; ++i) {
    const auto better = refined(*best, samples);
    if (!better || !possible(*better)) {
      break;
    }
    best = better;
  }
  const Vector3& p = *best;
  const double length = std::hypot(p[0], p[1], p[2]);
  up_ = {-p[0] / length, -p[1] / length, -p[2] / length};
  camera_height_m_ = focal_baseline_ / length;
  // The optical axis, and across it, within the plane.
  const Point axis{-up_.z * up_.x, -up_.z * up_.y, 1.0 - up_.z * up_.z};
  ahead_ = scaled(axis, 1.0 / std::sqrt(dot(axis, axis)));
  left_ = {up_.y * ahead_.z - up_.z * ahead_.y, up_.z * ahead_.x - up_.x * ahead_.z,
           up_.x * ahead_.y - up_.y * ahead_.x};
  return true;
}

GroundSurface::Place GroundSurface::place(const Point& point) const {
  return {dot(ahead_, point), dot(left_, point), dot(up_, point) + camera_height_m_};
}

double GroundSurface::height_sigma_m(double ahead_m) const {
  // Z errs by Z^2 s / (f B) along the sight, which falls by H over Z.
  return std::max(ahead_m, 1.0) * camera_height_m_ * settings_.disparity_sigma_px / focal_baseline_;
}

// --- The surface. ----------------------------------------------------------------------------

std::vector<float> GroundSurface::cell_heights(const StereoPicture& picture,
                                               std::vector<float>& weights) const {
  struct Height {
    std::uint32_t cell = 0;
    float height_m = 0.0F;
  };
  std::vector<Height> all;
  for (int v = 0; v < picture.height(); v += kCellStride_px) {
    for (int u = 0; u < picture.width(); u += kCellStride_px) {
      if (picture.disparity_px(u, v) <= StereoPicture::kNone) {
        continue;
      }
      const Place at = place(picture.point(u, v));
      const double row = at.ahead_m / settings_.cell_m;
      const double column = (at.left_m + settings_.aside_m) / settings_.cell_m;
      if (row >= 0.0 && row < rows_ && column >= 0.0 && column < columns_) {
        all.push_back(
            {static_cast<std::uint32_t>(cell(static_cast<int>(row), static_cast<int>(column))),
             static_cast<float>(at.height_m)});
      }
    }
  }
  std::ranges::sort(all, {}, [](const Height& h) { return std::pair(h.cell, h.height_m); });
  const auto cells = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_);
  std::vector<float> heights(cells, kNoHeight);
  weights.assign(cells, 0.0F);
  for (std::size_t begin = 0; begin < all.size();) {
    const std::uint32_t here = all[begin].cell;
    std::size_t end = begin;
    while (end < all.size() && all[end].cell == here) {
      ++end;
    }
    const std::size_t count = end - begin;
    if (count >= kLeastPoints) {
      heights[here] =
          all[begin + static_cast<std::size_t>(kLowQuantile * static_cast<double>(count))].height_m;
      const std::uint32_t row = here / static_cast<std::uint32_t>(columns_);
      const double ahead = (static_cast<double>(row) + 0.5) * settings_.cell_m;
      // Neighbouring pixels err alike: what counts is the deviation of one, not how many they are.
      const double sigma_cm = 1.0 + 100.0 * height_sigma_m(ahead);
      weights[here] = static_cast<float>(10.0 / sigma_cm);
    }
    begin = end;
  }
  return heights;
}

void GroundSurface::drop_holes(std::vector<float>& heights) const {
  std::vector<float> kept = heights;
  for (int row = 0; row < rows_; ++row) {
    const double limit = kHole_m + 3.0 * height_sigma_m((row + 0.5) * settings_.cell_m);
    for (int column = 0; column < columns_; ++column) {
      const float here = heights[cell(row, column)];
      if (here == kNoHeight) {
        continue;
      }
      int known = 0;
      int above = 0;
      for (int r = std::max(0, row - 2); r <= std::min(rows_ - 1, row + 2); ++r) {
        for (int c = std::max(0, column - 2); c <= std::min(columns_ - 1, column + 2); ++c) {
          const float there = heights[cell(r, c)];
          known += there != kNoHeight ? 1 : 0;
          above += there != kNoHeight && there > here + static_cast<float>(limit) ? 1 : 0;
        }
      }
      // Where ground ends in a drop, half of the cells around are as low.
      if (known < 4 || 10 * above > 6 * known) {
        kept[cell(row, column)] = kNoHeight;
      }
    }
  }
  heights = std::move(kept);
}

std::vector<float> GroundSurface::lower_bound(const std::vector<float>& heights) const {
  // How high each cell may be at most, by the others: two passes over the grid in each direction,
  // distances along the eight neighbours (G. Borgefors, "Distance transformations in digital
  // images", 1986; up to 8 % too long).
  const auto straight =
      static_cast<float>(std::tan(settings_.steepest_deg * kDegree) * settings_.cell_m);
  const float diagonal = straight * std::numbers::sqrt2_v<float>;
  std::vector<float> bound = heights;
  const auto relax = [&](int row, int column, int r, int c, float step) {
    if (r >= 0 && r < rows_ && c >= 0 && c < columns_) {
      float& here = bound[cell(row, column)];
      here = std::min(here, bound[cell(r, c)] + step);
    }
  };
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      relax(row, column, row, column - 1, straight);
      relax(row, column, row - 1, column - 1, diagonal);
      relax(row, column, row - 1, column, straight);
      relax(row, column, row - 1, column + 1, diagonal);
    }
    for (int column = columns_ - 1; column >= 0; --column) {
      relax(row, column, row, column + 1, straight);
    }
  }
  for (int row = rows_ - 1; row >= 0; --row) {
    for (int column = 0; column < columns_; ++column) {
      relax(row, column, row, column - 1, straight);
      relax(row, column, row + 1, column - 1, diagonal);
      relax(row, column, row + 1, column, straight);
      relax(row, column, row + 1, column + 1, diagonal);
    }
    for (int column = columns_ - 1; column >= 0; --column) {
      relax(row, column, row, column + 1, straight);
    }
  }
  return bound;
}

void GroundSurface::span_membrane(const std::vector<float>& heights,
                                  const std::vector<float>& weights) {
  // Minimises the sum of w (z - g)^2 over the cells and of t (g - g')^2 over neighbours, by
  // successive over-relaxation.
  for (int pass = 0; pass < kRelaxations; ++pass) {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const std::size_t here = cell(row, column);
        float sum = 0.0F;
        float weight = 0.0F;
        const bool known = heights[here] != kNoHeight;
        const auto pull = [&](bool there, std::size_t at) {
          if (there) {
            const float link = known && heights[at] != kNoHeight ? 1.0F : kUnknownLink;
            sum += link * surface_m_[at];
            weight += link;
          }
        };
        pull(row > 0, here - static_cast<std::size_t>(columns_));
        pull(row + 1 < rows_, here + static_cast<std::size_t>(columns_));
        pull(column > 0, here - 1);
        pull(column + 1 < columns_, here + 1);
        if (known) {
          const float own = weights[here] * 10.0F / kTension;
          sum += own * heights[here];
          weight += own;
        }
        surface_m_[here] += kOverRelaxation * (sum / weight - surface_m_[here]);
      }
    }
  }
}

bool GroundSurface::lay_surface(const StereoPicture& picture) {
  std::vector<float> weights;
  std::vector<float> heights = cell_heights(picture, weights);
  drop_holes(heights);
  const std::vector<float> bound = lower_bound(heights);
  // Begin near the end: at the bound, or at the plane where nothing is known.
  surface_m_.assign(heights.size(), 0.0F);
  bool any = false;
  for (int row = 0; row < rows_; ++row) {
    const double ahead = (row + 0.5) * settings_.cell_m;
    const auto margin = static_cast<float>(kRoughness_m + 2.0 * height_sigma_m(ahead));
    for (int column = 0; column < columns_; ++column) {
      const std::size_t here = cell(row, column);
      if (heights[here] == kNoHeight) {
        continue;
      }
      any = true;
      surface_m_[here] = bound[here];
      if (heights[here] > bound[here] + margin) {
        heights[here] = kNoHeight;
      }
    }
  }
  if (any) {
    span_membrane(heights, weights);
  }
  return any;
}

std::optional<double> GroundSurface::height_m(const Place& place) const {
  // Between the middles of four cells.
  const double row = place.ahead_m / settings_.cell_m - 0.5;
  const double column = (place.left_m + settings_.aside_m) / settings_.cell_m - 0.5;
  const int r = static_cast<int>(std::floor(row));
  const int c = static_cast<int>(std::floor(column));
  if (r < 0 || r + 1 >= rows_ || c < 0 || c + 1 >= columns_) {
    return std::nullopt;
  }
  const double p = row - r;
  const double q = column - c;
  const auto at = [this](int i, int j) { return static_cast<double>(surface_m_[cell(i, j)]); };
  return (1 - p) * ((1 - q) * at(r, c) + q * at(r, c + 1)) +
         p * ((1 - q) * at(r + 1, c) + q * at(r + 1, c + 1));
}

}  // namespace rigwire::find_rocks
