// The scene of a rig: sim/scene/scene_description.h with a name, as configs/scenes/*.yaml fill it.
// World frame W: x east, y north, z up, its origin at the rig's `origin`.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>

#include "fields/visitor.h"
#include "hil/configuration/soil.h"
#include "hil/configuration/weather.h"
#include "sim/scene/scene_description.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::hil {

struct SceneConfiguration {
  std::string name = "scene";
  std::string text;  ///< One line for `rigwire list scenes`.
  /// Each object's `mesh` is the full path of a file (hil/files/mesh_file.h).
  sim::SceneDescription description;
  sim::WeatherParameters weather;
};

}  // namespace rigwire::hil

namespace rigwire::sim {

inline void visit(fields::Visitor& v, sim::Material& p) {
  v.number("reflectance", p.reflectance, fields::plain().between(0, 1), "Diffuse, at 905 nm.");
  v.text("label", p.label, "What it is, for recordings.");
  v.number("retro_gain", p.retro_gain, fields::plain().between(0, 1),
           "Retro-reflector; 1 is an ideal one.");
  v.boolean("foliage", p.foliage, "Leaves in a closed surface: radio signals pass, weakened.");
  v.boolean("loose_leaves", p.loose_leaves, "Single leaves: radio signals pass.");
}

inline void visit(fields::Visitor& v, sim::Heap& p) {
  v.vector2("centre", p.centre_m, fields::in("m"), "[east, north].");
  v.number("height", p.height_m, fields::in("m").at_least(0), "Of the top.");
  v.number("repose", p.repose_deg, fields::in("deg").stored_as("deg").above(0).at_most(89),
           "Slope of the cone.");
}

inline void visit(fields::Visitor& v, sim::PitTerrain& p) {
  v.number("size", p.size_m, fields::in("m").above(0), "Edge of the square area around (0, 0).");
  v.number("cell", p.cell_m, fields::in("m").above(0), "Distance between two heights.");
  v.number("floor_height", p.floor_height_m, fields::in("m"), "Of the pit's floor.");
  v.vector2("floor_centre", p.floor_centre_m, fields::in("m"), "[east, north].");
  v.vector2("floor_half_lengths", p.floor_half_lengths_m, fields::in("m").above(0),
            "[east, north] from the centre to the faces.");
  v.integer("benches", p.benches, fields::IntegerRule{0, 100}, "Steps from the floor to the rim.");
  v.number("bench_height", p.bench_height_m, fields::in("m").above(0), "Of each.");
  v.number("face_angle", p.face_angle_deg, fields::in("deg").stored_as("deg").above(0).at_most(89),
           "Of the faces against the horizontal.");
  v.number("berm_width", p.berm_width_m, fields::in("m").at_least(0), "Flat part of each bench.");
  v.number("windrow_height", p.windrow_height_m, fields::in("m").at_least(0),
           "Ridge along each berm.");
  v.number("ramp_width", p.ramp_width_m, fields::in("m").at_least(0), "Of the access ramp.");
  v.number("ramp_slope", p.ramp_slope, fields::plain().between(0, 1), "Rise over run.");
  v.number("ramp_start_x", p.ramp_start_x_m, fields::in("m"),
           "The ramp rises from here to the west.");
  v.number("ramp_y", p.ramp_y_m, fields::in("m"), "North of its centre line.");
  v.number("floor_roughness", p.floor_roughness_m, fields::in("mm").at_least(0),
           "Standard deviation.");
  v.number("face_roughness", p.face_roughness_m, fields::in("mm").at_least(0),
           "Standard deviation.");
  v.list("heaps", p.heaps, "Cones of loose material.");
  v.section("material", p.material, "Of the ground.");
}

inline void visit(fields::Visitor& v, sim::MeanSlope& p) {
  v.number("rise", p.rise, fields::plain().between(-1, 1), "Rise over run.");
  v.number("uphill", p.uphill_rad, fields::in("deg").between(-360, 360), "Left from east.");
  v.number("height_at_0", p.height_at_0_m, fields::in("m"), "At (0, 0).");
}

inline void visit(fields::Visitor& v, sim::HillsTerrain& p) {
  v.number("size", p.size_m, fields::in("m").above(0), "Edge of the square area around (0, 0).");
  v.number("cell", p.cell_m, fields::in("m").above(0), "Distance between two heights.");
  v.section("slope", p.slope, "Mean slope.");
  v.number("roughness", p.roughness_m, fields::in("m").at_least(0),
           "Standard deviation of the heights.");
  v.number("longest_wave", p.longest_wave_m, fields::in("m").above(0),
           "Of the coarsest layer of noise.");
  v.section("material", p.material, "Of the ground.");
}

inline void visit(fields::Visitor& v, sim::LevelTerrain& p) {
  v.number("size", p.size_m, fields::in("m").above(0), "Edge of the square area around (0, 0).");
  v.number("cell", p.cell_m, fields::in("m").above(0), "Distance between two heights.");
  v.section("slope", p.slope, "Crossfall.");
  v.number("roughness", p.roughness_m, fields::in("mm").at_least(0),
           "Standard deviation of the heights.");
  v.section("material", p.material, "Of the ground.");
}

inline constexpr std::array<fields::Choice<sim::HeightMapPlace>, 2> kHeightMapPlaces{
    {{sim::HeightMapPlace::centred, "centred", "The map's middle at (0, 0)."},
     {sim::HeightMapPlace::georeferenced, "georeferenced",
      "Where the file says, seen from the rig's origin."}}};

inline void visit(fields::Visitor& v, sim::HeightMapTerrain& p) {
  v.required("file");
  v.file("file", p.file, "PNG of 8 or 16 bit, or GeoTIFF; relative to this file.");
  v.choice("place", p.place, kHeightMapPlaces, "Where the map lies.");
  v.number("scale", p.scale, fields::plain(), "Metres for each unit of the file.");
  v.number("offset", p.offset_m, fields::in("m"), "Added to all heights.");
  v.number("pixel", p.pixel_m, fields::in("m").at_least(0), "Of the file; 0 = as it says itself.");
  v.number("cell", p.cell_m, fields::in("m").at_least(0),
           "Distance between two heights; 0 = a pixel.");
  v.number("size", p.size_m, fields::in("m").at_least(0),
           "Edge of the square around (0, 0); 0 = all.");
  v.boolean("fill_gaps", p.fill_gaps, "Whether missing heights become the lowest.");
  v.section("material", p.material, "Of the ground.");
}

}  // namespace rigwire::sim

namespace rigwire::hil {

/// The terrain's section: its `type` beside the keys of that type; without `type` a pit.
struct TerrainSection {
  sim::Terrain* terrain;
};

inline void visit(fields::Visitor& v, TerrainSection& section) {
  v.variant("type", *section.terrain, "Kind of ground; pit when not given.");
}

}  // namespace rigwire::hil

namespace rigwire::sim {

inline void visit(fields::Visitor& v, sim::TrackPoint& p) {
  v.vector2("at", p.at_m, fields::in("m"), "[east, north].");
}

inline void visit(fields::Visitor& v, sim::Track& p) {
  v.text("name", p.name, "Of the track; soil regions name it.");
  v.list("points", p.points, "The centre line passes smoothly through each.");
  v.boolean("closed", p.closed, "Whether the last point joins the first.");
  v.number("width", p.width_m, fields::in("m").above(0), "Level across.");
  v.number("shoulder", p.shoulder_m, fields::in("m").at_least(0),
           "Blends into the ground, each side.");
  v.number("grading", p.grading_m, fields::in("m").at_least(0),
           "Waves of the ground much shorter than this are cut and filled.");
  v.number("roughness", p.roughness_m, fields::in("mm").at_least(0),
           "Standard deviation, on the track.");
  v.text("soil", p.soil, "Name of a soil; empty = as around it.");
}

inline void visit(fields::Visitor& v, sim::SoilDisc& p) {
  v.vector2("centre", p.centre_m, fields::in("m"), "[east, north].");
  v.number("radius", p.radius_m, fields::in("m").above(0), "Of the disc.");
}

inline void visit(fields::Visitor& v, sim::SoilRectangle& p) {
  v.vector2("centre", p.centre_m, fields::in("m"), "[east, north].");
  v.vector2("size", p.size_m, fields::in("m").above(0), "Full lengths along its own axes.");
  v.number("yaw", p.yaw_rad, fields::in("deg").between(-360, 360),
           "Of its first axis, left from east.");
}

inline void visit(fields::Visitor& v, sim::SoilStretch& p) {
  v.required("track");
  v.text("track", p.track, "Name of the track.");
  v.number("from", p.from_m, fields::in("m").at_least(0), "Along the track from its first point.");
  v.number("to", p.to_m, fields::in("m").at_least(0), "Along the track.");
}

inline void visit(fields::Visitor& v, sim::SoilRegion& p) {
  v.required("soil");
  v.text("soil", p.soil, "Name of the soil there.");
  v.required("type");
  v.variant("type", p.shape, "Shape of the region.");
}

inline void visit(fields::Visitor& v, sim::TreeField& p) {
  v.integer("count", p.count, fields::IntegerRule{0, 50000}, "Number of trees; 0 = by density.");
  v.number("density", p.density_per_ha, fields::plain().at_least(0), "Trees per hectare.");
  v.integer("seed", p.seed, fields::IntegerRule{0}, "Another forest on the same ground.");
  v.vector2("centre", p.centre_m, fields::in("m"), "[east, north] of the rectangle.");
  v.vector2("half_lengths", p.half_lengths_m, fields::in("m").above(0), "[east, north].");
  v.number("smallest", p.smallest_m, fields::in("m").above(0), "Height.");
  v.number("largest", p.largest_m, fields::in("m").above(0), "Height.");
  v.number("trunk_diameter", p.trunk_diameter_m, fields::in("m").above(0), "Of the largest tree.");
  v.number("conifer_share", p.conifer_share, fields::plain().between(0, 1),
           "The rest have round crowns.");
  v.number("track_distance", p.track_distance_m, fields::in("m").at_least(0),
           "From a track's edge to a trunk.");
  v.number("spacing", p.spacing_m, fields::in("m").at_least(0), "Between trunks, at least.");
  v.list("keep_out", p.keep_out, "Discs without trees.");
  v.section("trunk", p.trunk, "Surface of the trunks.");
  v.section("crown", p.crown, "Surface of the crowns.");
}

inline void visit(fields::Visitor& v, sim::BoxObject& p) {
  v.text("name", p.name, "Of the box.");
  v.vector3("size", p.size_m, fields::in("m").above(0), "Full lengths along its own axes.");
  v.vector3("position", p.position_m, fields::in("m"),
            "[east, north, up] of the middle of its base.");
  v.number("yaw", p.yaw_rad, fields::in("deg").between(-360, 360),
           "Of its x from east, left positive.");
  v.boolean("on_ground", p.on_ground, "Whether `up` counts from the terrain under it.");
  v.section("material", p.material, "Of its surface.");
}

inline void visit(fields::Visitor& v, sim::KeepOut& p) {
  v.vector2("centre", p.centre_m, fields::in("m"), "[east, north].");
  v.number("radius", p.radius_m, fields::in("m").at_least(0), "Nothing within.");
}

inline void visit(fields::Visitor& v, sim::RockField& p) {
  v.integer("count", p.count, fields::IntegerRule{0, 100000}, "Number of rocks.");
  v.vector2("centre", p.centre_m, fields::in("m"), "[east, north].");
  v.number("radius", p.radius_m, fields::in("m").above(0), "No rock beyond.");
  v.number("smallest", p.smallest_m, fields::in("m").above(0), "Diameter.");
  v.number("largest", p.largest_m, fields::in("m").above(0), "Diameter.");
  v.number("exponent", p.exponent, fields::plain().above(1),
           "Number above d falls as d^(1 - exponent).");
  v.section("material", p.material, "Of the rocks.");
  v.list("keep_out", p.keep_out, "Discs without rocks: for the machine, for the truck.");
}

inline constexpr std::array<fields::Choice<sim::Species>, 5> kTreeSpecies{
    {{sim::Species::spruce, "spruce", "Cone to near the ground, needles."},
     {sim::Species::pine, "pine", "Bare stem, crown at the top, needles."},
     {sim::Species::beech, "beech", "Wide round crown."},
     {sim::Species::oak, "oak", "Widest crown, thick branches."},
     {sim::Species::birch, "birch", "Slim, hanging twigs."}}};

inline constexpr std::array<fields::Choice<sim::LeafModel>, 2> kLeafModels{
    {{sim::LeafModel::cards, "cards", "Cards that rays pass where the texture has gaps."},
     {sim::LeafModel::triangles, "triangles", "Loose triangles: cheaper to cast at."}}};

inline void visit(fields::Visitor& v, sim::SpeciesShare& p) {
  v.choice("species", p.species, kTreeSpecies, "Of these trees.");
  v.number("share", p.share, fields::plain().at_least(0),
           "Of all trees, against the others' shares.");
  v.number("smallest", p.smallest_m, fields::in("m").above(0), "Height.");
  v.number("largest", p.largest_m, fields::in("m").above(0), "Height.");
}

inline void visit(fields::Visitor& v, sim::Forest& p) {
  v.integer("count", p.count, fields::IntegerRule{0, 50000}, "Number of trees; 0 = by density.");
  v.number("density", p.density_per_ha, fields::plain().at_least(0), "Trees per hectare.");
  v.integer("seed", p.seed, fields::IntegerRule{0}, "Another forest on the same ground.");
  v.vector2("centre", p.centre_m, fields::in("m"), "[east, north] of the rectangle.");
  v.vector2("half_lengths", p.half_lengths_m, fields::in("m").above(0), "[east, north].");
  v.list("species", p.species, "Which trees.");
  v.integer("variants", p.variants, fields::IntegerRule{1, 100}, "Models of each species.");
  v.choice("leaf_model", p.leaf_model, kLeafModels, "cards with textures, or loose triangles.");
  v.number("track_distance", p.track_distance_m, fields::in("m").at_least(0),
           "From a track's edge to a trunk.");
  v.number("spacing", p.spacing_m, fields::in("m").at_least(0), "Between trunks, at least.");
  v.number("bushes", p.bushes_per_ha, fields::plain().at_least(0), "Per hectare.");
  v.number("fallen", p.fallen_per_ha, fields::plain().at_least(0),
           "Trunks on the ground, per hectare.");
  v.list("keep_out", p.keep_out, "Discs without trees.");
  v.section("wood", p.wood, "Surface of trunks, branches and twigs.");
  v.section("leaves", p.leaves, "Surface of the leaves.");
  v.section("bush", p.bush, "Surface of the bushes.");
  v.section("fallen_wood", p.fallen, "Surface of the fallen trunks.");
}

inline void visit(fields::Visitor& v, sim::GrassField& p) {
  v.vector2("centre", p.centre_m, fields::in("m"), "[east, north] of the rectangle.");
  v.vector2("half_lengths", p.half_lengths_m, fields::in("m").above(0), "[east, north].");
  v.integer("seed", p.seed, fields::IntegerRule{0}, "Other grass at the same place.");
  v.number("stalks_per_m2", p.stalks_per_m2, fields::plain().at_least(0),
           "Stalks per square metre.");
  v.number("height", p.height_m, fields::in("m").above(0), "Of the stalks.");
  v.number("diameter", p.diameter_m, fields::in("mm").above(0), "At the foot; 0 at the tip.");
  v.number("lean", p.lean_rad, fields::in("deg").between(0, 57), "Standard deviation.");
  v.number("patch", p.patch_m, fields::in("m").above(0),
           "Edge of the patches that are laid side by side.");
  v.number("track_distance", p.track_distance_m, fields::in("m").at_least(0),
           "From a track's edge to a patch's middle.");
  v.list("keep_out", p.keep_out, "Discs without grass.");
  v.section("material", p.material, "Surface of the stalks.");
}

inline void visit(fields::Visitor& v, sim::NamedMaterial& p) {
  v.required("name");
  v.text("name", p.name, "Of a material in the mesh's file.");
  visit(v, p.material);
}

inline void visit(fields::Visitor& v, sim::FixedObject& p) {
  v.text("name", p.name, "Of the object.");
  v.required("mesh");
  v.file("mesh", p.mesh, "glTF, OBJ, STL or PLY, relative to this file; x forward, y left, z up.");
  v.vector3("position", p.position_m, fields::in("m"), "[east, north, up] of the mesh's origin.");
  v.number("yaw", p.yaw_rad, fields::in("deg").between(-360, 360),
           "Of its x from east, left positive.");
  v.boolean("on_ground", p.on_ground, "Whether `up` counts from the terrain under it.");
  v.number("scale", p.scale, fields::plain().above(0), "Metres for each unit of the mesh.");
  v.section("material", p.material, "Of its surface.");
  v.list("materials", p.materials, "Of parts, by the names in the mesh's file.");
}

}  // namespace rigwire::sim

namespace rigwire::hil {

inline void visit(fields::Visitor& v, SceneConfiguration& p) {
  v.text("name", p.name, "For people.");
  v.text("text", p.text, "One line for `rigwire list scenes`.");
  TerrainSection terrain{&p.description.terrain};
  v.section("terrain", terrain, "The ground.");
  v.list("tracks", p.description.tracks, "Ways carved into the ground.");
  v.list("soils", p.description.soils, "What the ground is made of; the first lies everywhere.");
  v.list("soil_regions", p.description.soil_regions, "Where another soil lies than around.");
  v.list("rocks", p.description.rocks, "Fields of rocks.");
  v.list("trees", p.description.trees, "Forests of closed crowns.");
  v.list("forests", p.description.forests, "Forests modelled leaf by leaf.");
  v.list("grass", p.description.grass, "Fields of stalks.");
  v.list("boxes", p.description.boxes, "Buildings, kerbs: solid boxes.");
  v.list("objects", p.description.objects, "Meshes that stand there.");
  v.section("weather", p.weather, "What is in the air, and how it changes.");
}

}  // namespace rigwire::hil
