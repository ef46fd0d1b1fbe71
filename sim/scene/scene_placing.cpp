// Where things are in a slice of time: the part of Scene that tells Embree.
#include <array>
#include <stdexcept>
#include <string>

#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

/// Column-major 3x4, the form that Embree takes.
using Transform = std::array<float, 12>;

Transform to_transform(const Eigen::Isometry3d& X_WM, double scale,
                       const Eigen::Vector3d& origin_W) {
  const Eigen::Matrix3d linear = scale * X_WM.linear();
  const Eigen::Vector3d translation = X_WM.translation() - origin_W;
  Transform transform{};
  for (std::size_t column = 0; column < 3; ++column) {
    for (std::size_t row = 0; row < 3; ++row) {
      transform[column * 3 + row] = static_cast<float>(
          linear(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)));
    }
  }
  for (std::size_t row = 0; row < 3; ++row) {
    transform[9 + row] = static_cast<float>(translation(static_cast<Eigen::Index>(row)));
  }
  return transform;
}

void set_transform(RTCGeometry geometry, const Transform& transform) {
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
  rtcCommitGeometry(geometry);
}

}  // namespace

void Scene::Internals::place_fixed() {
  for (const Placed& thing : placed) {
    if (thing.body == kFixed) {
      set_transform(thing.geometry.get(), to_transform(thing.X_PM, thing.scale, origin_W));
    }
  }
  for (const Terrain& terrain : terrains) {
    const Placed& thing = placed_of(terrain.instance);
    for (const Tile& tile : terrain.tiles) {
      set_transform(tile.placed.get(), to_transform(thing.X_PM, thing.scale, origin_W));
    }
  }
  rtcCommitScene(fixed.get());
  if (has_canopy) {
    rtcCommitScene(canopy.get());
  }
  fixed_placed = true;
}

void Scene::Internals::place_bodies(std::span<const BodyMotion> motions) {
  for (const std::uint32_t index : on_bodies) {
    const Placed& thing = placed[index];
    const BodyMotion& motion = motions[thing.body];
    const Transform start = to_transform(motion.X_WB_start * thing.X_PM, thing.scale, origin_W);
    const Transform end = to_transform(motion.X_WB_end * thing.X_PM, thing.scale, origin_W);
    RTCGeometry geometry = thing.geometry.get();
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, start.data());
    rtcSetGeometryTransform(geometry, 1, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, end.data());
    rtcCommitGeometry(geometry);
    shading[thing.geometry_id].R_WM =
        (motion.X_WB_end.linear() * thing.X_PM.linear()).cast<float>();
  }
}

void Scene::begin_slice(SimTime t0, SimTime t1, const Eigen::Vector3d& focus_W,
                        std::span<const BodyMotion> motions) {
  Internals& in = *internals_;
  if (motions.size() != in.bodies.size()) {
    throw std::invalid_argument("scene: " + std::to_string(motions.size()) + " motions for " +
                                std::to_string(in.bodies.size()) + " bodies");
  }
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (!motions[i].X_WB_start.matrix().allFinite() || !motions[i].X_WB_end.matrix().allFinite()) {
      throw std::invalid_argument("scene: the pose of body '" + in.bodies[i] + "' is not finite");
    }
  }
  if (t1 <= t0 || !focus_W.allFinite()) {
    throw std::invalid_argument("scene: a slice needs t0 < t1 and a finite focus");
  }
  in.t0 = t0;
  in.t1 = t1;
  if ((focus_W - in.origin_W).norm() > kRebaseDistance_m) {
    in.origin_W = focus_W.array().round();
    in.fixed_placed = false;
  }
  if (!in.fixed_placed) {
    in.place_fixed();
  }
  in.refresh_terrains();
  in.place_bodies(motions);
  rtcCommitScene(in.moving.get());
  in.check("placing the bodies");
}

}  // namespace rigwire::sim
