// A lidar that stands or turns before a scene of the test's own, for tests of its beams.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/lidar/beam_sampler.h"
#include "sim/lidar/spinning_lidar.h"
#include "sim/weather/weather.h"

namespace rigwire::sim::beam_test {

inline constexpr Duration kFiringPeriod{50'000};
inline constexpr double kHalfPulse_m = 0.5 * 299792458.0 * 5e-9;

/// Lasers at these elevations, all fired at once, 3 x 1.5 mrad wide, 5 ns.
inline LidarPattern head(const std::vector<double>& elevations_rad = {0.0}) {
  LidarPattern pattern;
  for (const double elevation_rad : elevations_rad) {
    pattern.lasers.push_back({.elevation_rad = elevation_rad});
  }
  pattern.firing_period = kFiringPeriod;
  pattern.minimum_range_m = 1.0;
  pattern.maximum_range_m = 100.0;
  pattern.beam = {.horizontal_divergence_rad = 3e-3, .vertical_divergence_rad = 1.5e-3};
  return pattern;
}

/// No noise, and a receiver that sees the faintest part.
inline SpinningLidarParameters exact(int sub_rays) {
  SpinningLidarParameters parameters;
  parameters.range_sigma_m = 0.0;
  parameters.sub_rays = sub_rays;
  parameters.reference_range_m = 1000.0;
  return parameters;
}

inline Material paint(double reflectance, double retro_gain = 0.0) {
  Material material;
  material.reflectance = reflectance;
  material.label = "paint";
  material.retro_gain = retro_gain;
  return material;
}

inline Eigen::Isometry3d at(double x, double y, double z, double yaw_rad = 0.0) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << x, y, z;
  X.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return X;
}

/// An upright board of 20 m height, its face towards the sensor at x, from y0 to y1.
inline Scene::InstanceId add_board(Scene& scene, double x, double y0, double y1,
                                   const Material& material) {
  const auto mesh = scene.add_mesh(make_box("board", {0.01, y1 - y0, 20.0}));
  return scene.add_object(mesh, at(x + 0.005, 0.5 * (y0 + y1), 0.0), 1.0, material);
}

/// Firings from the origin of the world; the rotor stands unless it is told to turn.
class Shooter {
 public:
  Shooter(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
          double rotor_rate_radps = 0.0, bool several = true, std::uint64_t seed = 1)
      : lidar_(parameters, pattern, SamplePlan{kStart + kFiringPeriod, kFiringPeriod},
               command(rotor_rate_radps, several), seed, "lidar") {}

  std::vector<LidarFiring>& shoot(Scene& scene, int firings = 1, const Weather* weather = nullptr) {
    const SimTime end = time_ + firings * kFiringPeriod;
    scene.begin_slice(time_, end, Eigen::Vector3d::Zero(), {});
    lidar_.cast(scene, {time_, end, {}, {}}, weather, firings_, &truth_);
    time_ = end;
    return firings_;
  }
  [[nodiscard]] const std::vector<LidarBankTruth>& truth() const { return truth_; }
  [[nodiscard]] SpinningLidar& lidar() { return lidar_; }

 private:
  static LidarCommand command(double rate_radps, bool several) {
    LidarCommand command;
    command.rotor_rate_radps = rate_radps;
    command.several_echoes = several;
    return command;
  }

  SpinningLidar lidar_;
  SimTime time_ = kStart;
  std::vector<LidarFiring> firings_;
  std::vector<LidarBankTruth> truth_;
};

}  // namespace rigwire::sim::beam_test
