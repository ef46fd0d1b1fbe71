#include "hil/world/scene.h"

#include <array>
#include <stdexcept>
#include <variant>

#include "fields/check.h"
#include "fields/visitor.h"
#include "hil/files/height_map_file.h"
#include "hil/files/mesh_file.h"

namespace rigwire::hil {

using fields::in;

namespace {

constexpr std::array<fields::Choice<GeoidSource>, 2> kGeoidSources{
    {{GeoidSource::constant, "constant", "One separation over the whole scene."},
     {GeoidSource::egm96, "egm96", "Looked up in a grid at every point."}}};
constexpr std::array<fields::Choice<sim::GeoidInterpolation>, 2> kGeoidInterpolations{
    {{sim::GeoidInterpolation::bilinear, "bilinear", "Bilinear, like most programs."},
     {sim::GeoidInterpolation::bicubic, "bicubic", "Nearer to the model."}}};

}  // namespace

void visit(fields::Visitor& v, OriginConfiguration& p) {
  v.number("latitude", p.latitude_deg, in("deg").stored_as("deg").between(-90, 90),
           "WGS 84, north positive.");
  v.number("longitude", p.longitude_deg, in("deg").stored_as("deg").between(-180, 180),
           "WGS 84, east positive.");
  v.number("height", p.height_m, in("m").between(-1000, 10000), "Height above the ellipsoid.");
  v.choice("geoid", p.geoid, kGeoidSources, "Receivers report heights above it.");
  const bool is_constant = p.geoid == GeoidSource::constant;
  v.only_if(is_constant, "geoid", "geoid: constant", [&p](fields::Visitor& keys) {
    keys.number("geoid_separation", p.geoid_separation_m, in("m").between(-120, 100),
                "Height of the geoid above the ellipsoid.");
  });
  v.only_if(!is_constant, "geoid", "geoid: egm96", [&p](fields::Visitor& keys) {
    keys.file("geoid_file", p.geoid_file, fields::FileKind::geoid,
              "GTX grid; empty = EGM96 of the package proj-data.");
    keys.choice("geoid_interpolation", p.geoid_interpolation, kGeoidInterpolations,
                "How the geoid is found between the grid's points.");
  });
}

void visit(fields::Visitor& v, SceneConfiguration& p) {
  v.text("name", p.name, "Name of the scene, for people.");
  v.text("text", p.text, "One line for `rigwire list scenes`.");
  visit(v, p.description);
  v.section("weather", p.weather, "What is in the air, and how it changes.");
  v.section("daylight", p.daylight, "Sky and clouds, as cameras see them.");
}

SceneFiles load_scene_files(const sim::SceneDescription& description,
                            const OriginConfiguration& origin) {
  SceneFiles files;
  files.description = description;
  if (auto* map = std::get_if<sim::HeightMapTerrain>(&files.description.terrain)) {
    try {
      map->heights = load_height_map(*map, {origin.latitude_deg, origin.longitude_deg});
    } catch (const std::invalid_argument& error) {
      throw fields::Refused("scene.terrain.file", error.what());
    }
  }
  files.meshes = load_meshes(description.objects, files.report);
  return files;
}

}  // namespace rigwire::hil
