// Previews of a rig's camera for people who watch it while no client takes its pictures.
#include "hil/world/camera_previews.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "camera_rig.h"
#include "hil/control/dashboard.h"
#include "hil/devices/gige_camera.h"
#include "hil/stream/run_stream.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kSmallPictures = "    sensor: {image_sensor: {width: 160, height: 120}}\n";

/// Reads no message before it is asked to.
class IdleSocket final : public drivers::WebSocket {
 public:
  void wake() override {}
  void close() override {}
};

class PreviewedRig : public CameraRig {
 protected:
  void TearDown() override { rig.reset(); }  // before what its previews refer to

  void open_small() {
    write(kSmallPictures);
    loaded_.emplace(load_rig(file, {}));
    open();
  }

  [[nodiscard]] PreviewedCamera eye() const {
    const RigConfiguration& configuration = loaded_->configuration;
    const auto& camera = *fields::as<GigeCameraConfiguration>(configuration.devices.at("eye"));
    return {"eye",
            rig->camera_stations().at("eye"),
            sensor_mount(configuration.machine, camera.mount),
            camera.sees_own_link,
            camera.sensor,
            power_on_command(camera)};
  }

  void add_previews() {
    PreviewViewers viewers;
    viewers.wanted = [this](std::size_t /*camera*/) { return watched_.load(); };
    viewers.show = [this](CameraPreview preview) {
      const std::scoped_lock lock(mutex_);
      shown_.push_back(std::move(preview));
      came_.notify_all();
    };
    viewers.failed = [](const std::string& what) { ADD_FAILURE() << what; };
    rig->world().add(make_camera_previews({eye()}, 5, rig->world().scene(), rig->world().terrain(),
                                          rig->more_surroundings(), viewers));
  }
  /// Waits for it. The first preview that is wanted is begun at the end of the next slice.
  CameraPreview first_preview() {
    std::unique_lock lock(mutex_);
    came_.wait(lock, [this] { return !shown_.empty(); });
    return shown_.front();
  }

  std::optional<LoadedRig> loaded_;
  std::atomic<bool> watched_{false};
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<CameraPreview> shown_;
};

TEST_F(PreviewedRig, nothing_is_rendered_while_nobody_watches) {
  open_small();
  add_previews();
  rig->executive().run_free(kStart + 100ms);
  watched_ = true;
  rig->executive().run_free(kStart + 200ms);
  // Previews are made in order: one of before would be the first.
  EXPECT_GT(first_preview().time, kStart + 100ms);
}

TEST_F(PreviewedRig, a_preview_is_a_picture_of_what_stands_before_the_camera) {
  open_small();
  add_previews();
  watched_ = true;
  rig->executive().run_free(kStart + 20ms);
  const CameraPreview preview = first_preview();
  EXPECT_EQ(preview.camera, 0U);
  EXPECT_EQ(preview.picture.columns, 160U);
  EXPECT_EQ(preview.picture.rows, 120U);
  // Sky above, ground below.
  EXPECT_GT(preview.picture.sample(5, 5, 0), preview.picture.sample(5, 115, 0));
  EXPECT_GT(preview.picture.sample(5, 115, 0), 0);
}

TEST_F(PreviewedRig, while_a_client_takes_pictures_there_is_no_preview) {
  open_small();
  add_previews();
  start_streaming();
  rig->executive().run_free(kStart + 100ms);
  watched_ = true;
  rig->executive().run_free(kStart + 300ms);
  set(2, reg::kAcquisitionStop, 1);
  rig->executive().run_free(kStart + 500ms);
  EXPECT_GT(first_preview().time, kStart + 300ms);
  EXPECT_GT(counts().at("pictures"), 0U);
}

TEST_F(PreviewedRig, previews_change_no_byte_that_the_camera_sends) {
  const auto hash = [this](bool watched) {
    shown_.clear();
    open_small();
    add_previews();
    watched_ = watched;
    rig->executive().run_free(kStart + 100ms);
    if (watched) {
      (void)first_preview();
    }
    start_streaming();
    rig->executive().run_free(kStart + 1s);
    EXPECT_GT(counts().at("pictures"), 5U);
    return rig->device_reports().at(0).statistics.hash.value();
  };
  const std::uint64_t without = hash(false);
  EXPECT_EQ(hash(true), without);
}

TEST_F(PreviewedRig, whoever_subscribes_to_a_camera_without_a_client_gets_a_preview) {
  open_small();
  boost::asio::io_context viewers_io;
  RunStream stream(viewers_io, streamed_run(loaded_->configuration, "session"));
  (void)stream.add_wire("eye", WireKind::ethernet);
  rig->world().add(stream.camera_previews({eye()}, 5, rig->world().scene(), rig->world().terrain(),
                                          rig->more_surroundings()));
  auto answer = stream.viewers().admit({"GET", "/stream", "", "", "", "", "foxglove.websocket.v1"});
  auto owner = answer.open(std::make_shared<IdleSocket>());
  std::optional<std::uint32_t> channel;
  std::optional<std::string> message;
  const auto read = [&] {
    for (auto next = owner.next(); next.bytes; next = owner.next()) {
      if (next.text) {
        for (const json& one : json::parse(*next.bytes).value("channels", json::array())) {
          if (one.at("topic") == "/camera/eye") {
            channel = one.at("id").get<std::uint32_t>();
          }
        }
      } else if ((*next.bytes)[0] == 1) {
        message = *next.bytes;
      }
    }
  };
  read();
  rig->executive().run_free(kStart + 100ms);
  EXPECT_TRUE(channel);
  if (channel) {
    owner.received(
        true, json{{"op", "subscribe"}, {"subscriptions", {{{"id", 7}, {"channelId", *channel}}}}}
                  .dump());
    rig->executive().run_free(kStart + 200ms);
    while (!message) {
      viewers_io.run_one();
      read();
    }
    EXPECT_THAT(*message, HasSubstr("preview, rendered for this page; no client takes the "
                                    "camera's pictures"));
    EXPECT_THAT(*message, HasSubstr("mono8"));
  }
  owner.closed();
  rig.reset();  // before the stream
}

TEST(CameraPreviews, ALargeCameraIsMadeSmallerWithTheSameView) {
  sim::CameraParameters camera;
  camera.sensor.width_px = 1920;
  camera.sensor.height_px = 1200;
  camera.sensor.dead_pixels = 3;
  camera.lens.focal_length_m = 0.006;
  camera.lens.principal_offset_px = {12.0, -6.0};
  camera.samples = 8;
  const auto preview = std::get<sim::CameraParameters>(preview_of(camera));
  EXPECT_EQ(preview.sensor.width_px, 320);
  EXPECT_EQ(preview.sensor.height_px, 200);
  EXPECT_EQ(preview.sensor.dead_pixels, 0);
  EXPECT_DOUBLE_EQ(preview.lens.focal_length_m, 0.001);
  EXPECT_DOUBLE_EQ(preview.lens.principal_offset_px.x(), 2.0);
  EXPECT_EQ(preview.samples, 1);
}

TEST(CameraPreviews, OfEachKindTheFirstHeadIsShown) {
  for (const sim::CameraKind& kind : {sim::CameraKind(sim::StereoCameraParameters{}),
                                      sim::CameraKind(sim::DepthCameraParameters{}),
                                      sim::CameraKind(sim::AllRoundCameraParameters{})}) {
    const sim::CameraAbilities abilities = sim::abilities_of(preview_of(kind));  // it is valid
    EXPECT_LE(abilities.width_px, kPreviewWidth_px);
    EXPECT_GE(abilities.width_px, kPreviewWidth_px / 2);
    EXPECT_TRUE(abilities.parts.intensity);
  }
  EXPECT_TRUE(
      std::holds_alternative<sim::CameraParameters>(preview_of(sim::StereoCameraParameters{})));
}

TEST(CameraPreviews, ThePreviewOfARoundPictureThatEndsAtTheNadirDoesSoToo) {
  sim::AllRoundCameraParameters round;
  round.width_px = 1023;
  round.height_px = 511;
  round.elevation_upper_rad = 1.5707963267948966;
  EXPECT_NO_THROW((void)sim::abilities_of(preview_of(round)));
}

}  // namespace
}  // namespace rigwire::hil
