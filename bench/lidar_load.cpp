#include "bench/lidar_load.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>

#include "bench/lidar_plan.h"
#include "hil/executive/cpu_time.h"
#include "sim/lidar/spinning_lidar.h"
#include "sim/random.h"

namespace rigwire::bench {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kHalfEdge_m = 200.0;
constexpr int kTrees = 2500;
constexpr int kLeaves = 4000;  ///< Triangles of a tree.
constexpr int kSpecies = 4;
constexpr double kHalfLane_m = 5.0;  ///< Without trees, for the vehicle.
constexpr int kBodies = 20;
constexpr double kLidarLoadSpeed_mps = 5.0;

double ground_height(double x, double y) {
  return 0.5 * std::sin(0.13 * x) * std::cos(0.11 * y) + 0.1 * std::sin(1.1 * x + 0.7 * y);
}

sim::HeightField make_ground() {
  sim::HeightField ground;
  ground.cell_m = 0.5;
  ground.columns = ground.rows = static_cast<std::size_t>(2.0 * kHalfEdge_m / ground.cell_m) + 1;
  ground.origin_m = {-kHalfEdge_m, -kHalfEdge_m};
  for (std::size_t r = 0; r < ground.rows; ++r) {
    for (std::size_t c = 0; c < ground.columns; ++c) {
      ground.heights_m.push_back(
          ground_height(-kHalfEdge_m + ground.cell_m * static_cast<double>(c),
                        -kHalfEdge_m + ground.cell_m * static_cast<double>(r)));
    }
  }
  return ground;
}

/// Loose leaves in a cone from just above the ground.
sim::TriangleMesh make_tree(sim::RandomStream& random) {
  sim::TriangleMesh mesh;
  mesh.name = "tree";
  for (int i = 0; i < kLeaves; ++i) {
    const double z = random.uniform(0.2, 8.2);
    const double radius = 2.0 * std::sqrt(random.uniform()) * (1.0 - z / 9.0);
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int corner = 0; corner < 3; ++corner) {
      const auto near = [&](double middle) {
        return static_cast<float>(middle + random.uniform(-0.08, 0.08));
      };
      mesh.vertices.push_back(
          {near(radius * std::cos(angle)), near(radius * std::sin(angle)), near(z)});
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// The place with its bodies and the vehicle.
class LoadDrive {
 public:
  explicit LoadDrive(LidarLoadPlace place) : place_(std::move(place)) {
    sim::Scene& scene = *place_.scene;
    const auto box = scene.add_mesh(sim::make_box("part", {0.6, 0.6, 1.5}));
    for (int i = 0; i < kBodies; ++i) {
      const auto body = scene.add_body("part" + std::to_string(i));
      scene.add_body_part(body, box, Isometry3d::Identity(), {.reflectance = 0.6, .label = "part"});
      bodies_.emplace_back();
    }
  }
  [[nodiscard]] sim::Scene& scene() { return *place_.scene; }
  [[nodiscard]] const std::string& name() const { return place_.name; }

  void begin_slice(SimTime t0, SimTime t1) {
    for (int i = 0; i < kBodies; ++i) {
      auto& body = bodies_[static_cast<std::size_t>(i)];
      body.X_WB_start = body_pose(i, to_seconds(t0));
      body.X_WB_end = body_pose(i, to_seconds(t1));
    }
    scene().begin_slice(t0, t1, vehicle(to_seconds(t0)).X_WL.translation(), bodies_);
  }
  [[nodiscard]] sim::LinkMotion vehicle(double t) const {
    sim::LinkMotion motion;
    motion.X_WL.linear() = Eigen::AngleAxisd(place_.yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
    motion.v_WL_W = kLidarLoadSpeed_mps * motion.X_WL.linear().col(0);
    motion.X_WL.translation() = place_.start_m + t * motion.v_WL_W;
    return motion;
  }

 private:
  /// They walk beside the vehicle, each on its circle.
  [[nodiscard]] Isometry3d body_pose(int i, double t) const {
    const double angle = 0.8 * t + 0.7 * i;
    const double radius = 4.0 + 0.5 * i;
    Isometry3d X = Isometry3d::Identity();
    X.translation() = vehicle(t).X_WL.translation() +
                      Vector3d(radius * std::cos(angle), radius * std::sin(angle), -1.5);
    X.rotate(Eigen::AngleAxisd(angle, Vector3d::UnitZ()));
    return X;
  }

  LidarLoadPlace place_;
  std::vector<sim::BodyMotion> bodies_;
};

double process_cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double elapsed_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Isometry3d corner(int lidar) {
  Isometry3d X_LS = Isometry3d::Identity();
  X_LS.translation() << (lidar < 2 ? 2.0 : -2.0), (lidar % 2 == 0 ? 0.9 : -0.9), 0.0;
  return X_LS;
}

LidarLoad measure(LoadDrive& drive, const LidarLoadCase& of, SimTime& t0) {
  const FiringPlan plan = firing_plan({});
  sim::SpinningLidarParameters parameters;
  parameters.threads = of.threads;
  std::vector<std::unique_ptr<sim::SpinningLidar>> lidars;
  for (int i = 0; i < of.lidars; ++i) {
    lidars.push_back(std::make_unique<sim::SpinningLidar>(
        parameters, plan.pattern, plan.plan, plan.command, 1, "bench" + std::to_string(i)));
  }
  LidarLoad load{.place = drive.name(), .of = of, .instances = drive.scene().instance_count()};
  std::vector<LidarFiring> firings;
  std::vector<double> ratios;
  const Duration slice = std::chrono::milliseconds{of.slice_ms};
  const Duration revolution = std::chrono::milliseconds{100};
  double begin_cpu_s = 0.0;
  double elapsed_s = 0.0;
  double encoding_s = 0.0;
  std::size_t hits = 0;
  std::size_t slices = 0;
  for (int r = 0; r < of.revolutions; ++r) {
    double stage_s = 0.0;
    double bare_s = 0.0;
    for (const SimTime end = t0 + revolution; t0 < end; t0 += slice, ++slices) {
      const SimTime t1 = t0 + slice;
      const double wall_s = elapsed_seconds();
      const double begin_s = hil::thread_cpu_seconds();
      drive.begin_slice(t0, t1);
      begin_cpu_s += hil::thread_cpu_seconds() - begin_s;
      elapsed_s += elapsed_seconds() - wall_s;
      for (int i = 0; i < of.lidars; ++i) {
        sim::SpinningLidar& lidar = *lidars[static_cast<std::size_t>(i)];
        const sim::LidarSlice stretch{
            .t0 = t0,
            .t1 = t1,
            .mount_at_t0 = sim::at_mount(drive.vehicle(to_seconds(t0)), corner(i)),
            .mount_at_t1 = sim::at_mount(drive.vehicle(to_seconds(t1)), corner(i))};
        sim::RecordedRays recorded = lidar.record(drive.scene(), stretch);
        const auto bare = [&] {
          const double before_s = hil::thread_cpu_seconds();
          recorded.cast_bare(drive.scene());
          bare_s += hil::thread_cpu_seconds() - before_s;
        };
        const auto stage = [&] {
          const double clock_s = elapsed_seconds();
          const double before_s = process_cpu_seconds();
          lidar.cast(drive.scene(), stretch, nullptr, firings, nullptr);
          stage_s += process_cpu_seconds() - before_s;
          elapsed_s += elapsed_seconds() - clock_s;
        };
        // In turns, because the second one finds the scene in the caches.
        if (slices % 2 == 0) {
          bare();
          stage();
        } else {
          stage();
          bare();
        }
        load.rays += recorded.size();
        hits += recorded.hits();
        if (slices == 0 && !firings.empty()) {
          encoding_s = 1e-9 * encoding_ns_per_firing({}, firings);
        }
      }
    }
    load.stage_s += stage_s;
    load.bare_s += bare_s;
    ratios.push_back(bare_s / stage_s);
  }
  const double simulated_s = to_seconds(revolution) * of.revolutions;
  const double firings_cast =
      static_cast<double>(load.rays) / static_cast<double>(plan.pattern.lasers.size());
  std::ranges::sort(ratios);
  load.bare_ratio = ratios[ratios.size() / 2];
  load.hit_share = static_cast<double>(hits) / static_cast<double>(load.rays);
  load.begin_slice_s = begin_cpu_s / static_cast<double>(slices);
  load.core_share = (load.stage_s + begin_cpu_s) / simulated_s;
  load.wall_share = elapsed_s / simulated_s;
  load.encoding_share = encoding_s * firings_cast / load.stage_s;
  return load;
}

}  // namespace

LidarLoadPlace make_instanced_forest() {
  LidarLoadPlace place{.name = "2500 trees of 4000 triangles",
                       .scene = std::make_unique<sim::Scene>(),
                       .start_m = {0.0, -100.0, 2.3},
                       .yaw_rad = 0.5 * std::numbers::pi};
  sim::RandomStream random(1, "bench/forest");
  place.scene->add_terrain(make_ground(), {.reflectance = 0.3, .label = "ground"});
  std::vector<sim::Scene::MeshId> species;
  for (int i = 0; i < kSpecies; ++i) {
    species.push_back(place.scene->add_mesh(make_tree(random)));
  }
  for (int i = 0; i < kTrees; ++i) {
    const double anywhere = random.uniform(-kHalfEdge_m, kHalfEdge_m);
    const double x = std::abs(anywhere) < kHalfLane_m
                         ? anywhere + std::copysign(kHalfLane_m, anywhere)
                         : anywhere;
    const double y = random.uniform(-kHalfEdge_m, kHalfEdge_m);
    Isometry3d X_WM = Isometry3d::Identity();
    X_WM.translation() << x, y, ground_height(x, y) - 0.2;
    X_WM.rotate(Eigen::AngleAxisd(random.uniform(0.0, 2.0 * std::numbers::pi), Vector3d::UnitZ()));
    place.scene->add_object(species[static_cast<std::size_t>(i) % species.size()], X_WM,
                            random.uniform(0.7, 1.3), {.reflectance = 0.5, .label = "tree"});
  }
  return place;
}

LidarLoadPlace make_described_place(const std::string& name,
                                    const sim::SceneDescription& description) {
  sim::BuiltScene built = sim::build_scene(description, {}, 1);
  const double ground_m = built.ground.node(built.ground.columns / 2, built.ground.rows / 2);
  return {.name = name,
          .scene = std::move(built.scene),
          .start_m = {0.0, 0.0, ground_m + 2.8},
          .yaw_rad = 0.0};
}

std::vector<LidarLoad> measure_lidar_load(LidarLoadPlace place,
                                          const std::vector<LidarLoadCase>& cases) {
  for (const LidarLoadCase& of : cases) {
    if (of.lidars < 1 || of.lidars > 4 || of.threads < 1 || of.slice_ms < 1 || of.revolutions < 1) {
      throw std::invalid_argument("lidar load: numbers must be 1 at least, and 4 lidars at most");
    }
  }
  LoadDrive drive(std::move(place));
  std::vector<LidarLoad> loads;
  SimTime t0 = kStart;
  for (const LidarLoadCase& of : cases) {
    loads.push_back(measure(drive, of, t0));
  }
  return loads;
}

}  // namespace rigwire::bench
