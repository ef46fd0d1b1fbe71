#include "hil/world/camera_previews.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <numbers>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "hil/executive/background_thread.h"
#include "hil/world/camera_worker.h"
#include "hil/world/picture_layers.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::hil {
namespace {

/// A client that triggers exposures itself counts as taking pictures for so long after each one.
constexpr Duration kTriggerCounts = std::chrono::seconds(2);
/// Pictures of the first preview of a camera that chooses its exposure, which settles meanwhile.
constexpr int kSettlingPictures = 12;
/// Between two looks at how much of the sky dug ground sees.
constexpr Duration kPreviewSkyPeriod = std::chrono::seconds(10);

int even_part(int side_px, int by) {
  return std::max(2, side_px / by / 2 * 2);
}

/// How many times coarser the pixels of a preview are.
int coarseness(int width_px) {
  return (width_px + kPreviewWidth_px - 1) / kPreviewWidth_px;
}

/// One ray for each pixel, of a sensor without faults.
void make_cheap(sim::CameraParameters& camera) {
  camera.samples = 1;
  camera.sky_rays = 0;
  camera.threads = 1;
  camera.sensor.dead_pixels = 0;
  camera.sensor.hot_pixels = 0;
  camera.sensor.dead_columns = 0;
  camera.sensor.row_time = Duration{0};
}

/// A shorter lens in front of fewer pixels of the same size sees the same, as bright.
sim::CameraParameters smaller(sim::CameraParameters camera) {
  const int by = coarseness(camera.sensor.width_px);
  camera.sensor.width_px = even_part(camera.sensor.width_px, by);
  camera.sensor.height_px = even_part(camera.sensor.height_px, by);
  camera.lens.focal_length_m /= by;
  camera.lens.principal_offset_px /= by;
  make_cheap(camera);
  return camera;
}

sim::CameraKind smaller_kind(const sim::CameraParameters& kind) {
  return smaller(kind);
}

/// Keeps the left head alone, at the mount.
sim::CameraKind smaller_kind(const sim::StereoCameraParameters& kind) {
  return smaller(kind.camera);
}

sim::CameraKind smaller_kind(const sim::DepthCameraParameters& kind) {
  sim::DepthCameraParameters depth = kind;
  depth.camera = smaller(kind.camera);
  return depth;
}

sim::CameraKind smaller_kind(const sim::AllRoundCameraParameters& kind) {
  sim::AllRoundCameraParameters round = kind;
  const int by = coarseness(kind.width_px);
  round.method = sim::AllRoundMethod::rays;
  round.camera.lens.vignetting = 0.0;
  round.width_px = even_part(kind.width_px, by);
  // Not below the nadir, wherever the width was rounded to.
  const double down_rad = kind.elevation_upper_rad + 0.5 * std::numbers::pi;
  const double most_rows = down_rad / (2.0 * std::numbers::pi) * round.width_px;
  round.height_px =
      std::min(even_part(kind.height_px, by), std::max(2, static_cast<int>(most_rows + 1e-6)));
  make_cheap(round.camera);
  return round;
}

class CameraPreviews final : public WorldSensor {
 public:
  CameraPreviews(std::vector<PreviewedCamera> cameras, std::uint64_t seed, const sim::Scene& scene,
                 sim::Scene::InstanceId terrain, std::shared_ptr<CameraSurroundings> surroundings,
                 PreviewViewers viewers)
      : cameras_(std::move(cameras)),
        seed_(seed),
        viewers_(std::move(viewers)),
        watched_(cameras_.size()),
        scene_(scene.twin()),
        terrain_(terrain),
        surroundings_(std::move(surroundings)),
        studios_(cameras_.size()) {
    thread_ = std::thread([this] {
      yield_to_the_loop();
      run();
    });
  }
  ~CameraPreviews() override {
    {
      const std::scoped_lock lock(mutex_);
      stopping_ = true;
    }
    work_.notify_one();
    thread_.join();
  }

  void take(SimTime frontier, const Shelves& requests) override {
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      Watched& watched = watched_[i];
      const auto* const plans = requests.find<SamplePlan>(cameras_[i].station);
      if (plans != nullptr && !plans->empty()) {
        watched.exposes = plans->back().first != kNever;
      }
      const auto* const commands = requests.find<CameraCommand>(cameras_[i].station);
      if (commands != nullptr && !commands->empty()) {
        const std::uint32_t triggers = commands->back().software_triggers;
        if (triggers != std::exchange(watched.triggers, triggers)) {
          watched.triggered = frontier;
        }
      }
    }
  }

  /// The previews' thread casts its rays into a scene of its own.
  [[nodiscard]] bool looks_at_scene() const override { return false; }
  void slice(const WorldSlice& slice, Shelves& /*samples*/) override {
    dug_.follow(slice);
    if (!busy_.load(std::memory_order_acquire)) {
      if (const auto camera = next_camera(slice.t1)) {
        submit(slice, *camera);
      }
    }
  }

 private:
  /// What the truth's thread knows of a camera.
  struct Watched {
    bool exposes = false;  ///< By its plan, for a client.
    std::uint32_t triggers = 0;
    std::optional<SimTime> triggered;  ///< By a client, last.
    std::chrono::steady_clock::time_point next;
  };
  /// What the previews' thread has of a camera.
  struct Studio {
    std::unique_ptr<sim::CameraSensor> sensor;
    CameraCommand command;
    std::optional<sim::AutoExposure> automatic;
    std::uint64_t frame = 0;
    bool failed = false;
  };
  struct Job {
    std::size_t camera = 0;
    SimTime at{};
    sim::LinkMotion mount;
    sim::ScenePlacement placement;
    std::vector<sim::BodyMotion> bodies;
    std::optional<DugGround> dug;
    std::optional<sim::DustCloud> dust;
  };

  /// In turns, so that all cameras that are watched get their previews.
  [[nodiscard]] std::optional<std::size_t> next_camera(SimTime now) {
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      const std::size_t camera = (turn_ + i) % cameras_.size();
      Watched& watched = watched_[camera];
      if (!viewers_.wanted(camera) || watched.exposes ||
          (watched.triggered && now < *watched.triggered + kTriggerCounts)) {
        continue;
      }
      if (const auto wall = std::chrono::steady_clock::now(); wall >= watched.next) {
        watched.next = wall + kPreviewPeriod;
        turn_ = camera + 1;
        return camera;
      }
    }
    return std::nullopt;
  }

  void submit(const WorldSlice& slice, std::size_t camera) {
    const SensorMount& mount = cameras_[camera].mount;
    Job job;
    job.camera = camera;
    job.at = slice.t1;
    // Held, so that nothing is blurred.
    job.mount.X_WL = slice.links_at_t1[mount.link].X_WL * mount.X_LS;
    job.placement = slice.scene.placement();
    job.bodies.reserve(slice.links_at_t1.size());
    for (const sim::LinkMotion& body : slice.links_at_t1) {
      job.bodies.push_back({body.X_WL, body.X_WL});
    }
    job.dug = dug_.take(slice);
    if (slice.weather != nullptr) {
      job.dust = slice.weather->dust();
    }
    {
      const std::scoped_lock lock(mutex_);
      job_ = std::move(job);
      busy_.store(true, std::memory_order_release);
    }
    work_.notify_one();
  }

  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      work_.wait(lock, [this] { return stopping_ || job_; });
      if (stopping_) {
        return;
      }
      const Job job = std::move(*job_);
      job_.reset();
      lock.unlock();
      render(job);
      busy_.store(false, std::memory_order_release);
      lock.lock();
    }
  }

  void render(const Job& job) {
    Studio& studio = studios_[job.camera];
    try {
      if (job.dug) {
        scene_->update_terrain(terrain_, job.dug->nodes, job.dug->heights_m);
        dug_since_ = true;
      }
      if (!studio.failed) {
        show(job, studio);
      }
    } catch (const std::exception& error) {
      studio.failed = true;
      viewers_.failed(fmt::format("no preview of {}: {}", cameras_[job.camera].name, error.what()));
    }
  }

  void show(const Job& job, Studio& studio) {
    const PreviewedCamera& camera = cameras_[job.camera];
    if (!studio.sensor) {
      equip(camera, studio);
    }
    const bool chooses = studio.command.exposure_auto || studio.command.gain_auto;
    const int pictures = chooses && studio.frame == 0 ? kSettlingPictures : 1;
    std::shared_ptr<const Picture> picture;
    for (int i = 0; i < pictures && !stopping_; ++i) {
      picture = expose(job, camera, studio);
    }
    if (picture && !stopping_) {
      const KeptPicture kept{std::move(picture), {}, {}, std::nullopt};
      viewers_.show({job.camera, job.at, layer_image(kept, PictureLayer::image, false)});
    }
  }

  void equip(const PreviewedCamera& camera, Studio& studio) const {
    const sim::CameraKind kind = preview_of(camera.kind);
    const sim::CameraAbilities abilities = sim::abilities_of(kind);
    studio.command = camera.command;
    studio.command.format = abilities.formats.front();
    studio.command.region = {0, 0, abilities.width_px, abilities.height_px};
    studio.command.binning_horizontal = 1;
    studio.command.binning_vertical = 1;
    studio.command.intensity = true;
    studio.command.intensity_right = false;
    studio.command.disparity = false;
    studio.command.range = false;
    studio.command.confidence = false;
    studio.automatic.emplace(
        sim::optics_of(kind).auto_exposure,
        sim::AutoExposure::Choice{studio.command.exposure, studio.command.gain_db});
    studio.sensor = sim::make_camera(kind, seed_, camera.name + "/preview");
  }

  [[nodiscard]] std::shared_ptr<const Picture> expose(const Job& job, const PreviewedCamera& camera,
                                                      Studio& studio) {
    const CameraCommand& command = studio.command;
    sim::AutoExposure::Choice choice = studio.automatic->next();
    choice.exposure = command.exposure_auto ? choice.exposure : command.exposure;
    choice.gain_db = command.gain_auto ? choice.gain_db : command.gain_db;
    const SimTime end = job.at + std::max(studio.sensor->span(command, choice.exposure),
                                          Duration{std::chrono::microseconds(1)});
    scene_->begin_slice(job.at, end, job.placement, job.bodies);
    if (!sky_ || (dug_since_ && job.at - sky_made_ >= kPreviewSkyPeriod)) {
      sky_ = std::make_shared<const sim::SkyVisibility>(*scene_);
      sky_made_ = job.at;
      dug_since_ = false;
    }
    if (!light_ || job.at >= light_until_) {
      light_.emplace(surroundings_->light_at(job.at));
      light_until_ = CameraSurroundings::light_changes(job.at);
    }
    const sim::CameraAir air = surroundings_->air_at(job.at, job.dust ? &*job.dust : nullptr);
    sim::CameraShot shot;
    shot.command = command;
    shot.exposure = choice.exposure;
    shot.gain_db = choice.gain_db;
    shot.frame = studio.frame++;
    shot.start = job.at;
    shot.poses = {{job.at, job.mount}, {end, job.mount}};
    if (!camera.sees_own_link) {
      shot.mask &= ~sim::Scene::body_mask(static_cast<sim::Scene::BodyId>(camera.mount.link));
    }
    shot.light = &*light_;
    shot.air = air.clear() ? nullptr : &air;
    shot.sky = sky_.get();
    shot.wetness = sim::wetness_of(air.rain_mmph());
    sim::CameraSensor::Taken taken = studio.sensor->take(*scene_, shot, nullptr);
    studio.automatic->taken(taken.mean, command.exposure_auto, command.gain_auto,
                            {command.exposure, command.gain_db});
    return std::move(taken.picture);
  }

  const std::vector<PreviewedCamera> cameras_;
  const std::uint64_t seed_;
  const PreviewViewers viewers_;

  // Used on the truth's thread.
  std::vector<Watched> watched_;
  std::size_t turn_ = 0;
  DugNodes dug_;

  // Used on the previews' thread.
  std::unique_ptr<sim::Scene> scene_;
  sim::Scene::InstanceId terrain_;
  std::shared_ptr<CameraSurroundings> surroundings_;
  std::vector<Studio> studios_;
  std::optional<sim::Daylight> light_;
  SimTime light_until_{};
  std::shared_ptr<const sim::SkyVisibility> sky_;
  SimTime sky_made_{};
  bool dug_since_ = false;

  std::mutex mutex_;
  std::condition_variable work_;
  std::optional<Job> job_;
  std::atomic<bool> busy_{false};  ///< A job waits or is being done.
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace

sim::CameraKind preview_of(const sim::CameraKind& kind) {
  return std::visit([](const auto& one) { return smaller_kind(one); }, kind);
}

std::unique_ptr<WorldSensor> make_camera_previews(std::vector<PreviewedCamera> cameras,
                                                  std::uint64_t seed, const sim::Scene& scene,
                                                  sim::Scene::InstanceId terrain,
                                                  std::shared_ptr<CameraSurroundings> surroundings,
                                                  PreviewViewers viewers) {
  return std::make_unique<CameraPreviews>(std::move(cameras), seed, scene, terrain,
                                          std::move(surroundings), std::move(viewers));
}

}  // namespace rigwire::hil
