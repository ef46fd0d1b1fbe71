#include "hil/bench/lidar_bench.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocols/velodyne/model.h"
#include "sim/lidar/spinning_lidar.h"
#include "sim/scene/scene_description.h"

namespace rigwire::hil {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kRotorRate_radps = 20.0 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::uint64_t kSeed = 1;
constexpr Duration kRevolution = std::chrono::milliseconds{100};

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

LidarPattern hdl_32e() {
  const protocols::velodyne::Model& model =
      *protocols::velodyne::find_model(std::string_view("HDL-32E"));
  LidarPattern pattern;
  for (const protocols::velodyne::Laser& laser : model.lasers) {
    pattern.lasers.push_back({.elevation_rad = laser.elevation_deg * kDegree,
                              .vertical_offset_m = laser.vertical_offset_mm * 1e-3,
                              .time_offset = Duration{laser.time_offset_ns}});
  }
  pattern.firing_period = Duration{model.firing_period_ns};
  pattern.minimum_range_m = model.minimum_range_m;
  pattern.maximum_range_m = model.maximum_range_m;
  return pattern;
}

sim::SpinningLidar make_lidar(double range_sigma_m) {
  const LidarPattern pattern = hdl_32e();
  sim::SpinningLidarParameters parameters;
  parameters.range_sigma_m = range_sigma_m;
  return {parameters,       pattern, {kStart + pattern.firing_period, pattern.firing_period},
          kRotorRate_radps, kSeed,   "bench"};
}

sim::BuiltScene standard_pit() {
  sim::SceneDescription description;
  description.rocks.emplace_back();
  sim::FixedObject truck;
  truck.name = "haul_truck";
  truck.mesh = "block";
  truck.position_m = {-1.0, 7.0, 1.5};
  description.objects.push_back(truck);
  return sim::build_scene(description, {sim::make_box("block", {6.5, 2.6, 3.0})}, kSeed);
}

/// Links of a machine: a row of boxes that swing together.
void add_links(sim::Scene& scene, std::size_t links) {
  const auto mesh = scene.add_mesh(sim::make_box("link", {1.2, 0.5, 0.5}));
  for (std::size_t i = 0; i < links; ++i) {
    scene.add_body_part(scene.add_body("link " + std::to_string(i)), mesh, Isometry3d::Identity(),
                        {.reflectance = 0.5, .label = "machine"});
  }
}

std::vector<sim::BodyMotion> link_motions(std::size_t links, double start_rad, double end_rad) {
  std::vector<sim::BodyMotion> motions(links);
  for (std::size_t i = 0; i < links; ++i) {
    const Vector3d p(1.0 + 1.1 * static_cast<double>(i), 0.0, 1.2);
    const auto pose = [&](double angle) {
      Isometry3d X = Isometry3d::Identity();
      X.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
      X.translation() = X.linear() * p;
      return X;
    };
    motions[i] = {pose(start_rad), pose(end_rad)};
  }
  return motions;
}

sim::LinkMotion mount_at(const Vector3d& p_W) {
  sim::LinkMotion mount;
  mount.X_WL.translation() = p_W;
  return mount;
}

}  // namespace

LidarStageCost measure_lidar_stage(int slice_ms, int rounds) {
  constexpr std::size_t kLinks = 4;
  const sim::BuiltScene built = standard_pit();
  sim::Scene& scene = *built.scene;
  add_links(scene, kLinks);
  sim::SpinningLidar lidar = make_lidar(0.02);
  const sim::LinkMotion mount = mount_at({-0.5, 0.0, 3.2});
  const Duration slice = std::chrono::milliseconds{slice_ms};
  std::vector<LidarFiring> firings;

  LidarStageCost cost;
  cost.stage_s = cost.bare_s = 1e9;
  for (int round = 0; round < rounds; ++round) {
    double stage = 0.0;
    double bare = 0.0;
    std::size_t rays = 0;
    std::size_t hits = 0;
    for (SimTime t0 = kStart; t0 < kStart + kRevolution; t0 += slice) {
      const double angle = 0.5 * to_seconds(t0);
      scene.begin_slice(t0, t0 + slice, mount.X_WL.translation(),
                        link_motions(kLinks, angle, angle + 0.5 * to_seconds(slice)));
      sim::RecordedRays recorded = lidar.record(scene, t0, t0 + slice, mount, mount);
      const double before_bare = thread_seconds();
      recorded.cast_bare(scene);
      const double before_stage = thread_seconds();
      lidar.cast(scene, t0, t0 + slice, mount, mount, firings);
      stage += thread_seconds() - before_stage;
      bare += before_stage - before_bare;
      rays += recorded.size();
      hits += recorded.hits();
    }
    cost.rays = rays;
    cost.hit_share = static_cast<double>(hits) / static_cast<double>(rays);
    cost.stage_s = std::min(cost.stage_s, stage);
    cost.bare_s = std::min(cost.bare_s, bare);
  }
  cost.stage_rays_per_s = static_cast<double>(cost.rays) / cost.stage_s;
  cost.bare_rays_per_s = static_cast<double>(cost.rays) / cost.bare_s;
  cost.ratio = cost.stage_rays_per_s / cost.bare_rays_per_s;
  return cost;
}

std::vector<LidarRangeError> measure_lidar_range_error(const std::vector<double>& map_offsets_m) {
  constexpr double kGround_m = 100.0;
  constexpr double kWall_m = 15.0;
  constexpr double kWallTop_m = 30.0;
  constexpr double kSky_m = 1e9;
  constexpr double kTolerance_m = 0.1;
  constexpr double kYawRate_radps = 1.0;
  const Vector3d velocity(2.0, -1.0, 0.3);
  const LidarPattern pattern = hdl_32e();
  std::vector<LidarRangeError> errors;
  for (const double offset : map_offsets_m) {
    const Vector3d centre(offset * std::numbers::sqrt2 / 2.0 + 0.37,
                          -offset * std::numbers::sqrt2 / 2.0 + 0.11, kGround_m);
    sim::Scene scene;
    sim::HeightField ground;
    ground.cell_m = 0.5;
    ground.columns = ground.rows = 401;
    ground.origin_m = centre.head<2>().array() - 100.0;
    ground.heights_m.assign(ground.columns * ground.rows, kGround_m);
    const sim::Material white{.reflectance = 0.9, .label = "white"};
    scene.add_terrain(ground, white);
    Isometry3d X_WM = Isometry3d::Identity();
    X_WM.translation() = centre + Vector3d(kWall_m + 0.5, 0.0, 0.0);
    scene.add_object(scene.add_mesh(sim::make_box("wall", {1.0, 400.0, 2.0 * kWallTop_m})), X_WM,
                     1.0, white);
    sim::SpinningLidar lidar = make_lidar(0.0);

    LidarRangeError error;
    error.map_offset_m = offset;
    double squares = 0.0;
    std::vector<LidarFiring> firings;
    const Vector3d p0 = centre + Vector3d(0.0, 0.0, 2.5);
    const auto mount = [&](double t) {
      sim::LinkMotion motion = mount_at(p0 + t * velocity);
      motion.X_WL.linear() =
          Eigen::AngleAxisd(kYawRate_radps * t, Vector3d::UnitZ()).toRotationMatrix();
      motion.v_WL_W = velocity;
      motion.w_WL_W = {0.0, 0.0, kYawRate_radps};
      return motion;
    };
    const Duration slice = std::chrono::milliseconds{5};
    for (SimTime t0 = kStart; t0 < kStart + kRevolution; t0 += slice) {
      const SimTime t1 = t0 + slice;
      scene.begin_slice(t0, t1, p0, {});
      lidar.cast(scene, t0, t1, mount(to_seconds(t0)), mount(to_seconds(t1)), firings);
      for (const LidarFiring& firing : firings) {
        for (std::size_t j = 0; j < pattern.lasers.size(); ++j) {
          const LaserGeometry& laser = pattern.lasers[j];
          const double t = to_seconds(firing.time + laser.time_offset);
          const sim::LinkMotion truth = mount(t);
          const double azimuth = kRotorRate_radps * t;
          const double horizontal = std::cos(laser.elevation_rad);
          const Vector3d d = truth.X_WL.linear() * Vector3d(horizontal * std::cos(azimuth),
                                                            -horizontal * std::sin(azimuth),
                                                            std::sin(laser.elevation_rad));
          const Vector3d p =
              truth.X_WL.translation() + Vector3d(0.0, 0.0, laser.vertical_offset_m) - centre;
          double range = d.z() < 0.0 ? -p.z() / d.z() : kSky_m;
          double cosine = -d.z();
          const double to_wall = d.x() > 0.0 ? (kWall_m - p.x()) / d.x() : kSky_m;
          if (to_wall < range && p.z() + to_wall * d.z() < kWallTop_m) {
            range = to_wall;
            cosine = d.x();
          }
          // Both surfaces are as white as the target of the maximum range.
          const double limit = pattern.maximum_range_m * std::sqrt(std::max(cosine, 0.0));
          const double found = firing.returns[j].range_m;
          if (range > limit) {
            error.leaks += found > 0.0 && range > limit + kTolerance_m ? 1U : 0U;
            continue;
          }
          if (range > limit - kTolerance_m) {
            continue;
          }
          ++error.rays;
          if (found == 0.0 || std::abs(found - range) > kTolerance_m) {
            ++error.leaks;
            continue;
          }
          squares += (found - range) * (found - range);
          error.worst_m = std::max(error.worst_m, std::abs(found - range));
        }
      }
    }
    error.rms_m = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(error.rays, 1)));
    errors.push_back(error);
  }
  return errors;
}

RecommitCost measure_recommit(std::size_t links, int slices) {
  const sim::BuiltScene built = standard_pit();
  sim::Scene& scene = *built.scene;
  add_links(scene, links);
  RecommitCost cost;
  cost.instances = scene.instance_count();
  cost.moving_instances = links;
  const Duration slice = std::chrono::milliseconds{1};
  SimTime t0 = kStart;
  scene.begin_slice(t0, t0 + slice, Vector3d::Zero(), link_motions(links, 0.0, 0.0));
  double seconds = 0.0;
  for (int i = 0; i < slices; ++i) {
    t0 += slice;
    const double angle = 1e-3 * i;
    const std::vector<sim::BodyMotion> motions = link_motions(links, angle, angle + 1e-3);
    const double before = thread_seconds();
    scene.begin_slice(t0, t0 + slice, Vector3d::Zero(), motions);
    seconds += thread_seconds() - before;
  }
  cost.mean_s = seconds / slices;
  return cost;
}

}  // namespace rigwire::hil
