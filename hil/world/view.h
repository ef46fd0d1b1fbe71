// Changes in the looks of a scene while it runs, for viewers: ground that is dug, loose bodies that
// are pushed, trees that lean, the air. sim::contents_of() gives the state at the start.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "hil/world/dug_ground.h"
#include "hil/world/world_sensor.h"
#include "sim/scene/scene_contents.h"

namespace rigwire::hil {

/// Air that dims distant objects.
struct AirView {
  double rain_mmph = 0.0;
  double snow_mmph = 0.0;
  /// Extinction of all but dust at the lidar's wavelength, where fog is densest, 1/m.
  double extinction_pm = 0.0;
  struct Puff {
    Eigen::Vector3d centre_W = Eigen::Vector3d::Zero();
    double sigma_m = 0.0;
    double depth = 0.0;  ///< Optical, one way through its middle.

    friend bool operator==(const Puff&, const Puff&) = default;
  };
  std::vector<Puff> dust;

  friend bool operator==(const AirView&, const AirView&) = default;
};

struct ViewChange {
  SimTime time{};
  std::optional<DugGround> dug;
  struct Body {
    std::size_t body = 0;  ///< Index of the body in the scene.
    Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  };
  std::vector<Body> moved;  ///< Loose bodies that have moved since the change before.
  /// All things that have left their place, when any of them has moved.
  std::vector<sim::DisplacedThing> displaced;
  std::optional<AirView> air;

  [[nodiscard]] bool changes_the_scene() const {
    return dug || !moved.empty() || !displaced.empty();
  }
};

/// Returns a sensor that calls `told`, on the thread of the truth, with what has changed, at most
/// once per `period`, and not when nothing has changed. It draws no random number and changes no
/// sample. `links`: bodies of the machine, which are the scene's first and are not reported.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_view(std::size_t links, Duration period,
                                                           std::function<void(ViewChange)> told);

}  // namespace rigwire::hil
