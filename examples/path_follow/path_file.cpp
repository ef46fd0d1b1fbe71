#include "path_follow/path_file.h"

#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace rigwire::path_follow {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r";
  const std::size_t begin = text.find_first_not_of(kSpace);
  return begin == std::string_view::npos
             ? std::string_view{}
             : text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

bool read_degrees(std::string_view text, double limit, double& value) {
  text = trimmed(text);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value >= -limit &&
         value <= limit;
}

}  // namespace

PathFile parse_path(std::string_view text, const std::string& name) {
  PathFile path;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    ++number;
    if (line.empty() || line.front() == '#') {
      continue;
    }
    if (line == "closed") {
      path.closed = true;
      continue;
    }
    const std::size_t comma = line.find(',');
    field::LatLon point;
    if (comma == std::string_view::npos ||
        !read_degrees(line.substr(0, comma), 90.0, point.latitude_deg) ||
        !read_degrees(line.substr(comma + 1), 180.0, point.longitude_deg)) {
      throw std::invalid_argument(name + ":" + std::to_string(number) + ": found '" +
                                  std::string(line) +
                                  "', allowed: latitude,longitude in degrees, closed, # comment");
    }
    path.points.push_back(point);
  }
  if (path.points.size() < 2) {
    throw std::invalid_argument(name + ": has " + std::to_string(path.points.size()) +
                                " points, allowed: at least 2");
  }
  return path;
}

PathFile load_path(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw std::invalid_argument("path file " + file + ": cannot be read");
  }
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_path(text.str(), file);
}

field::Polyline to_polyline(const PathFile& path, const field::LocalPlane& plane) {
  std::vector<field::PlanePosition> points;
  points.reserve(path.points.size());
  for (const field::LatLon& point : path.points) {
    points.push_back(plane.to_plane(point));
  }
  return {std::move(points), path.closed};
}

}  // namespace rigwire::path_follow
