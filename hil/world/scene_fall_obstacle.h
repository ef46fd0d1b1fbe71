// What soil that is poured out may fall on: the fixed objects of the scene, found by a ray.
#pragma once

#include "sim/excavator/bucket_soil.h"
#include "sim/scene/scene.h"

namespace rigwire::hil {

/// A truck's box catches what falls into it; the machine's own links do not.
class SceneFallObstacle final : public sim::FallObstacle {
 public:
  /// `scene` must outlive it. Nothing is caught before the scene's first slice.
  explicit SceneFallObstacle(const sim::Scene& scene) : scene_(scene) {}

  [[nodiscard]] bool catches(const Eigen::Vector3d& from_W, double terrain_m) const override;

 private:
  const sim::Scene& scene_;
};

}  // namespace rigwire::hil
