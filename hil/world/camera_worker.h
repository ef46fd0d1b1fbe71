// Renders pictures beside the loop: one worker for each camera, on a thread of its own.
//
// The content of a picture is fixed when its exposure is over: where camera and bodies were, dug
// ground, dust, where everything fixed was placed. All of it goes into a job, so that the live
// scene can continue; the worker renders the job in a twin of that scene (sim/scene/scene.h), which
// shares meshes and everything fixed with it. A second complete scene would cost a scene's memory
// for each camera; rays can be cast into the live one only while it does not change.
//
// Jobs are done in the order in which they came. A picture depends on its job, on the dug ground of
// the jobs before it, and on nothing else: neither on how fast the worker is, nor on its threads.
//
// The thread has a lower priority than the rest of the program, so that on a busy machine pictures
// wait, and wires do not.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hil/world/camera_surroundings.h"
#include "hil/world/dug_ground.h"
#include "sim/camera/camera_sensor.h"
#include "sim/scene/scene.h"
#include "sim/weather/dust_cloud.h"

namespace rigwire::hil {

struct CameraJob {
  /// The shot but for light, air, sky and wetness, which the worker adds. Empty: no picture, only
  /// preparation.
  std::optional<sim::CameraShot> shot;
  SimTime begin{};  ///< Start of the twin's slice, which spans the exposure.
  SimTime end{};
  SimTime due{};  ///< When the picture is wanted.
  sim::ScenePlacement placement;
  std::vector<sim::BodyMotion> bodies;
  std::optional<DugGround> dug;  ///< Ground dug since the job before.
  std::optional<sim::DustCloud> dust;
  bool with_truth = false;  ///< Compute the picture's ground truth, too.
};

class CameraWorker {
 public:
  using MakeSensor = std::function<std::unique_ptr<sim::CameraSensor>()>;
  using Number = std::uint64_t;  ///< Number of a job, from 0.
  struct Made {
    sim::CameraSensor::Taken taken;  ///< Null picture: it was skipped, or failed.
    sim::CameraTruth truth;          ///< Empty unless the job wanted it.
  };

  /// Has a twin of the scene made, whose first terrain is `terrain`, and calls `make` on the
  /// worker's thread; throws what they throw. `surroundings` are shared by all cameras of a rig.
  CameraWorker(const sim::Scene& scene, sim::Scene::InstanceId terrain,
               std::shared_ptr<CameraSurroundings> surroundings, const MakeSensor& make);
  ~CameraWorker();
  CameraWorker(const CameraWorker&) = delete;
  CameraWorker& operator=(const CameraWorker&) = delete;

  /// Never waits.
  Number submit(CameraJob job);
  /// Sets how far simulated time has come. `paced`: skips jobs that cannot be done in time, judged
  /// by the duration of the last one, and only when another job has kept the worker busy.
  void reach(SimTime now, bool paced);
  /// Returns the result of a job; nullopt: not yet. To be called once for each job.
  [[nodiscard]] std::optional<Made> take(Number job);
  /// Waits for the result of a job and returns it.
  [[nodiscard]] Made wait(Number job);
  /// Returns whether the worker has begun the job.
  [[nodiscard]] bool begun(Number job) const;
  /// Discards a job; take() must not be called for it again.
  void forget(Number job);
  /// Returns why a job failed, the first one.
  [[nodiscard]] std::optional<std::string> fault() const;

  [[nodiscard]] const sim::CameraSensor& sensor() const { return *sensor_; }

 private:
  struct Entry {
    CameraJob job;
    bool waited = false;     ///< The job waited for the worker.
    bool forgotten = false;  ///< Forgotten before it was done.
    std::optional<Made> made;
  };

  void run();
  [[nodiscard]] Made make_picture(CameraJob& job);
  void make_ready(const CameraJob& job);
  [[nodiscard]] Entry& entry(Number job) { return *entries_[job - first_]; }
  void drop_front();

  std::unique_ptr<sim::Scene> scene_;
  sim::Scene::InstanceId terrain_;
  std::shared_ptr<CameraSurroundings> surroundings_;
  std::unique_ptr<sim::CameraSensor> sensor_;

  // Used on the worker's thread.
  std::optional<sim::Daylight> light_;
  SimTime light_until_{};
  std::shared_ptr<const sim::SkyVisibility> sky_;
  SimTime sky_made_{};
  bool dug_since_ = false;

  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::condition_variable done_;
  std::deque<std::unique_ptr<Entry>> entries_;
  Number first_ = 0;  ///< Number of the first job in entries_.
  Number next_ = 0;   ///< Number of the next job to do.
  bool busy_ = false;
  bool paced_ = false;
  SimTime now_{};
  Duration last_cost_{0};  ///< Simulated time that the last picture took.
  std::optional<std::string> fault_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace rigwire::hil
