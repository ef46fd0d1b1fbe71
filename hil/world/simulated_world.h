// The truth source that simulates: machine, scene and sensors of sim/, stepped in slices.
//
// One slice is a whole number of physics steps. Sensors that sample within a step see the motion
// interpolated between the step's ends; those that use the scene see its state at the end of the
// slice. The world knows no kind of sensor (hil/world/world_sensor.h has the order in which they
// are called).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil/executive/truth_source.h"
#include "hil/world/hand.h"
#include "hil/world/quantities.h"
#include "hil/world/truth_observer.h"
#include "hil/world/world_sensor.h"
#include "sim/machine.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {
class FallObstacle;
class Ground;
class SceneWeather;
}  // namespace rigwire::sim

namespace rigwire::hil {

/// A machine, the ground that it stands on, and the scene with its links as moving bodies.
struct MachineInScene {
  MachineInScene();
  ~MachineInScene();
  MachineInScene(MachineInScene&&) noexcept;
  MachineInScene& operator=(MachineInScene&&) noexcept;

  std::unique_ptr<sim::Scene> scene;
  sim::Scene::InstanceId terrain = 0;
  std::unique_ptr<sim::Ground> ground;  ///< Outlives the machine.
  /// Obstacles to falling soil; outlives the machine.
  std::unique_ptr<sim::FallObstacle> obstacles;
  std::unique_ptr<sim::Machine> machine;
  std::vector<sim::ObstacleLook> looks;  ///< Looks of the ground's obstacles that may give way.
};

struct WorldSettings {
  Duration step = std::chrono::milliseconds{1};   ///< Step of the physics.
  Duration slice = std::chrono::milliseconds{2};  ///< A whole multiple of `step`.
  double gravity_mps2 = 9.80665;                  ///< Along world -z, for the inertial units.
};

class SimulatedWorld final : public TruthSource {
 public:
  /// The scene's bodies must be the machine's links in the machine's order, then what lies loose
  /// on the ground. Throws std::invalid_argument when slice is not a whole multiple of step.
  SimulatedWorld(const WorldSettings& settings, MachineInScene content);
  ~SimulatedWorld() override;
  SimulatedWorld(SimulatedWorld&&) noexcept;

  void add(std::unique_ptr<WorldSensor> sensor);
  /// Sets what is in the air from now on; without a call the air is clear.
  void set_weather(std::unique_ptr<sim::SceneWeather> weather);
  [[nodiscard]] bool has_weather() const { return weather_ != nullptr; }
  /// Adds an observer that receives the truth every `period`, a whole multiple of the step.
  void add_truth_observer(std::unique_ptr<TruthObserver> observer, Duration period);
  /// Sets the observer that receives every shot of every lidar.
  void set_lidar_truth_observer(std::unique_ptr<LidarTruthObserver> observer);
  /// Sets the observer that receives the pictures that it wants.
  void set_camera_truth_observer(std::unique_ptr<CameraTruthObserver> observer);

  [[nodiscard]] const sim::Scene& scene() const { return *content_.scene; }
  /// Returns the terrain, in which the machine may dig.
  [[nodiscard]] sim::Scene::InstanceId terrain() const { return content_.terrain; }
  /// For sensors at its ports; lives as long as the world, also when that is moved.
  [[nodiscard]] sim::Machine& machine() { return *content_.machine; }
  /// Returns the manual override of the machine; lives as long as the world, also when that is
  /// moved.
  [[nodiscard]] Hand& hand() { return *hand_; }
  [[nodiscard]] Duration slice() const override { return settings_.slice; }
  void begin(bool paced) override { paced_ = paced; }
  std::optional<std::string> advance(const TruthRequests& requests, SampleBatch& batch) override;
  [[nodiscard]] const std::vector<StateQuantity>& state_quantities() const override {
    return state_quantities_;
  }
  [[nodiscard]] TruthStages stages() const override { return stages_; }

 private:
  std::optional<std::string> step_machine();
  void sample_step(const WorldStep& step, Shelves& samples);
  void prepare_scene(SimTime t0, SimTime t1);
  void show_leaning();
  /// Copies the motions of the machine's links, and after them of loose things.
  void copy_motions(std::vector<sim::LinkMotion>& to) const;
  void sample_slice(SimTime t0, SimTime t1, Shelves& samples);
  void fill_truth(const WorldStep& step, SimTime time);

  WorldSettings settings_;
  MachineInScene content_;
  std::vector<std::unique_ptr<WorldSensor>> sensors_;
  std::unique_ptr<sim::SceneWeather> weather_;
  std::unique_ptr<LidarTruthObserver> lidar_observer_;
  struct Told {
    std::unique_ptr<TruthObserver> observer;
    Duration period{0};
    SimTime next = kNever;
  };
  std::vector<Told> told_;
  std::unique_ptr<CameraTruthObserver> camera_observer_;
  std::unique_ptr<Hand> hand_;
  TruthRecord truth_;  ///< Filled anew each time.

  SimTime frontier_ = kStart;
  bool paced_ = false;
  std::optional<sim::NodeRectangle> dug_;     ///< In the present slice.
  std::vector<sim::LinkMotion> slice_start_;  ///< At the start of the slice.
  std::vector<sim::LinkMotion> before_;       ///< At the start of the step.
  std::vector<sim::LinkMotion> after_;        ///< At the end of the step.
  std::vector<sim::BodyMotion> bodies_;
  /// Angles of the machine's leaning obstacles in the scene.
  std::vector<double> shown_rad_;
  std::vector<StateQuantity> state_quantities_;
  std::vector<double> state_;  ///< For fill_truth(), in the order of the quantities.
  TruthStages stages_;
};

}  // namespace rigwire::hil
