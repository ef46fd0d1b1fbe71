// A camera in the world: when it exposes, what its worker is told, and when pictures are handed
// over. The sensor is a false one that writes down its shots.
#include "hil/world/camera.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "sim/camera/plain_camera.h"
#include "sim/scene/height_field.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

constexpr StationIndex kStation = 3;
constexpr Duration kStep = 1ms;
constexpr Duration kSlice = 2ms;

/// What a worker was told, and how it is held up.
struct Studio {
  std::mutex mutex;
  std::condition_variable changed;
  bool open = true;   ///< Else take() waits.
  int entered = 0;    ///< How often it was called.
  Duration delay{0};  ///< In wall time, per picture.
  std::vector<sim::CameraShot> shots;
  std::vector<double> depths_m;  ///< Depths of the ground below (0, 0).
  std::vector<double> cubes_m;   ///< Height of what stands at (5, 0), middle of the exposure.

  void let_in(bool in) {
    const std::scoped_lock lock(mutex);
    open = in;
    changed.notify_all();
  }
  void wait_for_the_first() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return entered > 0; });
  }
  [[nodiscard]] std::size_t taken() {
    const std::scoped_lock lock(mutex);
    return shots.size();
  }
};

/// A picture whose one byte is the frame's number; the mean is in proportion to the exposure.
class FalseSensor final : public sim::CameraSensor {
 public:
  explicit FalseSensor(Studio& studio) : studio_(studio) {}
  [[nodiscard]] Duration span(const CameraCommand& /*command*/, Duration exposure) const override {
    return exposure + 1ms;
  }
  [[nodiscard]] Taken take(const sim::Scene& scene, const sim::CameraShot& shot,
                           sim::CameraTruth* /*truth*/) override {
    std::unique_lock lock(studio_.mutex);
    ++studio_.entered;
    studio_.changed.notify_all();
    studio_.changed.wait(lock, [this] { return studio_.open; });
    const auto height = [&](double x) {
      const auto hit = scene.cast({x, 0.0, 20.0}, -Eigen::Vector3d::UnitZ(), 0.0, 100.0,
                                  shot.start + shot.exposure / 2);
      return hit ? 20.0 - hit->range_m : -1000.0;
    };
    studio_.depths_m.push_back(height(0.0));
    studio_.cubes_m.push_back(height(5.0));
    studio_.shots.push_back(shot);
    const Duration delay = studio_.delay;
    lock.unlock();
    std::this_thread::sleep_for(delay);
    auto picture = std::make_shared<Picture>();
    picture->exposure_start = shot.start;
    picture->exposure = shot.exposure;
    picture->gain_db = shot.gain_db;
    picture->parts.push_back(
        {.region = {0, 0, 1, 1}, .bytes = {static_cast<std::uint8_t>(shot.frame)}});
    return {picture, to_seconds(shot.exposure) / 0.01 * std::pow(10.0, shot.gain_db / 20.0)};
  }

 private:
  Studio& studio_;
};

/// Level ground, one body (the camera's link), which climbs with 1 m/s at (5, 0).
class WorldCameraTest : public ::testing::Test {
 protected:
  WorldCameraTest() {
    field_.cell_m = 1.0;
    field_.columns = field_.rows = 41;
    field_.origin_m = Eigen::Vector2d(-20.0, -20.0);
    field_.heights_m.assign(field_.columns * field_.rows, 0.0);
    terrain_ = scene_.add_terrain(field_, {});
    scene_.make_changeable(terrain_);
    const auto body = scene_.add_body("cube");
    scene_.add_body_part(body, scene_.add_mesh(sim::make_box("cube", {1.0, 1.0, 1.0})),
                         Eigen::Isometry3d::Identity(), {});
  }

  void make(Duration processing, sim::AutoExposureParameters automatic = {}) {
    WorldCameraSettings settings;
    settings.mount.X_LS.translation().x() = 0.5;
    settings.processing = processing;
    settings.auto_exposure = automatic;
    settings.memory_bytes = memory_bytes_;
    camera_ = make_world_camera(
        kStation, settings, scene_, terrain_,
        std::make_shared<CameraSurroundings>(Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), 49.4, 7.75,
                                             sim::DaylightParameters{}, sim::WeatherParameters{}),
        [this] { return std::make_unique<FalseSensor>(studio_); });
  }

  static sim::LinkMotion link(SimTime time) {
    sim::LinkMotion motion;
    motion.X_WL.translation() << 5.0, 0.0, 1.0 + to_seconds(time);
    motion.v_WL_W = Eigen::Vector3d::UnitZ();
    return motion;
  }

  void plan(SimTime first, Duration period) {
    requests_.of<SamplePlan>(kStation).push_back({first, period});
  }
  void command(const CameraCommand& command) {
    command_ = command;
    requests_.of<CameraCommand>(kStation).push_back(command);
  }

  /// Runs slices up to `end`.
  void run(SimTime end, bool paced = false) {
    while (now_ < end) {
      camera_->take(now_, requests_);
      requests_.clear();
      samples_.clear();
      const SimTime t1 = now_ + kSlice;
      for (SimTime t = now_; t < t1; t += kStep) {
        const std::vector<sim::LinkMotion> at_t0{link(t)};
        const std::vector<sim::LinkMotion> at_t1{link(t + kStep)};
        camera_->step({t, t + kStep, at_t0, at_t1, 9.81}, samples_);
      }
      const std::vector<sim::LinkMotion> at_t0{link(now_)};
      const std::vector<sim::LinkMotion> at_t1{link(t1)};
      const sim::BodyMotion motion{at_t0[0].X_WL, at_t1[0].X_WL};
      scene_.begin_slice(now_, t1, Eigen::Vector3d::Zero(), {&motion, 1});
      camera_->slice({.t0 = now_,
                      .t1 = t1,
                      .links_at_t0 = at_t0,
                      .links_at_t1 = at_t1,
                      .scene = scene_,
                      .ground = &field_,
                      .dug = std::exchange(dug_, std::nullopt),
                      .paced = paced},
                     samples_);
      if (const auto* shelf = samples_.find<PictureSample>(kStation)) {
        for (const PictureSample& sample : *shelf) {
          EXPECT_GT(sample.time, now_);
          EXPECT_LE(sample.time, t1);
          handed_over_.push_back(sample);
        }
      }
      now_ = t1;
    }
  }

  [[nodiscard]] std::size_t skipped() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        handed_over_, [](const PictureSample& sample) { return !sample.picture; }));
  }

  static CameraCommand exposing(Duration exposure) {
    CameraCommand command;
    command.region = {0, 0, 1, 1};
    command.exposure = exposure;
    return command;
  }

  /// Paced, until the worker has begun the first picture, which it cannot make before it is let in.
  void expose_behind_a_closed_door(Duration processing, Duration period) {
    studio_.let_in(false);
    make(processing);
    command(exposing(1ms));
    plan(kStart, period);
    run(kStart + 20ms, true);
    studio_.wait_for_the_first();
  }

  /// Exposes 1 ms every 4 ms with room for 10 pictures, each of them due 102 ms after it began.
  /// Paced, what has room may still be late.
  void expect_only_what_has_room(bool paced) {
    memory_bytes_ = 10;
    make(100ms);
    command(exposing(1ms));
    plan(kStart, 4ms);
    run(kStart + (paced ? 704ms : 602ms), paced);  // What is late has been told by then, too.
    std::erase_if(handed_over_, [](const PictureSample& sample) {
      return sample.exposure_start > kStart + 500ms;
    });
    ASSERT_EQ(handed_over_.size(), 126U);
    std::deque<SimTime> kept;
    for (const PictureSample& sample : handed_over_) {
      while (!kept.empty() && kept.front() <= sample.exposure_start) {
        kept.pop_front();
      }
      const SimTime due = sample.exposure_start + 102ms;
      EXPECT_TRUE(sample.late ? paced && sample.time > due : sample.time == due);
      const bool room = kept.size() < 10;
      if (room) {
        kept.push_back(due);
      }
      ASSERT_TRUE(sample.picture ? room : paced || !room)
          << to_seconds(sample.exposure_start - kStart);
    }
    EXPECT_GE(skipped(), 76U);  // 15 or 16 of 26, five times
  }

  std::size_t memory_bytes_ = kPictureMemory_bytes;
  Studio studio_;
  sim::Scene scene_;
  sim::HeightField field_;
  sim::Scene::InstanceId terrain_ = 0;
  std::optional<sim::NodeRectangle> dug_;
  std::unique_ptr<WorldSensor> camera_;
  Shelves requests_;
  Shelves samples_;
  CameraCommand command_;
  SimTime now_ = kStart;
  std::vector<PictureSample> handed_over_;
};

TEST_F(WorldCameraTest, exposes_at_the_plans_instants_and_hands_over_after_processing) {
  make(20ms);
  command(exposing(3ms));
  plan(kStart + 5ms + 250us, 40ms);
  run(kStart + 200ms);
  ASSERT_EQ(handed_over_.size(), 5U);
  for (std::size_t i = 0; i < handed_over_.size(); ++i) {
    const SimTime start = kStart + 5ms + 250us + static_cast<int>(i) * 40ms;
    const PictureSample& sample = handed_over_[i];
    ASSERT_TRUE(sample.picture) << i;
    EXPECT_EQ(sample.exposure_start, start);
    EXPECT_EQ(sample.picture->exposure_start, start);
    EXPECT_EQ(sample.time, start + 3ms + 1ms + 20ms);
    EXPECT_EQ(sample.picture->parts[0].bytes[0], i);
  }
}

TEST_F(WorldCameraTest, tells_where_camera_and_bodies_were_during_the_exposure) {
  make(20ms);
  command(exposing(3ms));
  plan(kStart + 5ms + 250us, 1s);
  run(kStart + 100ms);
  ASSERT_EQ(studio_.shots.size(), 1U);
  const sim::CameraShot& shot = studio_.shots[0];
  EXPECT_EQ(shot.poses.front().time, shot.start);
  EXPECT_GE(shot.poses.back().time, shot.start + 4ms);
  EXPECT_GE(shot.poses.size(), 5U);
  for (const sim::CameraPose& pose : shot.poses) {
    const Eigen::Vector3d p = pose.mount.X_WL.translation();
    EXPECT_NEAR(p.x(), 5.5, 1e-12);
    EXPECT_NEAR(p.z(), 1.0 + to_seconds(pose.time), 1e-12);
  }
  // The live scene had gone on for long when the picture was made.
  EXPECT_NEAR(studio_.cubes_m[0], 1.5 + to_seconds(shot.start + 1ms + 500us), 1e-5);
  EXPECT_EQ(shot.mask & sim::Scene::body_mask(0), 0U);
  ASSERT_NE(shot.light, nullptr);
}

TEST_F(WorldCameraTest, ground_is_that_of_the_end_of_the_exposure) {
  make(20ms);
  command(exposing(3ms));
  plan(kStart + 10ms, 20ms);
  run(kStart + 16ms);
  // Between the first two exposures, and between the second and the third, elsewhere.
  const auto dig = [this](std::size_t first, std::size_t last, double height_m) {
    for (std::size_t r = first; r <= last; ++r) {
      for (std::size_t c = first; c <= last; ++c) {
        field_.heights_m[r * field_.columns + c] = height_m;
      }
    }
    dug_ = sim::NodeRectangle{first, first, last, last};
  };
  dig(18, 22, -1.0);
  run(kStart + 18ms);
  dig(2, 4, -3.0);
  run(kStart + 100ms);
  const std::scoped_lock lock(studio_.mutex);
  ASSERT_GE(studio_.depths_m.size(), 4U);
  EXPECT_NEAR(studio_.depths_m[0], 0.0, 1e-5);
  EXPECT_NEAR(studio_.depths_m[1], -1.0, 1e-5);
  EXPECT_NEAR(studio_.depths_m[2], -1.0, 1e-5);
}

TEST_F(WorldCameraTest, free_run_waits_for_every_picture) {
  studio_.delay = 15ms;
  make(1ms);
  command(exposing(1ms));
  plan(kStart, 4ms);
  run(kStart + 100ms);
  EXPECT_GE(handed_over_.size(), 23U);
  EXPECT_EQ(skipped(), 0U);
}

TEST_F(WorldCameraTest, paced_run_waits_for_none_and_counts_what_is_missing) {
  studio_.let_in(false);
  make(10ms);
  command(exposing(1ms));
  plan(kStart, 4ms);
  const auto begun = std::chrono::steady_clock::now();
  run(kStart + 400ms, true);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 5s);
  EXPECT_EQ(handed_over_.size(), 98U);
  EXPECT_EQ(skipped(), 98U);
  EXPECT_EQ(handed_over_[5].exposure_start, kStart + 20ms);
  // What was late is given up, and what comes next is made.
  studio_.let_in(true);
  handed_over_.clear();
  while (handed_over_.empty() || !handed_over_.back().picture) {
    std::this_thread::sleep_for(2ms);
    run(now_ + kSlice, true);
    ASSERT_LT(now_, kStart + 20s);
  }
  EXPECT_LT(studio_.taken(), 20U);
}

TEST_F(WorldCameraTest, paced_run_hands_a_late_picture_over_when_it_is_ready) {
  expose_behind_a_closed_door(1s, 10s);
  run(kStart + 1500ms, true);
  EXPECT_TRUE(handed_over_.empty());
  studio_.let_in(true);
  while (studio_.taken() == 0) {
    std::this_thread::sleep_for(2ms);
  }
  while (handed_over_.empty()) {
    std::this_thread::sleep_for(2ms);
    ASSERT_LT(now_, kStart + 2s);
    run(now_ + kSlice, true);
  }
  ASSERT_EQ(handed_over_.size(), 1U);
  EXPECT_TRUE(handed_over_[0].picture);
  EXPECT_TRUE(handed_over_[0].late);
  EXPECT_EQ(handed_over_[0].exposure_start, kStart);
  EXPECT_EQ(handed_over_[0].time, now_);
}

TEST_F(WorldCameraTest, paced_run_gives_up_a_picture_that_takes_twice_as_long_as_processing) {
  expose_behind_a_closed_door(100ms, 40ms);
  run(kStart + 200ms, true);
  EXPECT_TRUE(handed_over_.empty());
  run(kStart + 204ms, true);
  ASSERT_EQ(handed_over_.size(), 3U);  // those that wait behind it in vain, too
  EXPECT_EQ(skipped(), 3U);
  EXPECT_EQ(handed_over_[1].exposure_start, kStart + 40ms);
  studio_.let_in(true);
}

TEST_F(WorldCameraTest, paced_run_makes_what_it_can_when_pictures_take_longer_than_their_period) {
  // Each takes as long as three periods; without giving some up each would be late.
  studio_.delay = 12ms;
  make(16ms);
  command(exposing(1ms));
  plan(kStart, 4ms);
  const auto start = std::chrono::steady_clock::now();
  while (now_ < kStart + 1s) {
    run(now_ + kSlice, true);
    std::this_thread::sleep_until(start + (now_ - kStart));
  }
  EXPECT_GT(skipped(), 100U);
  EXPECT_GT(handed_over_.size() - skipped(), 20U);
}

TEST_F(WorldCameraTest, free_run_keeps_no_more_pictures_than_have_room) {
  expect_only_what_has_room(false);
  // And none is rendered in vain.
  EXPECT_LE(studio_.taken(), handed_over_.size() - skipped() + 10);
}

TEST_F(WorldCameraTest, paced_run_keeps_no_more_pictures_than_have_room) {
  expect_only_what_has_room(true);
}

TEST_F(WorldCameraTest, one_picture_has_room_in_any_memory) {
  memory_bytes_ = 1;
  make(1ms);
  CameraCommand command = exposing(1ms);
  command.format = PixelFormat::mono12;
  this->command(command);
  plan(kStart, 4ms);
  run(kStart + 100ms);
  EXPECT_GE(handed_over_.size(), 23U);
  EXPECT_EQ(skipped(), 0U);
}

TEST_F(WorldCameraTest, what_has_no_room_leaves_automatic_exposure_alone_however_slow_the_worker) {
  std::vector<std::vector<Duration>> chosen;
  for (const Duration delay : {Duration{0}, Duration{3ms}}) {
    studio_.delay = delay;
    now_ = kStart;
    handed_over_.clear();
    memory_bytes_ = 5;
    sim::AutoExposureParameters automatic;
    automatic.lag = 2;
    automatic.target = 0.40;
    make(100ms, automatic);
    CameraCommand command = exposing(1ms);
    command.exposure_auto = true;
    this->command(command);
    plan(kStart, 10ms);
    run(kStart + 1s);
    EXPECT_GT(skipped(), 30U);
    std::vector<Duration>& exposures = chosen.emplace_back();
    for (const PictureSample& sample : handed_over_) {
      exposures.push_back(sample.picture ? sample.picture->exposure : Duration{0});
    }
  }
  EXPECT_EQ(chosen[0], chosen[1]);
  EXPECT_NEAR(to_seconds(std::ranges::max(chosen[0])), 0.004, 0.0006);
}

TEST_F(WorldCameraTest, free_run_does_not_get_far_ahead_of_the_worker) {
  studio_.delay = 2ms;
  make(10s);
  command(exposing(1ms));
  plan(kStart, 4ms);
  std::ptrdiff_t farthest = 0;
  while (now_ < kStart + 400ms) {
    run(now_ + kSlice);
    const std::ptrdiff_t over = (now_ - kStart) / Duration{4ms};  // exposures
    farthest = std::max(farthest, over - static_cast<std::ptrdiff_t>(studio_.taken()));
  }
  EXPECT_LE(farthest, 17);  // 16 wait, one is under way
  EXPECT_GE(farthest, 10);  // and it does not wait for each
}

TEST_F(WorldCameraTest, triggers_by_software_expose_once_each_and_at_once) {
  make(5ms);
  command(exposing(3ms));
  run(kStart + 20ms);
  EXPECT_TRUE(handed_over_.empty());
  command_.software_triggers = 1;
  command(command_);
  run(kStart + 40ms);
  ASSERT_EQ(handed_over_.size(), 1U);
  EXPECT_EQ(handed_over_[0].exposure_start, kStart + 20ms);
  // Two at once: the sensor is busy with the first.
  command_.software_triggers = 3;
  command(command_);
  run(kStart + 80ms);
  ASSERT_EQ(handed_over_.size(), 3U);
  EXPECT_EQ(handed_over_[1].exposure_start, kStart + 40ms);
  EXPECT_EQ(handed_over_[2].exposure_start, kStart + 43ms);
}

TEST_F(WorldCameraTest, automatic_exposure_acts_with_its_lag_however_slow_the_worker) {
  sim::AutoExposureParameters automatic;
  automatic.lag = 2;
  automatic.target = 0.40;
  std::vector<std::vector<Duration>> chosen;
  for (const Duration delay : {Duration{0}, Duration{9ms}}) {
    studio_.shots.clear();
    studio_.delay = delay;
    now_ = kStart;
    handed_over_.clear();
    make(7ms, automatic);
    CameraCommand command = exposing(1ms);
    command.exposure_auto = true;
    this->command(command);
    plan(kStart, 40ms);
    run(kStart + 800ms);
    std::vector<Duration>& exposures = chosen.emplace_back();
    for (const PictureSample& sample : handed_over_) {
      exposures.push_back(sample.picture->exposure);
    }
  }
  ASSERT_GE(chosen[0].size(), 18U);
  EXPECT_EQ(chosen[0], chosen[1]);
  // A loop without workers chooses alike: what was measured acts two pictures later.
  sim::AutoExposure loop(automatic, {1ms, 0.0});
  for (std::size_t i = 0; i < chosen[0].size(); ++i) {
    const Duration exposure = loop.next().exposure;
    EXPECT_EQ(chosen[0][i], exposure) << i;
    loop.taken(to_seconds(exposure) / 0.01, true, false, {1ms, 0.0});
  }
  EXPECT_EQ(chosen[0][0], Duration{1ms});
  EXPECT_EQ(chosen[0][1], Duration{1ms});
  EXPECT_GT(chosen[0][2], Duration{1ms});
  EXPECT_NEAR(to_seconds(chosen[0].back()), 0.004, 0.0006);
}

TEST_F(WorldCameraTest, real_pictures_are_the_same_whatever_the_threads) {
  const auto pictures = [this](int threads) {
    sim::CameraParameters parameters;
    parameters.sensor.width_px = 96;
    parameters.sensor.height_px = 64;
    parameters.sensor.row_time = 20us;
    parameters.samples = 2;
    parameters.threads = threads;
    parameters.lens.focal_length_m = 5e-4;
    WorldCameraSettings settings;
    settings.mount.X_LS.translation().z() = 3.0;
    settings.mount.X_LS.linear() =
        Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()).toRotationMatrix();
    settings.processing = 5ms;
    camera_ = make_world_camera(
        kStation, settings, scene_, terrain_,
        std::make_shared<CameraSurroundings>(Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), 49.4, 7.75,
                                             sim::DaylightParameters{}, sim::WeatherParameters{}),
        [&] { return sim::make_plain_camera(parameters, 1, "eye"); });
    now_ = kStart;
    handed_over_.clear();
    CameraCommand command = exposing(1ms);
    command.region = {0, 0, 96, 64};
    command.exposure_auto = true;
    this->command(command);
    plan(kStart, 10ms);
    run(kStart + 120ms);
    std::vector<std::vector<std::uint8_t>> bytes;
    for (const PictureSample& sample : handed_over_) {
      bytes.push_back(sample.picture->parts.at(0).bytes);
    }
    return bytes;
  };
  const auto alone = pictures(1);
  ASSERT_GE(alone.size(), 10U);
  EXPECT_NE(alone[3], alone[4]);
  EXPECT_EQ(pictures(3), alone);
}

TEST_F(WorldCameraTest, a_picture_that_fails_ends_the_run_with_its_reason) {
  WorldCameraSettings settings;
  class Failing final : public sim::CameraSensor {
   public:
    [[nodiscard]] Duration span(const CameraCommand&, Duration exposure) const override {
      return exposure;
    }
    [[nodiscard]] Taken take(const sim::Scene&, const sim::CameraShot&,
                             sim::CameraTruth*) override {
      throw std::invalid_argument("the shot does not fit");
    }
  };
  camera_ = make_world_camera(
      kStation, settings, scene_, terrain_,
      std::make_shared<CameraSurroundings>(Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), 49.4, 7.75,
                                           sim::DaylightParameters{}, sim::WeatherParameters{}),
      [] { return std::make_unique<Failing>(); });
  command(exposing(1ms));
  plan(kStart, 10ms);
  EXPECT_FALSE(camera_->fault());
  run(kStart + 10ms);
  ASSERT_TRUE(camera_->fault());
  EXPECT_NE(camera_->fault()->find("the shot does not fit"), std::string::npos);
}

TEST_F(WorldCameraTest, a_sensor_that_cannot_be_made_says_so_at_once) {
  EXPECT_THROW((void)make_world_camera(kStation, {}, scene_, terrain_, nullptr,
                                       []() -> std::unique_ptr<sim::CameraSensor> {
                                         throw std::invalid_argument("no such lens");
                                       }),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::hil
