#include "hil/world/camera_worker.h"

#include <exception>
#include <future>
#include <utility>

#include "fields/failure_text.h"
#include "hil/executive/background_thread.h"

namespace rigwire::hil {
namespace {

/// Between two looks at how much of the sky dug ground sees, which costs a tenth of a second.
constexpr Duration kSkyPeriod = std::chrono::seconds(10);

}  // namespace

CameraWorker::CameraWorker(const sim::Scene& scene, sim::Scene::InstanceId terrain,
                           std::shared_ptr<CameraSurroundings> surroundings, const MakeSensor& make)
    : scene_(scene.twin()), terrain_(terrain), surroundings_(std::move(surroundings)) {
  std::promise<void> ready;
  std::future<void> made = ready.get_future();
  thread_ = std::thread([this, &make, ready = std::move(ready)]() mutable {
    yield_to_the_loop();
    try {
      sensor_ = make();
    } catch (...) {
      ready.set_exception(std::current_exception());
      return;
    }
    ready.set_value();
    run();
    sensor_.reset();
  });
  try {
    made.get();
  } catch (...) {
    thread_.join();
    throw;
  }
}

CameraWorker::~CameraWorker() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  work_.notify_one();
  thread_.join();
}

CameraWorker::Number CameraWorker::submit(CameraJob job) {
  const std::scoped_lock lock(mutex_);
  auto made = std::make_unique<Entry>();
  made->job = std::move(job);
  made->waited = busy_ || next_ < first_ + entries_.size();
  entries_.push_back(std::move(made));
  work_.notify_one();
  return first_ + entries_.size() - 1;
}

void CameraWorker::reach(SimTime now, bool paced) {
  const std::scoped_lock lock(mutex_);
  now_ = now;
  paced_ = paced;
}

std::optional<CameraWorker::Made> CameraWorker::take(Number job) {
  const std::scoped_lock lock(mutex_);
  Entry& asked = entry(job);
  if (!asked.made) {
    return std::nullopt;
  }
  auto made = std::move(asked.made);
  asked.made.emplace();
  asked.forgotten = true;
  drop_front();
  return made;
}

CameraWorker::Made CameraWorker::wait(Number job) {
  std::unique_lock lock(mutex_);
  Entry& asked = entry(job);
  done_.wait(lock, [&asked] { return asked.made.has_value(); });
  Made made = std::move(*asked.made);
  asked.made.emplace();
  asked.forgotten = true;
  drop_front();
  return made;
}

bool CameraWorker::begun(Number job) const {
  const std::scoped_lock lock(mutex_);
  return job < next_ || (busy_ && job == next_);
}

void CameraWorker::forget(Number job) {
  const std::scoped_lock lock(mutex_);
  entry(job).forgotten = true;
  drop_front();
}

std::optional<std::string> CameraWorker::fault() const {
  const std::scoped_lock lock(mutex_);
  return fault_;
}

/// Removes finished jobs at the front that have been taken or forgotten.
void CameraWorker::drop_front() {
  while (first_ < next_ && entries_.front()->forgotten && entries_.front()->made) {
    entries_.pop_front();
    ++first_;
  }
}

void CameraWorker::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    work_.wait(lock, [this] { return stopping_ || next_ < first_ + entries_.size(); });
    if (stopping_) {
      return;
    }
    Entry& present = *entries_[next_ - first_];
    // A job that had to wait is skipped if it would be late after the last picture's duration.
    const bool late = paced_ && present.waited && now_ + last_cost_ > present.job.due;
    const bool wanted = present.job.shot && !present.forgotten && !late;
    const SimTime begun = now_;
    busy_ = true;
    lock.unlock();
    Made made;
    std::string failed;
    try {
      if (wanted) {
        made = make_picture(present.job);
      } else {
        make_ready(present.job);
      }
    } catch (const std::exception& error) {
      failed = fields::failure_text(error, "a picture");
    }
    present.job = {};
    lock.lock();
    busy_ = false;
    if (wanted) {
      last_cost_ = now_ - begun;
    }
    if (!failed.empty() && !fault_) {
      fault_ = failed;
    }
    present.made = std::move(made);
    ++next_;
    drop_front();
    done_.notify_one();
  }
}

/// Also what is passed over says where the ground was dug.
void CameraWorker::make_ready(const CameraJob& job) {
  if (job.dug) {
    scene_->update_terrain(terrain_, job.dug->nodes, job.dug->heights_m);
    dug_since_ = true;
  }
  if (!sky_) {
    scene_->begin_slice(job.begin, job.end, job.placement, job.bodies);
    sky_ = surroundings_->sky(*scene_);
    sky_made_ = job.begin;
  }
}

CameraWorker::Made CameraWorker::make_picture(CameraJob& job) {
  make_ready(job);
  scene_->begin_slice(job.begin, job.end, job.placement, job.bodies);
  if (dug_since_ && job.begin - sky_made_ >= kSkyPeriod) {
    sky_ = std::make_shared<const sim::SkyVisibility>(*scene_);
    sky_made_ = job.begin;
    dug_since_ = false;
  }
  sim::CameraShot& shot = *job.shot;
  if (!light_ || shot.start >= light_until_) {
    light_.emplace(surroundings_->light_at(shot.start));
    light_until_ = CameraSurroundings::light_changes(shot.start);
  }
  const sim::CameraAir air = surroundings_->air_at(shot.start, job.dust ? &*job.dust : nullptr);
  shot.light = &*light_;
  shot.air = air.clear() ? nullptr : &air;
  shot.sky = sky_.get();
  shot.wetness = sim::wetness_of(air.rain_mmph());
  Made made;
  made.taken = sensor_->take(*scene_, shot, job.with_truth ? &made.truth : nullptr);
  return made;
}

}  // namespace rigwire::hil
