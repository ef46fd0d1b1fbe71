// The scene of a rig: sim/scene/scene_description.h with a name and its weather, as
// configs/scenes/*.yaml fill it, and what it names by file. World frame W: x east, y north, z up,
// its origin at the rig's `origin`.
#pragma once

#include <string>
#include <vector>

#include "fields/rules.h"
#include "sim/camera/daylight.h"
#include "sim/geoid.h"
#include "sim/scene/scene_description.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::hil {

enum class GeoidSource { constant, egm96 };

/// Where the origin of the world frame W lies on Earth (WGS 84).
struct OriginConfiguration {
  double latitude_deg = 49.4247;
  double longitude_deg = 7.7517;
  double height_m = 240.0;  ///< Above the ellipsoid.
  GeoidSource geoid = GeoidSource::constant;
  double geoid_separation_m = 48.0;  ///< Geoid above the ellipsoid there; constant only.
  std::string geoid_file;            ///< GTX; empty = EGM96 of the package proj-data.
  sim::GeoidInterpolation geoid_interpolation = sim::GeoidInterpolation::bilinear;
};
void visit(fields::Visitor& v, OriginConfiguration& p);

struct SceneConfiguration {
  std::string name = "scene";
  std::string text;  ///< One line for `rigwire list scenes`.
  /// Each object's `mesh` is the full path of a file (hil/files/mesh_file.h).
  sim::SceneDescription description;
  sim::WeatherParameters weather;
  sim::DaylightParameters daylight;
};
void visit(fields::Visitor& v, SceneConfiguration& p);

/// The arguments of sim::build_scene().
struct SceneFiles {
  sim::SceneDescription description;  ///< With the heights of its height map.
  std::vector<sim::TriangleMesh> meshes;
  std::vector<std::string> report;  ///< Lines for people: what was left out of the files.
};

/// Throws std::invalid_argument as load_model() (hil/files/mesh_file.h) and load_height_map()
/// (hil/files/height_map_file.h).
[[nodiscard]] SceneFiles load_scene_files(const sim::SceneDescription& description,
                                          const OriginConfiguration& origin);

}  // namespace rigwire::hil
