#include "hil/world/camera.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "hil/world/dug_ground.h"
#include "hil/world/truth_observer.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::hil {
namespace {

/// More than these are not kept waiting for the worker, for each holds its dust and its ground.
/// Paced, what is late by then is late for good; free-running, the run waits for the first of them.
constexpr std::ptrdiff_t kMostWaiting = 16;

class WorldCamera final : public WorldSensor {
 public:
  WorldCamera(StationIndex station, const WorldCameraSettings& settings, const sim::Scene& scene,
              sim::Scene::InstanceId terrain, std::shared_ptr<CameraSurroundings> surroundings,
              const CameraWorker::MakeSensor& make)
      : station_(station),
        settings_(settings),
        instants_(station),
        automatic_(settings.auto_exposure, {settings.auto_exposure.shortest, 0.0}),
        worker_(scene, terrain, std::move(surroundings), make) {
    if (!settings.sees_own_link) {
      mask_ &= ~sim::Scene::body_mask(static_cast<sim::Scene::BodyId>(settings.mount.link));
    }
  }

  void take(SimTime frontier, const Shelves& requests) override {
    instants_.take(frontier, requests);
    if (const auto* plans = requests.find<SamplePlan>(station_); plans && !plans->empty()) {
      period_ = plans->back().first == kNever ? Duration::max() : plans->back().period;
    }
    if (const auto* commands = requests.find<CameraCommand>(station_)) {
      for (const CameraCommand& command : *commands) {
        follow(frontier, command);
      }
    }
  }

  void step(const WorldStep& step, Shelves& /*samples*/) override {
    while (true) {
      const SimTime planned = instants_.next();
      const SimTime triggered = triggered_.empty() ? kNever : triggered_.front();
      const SimTime start = std::min(planned, triggered);
      if (start > step.t1) {
        break;
      }
      if (triggered <= planned) {
        triggered_.pop_front();
      } else {
        instants_.pass();
      }
      expose(step, start);
    }
    for (Exposure& exposure : open_) {
      if (exposure.job.shot->poses.back().time < step.t1) {
        exposure.job.shot->poses.push_back({step.t1, step.motion(settings_.mount, step.t1)});
      }
      if (!exposure.over && exposure.job.end <= step.t1) {
        bodies_at(step, exposure.job.end, &sim::BodyMotion::X_WB_end, exposure.job.bodies);
        exposure.over = true;
      }
    }
  }

  /// The worker casts its rays into a scene of its own.
  [[nodiscard]] bool looks_at_scene() const override { return false; }
  void slice(const WorldSlice& slice, Shelves& samples) override {
    paced_ = slice.paced;
    worker_.reach(slice.t1, slice.paced);
    dug_.follow(slice);
    prepare(slice);
    while (!open_.empty() && open_.front().over) {
      submit(slice, std::move(open_.front()));
      open_.pop_front();
    }
    measure();
    hand_over(slice, samples);
  }

  [[nodiscard]] std::optional<std::string> fault() const override {
    const auto fault = worker_.fault();
    return fault ? std::optional("camera: " + *fault) : std::nullopt;
  }

 private:
  struct Exposure {
    CameraJob job;
    std::uint64_t number = 0;
    bool over = false;
    bool no_room = false;  ///< Its memory is full; reported as skipped.
    bool exposure_free = false;
    bool gain_free = false;
    sim::AutoExposure::Choice fixed;  ///< Fixed exposure or gain of those that are not automatic.
  };
  /// A picture on its way.
  struct Pending {
    SimTime start{};
    SimTime due{};
    std::uint64_t number = 0;  ///< Number of the exposure.
    bool with_truth = false;
    /// Its job; empty: not tried, or already taken.
    std::optional<CameraWorker::Number> job;
    CameraWorker::Made made;
    // What automatic exposure needs of it, in the order of exposures.
    bool exposure_free = false;
    bool gain_free = false;
    sim::AutoExposure::Choice fixed;
  };

  /// Room in the memory.
  struct Kept {
    SimTime due{};
    std::size_t bytes = 0;
  };

  void follow(SimTime frontier, const CameraCommand& command) {
    const std::uint32_t triggers = command.software_triggers - command_.software_triggers;
    const bool restarts =
        command.exposure != command_.exposure || command.exposure_auto != command_.exposure_auto ||
        command.gain_db != command_.gain_db || command.gain_auto != command_.gain_auto;
    command_ = command;
    if (restarts) {
      automatic_ = sim::AutoExposure(settings_.auto_exposure, {command.exposure, command.gain_db});
      unmeasured_ = 0;
      for (Pending& pending : pending_) {
        pending.exposure_free = pending.gain_free = false;
      }
      for (Exposure& exposure : open_) {
        exposure.exposure_free = exposure.gain_free = false;
      }
    }
    for (std::uint32_t i = 0; i < triggers; ++i) {
      const SimTime after = triggered_.empty() ? ready_ : triggered_.back() + command.exposure;
      triggered_.push_back(std::max(frontier, after));
    }
  }

  /// How long and how bright, where the camera chooses for itself.
  sim::AutoExposure::Choice choose() {
    const sim::AutoExposure::Choice fixed{command_.exposure, command_.gain_db};
    if (!command_.exposure_auto && !command_.gain_auto) {
      return fixed;
    }
    // What the next picture is taken with is known once that `lag` pictures before is measured.
    while (unmeasured_ >= automatic_.known()) {
      measure_first(!paced_);
    }
    sim::AutoExposure::Choice choice = automatic_.next(unmeasured_++);
    choice.exposure =
        command_.exposure_auto ? std::min(choice.exposure, period_) : command_.exposure;
    choice.gain_db = command_.gain_auto ? choice.gain_db : command_.gain_db;
    return choice;
  }

  void expose(const WorldStep& step, SimTime start) {
    const sim::AutoExposure::Choice choice = choose();
    Exposure exposure;
    exposure.number = frame_++;
    exposure.exposure_free = command_.exposure_auto;
    exposure.gain_free = command_.gain_auto;
    exposure.fixed = {command_.exposure, command_.gain_db};
    sim::CameraShot& shot = exposure.job.shot.emplace();
    shot.command = command_;
    shot.exposure = choice.exposure;
    shot.gain_db = choice.gain_db;
    shot.frame = exposure.number;
    shot.start = start;
    shot.mask = mask_;
    shot.poses.push_back({start, step.motion(settings_.mount, start)});
    exposure.job.begin = start;
    exposure.job.end = start + worker_.sensor().span(command_, choice.exposure);
    last_due_ = std::max(last_due_, exposure.job.end + settings_.processing);
    exposure.job.due = last_due_;
    exposure.no_room = !keep(start, {last_due_, picture_bytes(command_)});
    exposure.job.bodies.resize(step.links_at_t0.size());
    bodies_at(step, start, &sim::BodyMotion::X_WB_start, exposure.job.bodies);
    ready_ = start + choice.exposure;
    open_.push_back(std::move(exposure));
  }

  /// Whether a picture that is exposed at `start` has room until it is due.
  bool keep(SimTime start, const Kept& picture) {
    while (!kept_.empty() && kept_.front().due <= start) {
      kept_bytes_ -= kept_.front().bytes;
      kept_.pop_front();
    }
    if (!kept_.empty() && kept_bytes_ + picture.bytes > settings_.memory_bytes) {
      return false;
    }
    kept_bytes_ += picture.bytes;
    kept_.push_back(picture);
    return true;
  }

  static void bodies_at(const WorldStep& step, SimTime time, Eigen::Isometry3d sim::BodyMotion::*at,
                        std::vector<sim::BodyMotion>& bodies) {
    for (std::size_t link = 0; link < bodies.size(); ++link) {
      bodies[link].*at = step.motion({link, Eigen::Isometry3d::Identity()}, time).X_WL;
    }
  }

  /// What can be made ready before the first exposure.
  void prepare(const WorldSlice& slice) {
    if (std::exchange(prepared_, true)) {
      return;
    }
    CameraJob job;
    job.begin = slice.t0;
    job.end = slice.t1;
    job.due = kNever;
    job.placement = slice.scene.placement();
    job.bodies.resize(slice.links_at_t0.size());
    for (std::size_t link = 0; link < job.bodies.size(); ++link) {
      job.bodies[link] = {slice.links_at_t0[link].X_WL, slice.links_at_t1[link].X_WL};
    }
    worker_.forget(worker_.submit(std::move(job)));
  }

  void submit(const WorldSlice& slice, Exposure exposure) {
    Pending pending;
    pending.start = exposure.job.begin;
    pending.due = exposure.job.due;
    pending.number = exposure.number;
    pending.with_truth =
        slice.camera_truth != nullptr && slice.camera_truth->wants(settings_.name, pending.start);
    pending.exposure_free = exposure.exposure_free;
    pending.gain_free = exposure.gain_free;
    pending.fixed = exposure.fixed;
    if (!exposure.no_room && may_wait(slice.paced)) {
      CameraJob& job = exposure.job;
      job.placement = slice.scene.placement();
      job.with_truth = pending.with_truth;
      job.dug = dug_.take(slice);
      if (slice.weather != nullptr) {
        job.dust = slice.weather->dust();
      }
      pending.job = worker_.submit(std::move(job));
    }
    pending_.push_back(std::move(pending));
  }

  /// Whether one more picture may wait for the worker; free-running it may when another has been
  /// waited for.
  bool may_wait(bool paced) {
    const auto waits = [](const Pending& pending) { return pending.job.has_value(); };
    if (std::ranges::count_if(pending_, waits) < kMostWaiting) {
      return true;
    }
    if (!paced) {
      const auto first = std::ranges::find_if(pending_, waits);
      collect(*first, worker_.wait(*first->job));
    }
    return !paced;
  }

  /// Collects what the worker has made, as far as it has come.
  void measure() {
    for (std::size_t i = 0; i < pending_.size(); ++i) {
      Pending& pending = pending_[i];
      if (!pending.job) {
        settle(pending, false);  // unless it is settled
        continue;
      }
      auto made = worker_.take(*pending.job);
      if (!made) {
        return;
      }
      collect(pending, std::move(*made));
    }
  }

  void collect(Pending& pending, CameraWorker::Made made) {
    pending.job.reset();
    pending.made = std::move(made);
    settle(pending, pending.made.taken.picture != nullptr);
  }

  /// Reports it to automatic exposure, once.
  void settle(Pending& pending, bool measured) {
    if (!pending.exposure_free && !pending.gain_free) {
      return;
    }
    if (measured) {
      automatic_.taken(pending.made.taken.mean, pending.exposure_free, pending.gain_free,
                       pending.fixed);
    } else {
      automatic_.unmeasured();
    }
    pending.exposure_free = pending.gain_free = false;
    --unmeasured_;
  }

  /// Settles the oldest exposure that automatic exposure still waits for.
  void measure_first(bool may_wait) {
    for (Pending& pending : pending_) {
      if (!pending.exposure_free && !pending.gain_free) {
        continue;
      }
      if (may_wait && pending.job) {
        collect(pending, worker_.wait(*pending.job));
      } else {
        settle(pending, false);
      }
      return;
    }
    // It is still being exposed.
    for (Exposure& exposure : open_) {
      if (exposure.exposure_free || exposure.gain_free) {
        exposure.exposure_free = exposure.gain_free = false;
        automatic_.unmeasured();
        break;
      }
    }
    --unmeasured_;
  }

  void hand_over(const WorldSlice& slice, Shelves& samples) {
    if (pending_.empty() || pending_.front().due > slice.t1) {
      return;
    }
    std::vector<PictureSample>& shelf = samples.of<PictureSample>(station_);
    for (; !pending_.empty() && pending_.front().due <= slice.t1; pending_.pop_front()) {
      Pending& pending = pending_.front();
      if (pending.job && !slice.paced) {
        collect(pending, worker_.wait(*pending.job));
      } else if (pending.job && slice.t1 < pending.due + settings_.processing &&
                 worker_.begun(*pending.job)) {
        break;
      } else if (pending.job) {
        worker_.forget(*pending.job);
        pending.job.reset();
        settle(pending, false);
      } else {
        settle(pending, false);  // unless it is settled
      }
      std::shared_ptr<const Picture>& picture = pending.made.taken.picture;
      if (picture && pending.with_truth && slice.camera_truth != nullptr) {
        slice.camera_truth->record(settings_.name,
                                   {pending.number, picture, std::move(pending.made.truth)});
      }
      const bool late = pending.due <= slice.t0;
      shelf.push_back({late ? slice.t1 : pending.due, pending.start, std::move(picture), late});
    }
  }

  StationIndex station_;
  WorldCameraSettings settings_;
  PlannedInstants instants_;
  Duration period_ = Duration::max();  ///< Period of the plan.
  CameraCommand command_;
  std::deque<SimTime> triggered_;  ///< By software, to come.
  SimTime ready_{};                ///< For the next exposure by software.
  SimTime last_due_{};
  std::deque<Kept> kept_;  ///< In the order in which they are due.
  std::size_t kept_bytes_ = 0;
  std::uint64_t frame_ = 0;
  std::uint32_t mask_ = sim::Scene::kSeeEverything;
  std::deque<Exposure> open_;  ///< In order of their beginnings and of their ends.
  std::deque<Pending> pending_;
  sim::AutoExposure automatic_;
  std::size_t unmeasured_ = 0;  ///< Exposures that automatic_ has chosen and that are not settled.
  DugNodes dug_;
  bool paced_ = false;
  bool prepared_ = false;
  CameraWorker worker_;
};

}  // namespace

std::unique_ptr<WorldSensor> make_world_camera(StationIndex station,
                                               const WorldCameraSettings& settings,
                                               const sim::Scene& scene,
                                               sim::Scene::InstanceId terrain,
                                               std::shared_ptr<CameraSurroundings> surroundings,
                                               const CameraWorker::MakeSensor& make) {
  return std::make_unique<WorldCamera>(station, settings, scene, terrain, std::move(surroundings),
                                       make);
}

}  // namespace rigwire::hil
