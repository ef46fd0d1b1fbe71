#include "bench/depth_image_bench.h"

#include <algorithm>
#include <cmath>

#include "bench/cost.h"
#include "fields/constants.h"
#include "hil/executive/cpu_time.h"
#include "sim/lidar/depth_image_lidar.h"
#include "sim/lidar/depth_image_set.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::bench {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kGhost_m = 0.3;
constexpr std::uint64_t kSeed = 1;

sim::SpinningLidarParameters noiseless() {
  sim::SpinningLidarParameters receiver;
  receiver.range_sigma_m = 0.0;
  return receiver;
}

sim::LidarSlice standing_revolution(const LidarCase& scene) {
  return {.t0 = kStart,
          .t1 = kStart + kBenchRevolution,
          .mount_at_t0 = scene.mount,
          .mount_at_t1 = scene.mount};
}

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

double azimuth_of(const LidarFiring& firing, const LaserGeometry& laser) {
  return firing.rotor_azimuth_rad + firing.rotor_rate_radps * to_seconds(laser.time_offset) +
         laser.azimuth_offset_rad;
}

/// What is around a place of an image, by rays through it and half pixels around.
class Neighbourhood {
 public:
  Neighbourhood(const LidarCase& scene, const sim::DepthImageGeometry& geometry,
                const sim::ImagePoint& at, double reach_m) {
    const Isometry3d& X_WS = scene.mount.X_WL;
    for (std::size_t row = 0; row < kSide; ++row) {
      for (std::size_t column = 0; column < kSide; ++column) {
        sim::ImagePoint beside = at;
        beside.u_px += 0.5 * (static_cast<double>(column) - kMiddle);
        beside.v_px += 0.5 * (static_cast<double>(row) - kMiddle);
        const Vector3d direction_W = X_WS.linear() * geometry.direction_S(beside).normalized();
        if (const auto hit = scene.scene->cast(X_WS.translation(), direction_W, 0.1, reach_m,
                                               kStart + kBenchRevolution)) {
          hits_[row][column] = *hit;
        }
      }
    }
  }
  /// Whether a point at this range is on a surface, or between two neighbours on one that do not
  /// differ by more than slanting ground does.
  [[nodiscard]] bool has(double range_m) const {
    for (std::size_t row = 0; row < kSide; ++row) {
      for (std::size_t column = 0; column < kSide; ++column) {
        if (std::abs(hits_[row][column].range_m - range_m) < kGhost_m ||
            (row > 0 && between(hits_[row - 1][column], hits_[row][column], range_m)) ||
            (column > 0 && between(hits_[row][column - 1], hits_[row][column], range_m))) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::size_t kSide = 7;
  static constexpr double kMiddle = 3.0;
  static constexpr double kGreatestStep = 0.2;

  static bool between(const sim::SceneHit& a, const sim::SceneHit& b, double range_m) {
    const auto [least, greatest] = std::minmax(a.range_m, b.range_m);
    return a.instance == b.instance && least > 0.0 && greatest - least < kGreatestStep * greatest &&
           least < range_m && range_m < greatest;
  }
  std::array<std::array<sim::SceneHit, kSide>, kSide> hits_{};
};

/// Sorts errors into classes of the true range.
class ErrorTable {
 public:
  void add(double truth_m, double error_m) {
    for (std::size_t i = 0; i < kRangeClasses_m.size(); ++i) {
      if (truth_m < kRangeClasses_m[i]) {
        errors_m_[i].push_back(std::abs(error_m));
        return;
      }
    }
  }
  [[nodiscard]] std::array<RangeClassError, kRangeClasses_m.size()> summary() {
    std::array<RangeClassError, kRangeClasses_m.size()> classes;
    for (std::size_t i = 0; i < classes.size(); ++i) {
      double squares = 0.0;
      for (const double error_m : errors_m_[i]) {
        squares += error_m * error_m;
      }
      const std::size_t count = errors_m_[i].size();
      const double mean = squares / static_cast<double>(std::max<std::size_t>(count, 1));
      classes[i] = {kRangeClasses_m[i], count, std::sqrt(mean), quantile(errors_m_[i], 0.99),
                    quantile(errors_m_[i], 0.999)};
    }
    return classes;
  }

 private:
  std::array<std::vector<double>, kRangeClasses_m.size()> errors_m_;
};

}  // namespace

std::vector<DepthImageVariant> depth_image_variants(int width_px) {
  using sim::DepthSampling;
  const std::vector read{DepthSampling::nearest, DepthSampling::bilinear_inverse_depth};
  const std::vector all{DepthSampling::nearest, DepthSampling::bilinear_depth,
                        DepthSampling::bilinear_inverse_depth, DepthSampling::edge_aware,
                        DepthSampling::tangent_plane};
  std::vector<DepthImageVariant> variants;
  sim::DepthImageParameters exact;
  exact.width_px = width_px;
  sim::DepthImageParameters approximate = exact;
  approximate.parallax_steps = 0;
  approximate.rows = sim::RowRule::straight;
  variants.push_back({"straight rows", approximate, read});
  approximate.rows = sim::RowRule::hyperbola_half_width;
  variants.push_back({"b = W/2", approximate, read});
  approximate.cameras = 4;
  variants.push_back({"b = W/2, 4 cameras", approximate, read});
  sim::DepthImageParameters printed = sim::as_printed();
  printed.width_px = width_px;
  variants.push_back({"as printed", printed, {DepthSampling::nearest}});
  sim::DepthImageParameters uniform = exact;
  uniform.parallax_steps = 0;
  uniform.columns = sim::ColumnRule::uniform;
  variants.push_back({"uniform columns", uniform, read});
  sim::DepthImageParameters quantised = exact;
  quantised.depth = sim::DepthFormat::fixed_24;
  variants.push_back({"exact, 24 bits", quantised, {DepthSampling::edge_aware}});
  variants.push_back({"exact", exact, all});
  return variants;
}

std::vector<DepthImageError> measure_depth_images(const LidarCase& scene,
                                                  const DepthImageVariant& variant) {
  const LidarPattern head = bench_head();
  const sim::LidarSlice slice = standing_revolution(scene);
  scene.begin_revolution();
  sim::SpinningLidar rays(noiseless(), head, bench_firing_plan(), bench_rotor(), kSeed, "bench");
  std::vector<LidarFiring> firings;
  std::vector<sim::LidarBankTruth> truth;
  double rays_s = 0.0;
  {
    // The second time, when memory is taken.
    rays.cast(*scene.scene, slice, nullptr, firings, nullptr);
    const hil::StageTimer timer(rays_s);
    rays.cast(*scene.scene, slice, nullptr, firings, nullptr);
  }
  rays.cast(*scene.scene, slice, nullptr, firings, &truth);

  sim::DepthImageSet images(variant.parameters, head, head.maximum_range_m, 1);
  DepthImageError common;
  common.scene = scene.name;
  common.variant = variant.name;
  common.parameters = variant.parameters;
  common.rays_s = rays_s;
  {
    const hil::StageTimer timer(common.render_s);
    common.pixels = images.render(*scene.scene, {.X_WS = scene.mount.X_WL}, 0.0, kTurn);
  }
  std::vector<DepthImageError> errors;
  std::vector<double> ranges_m(firings.size() * head.lasers.size());
  for (const sim::DepthSampling sampling : variant.samplings) {
    DepthImageError error = common;
    error.parameters.sampling = sampling;
    images.set_sampling(sampling);
    {
      const hil::StageTimer timer(error.look_up_s);
      for (std::size_t i = 0; i < ranges_m.size(); ++i) {
        const LidarFiring& firing = firings[i / head.lasers.size()];
        const std::size_t laser = i % head.lasers.size();
        ranges_m[i] =
            images.see(*scene.scene, laser, azimuth_of(firing, head.lasers[laser])).range_m;
      }
      keep(ranges_m.data());
    }
    ErrorTable table;
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      const std::size_t laser = i % head.lasers.size();
      const LidarFiring& firing = firings[i / head.lasers.size()];
      const double true_m = truth[i / head.lasers.size()][laser].range_m;
      const double range_m = ranges_m[i];
      if ((true_m > 0.0) != (range_m > 0.0)) {
        ++error.one_sided;
      }
      if (true_m > 0.0 && range_m > 0.0) {
        ++error.shots;
        table.add(true_m, range_m - true_m);
      }
      if (range_m > 0.0 && range_m < head.maximum_range_m &&
          std::abs(range_m - true_m) > kGhost_m) {
        const sim::ImagePoint at =
            images.geometry().beam(laser, azimuth_of(firing, head.lasers[laser]));
        const Neighbourhood around(scene, images.geometry(), at, 2.0 * head.maximum_range_m);
        error.ghosts += around.has(range_m) ? 0U : 1U;
      }
    }
    error.classes = table.summary();
    errors.push_back(error);
  }
  return errors;
}

DepthImageMotionError measure_depth_image_motion(const LidarCase& scene,
                                                 int images_per_revolution) {
  constexpr double kSpeed_mps = 5.0;
  constexpr double kTurnRate_radps = kTurn / 6.0;
  constexpr Duration kSlice = std::chrono::milliseconds{5};
  const auto mount_at = [&](SimTime time) {
    const double t = to_seconds(time);
    sim::LinkMotion mount = scene.mount;
    mount.X_WL.translation().x() += kSpeed_mps * t;
    mount.X_WL.linear() =
        Eigen::AngleAxisd(kTurnRate_radps * t, Vector3d::UnitZ()).toRotationMatrix();
    mount.v_WL_W << kSpeed_mps, 0.0, 0.0;
    mount.w_WL_W << 0.0, 0.0, kTurnRate_radps;
    return mount;
  };
  DepthImageMotionError error;
  error.images_per_revolution = images_per_revolution;
  sim::DepthImageParameters parameters;
  parameters.images_per_revolution = images_per_revolution;
  const LidarPattern head = bench_head();
  sim::DepthImageLidar images(parameters, noiseless(), head, bench_firing_plan(), bench_rotor(),
                              kSeed, "bench");
  sim::SpinningLidar rays(noiseless(), head, bench_firing_plan(), bench_rotor(), kSeed, "bench");
  std::vector<LidarFiring> found;
  std::vector<LidarFiring> expected;
  std::vector<double> errors_m;
  double squares = 0.0;
  for (SimTime t0 = kStart; t0 < kStart + kBenchRevolution; t0 += kSlice) {
    const SimTime t1 = t0 + kSlice;
    const sim::LidarSlice slice{
        .t0 = t0, .t1 = t1, .mount_at_t0 = mount_at(t0), .mount_at_t1 = mount_at(t1)};
    scene.scene->begin_slice(t0, t1, scene.mount.X_WL.translation(), {});
    {
      const hil::StageTimer timer(error.cast_s);
      images.cast(*scene.scene, slice, nullptr, found, nullptr);
    }
    rays.cast(*scene.scene, slice, nullptr, expected, nullptr);
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (std::size_t j = 0; j < head.lasers.size(); ++j) {
        const double range_m = found[i].strongest[j].range_m;
        const double true_m = expected[i].strongest[j].range_m;
        if (range_m > 0.0 && true_m > 0.0) {
          errors_m.push_back(std::abs(range_m - true_m));
          squares += errors_m.back() * errors_m.back();
        }
      }
    }
  }
  error.pixels = images.rays();
  error.rms_m = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(errors_m.size(), 1)));
  error.p99_m = quantile(errors_m, 0.99);
  return error;
}

/// Samples each laser's ring on level ground, 240 points per turn: radius = sqrt(range^2 -
/// height^2).
std::vector<DepthImageRing> depth_image_rings(const sim::DepthImageParameters& parameters) {
  constexpr int kPoints = 240;
  constexpr double kLowest_deg = -31.0;
  constexpr double kHighest_deg = -5.0;
  const LidarCase level = level_ground_case();
  level.begin_revolution();
  LidarPattern head = bench_head();
  for (LaserGeometry& laser : head.lasers) {
    laser.vertical_offset_m = 0.0;
  }
  sim::DepthImageSet images(parameters, head, head.maximum_range_m, 1);
  images.render(*level.scene, {.X_WS = level.mount.X_WL}, 0.0, kTurn);
  const double height_m = level.mount.X_WL.translation().z();
  std::vector<DepthImageRing> rings;
  for (std::size_t laser = 0; laser < head.lasers.size(); ++laser) {
    DepthImageRing ring;
    ring.elevation_deg = head.lasers[laser].elevation_rad * 360.0 / kTurn;
    if (ring.elevation_deg < kLowest_deg || ring.elevation_deg > kHighest_deg) {
      continue;
    }
    for (int i = 0; i <= kPoints; ++i) {
      const double azimuth_rad = kTurn * i / kPoints;
      const double range_m = images.see(*level.scene, laser, azimuth_rad).range_m;
      if (range_m > height_m) {
        ring.azimuth_deg.push_back(azimuth_rad * 360.0 / kTurn);
        ring.radius_m.push_back(std::sqrt(range_m * range_m - height_m * height_m));
      }
    }
    rings.push_back(std::move(ring));
  }
  return rings;
}

}  // namespace rigwire::bench
