// What stands and lies around the machine: terrain, rocks, objects. Places are in the world frame W
// (x east, y north, z up) with its origin at the rig's `origin`.
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "hil/configuration/fields.h"
#include "hil/configuration/shapes.h"
#include "hil/configuration/units.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

/// A pit: a level rectangular floor with straight slopes up to the surface around it.
struct PitDescription {
  double east_m = 0.0;  ///< Centre of the floor.
  double north_m = 0.0;
  double length_m = 30.0;  ///< Floor along its own x.
  double width_m = 20.0;   ///< Floor along its own y.
  double yaw_rad = 0.0;    ///< Of its x from east, left positive.
  double depth_m = 4.0;
  double slope_rad = 0.7;     ///< Of the walls against the horizontal.
  double ramp_width_m = 0.0;  ///< Ramp out of the +x end; 0 = none.
  double ramp_slope_rad = 0.15;
};

/// A heap: a cone with a rounded top, as poured soil.
struct MoundDescription {
  double east_m = 0.0;
  double north_m = 0.0;
  double height_m = 2.0;
  double slope_rad = 0.6;  ///< Of its flank.
};

/// Terrain as heights on a square grid, the sum of base, pits, mounds and roughness.
struct TerrainDescription {
  double east_m = 0.0;  ///< Centre of the area.
  double north_m = 0.0;
  double size_east_m = 160.0;
  double size_north_m = 160.0;
  double cell_m = 0.5;
  double base_height_m = 0.0;
  double roughness_m = 0.03;        ///< Standard deviation of the random unevenness.
  double roughness_length_m = 2.0;  ///< Distance over which it changes.
  double reflectance = 0.25;
  std::vector<PitDescription> pits;
  std::vector<MoundDescription> mounds;
};

/// Rocks strewn at random (stream "scene/rocks/<name>") over a ring, resting in the ground.
struct RockFieldDescription {
  std::uint32_t count = 20;
  double east_m = 0.0;  ///< Centre of the ring.
  double north_m = 0.0;
  double inner_radius_m = 10.0;
  double outer_radius_m = 40.0;
  double size_min_m = 0.2;  ///< Greatest length of the smallest rock.
  double size_max_m = 1.2;
  double buried = 0.3;  ///< Share of the height below ground.
  double reflectance = 0.35;
};

/// Something that stands in the scene.
struct ObjectDescription {
  std::vector<PlacedShape> shapes;  ///< In the object's frame: x forward, y left, z up.
  Vector3 position_m;
  double yaw_rad = 0.0;   ///< Of its x from east, left positive.
  bool on_ground = true;  ///< position z counts from the terrain under it.
};

struct SceneDescription {
  std::string name = "scene";
  std::string text;  ///< One line for `rigwire list scenes`.
  TerrainDescription terrain;
  std::map<std::string, RockFieldDescription> rocks;
  std::map<std::string, ObjectDescription> objects;
};

/// Throws std::invalid_argument: a ring without width, sizes the wrong way round.
inline void validate(const RockFieldDescription& p) {
  if (p.outer_radius_m <= p.inner_radius_m) {
    throw std::invalid_argument("outer_radius must be greater than inner_radius");
  }
  if (p.size_max_m < p.size_min_m) {
    throw std::invalid_argument("size_max must not be less than size_min");
  }
}

/// Throws std::invalid_argument: more nodes along a side than the ray caster takes (32767), or
/// fewer than two.
inline void validate(const TerrainDescription& p) {
  constexpr double kMostCells = 32766.0;
  for (const double side_m : {p.size_east_m, p.size_north_m}) {
    const double cells = side_m / p.cell_m;
    if (cells > kMostCells || cells < 1.0) {
      throw std::invalid_argument("size / cell must be 1 .. 32766 cells along each side");
    }
  }
}

template <class Visitor>
void visit(Visitor& v, PitDescription& p) {
  v.number("east", p.east_m, in("m"), "Centre of the floor.");
  v.number("north", p.north_m, in("m"), "Centre of the floor.");
  v.number("length", p.length_m, in("m").above(0), "Of the floor, along its own x.");
  v.number("width", p.width_m, in("m").above(0), "Of the floor, along its own y.");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360), "Of its x from east, left positive.");
  v.number("depth", p.depth_m, in("m").at_least(0), "Floor below the surface around it.");
  v.number("slope", p.slope_rad, in("deg").above(0).at_most(89), "Of the walls.");
  v.number("ramp_width", p.ramp_width_m, in("m").at_least(0), "Ramp out of the +x end; 0 = none.");
  v.number("ramp_slope", p.ramp_slope_rad, in("deg").above(0).at_most(45), "Of the ramp.");
}

template <class Visitor>
void visit(Visitor& v, MoundDescription& p) {
  v.number("east", p.east_m, in("m"), "Centre.");
  v.number("north", p.north_m, in("m"), "Centre.");
  v.number("height", p.height_m, in("m").at_least(0), "Of the top above the ground around it.");
  v.number("slope", p.slope_rad, in("deg").above(0).at_most(60), "Of the flank.");
}

template <class Visitor>
void visit(Visitor& v, TerrainDescription& p) {
  v.number("east", p.east_m, in("m"), "Centre of the area.");
  v.number("north", p.north_m, in("m"), "Centre of the area.");
  v.number("size_east", p.size_east_m, in("m").above(0), "Whole length from west to east.");
  v.number("size_north", p.size_north_m, in("m").above(0), "Whole length from south to north.");
  v.number("cell", p.cell_m, in("m").above(0), "Distance between two heights.");
  v.number("base_height", p.base_height_m, in("m"), "Of the level ground, in the world frame.");
  v.number("roughness", p.roughness_m, in("mm").between(0, 10000),
           "Standard deviation of the unevenness.");
  v.number("roughness_length", p.roughness_length_m, in("m").above(0), "Over which it changes.");
  v.number("reflectance", p.reflectance, plain().between(0, 1), "Diffuse, at 905 nm.");
  v.list("pits", p.pits, "Pits, cut one after another.");
  v.list("mounds", p.mounds, "Heaps, added one after another.");
}

template <class Visitor>
void visit(Visitor& v, RockFieldDescription& p) {
  v.integer("count", p.count, IntegerRule{0, 100000}, "Number of rocks.");
  v.number("east", p.east_m, in("m"), "Centre of the ring.");
  v.number("north", p.north_m, in("m"), "Centre of the ring.");
  v.number("inner_radius", p.inner_radius_m, in("m").at_least(0), "Free of rocks within.");
  v.number("outer_radius", p.outer_radius_m, in("m").above(0), "No rocks beyond.");
  v.number("size_min", p.size_min_m, in("m").above(0), "Greatest length of the smallest rock.");
  v.number("size_max", p.size_max_m, in("m").above(0), "Greatest length of the largest rock.");
  v.number("buried", p.buried, plain().between(0, 1), "Share of the height below ground.");
  v.number("reflectance", p.reflectance, plain().between(0, 1), "Diffuse, at 905 nm.");
}

template <class Visitor>
void visit(Visitor& v, ObjectDescription& p) {
  v.list("shapes", p.shapes, "In the object's frame: x forward, y left, z up.");
  v.vector3("position", p.position_m, in("m"), "[east, north, up].");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360), "Of its x from east, left positive.");
  v.boolean("on_ground", p.on_ground, "Whether `up` counts from the terrain under it.");
}

template <class Visitor>
void visit(Visitor& v, SceneDescription& p) {
  v.text("name", p.name, "For people.");
  v.text("text", p.text, "One line for `rigwire list scenes`.");
  v.section("terrain", p.terrain, "The ground.");
  v.named("rocks", p.rocks, "rock field", "Fields of rocks, by name.");
  v.named("objects", p.objects, "object", "Things that stand there, by name.");
}

}  // namespace rigwire::hil
