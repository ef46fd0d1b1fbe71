#include "sim/camera/painted_looks.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace rigwire::sim {
namespace {

/// Lower limit of the cosine of the angle of incidence; it bounds a footprint's length at grazing
/// incidence.
constexpr float kLeastCosine = 1e-3F;

}  // namespace

Shade painted(Shade label, const MeshColour& colour) {
  label.one = {colour.factor[0], colour.factor[1], colour.factor[2]};
  label.two = label.one;
  if (colour.texture) {
    label.grain = label.relief = label.variation = label.stones = 0.0F;
    label.panes = {};
  }
  return label;
}

void paint(const PaintedSurface& surface, const float* X, const RTCRayHit8& rays, float pixel_rad,
           std::size_t lane, MetSurfaces& met) {
  const auto& triangle = surface.triangles[rays.hit.primID[lane]];
  const Eigen::Map<const Eigen::Matrix3f> linear(X);
  const Eigen::Vector3f n(met.gx[lane], met.gy[lane], met.gz[lane]);
  const Eigen::Vector3f d(rays.ray.dir_x[lane], rays.ray.dir_y[lane], rays.ray.dir_z[lane]);
  // The footprint's axes on the surface: as wide as the pixel across, longer by the slant along.
  const Eigen::Vector3f side = d.cross(n);
  const float sine = side.norm();
  const Eigen::Vector3f across = sine > 1e-4F ? Eigen::Vector3f(side / sine) : n.unitOrthogonal();
  const Eigen::Vector3f along = n.cross(across);
  const float wide_m = met.range_m[lane] * pixel_rad;
  const float long_m = wide_m / std::max(std::abs(n.dot(d)), kLeastCosine);
  // Into the mesh, and there by the gradients into the texture: an even scale is a column's length.
  const float per_square = 1.0F / linear.col(0).squaredNorm();
  const Eigen::Vector3f across_M = linear.transpose() * across * (per_square * wide_m);
  const Eigen::Vector3f along_M = linear.transpose() * along * (per_square * long_m);
  const Eigen::Map<const Eigen::Vector3f> grad_u(triangle.grad_u.data());
  const Eigen::Map<const Eigen::Vector3f> grad_v(triangle.grad_v.data());
  const TextureFootprint seen{grad_u.dot(across_M), grad_v.dot(across_M), grad_u.dot(along_M),
                              grad_v.dot(along_M)};
  const float a = rays.hit.u[lane];
  const float b = rays.hit.v[lane];
  const auto& c = triangle.corners;
  const MeshColour& colour = *surface.colour;
  const std::array<float, 3> albedo = colour.texture->mean(
      c[0] + a * c[2] + b * c[4], c[1] + a * c[3] + b * c[5], seen, colour.edge_u, colour.edge_v);
  met.red[lane] = met.red2[lane] = colour.factor[0] * albedo[0];
  met.green[lane] = met.green2[lane] = colour.factor[1] * albedo[1];
  met.blue[lane] = met.blue2[lane] = colour.factor[2] * albedo[2];
}

}  // namespace rigwire::sim
