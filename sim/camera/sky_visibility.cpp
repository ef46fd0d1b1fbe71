#include "sim/camera/sky_visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "sim/lidar/counter_noise.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

constexpr std::array<float, SkyVisibility::kHeights> kHeights_m{0.3F, 3.0F, 10.0F};
/// A node of the lattice.
using Four = float __attribute__((vector_size(16)));
constexpr double kLeastCell_m = 1.0;
constexpr float kFarthest_m = 80.0F;
constexpr int kMostNodes = 96;
/// Dug ground is among what moves; bodies are there as well.
const std::uint32_t kFixed = surface_mask(Material{}, Scene::Internals::kFixed) |
                             Scene::foliage_mask() | Scene::loose_leaves_mask();

}  // namespace

SkyVisibility::SkyVisibility(const Scene& scene) {
  const Scene::Internals& in = scene.internals();
  if (in.terrains.empty()) {
    return;
  }
  const HeightField& field = in.terrains.front().field;
  const double width_m = field.cell_m * static_cast<double>(field.columns - 1);
  const double depth_m = field.cell_m * static_cast<double>(field.rows - 1);
  const double cell_m = std::max(kLeastCell_m, std::max(width_m, depth_m) / (kMostNodes - 1));
  origin_m_ = field.origin_m;
  per_m_ = static_cast<float>(1.0 / cell_m);
  columns_ = std::max(2, static_cast<int>(width_m / cell_m) + 1);
  rows_ = std::max(2, static_cast<int>(depth_m / cell_m) + 1);
  nodes_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));

  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);  // incoherent: see camera_renderer.cpp
  alignas(32) std::array<int, kLanes> valid;
  valid.fill(-1);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const std::size_t number =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
          static_cast<std::size_t>(column);
      const double x_m = field.origin_m.x() + column * cell_m;
      const double y_m = field.origin_m.y() + row * cell_m;
      Node& node = nodes_[number];
      node.ground_m = static_cast<float>(field.height_m(x_m, y_m));
      for (std::size_t height = 0; height < kHeights_m.size(); ++height) {
        const Eigen::Vector3f p = (Eigen::Vector3d(x_m, y_m,
                                                   static_cast<double>(node.ground_m) +
                                                       static_cast<double>(kHeights_m[height])) -
                                   in.origin_W)
                                      .cast<float>();
        const double turn = counter_uniform(number, height);
        int open = 0;
        for (int first = 0; first < kRays; first += static_cast<int>(kLanes)) {
          alignas(32) RTCRay8 rays{};
          for (std::size_t i = 0; i < kLanes; ++i) {
            // By the golden angle; equal areas of the unit disc are equal shares of the light.
            const double place = (first + static_cast<double>(i) + 0.5) / kRays;
            const double angle = 2.0 * std::numbers::pi *
                                 (turn + (first + static_cast<double>(i)) * std::numbers::phi);
            const double across = std::sqrt(place);
            rays.org_x[i] = p.x();
            rays.org_y[i] = p.y();
            rays.org_z[i] = p.z();
            rays.dir_x[i] = static_cast<float>(across * std::cos(angle));
            rays.dir_y[i] = static_cast<float>(across * std::sin(angle));
            rays.dir_z[i] = static_cast<float>(std::sqrt(1.0 - place));
            rays.tnear[i] = 0.0F;
            rays.tfar[i] = kFarthest_m;
            rays.time[i] = 0.0F;
            rays.mask[i] = kFixed;
          }
          rtcOccluded8(valid.data(), in.fixed.get(), &context, &rays);
          if (in.ground_moves) {
            rtcOccluded8(valid.data(), in.moving.get(), &context, &rays);
          }
          for (std::size_t i = 0; i < kLanes; ++i) {
            open += rays.tfar[i] >= 0.0F ? 1 : 0;
          }
        }
        node.share[height] = static_cast<float>(open) / kRays;
      }
    }
  }
}

float SkyVisibility::at(float x_m, float y_m, float z_m) const {
  LaneArray x, y, z, share;
  x.fill(x_m);
  y.fill(y_m);
  z.fill(z_m);
  at(x, y, z, Eigen::Vector3f::Zero(), share);
  return share[0];
}

RIGWIRE_WIDE_VECTORS void SkyVisibility::at(const LaneArray& x_m, const LaneArray& y_m,
                                            const LaneArray& z_m, const Eigen::Vector3f& offset_m,
                                            LaneArray& share) const {
  if (nodes_.empty()) {
    share.fill(1.0F);
    return;
  }
  LaneArray a, b;
  alignas(32) std::array<int, kLanes> first;
  const float offset_x = offset_m.x();
  const float offset_y = offset_m.y();
  const float offset_z = offset_m.z();
  const float last_x = static_cast<float>(columns_ - 1) - 1e-3F;
  const float last_y = static_cast<float>(rows_ - 1) - 1e-3F;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    float x = (x_m[i] + offset_x) * per_m_;
    float y = (y_m[i] + offset_y) * per_m_;
    x = choose(x > 0.0F, x, 0.0F);
    y = choose(y > 0.0F, y, 0.0F);
    x = x < last_x ? x : last_x;
    y = y < last_y ? y : last_y;
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    a[i] = x - static_cast<float>(column);
    b[i] = y - static_cast<float>(row);
    first[i] = row * columns_ + column;
  }
  // Between the four nodes around; a node's numbers lie beside each other.
  alignas(32) std::array<Node, kLanes> between;
  for (std::size_t i = 0; i < kLanes; ++i) {
    std::array<Four, 4> corner;
    std::memcpy(corner.data(), nodes_.data() + first[i], 2 * sizeof(Node));
    std::memcpy(corner.data() + 2, nodes_.data() + first[i] + columns_, 2 * sizeof(Node));
    const Four south = corner[0] + a[i] * (corner[1] - corner[0]);
    const Four north = corner[2] + a[i] * (corner[3] - corner[2]);
    const Four here = south + b[i] * (north - south);
    std::memcpy(&between[i], &here, sizeof(Node));
  }
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Node& n = between[i];
    const float h = z_m[i] + offset_z - n.ground_m;
    const float low = clamp_to_one((h - kHeights_m[0]) * (1.0F / (kHeights_m[1] - kHeights_m[0])));
    const float high = clamp_to_one((h - kHeights_m[1]) * (1.0F / (kHeights_m[2] - kHeights_m[1])));
    share[i] = n.share[0] + low * (n.share[1] - n.share[0]) + high * (n.share[2] - n.share[1]);
  }
}

}  // namespace rigwire::sim
