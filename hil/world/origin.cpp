#include "hil/world/origin.h"

#include <array>

#include "fields/visitor.h"

namespace rigwire::hil {

using fields::in;

namespace {

constexpr std::array<fields::Choice<GeoidSource>, 2> kGeoidSources{
    {{GeoidSource::constant, "constant", "One separation over the whole scene."},
     {GeoidSource::egm96, "egm96", "Looked up in a grid at every point."}}};
constexpr std::array<fields::Choice<sim::GeoidInterpolation>, 2> kGeoidInterpolations{
    {{sim::GeoidInterpolation::bilinear, "bilinear", "As most programs do."},
     {sim::GeoidInterpolation::bicubic, "bicubic", "Nearer to the model."}}};

}  // namespace

void visit(fields::Visitor& v, OriginConfiguration& p) {
  v.number("latitude", p.latitude_deg, in("deg").stored_as("deg").between(-90, 90),
           "WGS 84, north positive.");
  v.number("longitude", p.longitude_deg, in("deg").stored_as("deg").between(-180, 180),
           "WGS 84, east positive.");
  v.number("height", p.height_m, in("m").between(-1000, 10000), "Height above the ellipsoid.");
  v.choice("geoid", p.geoid, kGeoidSources, "Receivers report heights above it.");
  if (p.geoid == GeoidSource::constant) {
    v.number("geoid_separation", p.geoid_separation_m, in("m").between(-120, 100),
             "Height of the geoid above the ellipsoid.");
    v.refused("geoid_file", "the geoid is constant; a file needs `geoid: egm96`");
    v.refused("geoid_interpolation", "the geoid is constant; a grid needs `geoid: egm96`");
  } else {
    v.refused("geoid_separation", "the geoid comes from a grid; a number needs `geoid: constant`");
    v.file("geoid_file", p.geoid_file, "GTX grid; empty = EGM96 of the package proj-data.");
    v.choice("geoid_interpolation", p.geoid_interpolation, kGeoidInterpolations,
             "How the geoid is found between the grid's points.");
  }
}

}  // namespace rigwire::hil
