#include "bench/lidar_cases.h"

#include <cmath>
#include <numbers>

#include "fields/constants.h"
#include "sim/random.h"
#include "sim/scene/scene_description.h"

namespace rigwire::bench {
namespace {

constexpr std::uint64_t kLidarCasesSeed = 1;
constexpr double kTriangle_m = 1.0;

struct Pit {
  sim::HeightField ground;
  std::vector<sim::TriangleMesh> rock_shapes;
  std::vector<sim::PlacedRock> rocks;
};

Pit make_pit_parts() {
  const sim::PitTerrain terrain;
  const std::vector<sim::RockField> fields(1);
  Pit pit;
  pit.ground = sim::make_pit(terrain, kLidarCasesSeed);
  sim::RandomStream shapes(kLidarCasesSeed, "bench/rock_shapes");
  for (std::size_t i = 0; i < sim::kRockShapes; ++i) {
    pit.rock_shapes.push_back(sim::make_rock("rock", shapes));
  }
  sim::RandomStream places(kLidarCasesSeed, "bench/rock_places");
  pit.rocks = sim::place_rocks(fields.front(), pit.ground, places);
  return pit;
}

sim::LinkMotion standing_at(double x_m, double y_m, double z_m) {
  sim::LinkMotion mount;
  mount.X_WL.translation() << x_m, y_m, z_m;
  return mount;
}

}  // namespace

LidarPattern bench_head() {
  // Lasers alternate between the lower and the upper half (HDL-32E manual 63-9113).
  LidarPattern head;
  for (int i = 0; i < 32; ++i) {
    const double elevation_deg =
        (i % 2 == 0 ? -92.0 / 3.0 : -28.0 / 3.0) + 4.0 / 3.0 * std::floor(0.5 * i);
    const double elevation_rad = elevation_deg * kDegree;
    head.lasers.push_back({.elevation_rad = elevation_rad,
                           .vertical_offset_m = -0.02883 * std::tan(elevation_rad),
                           .time_offset = Duration{1152 * i}});
  }
  head.firing_period = Duration{46080};
  head.minimum_range_m = 1.0;
  head.maximum_range_m = 100.0;
  return head;
}

SamplePlan bench_firing_plan() {
  return {kStart + bench_head().firing_period, bench_head().firing_period};
}

LidarCommand bench_rotor() {
  LidarCommand command;
  command.rotor_rate_radps = 20.0 * std::numbers::pi;
  return command;
}

void LidarCase::begin_revolution() const {
  scene->begin_slice(kStart, kStart + kBenchRevolution, mount.X_WL.translation(), {});
}

LidarCase level_ground_case() {
  sim::HeightField ground;
  ground.cell_m = kTriangle_m;
  ground.columns = ground.rows = 401;
  ground.origin_m = {-200.0, -200.0};
  ground.heights_m.assign(ground.columns * ground.rows, 0.0);
  LidarCase level{"level ground", std::make_unique<sim::Scene>(), standing_at(0.1, 0.2, 2.5)};
  level.scene->add_terrain(ground, {.reflectance = 0.9, .label = "ground"});
  return level;
}

LidarCase pit_case() {
  const Pit pit = make_pit_parts();
  LidarCase made{"pit", std::make_unique<sim::Scene>(),
                 standing_at(0.0, 0.0, pit.ground.height_m(0.0, 0.0) + 3.2)};
  // White, so that reach is the same for all and errors are counted far out.
  const sim::Material white{.reflectance = 0.9, .label = "white"};
  made.scene->add_terrain(pit.ground, white);
  std::vector<sim::Scene::MeshId> meshes;
  for (const sim::TriangleMesh& shape : pit.rock_shapes) {
    meshes.push_back(made.scene->add_mesh(shape));
  }
  for (const sim::PlacedRock& rock : pit.rocks) {
    made.scene->add_object(meshes[rock.shape], rock.X_WM, rock.radius_m, white);
  }
  return made;
}

WorldTriangles pit_triangles() {
  const Pit pit = make_pit_parts();
  WorldTriangles world;
  const sim::HeightField& ground = pit.ground;
  for (std::size_t r = 0; r < ground.rows; ++r) {
    for (std::size_t c = 0; c < ground.columns; ++c) {
      world.vertices_m.emplace_back(ground.origin_m.x() + ground.cell_m * static_cast<double>(c),
                                    ground.origin_m.y() + ground.cell_m * static_cast<double>(r),
                                    ground.node(c, r));
    }
  }
  const auto columns = static_cast<std::uint32_t>(ground.columns);
  for (std::uint32_t r = 0; r + 1 < ground.rows; ++r) {
    for (std::uint32_t c = 0; c + 1 < columns; ++c) {
      // Parted by the diagonal from south-east to north-west (sim/scene/height_field.h).
      const std::uint32_t south_west = r * columns + c;
      const std::uint32_t north_west = south_west + columns;
      world.triangles.push_back({south_west, south_west + 1, north_west});
      world.triangles.push_back({south_west + 1, north_west + 1, north_west});
    }
  }
  for (const sim::PlacedRock& rock : pit.rocks) {
    const sim::TriangleMesh& shape = pit.rock_shapes[rock.shape];
    const auto first = static_cast<std::uint32_t>(world.vertices_m.size());
    for (const Eigen::Vector3f& vertex : shape.vertices) {
      world.vertices_m.push_back(rock.X_WM * (rock.radius_m * vertex.cast<double>()));
    }
    for (const auto& triangle : shape.triangles) {
      world.triangles.push_back({first + triangle[0], first + triangle[1], first + triangle[2]});
    }
  }
  return world;
}

}  // namespace rigwire::bench
