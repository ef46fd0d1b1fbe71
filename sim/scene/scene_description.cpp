#include "sim/scene/scene_description.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/scene/range_checks.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

Eigen::Quaterniond random_attitude(RandomStream& random) {
  Eigen::Quaterniond attitude(random.gaussian(), random.gaussian(), random.gaussian(),
                              random.gaussian());
  return attitude.normalized();
}

/// Diameter below which the share p of all rocks stays: the power law cut at both ends.
double diameter_at(const RockField& rocks, double p) {
  const double power = 1.0 - rocks.exponent;
  const double low = std::pow(rocks.smallest_m, power);
  const double high = std::pow(rocks.largest_m, power);
  return std::pow(low + p * (high - low), 1.0 / power);
}

}  // namespace

void visit(fields::Visitor& v, Heap& p) {
  v.vector2("centre", p.centre_m, in("m").between(-4000, 4000), "[east, north] of the top.");
  v.number("height", p.height_m, in("m").between(0, 50), "Height of the top.");
  v.number("repose", p.repose_deg, in("deg").stored_as("deg").between(5, 60),
           "Slope of the cone of loose material.");
}

void visit(fields::Visitor& v, PitTerrain& p) {
  v.number("size", p.size_m, in("m").between(10, 4000), "Edge of the square area around (0, 0).");
  v.number("cell", p.cell_m, in("m").between(0.05, 400), "Distance between two heights.");
  v.number("floor_height", p.floor_height_m, in("m").between(-10'000, 10'000),
           "Height of the pit's floor.");
  v.vector2("floor_centre", p.floor_centre_m, in("m").between(-4000, 4000),
            "[east, north] of the floor's middle.");
  v.vector2("floor_half_lengths", p.floor_half_lengths_m, in("m").between(8, 4000),
            "[east, north] from the floor's centre to the faces.");
  v.integer("benches", p.benches, IntegerRule{0, 50}, "Steps from the floor to the rim.");
  v.number("bench_height", p.bench_height_m, in("m").between(0.1, 50), "Height of each bench.");
  v.number("face_angle", p.face_angle_deg, in("deg").stored_as("deg").between(20, 85),
           "Slope of the faces against the horizontal.");
  v.number("berm_width", p.berm_width_m, in("m").between(0.5, 100), "Flat part of each bench.");
  v.number("windrow_height", p.windrow_height_m, in("m").between(0, 5),
           "Height of the ridge along each berm.");
  v.number("ramp_width", p.ramp_width_m, in("m").between(0, 100), "Width of the access ramp.");
  v.number("ramp_slope", p.ramp_slope, plain().between(0.01, 1), "Rise over run of the ramp.");
  v.number("ramp_start_x", p.ramp_start_x_m, in("m").between(-4000, 4000),
           "The ramp rises from here to the west.");
  v.number("ramp_y", p.ramp_y_m, in("m").between(-4000, 4000), "North of the ramp's centre line.");
  v.number("floor_roughness", p.floor_roughness_m, in("mm").between(0, 1000),
           "Standard deviation of the heights on floor and ramp.");
  v.number("face_roughness", p.face_roughness_m, in("mm").between(0, 3000),
           "Standard deviation of the heights on faces and berms.");
  v.list("heaps", p.heaps, "Cones of loose material.");
  v.section("material", p.material, "Surface of the ground.");
}

void visit(fields::Visitor& v, RockField& p) {
  v.integer("count", p.count, IntegerRule{0, 100'000}, "Number of rocks.");
  v.vector2("centre", p.centre_m, in("m").between(-4000, 4000),
            "[east, north] of the disc with rocks.");
  v.number("radius", p.radius_m, in("m").between(0.1, 4000), "Radius of the disc with rocks.");
  v.number("smallest", p.smallest_m, in("m").between(0.02, 20), "Diameter of the smallest rock.");
  v.number("largest", p.largest_m, in("m").between(0.02, 20), "Diameter of the largest rock.");
  v.number("exponent", p.exponent, plain().between(1.1, 6),
           "Number above d falls as d^(1 - exponent).");
  v.section("material", p.material, "Surface of the rocks.");
  v.list("keep_out", p.keep_out, "Discs without rocks: for the machine, for the truck.");
  v.boolean("loose", p.loose, "They lie on the ground; machines push, roll and lift them.");
  v.only_if(p.loose, "loose", "loose: true", [&p](fields::Visitor& w) {
    w.number("density", p.density_kgpm3, in("kg/m3").between(100, 20'000), "Density of the rock.");
  });
}

void visit(fields::Visitor& v, BoxObject& p) {
  v.text("name", p.name, "Name of the box.");
  v.vector3("size", p.size_m, in("m").between(0.01, 1000), "Full lengths along its own axes.");
  v.vector3("position", p.position_m, in("m").between(-10'000, 10'000),
            "[east, north, up] of the middle of its base.");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360),
           "Direction of its x from east, left positive.");
  v.boolean("on_ground", p.on_ground, "Whether `up` counts from the terrain under it.");
  v.boolean("loose", p.loose, "A crate: machines push, tip and lift it.");
  v.only_if(!p.loose, "loose", "loose: false", [&p](fields::Visitor& w) {
    w.boolean("solid", p.solid, "Whether machines meet it and plants keep clear of it.");
  });
  v.only_if(p.loose, "loose", "loose: true", [&p](fields::Visitor& w) {
    w.number("mass", p.mass_kg, in("kg").between(1, 1e6), "Mass, evenly spread.");
    w.number("friction", p.friction, plain().between(0, 2),
             "Coefficient of friction of its surface; of two that rub, also on the ground, the "
             "smaller counts.");
  });
  v.section("material", p.material, "What its surface is.");
}

void visit(fields::Visitor& v, NamedMaterial& p) {
  v.required("name");
  v.text("name", p.name, "Name of a material in the mesh's file.");
  visit(v, p.material);
}

void visit(fields::Visitor& v, FixedObject& p) {
  v.text("name", p.name, "Name of the object.");
  v.required("mesh");
  v.file("mesh", p.mesh, fields::FileKind::mesh,
         "glTF, OBJ, STL or PLY, relative to this file; x forward, y left, z up.");
  v.vector3("position", p.position_m, in("m").between(-10'000, 10'000),
            "[east, north, up] of the mesh's origin.");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360),
           "Direction of its x from east, left positive.");
  v.boolean("on_ground", p.on_ground, "Whether `up` counts from the terrain under it.");
  v.number("scale", p.scale, plain().between(1e-6, 1e6), "Metres for each unit of the mesh.");
  v.boolean("solid", p.solid, "Whether machines meet it, each connected part as its convex hull.");
  v.section("material", p.material, "What its surface is.");
  v.list("materials", p.materials, "Surfaces of parts, by the names in the mesh's file.");
}

void validate(const PitTerrain& terrain) {
  fields::check(terrain);
  require_grid(terrain.size_m, terrain.cell_m);
}

void validate(const RockField& rocks) {
  fields::check(rocks);
  require_within(rocks.largest_m, rocks.smallest_m, 20.0, "m", "largest", "not below the smallest");
}

void validate(const BoxObject& box) {
  fields::check(box);
}

void validate(const FixedObject& object) {
  fields::check(object);
}

void visit(fields::Visitor& v, SceneDescription& p) {
  v.group(
      "terrain",
      [&p](fields::Visitor& keys) {
        keys.variant("type", p.terrain, "Kind of ground; pit when not given.");
      },
      "The ground.");
  v.list("tracks", p.tracks, "Ways carved into the ground.");
  v.list("soils", p.soils, "What the ground is made of; the first lies everywhere.");
  v.list("soil_regions", p.soil_regions, "Where another soil lies than around.");
  v.list("rocks", p.rocks, "Fields of rocks.");
  v.list("trees", p.trees, "Forests of closed crowns.");
  v.list("forests", p.forests, "Forests modelled leaf by leaf.");
  v.list("grass", p.grass, "Fields of stalks.");
  v.list("boxes", p.boxes, "Buildings, kerbs: solid boxes.");
  v.list("objects", p.objects, "Meshes that stand there.");
}

void validate(const SceneDescription& description) {
  fields::check(description);
}

std::vector<PlacedRock> place_rocks(const RockField& rocks, const HeightField& ground,
                                    RandomStream& random) {
  validate(rocks);
  constexpr int kTriesPerRock = 20;
  constexpr double kSunk = 0.3;
  std::vector<PlacedRock> placed;
  for (int i = 0; i < rocks.count; ++i) {
    const double radius = 0.5 * diameter_at(rocks, random.uniform());
    for (int attempt = 0; attempt < kTriesPerRock; ++attempt) {
      const double away = rocks.radius_m * std::sqrt(random.uniform());
      const double bearing = random.uniform(0.0, 2.0 * std::numbers::pi);
      const Eigen::Vector2d spot =
          rocks.centre_m + away * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
      const bool kept_out = std::ranges::any_of(rocks.keep_out, [&](const KeepOut& disc) {
        return (spot - disc.centre_m).norm() < disc.radius_m + radius;
      });
      if (kept_out) {
        continue;
      }
      PlacedRock& rock = placed.emplace_back();
      rock.shape = static_cast<std::size_t>(random.bits() % kRockShapes);
      rock.radius_m = radius;
      rock.X_WM.linear() = random_attitude(random).toRotationMatrix();
      rock.X_WM.translation() << spot, ground.height_m(spot.x(), spot.y()) + kSunk * radius;
      break;
    }
  }
  return placed;
}

Eigen::Isometry3d object_pose(const FixedObject& object, const HeightField& ground) {
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.linear() = Eigen::AngleAxisd(object.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  X_WM.translation() = object.position_m;
  if (object.on_ground) {
    X_WM.translation().z() += ground.height_m(object.position_m.x(), object.position_m.y());
  }
  return X_WM;
}

Eigen::Isometry3d box_pose(const BoxObject& box, const HeightField& ground) {
  FixedObject base;
  base.position_m = box.position_m;
  base.yaw_rad = box.yaw_rad;
  base.on_ground = box.on_ground;
  Eigen::Isometry3d X_WM = object_pose(base, ground);
  X_WM.translation().z() += 0.5 * box.size_m.z();
  return X_WM;
}

}  // namespace rigwire::sim
