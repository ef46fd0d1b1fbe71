#include "hil/world/standing_free.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fields/check.h"
#include "hil/files/mesh_file.h"

namespace rigwire::hil {
namespace {

constexpr double kSpacing_m = 0.25;
constexpr double kMostPerEdge = 40.0;

/// Points all over a box's surface, in its own frame.
std::vector<Eigen::Vector3d> surface_of(const BoxShape& box) {
  const Eigen::Array3d size_m(box.size_m.x, box.size_m.y, box.size_m.z);
  const Eigen::Array3d steps = (size_m / kSpacing_m).ceil().min(kMostPerEdge).max(1.0);
  std::vector<Eigen::Vector3d> points;
  for (double x = 0.0; x <= steps.x(); ++x) {
    for (double y = 0.0; y <= steps.y(); ++y) {
      const bool side = x == 0.0 || x == steps.x() || y == 0.0 || y == steps.y();
      for (double z = 0.0; z <= steps.z(); z += side ? 1.0 : steps.z()) {
        points.emplace_back((size_m * (Eigen::Array3d(x, y, z) / steps - 0.5)).matrix());
      }
    }
  }
  return points;
}

std::vector<Eigen::Vector3d> surface_of(const MeshShape& shape) {
  const sim::TriangleMesh mesh = load_mesh(shape.file, shape.file);
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    points.emplace_back(vertex.cast<double>() * shape.scale);
  }
  return points;
}

struct Deepest {
  std::string body;
  sim::Penetration found;

  void look(const sim::Ground& ground, std::string_view name, const Eigen::Vector3d& p_W) {
    const auto here = ground.penetration(p_W);
    if (here && here->depth_m > found.depth_m) {
      body = name;
      found = *here;
    }
  }
};

}  // namespace

void require_on_terrain(const MachineConfiguration& configuration,
                        const sim::HeightField& terrain) {
  const Eigen::Array2d place_m(configuration.position_m.x, configuration.position_m.y);
  const Eigen::Array2d least_m = terrain.origin_m.array();
  const Eigen::Array2d extent_m =
      terrain.cell_m * Eigen::Array2d(static_cast<double>(terrain.columns) - 1.0,
                                      static_cast<double>(terrain.rows) - 1.0);
  const Eigen::Array2d greatest_m = least_m + extent_m;
  if ((place_m < least_m).any() || (place_m > greatest_m).any()) {
    throw fields::Refused(
        "machine.position",
        fmt::format("not on the scene's terrain, found [{:.10g} m, {:.10g} m], allowed {:.10g} .. "
                    "{:.10g} m east, {:.10g} .. {:.10g} m north",
                    place_m.x(), place_m.y(), least_m.x(), greatest_m.x(), least_m.y(),
                    greatest_m.y()));
  }
}

void require_standing_free(const MachineConfiguration& configuration, const sim::Machine& machine,
                           const sim::Ground& ground) {
  if (const std::string trouble = machine.unsteady_start(); !trouble.empty()) {
    throw fields::Refused("machine", "cannot stand where it is put: " + trouble);
  }
  Deepest deepest;
  for (const sim::BodyPoint& point : machine.body_points()) {
    deepest.look(ground, point.body, point.p_W);
  }
  const auto links = machine.link_names();
  const auto standing = configuration.model->standing_links();
  for (const LinkShape& shape : configuration.shapes) {
    const auto link = std::ranges::find(links, std::string_view(shape.link));
    if (link == links.end() || std::ranges::find(standing, *link) != standing.end()) {
      continue;
    }
    const Eigen::Isometry3d X_WS =
        machine.links()[static_cast<std::size_t>(link - links.begin())].X_WL *
        pose(shape.placed.position_m, shape.placed.rotation);
    for (const Eigen::Vector3d& p_S :
         std::visit([](const auto& one) { return surface_of(one); }, shape.placed.shape)) {
      deepest.look(ground, *link, X_WS * p_S);
    }
  }
  if (deepest.found.depth_m > kDeepestStart_m) {
    throw fields::Refused(
        "machine", fmt::format("starts with its {} {:.1f} cm deep in the ground or an obstacle, "
                               "allowed a position and a posture that are free",
                               deepest.body, 100.0 * deepest.found.depth_m));
  }
}

}  // namespace rigwire::hil
