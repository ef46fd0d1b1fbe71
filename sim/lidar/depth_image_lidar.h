// A spinning lidar made of depth images, as in simulators that have only a renderer: virtual
// cameras around the spin axis render the scene at one instant, and each shot is a place in one of
// their images (Wolf et al. 2020, Algorithm 2; choices: depth_image_parameters.h, mapping:
// depth_image_geometry.h, between pixels: depth_image_lookup.h).
//
// It cannot, whatever the parameters, separate echoes (there is one surface per pixel, so at most
// one echo per shot), widen the beam, or resolve motion within an image. Bodies and sensor are at
// rest from one image to the next: with one image per revolution of T seconds and a relative speed
// v, the last shots are off by v T. Error on fixed planes with the exact rules: below 0.1 mm within
// 100 m; without interpolation about r^2 / (h f) for ground seen from height h, f the focal length
// in pixels. Compared with rays by `rigwire bench lidar` (docs/accuracy/depth-images.md).
//
// Firing clock, azimuths, noise, losses, echo limit, reflectivity and weather are those of
// SpinningLidar with one ray per beam (echo_model.h).
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/lidar/depth_image_parameters.h"
#include "sim/lidar/echo_model.h"
#include "sim/lidar/lidar_parameters.h"
#include "sim/lidar/lidar_sensor.h"
#include "sim/lidar/rotor.h"
#include "sim/samples/lidar_sample.h"
#include "sim/weather/weather.h"

namespace rigwire::sim {

class DepthImageLidar final : public LidarSensor {
 public:
  /// Takes what SpinningLidar's constructor takes; housing_radius_m and echo_separation_m of
  /// `receiver` are not used. Throws std::invalid_argument for bad parameters, for sub-rays or
  /// blooming, which an image cannot give, and for a pattern that DepthImageGeometry refuses or
  /// that has no firing plan or range window.
  DepthImageLidar(const DepthImageParameters& parameters, const SpinningLidarParameters& receiver,
                  const LidarPattern& pattern, const SamplePlan& plan, const LidarCommand& command,
                  std::uint64_t seed, std::string_view name, const RotorParameters& rotor = {});
  ~DepthImageLidar() override;

  void command(SimTime time, const LidarCommand& command) override;

  /// Renders when the rotor enters the next part of its revolution, at the instant of the first
  /// firing there, or when an image is kLongestAge old because the rotor is slow or at rest. The
  /// truth comes from one ray for each shot, at the shot's own instant, at the cost of that ray.
  void cast(const Scene& scene, const LidarSlice& slice, const Weather* weather,
            std::vector<LidarFiring>& firings, std::vector<LidarBankTruth>* truth) override;

  /// Pixels rendered so far.
  [[nodiscard]] std::uint64_t rays() const override { return pixels_; }

  /// Longer than a revolution at 300 rpm.
  static constexpr Duration kLongestAge = std::chrono::milliseconds{250};

 private:
  struct State;
  struct Pending;
  [[nodiscard]] bool outdated(const Pending& next) const;
  void render(const Scene& scene, const LidarSlice& slice, const Pending& first);
  void answer(const Scene& scene, const Weather* weather, const Pending& pending,
              std::vector<LidarFiring>& firings) const;
  [[nodiscard]] WeatherBeam weather_beam(const Pending& pending, std::size_t laser) const;
  void answer_truly(const Scene& scene, const LidarSlice& slice, const Pending& pending,
                    std::vector<LidarBankTruth>& truth) const;

  DepthImageParameters parameters_;
  LidarPattern pattern_;
  SamplePlan plan_;
  LidarCommand command_;
  Rotor rotor_;
  EchoModel echo_model_;
  bool compensates_incidence_;
  std::uint64_t air_key_;
  std::uint64_t pixels_ = 0;
  std::unique_ptr<State> state_;
};

}  // namespace rigwire::sim
