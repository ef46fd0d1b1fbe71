// Interface of all simulations of a spinning lidar: rays (spinning_lidar.h), or depth images of
// virtual cameras (depth_image_lidar.h). Users of the firings need not know which.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/link_motion.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/time.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

class Weather;

/// The stretch of time to be measured, and the sensor's frame S at both of its ends.
struct LidarSlice {
  SimTime t0{};
  SimTime t1{};
  LinkMotion mount_at_t0;
  LinkMotion mount_at_t1;
  std::uint32_t mask = Scene::kSeeEverything;
};

/// What is true of one laser shot, along the middle of its beam.
struct LidarShotTruth {
  float range_m = 0.0F;          ///< Exact range of the first surface; 0: nothing within reach.
  std::uint32_t instance = ~0U;  ///< Scene::InstanceId of that surface; ~0: none.
  float cosine_of_incidence = 0.0F;
};

/// Beside the LidarFiring of the same index.
using LidarBankTruth = std::array<LidarShotTruth, kBankLasers>;

class LidarSensor {
 public:
  virtual ~LidarSensor() = default;

  /// Applies from `time` on; `time` must not decrease from call to call, nor lie before the last
  /// slice's end.
  virtual void command(SimTime time, const LidarCommand& command) = 0;

  /// All firings whose first laser is in (t0, t1], in order, bank by bank, replacing what `firings`
  /// held. The scene must be prepared for the slice (Scene::begin_slice). `weather` null: clear
  /// air. `truth` not null: filled with one entry per firing. Firings outside the commanded view,
  /// or with the laser off, are there with empty returns.
  virtual void cast(const Scene& scene, const LidarSlice& slice, const Weather* weather,
                    std::vector<LidarFiring>& firings, std::vector<LidarBankTruth>* truth) = 0;

  /// Rays cast so far.
  [[nodiscard]] virtual std::uint64_t rays() const = 0;

 protected:
  LidarSensor() = default;
  LidarSensor(const LidarSensor&) = default;
  LidarSensor& operator=(const LidarSensor&) = default;
};

}  // namespace rigwire::sim
