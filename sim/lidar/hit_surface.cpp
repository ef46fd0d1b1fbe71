#include "sim/lidar/hit_surface.h"

#include <algorithm>

namespace rigwire::sim {

SurfaceLanes surfaces_of(const Scene::Internals& scene, const RTCRayHit8& packet) {
  SurfaceLanes result;
  const unsigned instance = packet.hit.instID[0][0];
  const bool one_surface =
      instance != RTC_INVALID_GEOMETRY_ID &&
      std::ranges::all_of(packet.hit.instID[0], [&](unsigned other) { return other == instance; });
  if (one_surface) {
    const Scene::Internals::Shading& surface = scene.shading[instance];
    const LanesIn x(packet.hit.Ng_x);
    const LanesIn y(packet.hit.Ng_y);
    const LanesIn z(packet.hit.Ng_z);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      result.normal_W[i] =
          surface.R_WM(row, 0) * x + surface.R_WM(row, 1) * y + surface.R_WM(row, 2) * z;
    }
    result.reflectance.setConstant(surface.reflectance);
    result.retro_gain.setConstant(surface.retro_gain);
    result.any_retro = surface.retro_gain > 0.0F;
    return result;
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<Eigen::Index>(lane);
    if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
      result.normal_W[0](i) = result.normal_W[1](i) = result.normal_W[2](i) = 1.0F;
      result.reflectance(i) = 0.0F;
      result.retro_gain(i) = 0.0F;
      continue;
    }
    const Scene::Internals::Shading& surface = scene.shading[packet.hit.instID[0][lane]];
    const Eigen::Vector3f n_W =
        surface.R_WM *
        Eigen::Vector3f(packet.hit.Ng_x[lane], packet.hit.Ng_y[lane], packet.hit.Ng_z[lane]);
    result.normal_W[0](i) = n_W.x();
    result.normal_W[1](i) = n_W.y();
    result.normal_W[2](i) = n_W.z();
    result.reflectance(i) = surface.reflectance;
    result.retro_gain(i) = surface.retro_gain;
    result.any_retro = result.any_retro || surface.retro_gain > 0.0F;
  }
  return result;
}

Lanes cosine_of_incidence(const SurfaceLanes& surface, const RTCRayHit8& packet) {
  const std::array<Lanes, 3>& n = surface.normal_W;
  const Lanes along = n[0] * LanesIn{packet.ray.dir_x} + n[1] * LanesIn{packet.ray.dir_y} +
                      n[2] * LanesIn{packet.ray.dir_z};
  const Lanes length = (n[0].square() + n[1].square() + n[2].square()).sqrt();
  return along.abs() / length;
}

}  // namespace rigwire::sim
