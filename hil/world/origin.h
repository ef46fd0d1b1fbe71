// Where a rig stands on Earth: the origin of its world frame, and the geoid there.
#pragma once

#include <array>
#include <string>

#include "fields/visitor.h"
#include "sim/geoid.h"

namespace rigwire::hil {

enum class GeoidSource { constant, egm96 };
inline constexpr std::array<fields::Choice<GeoidSource>, 2> kGeoidSources{
    {{GeoidSource::constant, "constant", "One separation over the whole scene."},
     {GeoidSource::egm96, "egm96", "Looked up in a grid at every point."}}};
inline constexpr std::array<fields::Choice<sim::GeoidInterpolation>, 2> kGeoidInterpolations{
    {{sim::GeoidInterpolation::bilinear, "bilinear", "As most programs do."},
     {sim::GeoidInterpolation::bicubic, "bicubic", "Nearer to the model."}}};

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

inline void visit(fields::Visitor& v, OriginConfiguration& p) {
  v.number("latitude", p.latitude_deg, fields::in("deg").stored_as("deg").between(-90, 90),
           "WGS 84, north positive.");
  v.number("longitude", p.longitude_deg, fields::in("deg").stored_as("deg").between(-180, 180),
           "WGS 84, east positive.");
  v.number("height", p.height_m, fields::in("m").between(-1000, 10000), "Above the ellipsoid.");
  v.choice("geoid", p.geoid, kGeoidSources, "Receivers report heights above it.");
  if (p.geoid == GeoidSource::constant) {
    v.number("geoid_separation", p.geoid_separation_m, fields::in("m").between(-120, 100),
             "Geoid above the ellipsoid.");
    v.refused("geoid_file", "the geoid is constant; a file needs `geoid: egm96`");
    v.refused("geoid_interpolation", "the geoid is constant; a grid needs `geoid: egm96`");
  } else {
    v.refused("geoid_separation", "the geoid comes from a grid; a number needs `geoid: constant`");
    v.file("geoid_file", p.geoid_file, "GTX grid; empty = EGM96 of the package proj-data.");
    v.choice("geoid_interpolation", p.geoid_interpolation, kGeoidInterpolations,
             "Between the grid's points.");
  }
}

}  // namespace rigwire::hil
