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
#include "sim/contact/closest.h"
#include "sim/contact/loose_bodies.h"

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

sim::ConvexShape solid_of(const BoxShape& box) {
  return sim::ConvexShape::box(0.5 * Eigen::Vector3d(box.size_m.x, box.size_m.y, box.size_m.z));
}

struct Deepest {
  std::string body;
  std::string in = "the ground or an obstacle";
  double depth_m = 0.0;

  void take(std::string_view name, double found_m, std::string_view what) {
    if (found_m > depth_m) {
      body = name;
      in = what;
      depth_m = found_m;
    }
  }
  /// `stands`: the point may be in the ground.
  void look(const sim::Ground& ground, std::string_view name, const Eigen::Vector3d& p_W,
            bool stands = false) {
    const auto here = ground.penetration(p_W);
    if (here && !stands) {
      take(name, here->depth_m, "the ground or an obstacle");
    }
    constexpr double kPoint_m = 1e-3;
    look_at_loose(ground, name, sim::ConvexShape::sphere(kPoint_m),
                  Eigen::Isometry3d(Eigen::Translation3d(p_W)));
  }
  void look_at_loose(const sim::Ground& ground, std::string_view name,
                     const sim::ConvexShape& shape, const Eigen::Isometry3d& X_WS) {
    const sim::LooseBodies* loose = ground.loose();
    for (std::size_t i = 0; loose != nullptr && i < loose->size(); ++i) {
      const sim::Mover& mover = loose->movers()[i];
      const double apart_m = (mover.X_WM.translation() - X_WS.translation()).norm();
      if (apart_m < shape.reach_m() + mover.shape->reach_m()) {
        const sim::Separation found =
            sim::separation({&shape, X_WS}, {mover.shape, mover.X_WM}, 0.0);
        take(name, -found.gap_m, fmt::format("'{}', which lies loose", loose->name(i)));
      }
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
    if (link == links.end()) {
      continue;
    }
    const Eigen::Isometry3d X_WS =
        machine.links()[static_cast<std::size_t>(link - links.begin())].X_WL *
        pose(shape.placed.position_m, shape.placed.rotation);
    if (const auto* box = std::get_if<BoxShape>(&shape.placed.shape)) {
      deepest.look_at_loose(ground, *link, solid_of(*box), X_WS);
    }
    const bool stands = std::ranges::find(standing, *link) != standing.end();
    for (const Eigen::Vector3d& p_S :
         std::visit([](const auto& one) { return surface_of(one); }, shape.placed.shape)) {
      deepest.look(ground, *link, X_WS * p_S, stands);
    }
  }
  if (deepest.depth_m > kDeepestStart_m) {
    throw fields::Refused("machine",
                          fmt::format("starts with its {} {:.1f} cm deep in {}, "
                                      "allowed a position and a posture that are free",
                                      deepest.body, 100.0 * deepest.depth_m, deepest.in));
  }
}

}  // namespace rigwire::hil
