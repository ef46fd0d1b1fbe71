// Skies for tests of satellite receivers.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "sim/gnss/sky_view.h"
#include "sim/visibility.h"

namespace rigwire::sim {

/// Hides, or weakens by so many metres of foliage, what a function of the direction says.
class FakeSky final : public Visibility {
 public:
  using Hides = std::function<bool(const Eigen::Vector3d&)>;
  using Foliage = std::function<double(const Eigen::Vector3d&)>;
  explicit FakeSky(
      Hides hides, Foliage foliage_m = [](const Eigen::Vector3d&) { return 0.0; })
      : hides_(std::move(hides)), foliage_m_(std::move(foliage_m)) {}

  bool blocked(const Eigen::Vector3d&, const Eigen::Vector3d& direction_W, double) const override {
    return hides_(direction_W);
  }
  SkyPath sky_path(const Eigen::Vector3d&, const Eigen::Vector3d& direction_W,
                   double) const override {
    return {hides_(direction_W), foliage_m_(direction_W)};
  }

 private:
  Hides hides_;
  Foliage foliage_m_;
};

inline FakeSky open_sky() {
  return FakeSky([](const Eigen::Vector3d&) { return false; });
}
/// An antenna on the roof of a car, with less gain overhead than one for surveying and less loss
/// towards the horizon: two NEO-7Ps on a drive through a town.
inline void put_car_antenna(SkyViewParameters& sky) {
  sky.cn0_zenith_dbhz = 48.5;
  sky.cn0_horizon_dbhz = 26.0;
}

inline FakeSky closed_sky() {
  return FakeSky([](const Eigen::Vector3d&) { return true; });
}

/// A vertical wall whose foot is the line x = `distance_m`, from y = -half_length to half_length
/// and up to `height_m` (z from 0).
class FakeWall final : public Visibility {
 public:
  FakeWall(double distance_m, double half_length_m, double height_m)
      : distance_m_(distance_m), half_length_m_(half_length_m), height_m_(height_m) {}

  bool blocked(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
               double clearance_m) const override {
    return surface(p_W, direction_W, clearance_m, std::numeric_limits<double>::infinity())
        .has_value();
  }
  std::optional<ReflectingSurface> surface(const Eigen::Vector3d& p_W,
                                           const Eigen::Vector3d& direction_W, double clearance_m,
                                           double reach_m) const override {
    const double range_m = (distance_m_ - p_W.x()) / direction_W.x();
    const Eigen::Vector3d hit = p_W + range_m * direction_W;
    if (!(range_m > clearance_m && range_m <= reach_m) || std::abs(hit.y()) > half_length_m_ ||
        hit.z() < 0.0 || hit.z() > height_m_) {
      return std::nullopt;
    }
    return ReflectingSurface{range_m, direction_W.x() > 0.0
                                          ? Eigen::Vector3d(-Eigen::Vector3d::UnitX())
                                          : Eigen::Vector3d(Eigen::Vector3d::UnitX())};
  }

 private:
  double distance_m_;
  double half_length_m_;
  double height_m_;
};

/// East-north-up.
inline Eigen::Vector3d direction(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::cos(elevation_rad) * std::cos(azimuth_rad), std::sin(elevation_rad)};
}

}  // namespace rigwire::sim
