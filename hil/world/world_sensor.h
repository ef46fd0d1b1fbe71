// A sensor in the simulated world. A kind of sensor is a pair of files in this folder: a
// WorldSensor around the model in sim/ and the function that makes it. Nothing else in the bridge
// knows a kind: its samples leave on the shelf of its station, its device's sample plan and
// commands arrive there.
//
// In each slice the world calls take() of all sensors; then, for each physics step, step() of all
// in the order in which they were added; then slice(), first of those that cast rays for every
// beam, then of the others, in that same order. Within one kind the order is thus that of the rig.
// Between kinds the order changes no sample: machine and scene do not change while sensors read
// them, every shelf has one sensor only, and no sensor sees what another one made or drew, but that
// satellite receivers note where their antennas are (sim/gnss/antenna_book.h) for each other.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/executive/shelves.h"
#include "sim/link_motion.h"
#include "sim/samples/time.h"
#include "sim/scene/node_rectangle.h"

namespace rigwire::sim {
class Scene;
class SceneWeather;
struct HeightField;
}  // namespace rigwire::sim

namespace rigwire::hil {

class CameraTruthObserver;
class LidarTruthObserver;
struct TruthRecord;

/// Where a sensor is mounted on the machine.
struct SensorMount {
  std::size_t link = 0;                                    ///< Index of the machine's link.
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();  ///< Pose of the sensor in its link.
};

/// Motions of all bodies of the scene at one instant: the machine's links, and after them what lies
/// loose on the ground.
using LinkMotions = std::span<const sim::LinkMotion>;

/// One step of the physics, for sensors that measure within it. The machine itself is in its state
/// at t1.
struct WorldStep {
  SimTime t0{};
  SimTime t1{};
  LinkMotions links_at_t0;
  LinkMotions links_at_t1;
  double gravity_mps2 = 0.0;  ///< Along world -z.

  /// Interpolated between the step's ends (sim/link_motion.h). Precondition: t0 <= time <= t1.
  [[nodiscard]] sim::LinkMotion motion(const SensorMount& mount, SimTime time) const;
};

/// One slice, for sensors that measure when its last step is done.
struct WorldSlice {
  SimTime t0{};
  SimTime t1{};
  LinkMotions links_at_t0;
  LinkMotions links_at_t1;
  const sim::Scene& scene;                      ///< Ready for the rays of sensors that use it.
  const sim::SceneWeather* weather = nullptr;   ///< Null: clear air.
  LidarTruthObserver* lidar_truth = nullptr;    ///< Null: no observer.
  CameraTruthObserver* camera_truth = nullptr;  ///< Null: no observer.
  const sim::HeightField* ground = nullptr;     ///< Ground at t1; null: it never changes.
  std::optional<sim::NodeRectangle> dug;        ///< Area that has changed in this slice.
  /// Time follows a clock: the slice does not wait for what is computed beside the run.
  bool paced = false;
};

class WorldSensor {
 public:
  WorldSensor() = default;
  virtual ~WorldSensor() = default;
  WorldSensor(const WorldSensor&) = delete;
  WorldSensor& operator=(const WorldSensor&) = delete;

  /// Takes the device's requests, which act from `frontier`, the end of the last slice, on.
  virtual void take(SimTime frontier, const Shelves& requests) = 0;
  /// Takes samples in (t0, t1], and at the very start also that of t0. Every shelf is filled in
  /// order of time.
  virtual void step(const WorldStep& /*step*/, Shelves& /*samples*/) {}
  /// Called when the last step of the slice is done.
  virtual void slice(const WorldSlice& /*slice*/, Shelves& /*samples*/) {}
  /// Whether slice() is called first, and its time counted as ray casting.
  [[nodiscard]] virtual bool casts_beams() const { return false; }
  /// Returns whether slice() will cast rays into the scene itself; called when the last step is
  /// done. If no sensor does, moving bodies are not placed for rays.
  [[nodiscard]] virtual bool looks_at_scene() const { return true; }
  /// Adds the ground truth of the sensor at `time` within the step that is no property of the
  /// machine.
  virtual void tell(const WorldStep& /*step*/, SimTime /*time*/, TruthRecord& /*truth*/) const {}
  /// Returns why it failed, which ends the run.
  [[nodiscard]] virtual std::optional<std::string> fault() const { return std::nullopt; }
};

/// The instants at which a station's device wants to be sampled.
class PlannedInstants {
 public:
  explicit PlannedInstants(StationIndex station) : station_(station) {}

  /// Follows the newest plan among the requests. At the very start the instant 0 itself is still
  /// open.
  void take(SimTime frontier, const Shelves& requests);
  /// kNever without a plan.
  [[nodiscard]] SimTime next() const { return next_; }
  void pass() { next_ = plan_.next_after(next_); }

 private:
  StationIndex station_;
  SamplePlan plan_;
  SimTime next_ = kNever;
};

/// A sensor that measures within physics steps, whenever its device's plan wants it to.
template <class Sample>
class StepSensor : public WorldSensor {
 public:
  void take(SimTime frontier, const Shelves& requests) override {
    instants_.take(frontier, requests);
  }
  [[nodiscard]] bool looks_at_scene() const final { return false; }

  void step(const WorldStep& step, Shelves& samples) final {
    if (instants_.next() > step.t1) {
      return;
    }
    std::vector<Sample>& shelf = samples.of<Sample>(station_);
    for (; instants_.next() <= step.t1; instants_.pass()) {
      shelf.push_back(measure(step, instants_.next()));
    }
  }

 protected:
  explicit StepSensor(StationIndex station) : station_(station), instants_(station) {}
  [[nodiscard]] StationIndex station() const { return station_; }

 private:
  /// In order of time.
  virtual Sample measure(const WorldStep& step, SimTime time) = 0;

  StationIndex station_;
  PlannedInstants instants_;
};

}  // namespace rigwire::hil
