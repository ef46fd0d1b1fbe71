#include "bench/beam_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include "emulators/device.h"
#include "emulators/velodyne/velodyne_lidar.h"
#include "hil/executive/cpu_time.h"
#include "hil/rig/rig_configuration.h"
#include "sim/lidar/spinning_lidar.h"
#include "sim/random.h"

namespace rigwire::bench {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::uint64_t kSeed = 1;
constexpr Duration kLeastSector = std::chrono::milliseconds{1};
constexpr double kSectorAngle_rad = 0.2 * 2.0 * std::numbers::pi;
constexpr int kReference = 1000;
constexpr int kRounds = 5;
constexpr double kSensorHeight_m = 2.0;
constexpr double kHalfPulse_m = 0.75;

sim::Material paint(double reflectance, const char* label) {
  sim::Material material;
  material.reflectance = reflectance;
  material.label = label;
  return material;
}

/// Objects ahead and to the right, where the rotor passes.
Isometry3d somewhere(sim::RandomStream& random, double nearest_m, double farthest_m, double z_m) {
  const double range_m = random.uniform(nearest_m, farthest_m);
  const double azimuth = random.uniform(0.0, kSectorAngle_rad);
  Isometry3d X = Isometry3d::Identity();
  X.translation() << range_m * std::cos(azimuth), -range_m * std::sin(azimuth), z_m;
  X.linear() = Eigen::AngleAxisd(random.uniform(0.0, 2.0 * std::numbers::pi), Vector3d::UnitZ())
                   .toRotationMatrix();
  return X;
}

void add_poles(sim::Scene& scene, sim::RandomStream& random) {
  for (int i = 0; i < 120; ++i) {
    const double width_m = random.uniform(0.02, 0.1);
    const auto mesh = scene.add_mesh(sim::make_box("pole", {width_m, width_m, 5.0}));
    scene.add_object(mesh, somewhere(random, 4.0, 35.0, 2.0), 1.0,
                     paint(random.uniform(0.1, 0.8), "pole"));
  }
  const auto wall = scene.add_mesh(sim::make_box("wall", {0.2, 200.0, 12.0}));
  Isometry3d X = Isometry3d::Identity();
  X.linear() = Eigen::AngleAxisd(-0.5 * kSectorAngle_rad, Vector3d::UnitZ()).toRotationMatrix();
  X.translation() = X.linear() * Vector3d(40.0, 0.0, 0.0);
  scene.add_object(wall, X, 1.0, paint(0.4, "wall"));
}

/// Adds 32 tree crowns of four kinds: 3000 square leaves each, uniform in a ball of 1.6 m radius.
void add_crowns(sim::Scene& scene, sim::RandomStream& random) {
  constexpr double kCrown_m = 1.6;
  constexpr double kLeaf_m = 0.05;
  for (int kind = 0; kind < 4; ++kind) {
    sim::TriangleMesh leaves;
    leaves.name = "leaves";
    while (leaves.triangles.size() < 6000) {
      const auto within = [&] {
        return Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                        random.uniform(-1.0, 1.0));
      };
      const Vector3d centre = kCrown_m * within();
      if (centre.norm() > kCrown_m) {
        continue;
      }
      const Vector3d side = kLeaf_m * within().normalized();
      const Vector3d other = kLeaf_m * within().cross(side).normalized();
      const auto first = static_cast<std::uint32_t>(leaves.vertices.size());
      for (const Vector3d& corner :
           std::array<Vector3d, 4>{centre - side - other, centre + side - other,
                                   centre + side + other, centre - side + other}) {
        leaves.vertices.push_back(corner.cast<float>());
      }
      leaves.triangles.push_back({first, first + 1, first + 2});
      leaves.triangles.push_back({first, first + 2, first + 3});
    }
    const auto mesh = scene.add_mesh(leaves);
    for (int i = 0; i < 8; ++i) {
      scene.add_object(mesh, somewhere(random, 5.0, 40.0, 2.2), 1.0, paint(0.5, "leaves"));
    }
  }
}

void add_crates(sim::Scene& scene, sim::RandomStream& random) {
  const auto mesh = scene.add_mesh(sim::make_box("crate", {1.0, 0.8, 0.6}));
  for (int i = 0; i < 150; ++i) {
    scene.add_object(mesh, somewhere(random, 4.0, 45.0, random.uniform(0.0, 3.0)),
                     random.uniform(0.5, 2.0), paint(random.uniform(0.1, 0.9), "crate"));
  }
}

/// Adds level ground and the objects on it.
void furnish(sim::Scene& scene, void (*add)(sim::Scene&, sim::RandomStream&)) {
  sim::HeightField ground;
  ground.cell_m = 1.0;
  ground.columns = ground.rows = 201;
  ground.origin_m = {-100.0, -100.0};
  ground.heights_m.assign(ground.columns * ground.rows, 0.0);
  scene.add_terrain(ground, paint(0.3, "ground"));
  sim::RandomStream random(kSeed, "sub-ray bench");
  add(scene, random);
}

/// One sector by beams of so many sub-rays.
class Sector {
 public:
  Sector(const LidarPattern& pattern, const SamplePlan& plan, LidarCommand command, int sub_rays)
      : lidar_(parameters(sub_rays), pattern, plan, with_several(command), kSeed, "bench") {}

  /// CPU seconds of one cast.
  double cast(const sim::Scene& scene, Duration sector) {
    sim::LinkMotion mount;
    mount.X_WL.translation().z() = kSensorHeight_m;
    const double before_s = hil::thread_cpu_seconds();
    lidar_.cast(scene,
                {.t0 = kStart, .t1 = kStart + sector, .mount_at_t0 = mount, .mount_at_t1 = mount},
                nullptr, firings_, nullptr);
    return hil::thread_cpu_seconds() - before_s;
  }
  [[nodiscard]] const std::vector<LidarFiring>& firings() const { return firings_; }
  [[nodiscard]] std::uint64_t rays() const { return lidar_.rays(); }

 private:
  static sim::SpinningLidarParameters parameters(int sub_rays) {
    sim::SpinningLidarParameters result;
    result.range_sigma_m = 0.0;
    result.sub_rays = sub_rays;
    return result;
  }
  static LidarCommand with_several(LidarCommand command) {
    command.several_echoes = true;
    return command;
  }

  sim::SpinningLidar lidar_;
  std::vector<LidarFiring> firings_;
};

bool wrong(const LidarReturn& found, const LidarReturn& reference) {
  return (found.range_m > 0.0F) != (reference.range_m > 0.0F) ||
         std::abs(static_cast<double>(found.range_m - reference.range_m)) > kHalfPulse_m;
}

SubRayError compare(std::span<const LidarFiring> found, std::span<const LidarFiring> reference,
                    std::size_t lasers) {
  SubRayError error;
  double right = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t j = 0; j < lasers; ++j) {
      const LidarReturn& echo = found[i].strongest[j];
      const LidarReturn& truth = reference[i].strongest[j];
      if (echo.range_m == 0.0F && truth.range_m == 0.0F) {
        continue;
      }
      ++error.shots;
      // One ray in clear air has one echo, which is the last one too.
      const LidarReturn& last = found[i].several ? found[i].last[j] : echo;
      error.wrong_last += wrong(last, reference[i].last[j]) ? 1.0 : 0.0;
      if (wrong(echo, truth)) {
        error.wrong_strongest += 1.0;
        continue;
      }
      const auto off_m = static_cast<double>(echo.range_m - truth.range_m);
      const auto off = static_cast<double>(echo.reflectivity - truth.reflectivity);
      error.rms_m += off_m * off_m;
      error.reflectivity_rms += off * off;
      right += 1.0;
    }
  }
  const auto shots = static_cast<double>(error.shots);
  error.wrong_strongest /= shots;
  error.wrong_last /= shots;
  error.rms_m = std::sqrt(error.rms_m / right);
  error.reflectivity_rms = std::sqrt(error.reflectivity_rms / right);
  return error;
}

}  // namespace

/// Casts the same sector with 1, 5 and 19 sub-rays and with the reference's, per scene; the CPU
/// time is the minimum of kRounds.
std::vector<SubRayError> measure_sub_rays(Duration sector_length) {
  if (sector_length < kLeastSector) {
    throw std::invalid_argument(
        fmt::format("sub-rays: found a sector of {} ns, allowed >= 1 ms", sector_length.count()));
  }
  const Calendar calendar(hil::RigConfiguration{}.start);
  emulators::NullByteOutput silence;
  const emulators::VelodyneLidar device(emulators::VelodyneSettings{}, calendar, silence, silence);
  LidarPattern pattern = device.pattern();
  pattern.beam = {.horizontal_divergence_rad = 3e-3, .vertical_divergence_rad = 1.5e-3};
  const auto sector = [&](int sub_rays) {
    return Sector(pattern, device.sample_plan(), device.command(), sub_rays);
  };
  struct Place {
    const char* name;
    void (*add)(sim::Scene&, sim::RandomStream&);
  };
  std::vector<SubRayError> errors;
  for (const Place& place :
       {Place{"poles", add_poles}, Place{"crowns", add_crowns}, Place{"crates", add_crates}}) {
    sim::Scene scene;
    furnish(scene, place.add);
    scene.begin_slice(kStart, kStart + sector_length, Vector3d::Zero(), {});
    Sector reference = sector(kReference);
    reference.cast(scene, sector_length);
    double one_ray_s = 0.0;
    for (const int sub_rays : {1, 5, 19}) {
      Sector measured = sector(sub_rays);
      double least_s = measured.cast(scene, sector_length);
      for (int round = 1; round < kRounds; ++round) {
        least_s = std::min(least_s, sector(sub_rays).cast(scene, sector_length));
      }
      one_ray_s = sub_rays == 1 ? least_s : one_ray_s;
      SubRayError error = compare(measured.firings(), reference.firings(), pattern.lasers.size());
      error.scene = place.name;
      error.sub_rays = sub_rays;
      error.rays_per_s = static_cast<double>(measured.rays()) / least_s;
      error.cost = least_s / one_ray_s;
      errors.push_back(error);
    }
  }
  return errors;
}

}  // namespace rigwire::bench
