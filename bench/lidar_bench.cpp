#include "bench/lidar_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <variant>

#include "bench/lidar_plan.h"
#include "hil/devices/velodyne.h"
#include "hil/executive/cpu_time.h"
#include "hil/rig/rig.h"
#include "sim/lidar/link_budget.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::bench {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::uint64_t kLidarSeed = 1;
constexpr Duration kRevolution = std::chrono::milliseconds{100};

const hil::VelodyneConfiguration& lidar_of(const hil::RigConfiguration& rig) {
  for (const auto& [name, device] : rig.devices) {
    if (const auto* lidar = fields::as<hil::VelodyneConfiguration>(device)) {
      return *lidar;
    }
  }
  throw std::invalid_argument("the rig has no lidar to measure");
}

/// The rig's machine in its scene, all functions in motion, seen by the rig's lidar.
class MovingMachine {
 public:
  MovingMachine(const hil::RigConfiguration& rig, const hil::SensorMount& mount)
      : built_(hil::build_machine_in_scene(rig)), mount_(mount) {
    if (built_.machine->valve_port() == nullptr) {
      throw std::invalid_argument("the lidar's benchmark moves a machine with a valve block");
    }
    remember_links();
    bodies_.resize(after_.size());
  }
  [[nodiscard]] sim::Scene& scene() { return *built_.scene; }

  /// Moves on by one slice; the functions turn round every second.
  void advance(Duration slice) {
    const SimTime now = built_.machine->time();
    const double sign = std::cos(std::numbers::pi * to_seconds(now)) >= 0.0 ? 1.0 : -1.0;
    ValveCommand command;
    command.opening = {0.6 * sign, 0.4 * sign, 0.5 * sign, -0.5 * sign};
    built_.machine->valve_port()->command(command);
    built_.machine->step(slice);
    std::swap(before_, after_);
    remember_links();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      bodies_[i] = {before_[i].X_WL, after_[i].X_WL};
    }
  }
  void begin_slice(SimTime t0, SimTime t1) {
    built_.scene->begin_slice(t0, t1, after_[mount_.link].X_WL.translation(), bodies_);
  }
  [[nodiscard]] sim::LinkMotion mount_before() const {
    return sim::at_mount(before_[mount_.link], mount_.X_LS);
  }
  [[nodiscard]] sim::LinkMotion mount_after() const {
    return sim::at_mount(after_[mount_.link], mount_.X_LS);
  }

 private:
  void remember_links() {
    const auto links = built_.machine->links();
    after_.assign(links.begin(), links.end());
  }

  hil::MachineInScene built_;
  hil::SensorMount mount_;
  std::vector<sim::LinkMotion> before_;
  std::vector<sim::LinkMotion> after_;
  std::vector<sim::BodyMotion> bodies_;
};

/// CPU seconds of this thread that `work` takes.
template <class Work>
double timed(const Work& work) {
  const double before_s = hil::thread_cpu_seconds();
  work();
  return hil::thread_cpu_seconds() - before_s;
}

sim::LinkMotion mount_at(const Vector3d& p_W) {
  sim::LinkMotion mount;
  mount.X_WL.translation() = p_W;
  return mount;
}

}  // namespace

std::vector<LidarStageCost> measure_lidar_stage(const hil::RigConfiguration& rig,
                                                const std::vector<int>& slices_ms, int rounds) {
  const hil::VelodyneConfiguration& lidar_settings = lidar_of(rig);
  const FiringPlan plan = firing_plan(lidar_settings.lidar);
  std::vector<LidarStageCost> costs;
  for (const int slice_ms : slices_ms) {
    const Duration slice = std::chrono::milliseconds{slice_ms};
    if (slice_ms < 1 || rounds < 1) {
      throw std::invalid_argument(fmt::format(
          "lidar stage: found slices of {} ms and {} rounds, allowed >= 1", slice_ms, rounds));
    }
    MovingMachine machine(rig, hil::sensor_mount(rig.machine, lidar_settings.mount));
    sim::SpinningLidar lidar(lidar_settings.sensor.beam, plan.pattern, plan.plan, plan.command,
                             kLidarSeed, "bench");
    std::vector<LidarFiring> firings;
    std::vector<double> ratios;
    LidarStageCost cost;
    cost.slice_ms = slice_ms;
    cost.instances = machine.scene().instance_count();
    SimTime t0 = kStart;
    std::size_t slices = 0;
    for (int round = 0; round < rounds; ++round) {
      double stage_s = 0.0;
      double bare_s = 0.0;
      for (const SimTime end = t0 + kRevolution; t0 < end; t0 += slice, ++slices) {
        const SimTime t1 = t0 + slice;
        machine.advance(slice);
        cost.begin_slice_s += timed([&] { machine.begin_slice(t0, t1); });
        const sim::LidarSlice stretch{.t0 = t0,
                                      .t1 = t1,
                                      .mount_at_t0 = machine.mount_before(),
                                      .mount_at_t1 = machine.mount_after()};
        sim::RecordedRays recorded = lidar.record(machine.scene(), stretch);
        const auto bare = [&] { recorded.cast_bare(machine.scene()); };
        const auto stage = [&] { lidar.cast(machine.scene(), stretch, nullptr, firings, nullptr); };
        // In turns, because the second one finds the scene in the caches.
        if (slices % 2 == 0) {
          bare_s += timed(bare);
          stage_s += timed(stage);
        } else {
          stage_s += timed(stage);
          bare_s += timed(bare);
        }
        cost.rays += recorded.size();
        cost.hits += recorded.hits();
      }
      cost.stage_s += stage_s;
      cost.bare_s += bare_s;
      ratios.push_back(bare_s / stage_s);
    }
    cost.begin_slice_s /= static_cast<double>(slices);
    std::ranges::sort(ratios);
    cost.ratio = ratios[ratios.size() / 2];
    cost.least_ratio = ratios.front();
    cost.greatest_ratio = ratios.back();
    costs.push_back(cost);
  }
  return costs;
}

std::vector<LidarRangeError> measure_lidar_range_error(const std::vector<double>& map_offsets_m) {
  constexpr double kGround_m = 100.0;
  constexpr double kWall_m = 15.0;
  constexpr double kWallTop_m = 30.0;
  constexpr double kSky_m = 1e9;
  constexpr double kTolerance_m = 0.1;
  constexpr double kYawRate_radps = 1.0;
  const Vector3d velocity(2.0, -1.0, 0.3);
  const FiringPlan plan = firing_plan({});
  const LidarPattern& pattern = plan.pattern;
  std::vector<LidarRangeError> errors;
  for (const double offset : map_offsets_m) {
    const Vector3d centre(offset * std::numbers::sqrt2 / 2.0 + 0.37,
                          -offset * std::numbers::sqrt2 / 2.0 + 0.11, kGround_m);
    sim::Scene scene;
    sim::HeightField ground;
    ground.cell_m = 0.5;
    ground.columns = ground.rows = 401;
    ground.origin_m = centre.head<2>().array() - 100.0;
    ground.heights_m.assign(ground.columns * ground.rows, kGround_m);
    const sim::Material white{.reflectance = 0.9, .label = "white"};
    scene.add_terrain(ground, white);
    Isometry3d X_WM = Isometry3d::Identity();
    X_WM.translation() = centre + Vector3d(kWall_m + 0.5, 0.0, 0.0);
    scene.add_object(scene.add_mesh(sim::make_box("wall", {1.0, 400.0, 2.0 * kWallTop_m})), X_WM,
                     1.0, white);
    sim::SpinningLidar lidar({.range_sigma_m = 0.0}, pattern, plan.plan, plan.command, kLidarSeed,
                             "bench");

    LidarRangeError error;
    error.map_offset_m = offset;
    double squares = 0.0;
    std::vector<LidarFiring> firings;
    const Vector3d p0 = centre + Vector3d(0.0, 0.0, 2.5);
    const auto mount = [&](double t) {
      sim::LinkMotion motion = mount_at(p0 + t * velocity);
      motion.X_WL.linear() =
          Eigen::AngleAxisd(kYawRate_radps * t, Vector3d::UnitZ()).toRotationMatrix();
      motion.v_WL_W = velocity;
      motion.w_WL_W = {0.0, 0.0, kYawRate_radps};
      return motion;
    };
    const Duration slice = std::chrono::milliseconds{5};
    for (SimTime t0 = kStart; t0 < kStart + kRevolution; t0 += slice) {
      const SimTime t1 = t0 + slice;
      scene.begin_slice(t0, t1, p0, {});
      lidar.cast(scene,
                 {.t0 = t0,
                  .t1 = t1,
                  .mount_at_t0 = mount(to_seconds(t0)),
                  .mount_at_t1 = mount(to_seconds(t1))},
                 nullptr, firings, nullptr);
      for (const LidarFiring& firing : firings) {
        for (std::size_t j = 0; j < pattern.lasers.size(); ++j) {
          const LaserGeometry& laser = pattern.lasers[j];
          const double t = to_seconds(firing.time + laser.time_offset);
          const sim::LinkMotion truth = mount(t);
          const double azimuth = plan.command.rotor_rate_radps * t;
          const double horizontal = std::cos(laser.elevation_rad);
          const Vector3d d = truth.X_WL.linear() * Vector3d(horizontal * std::cos(azimuth),
                                                            -horizontal * std::sin(azimuth),
                                                            std::sin(laser.elevation_rad));
          const Vector3d p =
              truth.X_WL.translation() + Vector3d(0.0, 0.0, laser.vertical_offset_m) - centre;
          double range = d.z() < 0.0 ? -p.z() / d.z() : kSky_m;
          double cosine = -d.z();
          const double to_wall = d.x() > 0.0 ? (kWall_m - p.x()) / d.x() : kSky_m;
          if (to_wall < range && p.z() + to_wall * d.z() < kWallTop_m) {
            range = to_wall;
            cosine = d.x();
          }
          // Both surfaces are as white as the target of the maximum range.
          const double limit =
              pattern.maximum_range_m * std::sqrt(sim::incidence_share(std::max(cosine, 0.0)));
          const double found = firing.strongest[j].range_m;
          if (range > limit) {
            error.leaks += found > 0.0 && range > limit + kTolerance_m ? 1U : 0U;
            continue;
          }
          if (range > limit - kTolerance_m) {
            continue;
          }
          ++error.rays;
          if (found == 0.0 || std::abs(found - range) > kTolerance_m) {
            ++error.leaks;
            continue;
          }
          squares += (found - range) * (found - range);
          error.worst_m = std::max(error.worst_m, std::abs(found - range));
        }
      }
    }
    error.rms_m = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(error.rays, 1)));
    errors.push_back(error);
  }
  return errors;
}

}  // namespace rigwire::bench
