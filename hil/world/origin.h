// Where a rig stands on Earth: the origin of its world frame, and the geoid there.
#pragma once

#include <string>

#include "fields/rules.h"
#include "sim/geoid.h"

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

}  // namespace rigwire::hil
