#include "hil/world/scene_fall_obstacle.h"

namespace rigwire::hil {

bool SceneFallObstacle::catches(const Eigen::Vector3d& from_W, double terrain_m) const {
  constexpr double kClear_m = 0.1;  // The rays' terrain lags behind the one that is dug.
  const double reach_m = from_W.z() - terrain_m - kClear_m;
  const auto now = scene_.slice_end();
  if (!now || !(reach_m > 0.0)) {
    return false;
  }
  std::uint32_t mask = sim::Scene::kSeeEverything;
  for (sim::Scene::BodyId body = 0; body < scene_.body_count(); ++body) {
    mask &= ~sim::Scene::body_mask(body);
  }
  return scene_.cast(from_W, -Eigen::Vector3d::UnitZ(), 0.0, reach_m, *now, mask).has_value();
}

}  // namespace rigwire::hil
