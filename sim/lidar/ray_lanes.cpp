#include "sim/lidar/ray_lanes.h"

#include <cmath>

#include "sim/lidar/counter_noise.h"

namespace rigwire::sim {

void fill_rays(const FiringLanes& firing, const LaserLanes& laser, RTCRay8& ray) {
  const Lanes cosine =
      firing.cos_azimuth() * laser.cos_turn() - firing.sin_azimuth() * laser.sin_turn();
  const Lanes sine =
      firing.sin_azimuth() * laser.cos_turn() + firing.cos_azimuth() * laser.sin_turn();
  const Lanes x_S = laser.cos_elevation() * cosine;
  const Lanes y_S = -laser.cos_elevation() * sine;
  const auto z_S = laser.sin_elevation();
  const auto dt = laser.delay_s();
  const Lanes x = firing.R(0) * x_S + firing.R(3) * y_S + firing.R(6) * z_S;
  const Lanes y = firing.R(1) * x_S + firing.R(4) * y_S + firing.R(7) * z_S;
  const Lanes z = firing.R(2) * x_S + firing.R(5) * y_S + firing.R(8) * z_S;
  // The sensor has turned and moved on since the firing's first laser.
  LanesOut{ray.dir_x} = x + dt * (firing.w(1) * z - firing.w(2) * y);
  LanesOut{ray.dir_y} = y + dt * (firing.w(2) * x - firing.w(0) * z);
  LanesOut{ray.dir_z} = z + dt * (firing.w(0) * y - firing.w(1) * x);
  LanesOut{ray.org_x} = firing.p(0) + dt * firing.v(0) + laser.offset_m() * firing.R(6);
  LanesOut{ray.org_y} = firing.p(1) + dt * firing.v(1) + laser.offset_m() * firing.R(7);
  LanesOut{ray.org_z} = firing.p(2) + dt * firing.v(2) + laser.offset_m() * firing.R(8);
  LanesOut{ray.time} = (firing.time() + laser.delay_share()).min(1.0F);
}

Lanes gaussian_lanes(std::uint64_t key, const std::array<std::uint64_t, kLanes>& shots) {
  std::array<double, kLanes> p{};
  Lanes q;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    p[lane] = counter_uniform(key, shots[lane]);
    q(static_cast<Eigen::Index>(lane)) = static_cast<float>(p[lane] - 0.5);
  }
  Lanes value = central_normal_quantile<float>(q);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (std::abs(p[lane] - 0.5) > kCentralHalfWidth) {
      value(static_cast<Eigen::Index>(lane)) = static_cast<float>(normal_quantile(p[lane]));
    }
  }
  return value;
}

}  // namespace rigwire::sim
