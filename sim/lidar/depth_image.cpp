#include "sim/lidar/depth_image.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/lidar/ray_lanes.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

constexpr double kGreatest24 = 16777215.0;

}  // namespace

DepthImage::DepthImage(const DepthImageGeometry& geometry, std::size_t camera,
                       const DepthImageParameters& parameters, double far_m)
    : width_px_(geometry.width_px()),
      height_px_(geometry.height_px()),
      axes_(geometry.axes(camera)),
      focal_px_(geometry.focal_px()),
      top_px_(geometry.top_px()),
      near_m_(parameters.near_plane_m),
      far_m_(far_m),
      format_(parameters.depth),
      inverse_depth_(width_px_ * height_px_, 0.0F),
      surface_(width_px_ * height_px_, kNothing) {
  for (std::vector<float>& component : normal_S_) {
    component.assign(width_px_ * height_px_, 0.0F);
  }
}

float DepthImage::stored(float depth_m) const {
  if (format_ == DepthFormat::reversed_float) {
    return static_cast<float>(near_m_) / depth_m / static_cast<float>(near_m_);
  }
  // Depth buffer of 24 bits: levels even in 1 / z between the two planes.
  const double span = 1.0 / near_m_ - 1.0 / far_m_;
  const double share = (1.0 / near_m_ - 1.0 / static_cast<double>(depth_m)) / span;
  const double level = std::round(std::clamp(share, 0.0, 1.0) * kGreatest24);
  return static_cast<float>(1.0 / near_m_ - level / kGreatest24 * span);
}

void DepthImage::set(std::size_t pixel, float inverse_depth, std::uint32_t surface,
                     const Eigen::Vector3f& normal_S) {
  inverse_depth_[pixel] = inverse_depth;
  surface_[pixel] = surface;
  for (std::size_t i = 0; i < 3; ++i) {
    normal_S_[i][pixel] = normal_S(static_cast<Eigen::Index>(i));
  }
}

std::size_t DepthImage::render_row(const Scene& scene, const DepthImageView& view, std::size_t row,
                                   ColumnRange columns) {
  const FlushDenormals flush;
  const Scene::Internals& in = scene.internals();
  const Eigen::Matrix3d R_WS = view.X_WS.linear();
  const Eigen::Matrix3f R_SW = R_WS.transpose().cast<float>();
  const Eigen::Vector3f p = (view.X_WS.translation() - in.origin_W).cast<float>();
  const double v = top_px_ - static_cast<double>(row) - 0.5;
  // Pinhole: forward + (u / f) right + (v / f) up, v once per row.
  const Eigen::Vector3d in_row = R_WS * (axes_.forward_S + (v / focal_px_) * axes_.up_S);
  const Eigen::Vector3d along_row = R_WS * axes_.right_S;

  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(32) std::array<int, kLanes> valid{};
  RTCRayHit8 packet;
  for (std::size_t first = columns.first; first < columns.last; first += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t column = std::min(first + lane, columns.last - 1);
      valid[lane] = first + lane < columns.last ? -1 : 0;
      const double u = static_cast<double>(column) + 0.5 - 0.5 * static_cast<double>(width_px_);
      // The direction has planar depth 1, so that the ray's length is planar depth too.
      const Eigen::Vector3d direction = in_row + (u / focal_px_) * along_row;
      packet.ray.org_x[lane] = p.x();
      packet.ray.org_y[lane] = p.y();
      packet.ray.org_z[lane] = p.z();
      packet.ray.dir_x[lane] = static_cast<float>(direction.x());
      packet.ray.dir_y[lane] = static_cast<float>(direction.y());
      packet.ray.dir_z[lane] = static_cast<float>(direction.z());
      packet.ray.tnear[lane] = static_cast<float>(near_m_);
      packet.ray.tfar[lane] = static_cast<float>(far_m_);
      packet.ray.time[lane] = view.time;
      packet.ray.mask[lane] = view.mask;
      packet.ray.id[lane] = 0;
      packet.ray.flags[lane] = 0;
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    in.intersect(valid.data(), context, packet);
    const std::size_t count = std::min(kLanes, columns.last - first);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const std::size_t pixel = index(first + lane, row);
      const std::uint32_t surface =
          surface_number(packet.hit.instID[0][lane], packet.hit.geomID[lane]);
      if (surface == RTC_INVALID_GEOMETRY_ID) {
        inverse_depth_[pixel] = 0.0F;
        surface_[pixel] = kNothing;
        continue;
      }
      const Eigen::Vector3f n_W =
          in.shading[surface].R_WM *
          Eigen::Vector3f(packet.hit.Ng_x[lane], packet.hit.Ng_y[lane], packet.hit.Ng_z[lane]);
      set(pixel, stored(packet.ray.tfar[lane]), surface, (R_SW * n_W).normalized());
    }
  }
  return columns.last - columns.first;
}

}  // namespace rigwire::sim
