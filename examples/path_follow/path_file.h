// Paths as files: one point a line, "latitude,longitude" in degrees; lines that begin with # and
// empty ones are skipped. The word "closed" on a line of its own joins the last point to the first.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "field/geometry.h"

namespace rigwire::path_follow {

struct PathFile {
  std::vector<field::LatLon> points;
  bool closed = false;
};

/// Throws std::invalid_argument naming `name`, the line, what was found and what is allowed.
[[nodiscard]] PathFile parse_path(std::string_view text, const std::string& name);
/// Throws std::invalid_argument also when the file cannot be read.
[[nodiscard]] PathFile load_path(const std::string& file);

/// The path in the plane.
[[nodiscard]] field::Polyline to_polyline(const PathFile& path, const field::LocalPlane& plane);

}  // namespace rigwire::path_follow
