// Geoid grids from files in NOAA's GTX format (vdatum), as PROJ ships EGM96.
//
// The format, everything big endian: latitude and longitude of the south-western point, steps of
// latitude and longitude (four doubles, degrees), rows, columns (two 32-bit integers), then the
// heights in metres as floats, row after row from south to north, each from west to east.
#pragma once

#include <filesystem>
#include <memory>

#include "sim/geoid.h"

namespace rigwire::hil {

/// EGM96 at every 15 minutes, of the Debian package proj-data.
inline constexpr const char* kEgm96File = "/usr/share/proj/egm96_15.gtx";

/// Throws std::invalid_argument naming the file and what is wrong with it, and the package to
/// install when it is kEgm96File that is missing.
[[nodiscard]] std::shared_ptr<const sim::GeoidGrid> load_geoid(
    const std::filesystem::path& file,
    sim::GeoidInterpolation interpolation = sim::GeoidInterpolation::bilinear);

}  // namespace rigwire::hil
