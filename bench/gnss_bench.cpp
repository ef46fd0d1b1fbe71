#include "bench/gnss_bench.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "bench/cost.h"
#include "fields/constants.h"
#include "sim/gnss/constellation.h"
#include "sim/gnss/dilution.h"
#include "sim/local_frame.h"

namespace rigwire::bench {
namespace {

using Eigen::Vector3d;

constexpr double kDay_s = 86'400.0;
constexpr double kEvery_s = 120.0;

/// A part of the sky that is open.
struct OpenSky {
  std::string name;
  double mask_rad = 0.0;
  /// Walls of this elevation as seen from the middle of a street that runs east and west.
  double wall_rad = 0.0;

  [[nodiscard]] bool contains(const Vector3d& enu) const {
    const double elevation = std::asin(enu.z());
    if (elevation < mask_rad) {
      return false;
    }
    // The roof edge's elevation falls with the sine of the angle to the street.
    const double sideways = std::abs(enu.y()) / std::max(1e-9, std::hypot(enu.x(), enu.y()));
    return std::tan(elevation) >= std::tan(wall_rad) * sideways;
  }
};

/// Spread of a ratio: mean and standard deviation of its logarithm.
class LogRatio {
 public:
  void add(double ratio) {
    const double value = std::log(ratio);
    sum_ += value;
    squares_ += value * value;
    ++count_;
  }
  [[nodiscard]] double middle() const { return std::exp(mean()); }
  [[nodiscard]] double scatter() const {
    return std::exp(std::sqrt(std::max(0.0, squares_ / count_ - mean() * mean())));
  }

 private:
  [[nodiscard]] double mean() const { return sum_ / count_; }
  double sum_ = 0.0;
  double squares_ = 0.0;
  double count_ = 0.0;
};

double model_ns(sim::DilutionKind kind, const std::vector<std::vector<Vector3d>>& skies) {
  const auto model = sim::make_dilution(kind);
  return nanoseconds_of([&](int i) {
    const sim::Dilution dilution =
        model->reported(skies[static_cast<std::size_t>(i) % skies.size()]);
    keep(&dilution);
  });
}

/// Compares the regression's DOPs with the geometric ones over a day of GPS skies: geometric mean
/// and scatter of their ratios, where at least four satellites are visible.
DilutionCost measure_sky(const OpenSky& sky, const sim::LocalFrame& frame) {
  const auto constellation = sim::make_nominal_constellation(std::array{GnssSystem::gps});
  const Calendar calendar(hil::RigConfiguration{}.start);
  const auto exact = sim::make_dilution(sim::DilutionKind::geometric);
  const auto regression = sim::make_dilution(sim::DilutionKind::regression);
  const Vector3d p_E = frame.to_ecef(Vector3d::Zero());
  DilutionCost cost{.sky = sky.name};
  LogRatio horizontal;
  LogRatio vertical;
  LogRatio position;
  std::vector<std::vector<Vector3d>> skies;
  for (double at_s = 0.0; at_s < kDay_s; at_s += kEvery_s) {
    const GpsTime time = calendar.gps(kStart + from_seconds(at_s));
    std::vector<Vector3d> directions;
    for (std::size_t i = 0; i < constellation->satellites().size(); ++i) {
      const Vector3d enu = frame.world_from_ecef() *
                           (constellation->state(i, time, 0.0).position_E_m - p_E).normalized();
      if (sky.contains(enu)) {
        directions.push_back(enu);
      }
    }
    const sim::Dilution truth = exact->reported(directions);
    if (directions.size() < 4 || !std::isfinite(truth.vertical)) {
      continue;
    }
    const sim::Dilution model = regression->reported(directions);
    horizontal.add(model.horizontal / truth.horizontal);
    vertical.add(model.vertical / truth.vertical);
    position.add(model.position / truth.position);
    cost.satellites += static_cast<double>(directions.size());
    skies.push_back(std::move(directions));
  }
  cost.epochs = skies.size();
  if (skies.empty()) {
    throw std::runtime_error("gnss bench: no epoch with four satellites under '" + sky.name + "'");
  }
  cost.satellites /= static_cast<double>(cost.epochs);
  cost.regression_ns = model_ns(sim::DilutionKind::regression, skies);
  cost.geometric_ns = model_ns(sim::DilutionKind::geometric, skies);
  cost.horizontal_ratio = horizontal.middle();
  cost.horizontal_scatter = horizontal.scatter();
  cost.vertical_ratio = vertical.middle();
  cost.vertical_scatter = vertical.scatter();
  cost.position_ratio = position.middle();
  cost.position_scatter = position.scatter();
  return cost;
}

/// Degrees per metre by the radii of curvature at the origin (WGS 84), and nothing else.
class TangentPlane {
 public:
  explicit TangentPlane(double latitude_deg) : latitude_deg_(latitude_deg) {
    constexpr double kA_m = 6'378'137.0;
    constexpr double kE2 = 6.69437999014e-3;
    const double sine = std::sin(latitude_deg * kDegree);
    const double w = std::sqrt(1.0 - kE2 * sine * sine);
    north_deg_per_m_ = w * w * w / (kA_m * (1.0 - kE2)) / kDegree;
    east_deg_per_m_ = w / (kA_m * std::cos(latitude_deg * kDegree)) / kDegree;
  }
  [[nodiscard]] sim::GeodeticPoint at(const Vector3d& p_W) const {
    return {latitude_deg_ + p_W.y() * north_deg_per_m_, p_W.x() * east_deg_per_m_, p_W.z()};
  }

 private:
  double latitude_deg_;
  double north_deg_per_m_ = 0.0;
  double east_deg_per_m_ = 0.0;
};

}  // namespace

std::vector<DilutionCost> measure_dilution(double latitude_deg, double longitude_deg) {
  const sim::LocalFrame frame({latitude_deg, longitude_deg, 0.0, 0.0});
  const std::array<OpenSky, 5> skies{{{"open, mask 5 deg", 5.0 * kDegree, 0.0},
                                      {"open, mask 10 deg", 10.0 * kDegree, 0.0},
                                      {"open, mask 15 deg", 15.0 * kDegree, 0.0},
                                      {"street, walls 30 deg", 5.0 * kDegree, 30.0 * kDegree},
                                      {"street, walls 45 deg", 5.0 * kDegree, 45.0 * kDegree}}};
  std::vector<DilutionCost> costs;
  for (const OpenSky& sky : skies) {
    costs.push_back(measure_sky(sky, frame));
  }
  return costs;
}

std::vector<TangentCost> measure_tangent(double latitude_deg,
                                         const std::vector<double>& distances_m) {
  const sim::LocalFrame frame({latitude_deg, 0.0, 0.0, 0.0});
  const TangentPlane plane(latitude_deg);
  std::vector<TangentCost> costs;
  for (const double distance_m : distances_m) {
    TangentCost cost{.distance_m = distance_m};
    const auto point = [&](int i) {
      const double azimuth = 2.0 * std::numbers::pi * i / kCostVariants;
      return Vector3d(distance_m * std::sin(azimuth), distance_m * std::cos(azimuth), 0.0);
    };
    for (int i = 0; i < kCostVariants; i += 8) {
      const sim::GeodeticPoint exact = frame.to_geodetic(point(i));
      const sim::GeodeticPoint cheap = plane.at(point(i));
      const Vector3d meant_W =
          frame.to_world({cheap.latitude_deg, cheap.longitude_deg, exact.ellipsoid_height_m});
      cost.plane_error_m = std::max(cost.plane_error_m, (meant_W - point(i)).norm());
      cost.plane_height_error_m = std::max(
          cost.plane_height_error_m, std::abs(exact.ellipsoid_height_m - cheap.ellipsoid_height_m));
      cost.frame_error_m = std::max(cost.frame_error_m, (frame.to_world(exact) - point(i)).norm());
    }
    cost.plane_ns = nanoseconds_of([&](int i) {
      const auto found = plane.at(point(i));
      keep(&found);
    });
    cost.frame_ns = nanoseconds_of([&](int i) {
      const auto found = frame.to_geodetic(point(i));
      keep(&found);
    });
    costs.push_back(cost);
  }
  return costs;
}

}  // namespace rigwire::bench
