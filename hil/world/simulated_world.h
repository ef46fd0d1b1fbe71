// The truth source that simulates: machine, scene and sensors of sim/, stepped in slices.
//
// One slice is a whole number of physics steps. Sensors that sample within a step see the motion
// interpolated between the step's ends (sim/link_motion.h); the lidar casts the slice as a whole,
// every laser at its own time; satellites are looked for in the scene as it stands at the end of
// the slice.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil/executive/truth_source.h"
#include "hil/record/lidar_truth_tap.h"
#include "hil/record/truth_tap.h"
#include "sim/encoder/joint_angle.h"
#include "sim/excavator/bucket_soil.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/ground/ground.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"
#include "sim/lidar/lidar_sensor.h"
#include "sim/local_frame.h"
#include "sim/machine.h"
#include "sim/scene/scene.h"
#include "sim/vehicle_sensors/vehicle_sensors.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::hil {

/// Where on the machine a sensor sits.
struct SensorMount {
  std::size_t link = 0;                                    ///< Of the machine's links.
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();  ///< Pose of the sensor in its link.
};

/// A machine, the ground that it stands on, and the scene with its links as moving bodies.
struct MachineInScene {
  std::unique_ptr<sim::Scene> scene;
  sim::Scene::InstanceId terrain = 0;
  std::unique_ptr<sim::Ground> ground;           ///< Outlives the machine.
  std::unique_ptr<sim::FallObstacle> obstacles;  ///< What soil may fall on; outlives the machine.
  std::unique_ptr<sim::Machine> machine;
};

struct WorldSettings {
  Duration step = std::chrono::milliseconds{1};   ///< Of the physics.
  Duration slice = std::chrono::milliseconds{2};  ///< A whole multiple of `step`.
  double gravity_mps2 = 9.80665;                  ///< Along world -z, for the inertial units.
};

class SimulatedWorld final : public TruthSource {
 public:
  /// The scene's bodies must be the machine's links in the machine's order. Throws
  /// std::invalid_argument when slice is not a whole multiple of step.
  SimulatedWorld(const WorldSettings& settings, MachineInScene content,
                 const sim::LocalFrame& frame);

  /// Sensors, by the device whose samples they make.
  void add_gnss(DeviceIndex device, const SensorMount& mount, sim::GnssSensor sensor);
  void add_imu(DeviceIndex device, const SensorMount& mount, sim::ImuSensor sensor,
               std::optional<sim::Magnetometer> magnetometer = std::nullopt);
  /// An encoder that reads link `moving` against link `base`.
  void add_encoder(DeviceIndex device, std::size_t base, std::size_t moving, sim::JointAngle joint);
  void add_lidar(DeviceIndex device, const SensorMount& mount,
                 std::unique_ptr<sim::LidarSensor> sensor, LidarPattern pattern);
  /// Throw std::invalid_argument when the machine has no valve block, or does not drive.
  void add_valves(DeviceIndex device);
  void add_vehicle(DeviceIndex device, sim::VehicleSensors sensors);
  /// What is in the air from now on; without, it is clear.
  void set_weather(std::unique_ptr<sim::SceneWeather> weather);
  /// Records truth every `period`, a whole multiple of the step, to `tap`.
  void set_truth_tap(std::unique_ptr<TruthTap> tap, Duration period);

  /// Records every shot of every lidar, numbered in the order of add_lidar().
  void set_lidar_truth_tap(std::unique_ptr<LidarTruthTap> tap);

  [[nodiscard]] const sim::Scene& scene() const { return *content_.scene; }
  [[nodiscard]] const sim::Machine& machine() const { return *content_.machine; }
  [[nodiscard]] Duration slice() const override { return settings_.slice; }
  std::optional<std::string> advance(const TruthRequests& requests, SampleBatch& batch) override;
  [[nodiscard]] const std::vector<StateQuantity>& state_quantities() const override {
    return state_quantities_;
  }
  [[nodiscard]] TruthStages stages() const override { return stages_; }

 private:
  using Motions = std::vector<sim::LinkMotion>;

  template <class Sensor>
  struct Mounted {
    DeviceIndex device;
    SensorMount mount;
    Sensor sensor;
    SamplePlan plan;
    SimTime next = kNever;  ///< Next instant to sample.

    void replan(const SamplePlan& changed, SimTime frontier);
  };
  struct Unmounted {};
  struct Inertial {
    sim::ImuSensor sensor;
    std::optional<sim::Magnetometer> magnetometer;
  };
  struct Joint {
    std::size_t moving;  ///< Link; the mount's is the base.
    sim::JointAngle angle;
  };
  struct Lidar {
    std::unique_ptr<sim::LidarSensor> sensor;
    LidarPattern pattern;
  };
  /// A navigation epoch that waits until the scene stands as it is at the end of the slice.
  struct DueEpoch {
    Mounted<sim::GnssSensor>* gnss;
    SimTime time;
    sim::LinkMotion motion;
  };

  void apply(const TruthRequests& requests);
  std::optional<std::string> step_machine();
  void sample_step(SimTime t0, SimTime t1, SampleBatch& batch);
  void cast_slice(SampleBatch& batch);
  void read_state(SampleBatch& batch) const;
  void record_truth(SimTime t0, SimTime t1, SimTime time);
  [[nodiscard]] sim::LinkMotion motion_at(const SensorMount& mount, SimTime t0, SimTime t1,
                                          SimTime time) const;

  WorldSettings settings_;
  MachineInScene content_;
  sim::LocalFrame frame_;
  std::vector<Mounted<sim::GnssSensor>> gnss_;
  std::vector<Mounted<Inertial>> imu_;
  std::vector<Mounted<Joint>> encoders_;
  std::vector<Mounted<Lidar>> lidars_;
  std::vector<Mounted<Unmounted>> valves_;
  std::vector<Mounted<sim::VehicleSensors>> vehicles_;
  std::unique_ptr<sim::SceneWeather> weather_;
  std::unique_ptr<LidarTruthTap> lidar_tap_;
  std::vector<sim::LidarBankTruth> lidar_truth_;  ///< Of one lidar's slice.
  std::unique_ptr<TruthTap> tap_;
  Duration tap_period_{0};
  TruthRecord truth_;  ///< Filled anew for every line.
  SimTime next_tap_ = kNever;

  SimTime frontier_ = kStart;
  Motions slice_start_;  ///< At the start of the slice.
  Motions before_;       ///< At the start of the step.
  Motions after_;        ///< At the end of the step.
  std::vector<DueEpoch> due_epochs_;
  std::vector<sim::BodyMotion> bodies_;
  std::vector<StateQuantity> state_quantities_;
  TruthStages stages_;
};

}  // namespace rigwire::hil
