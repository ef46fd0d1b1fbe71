// find_rocks as a process, on the sockets of this host: it finds, logs, and ends with a reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "child_process.h"
#include "loopback_camera.h"
#include "private_wires.h"
#include "stereo_stage.h"

namespace rigwire::find_rocks {
namespace {

using nlohmann::json;
using test::ChildProcess;
using test::eventually;
using testing::HasSubstr;

constexpr int kWidth = 320;
constexpr int kHeight = 240;

/// A boulder 6 m ahead, as a camera of half the stage's resolution sees it.
class FindRocksProgram : public testing::Test {
 protected:
  static emulators::GigeCameraSettings head() {
    emulators::GigeCameraSettings settings;
    settings.kind = emulators::GigeCameraKind::stereo;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.frame_period = std::chrono::milliseconds{100};
    const StereoGeometry stage = stage_geometry();
    settings.geometry = {stage.focal_px / 2,
                         stage.baseline_m,
                         (kWidth - 1) / 2.0,
                         (kHeight - 1) / 2.0,
                         {stage.scale_px, 0.0, 0}};
    return settings;
  }

  std::shared_ptr<const Picture> picture(const CameraCommand& command, SimTime start) const {
    auto made = std::make_shared<Picture>();
    made->exposure_start = start;
    made->exposure = command.exposure;
    if (command.disparity) {
      made->parts.push_back(
          {PictureComponent::disparity, 0, PixelFormat::coord3d_c16, command.region, pixels});
    }
    if (command.confidence) {
      made->parts.push_back({PictureComponent::confidence, 0, PixelFormat::confidence8,
                             command.region, std::vector<std::uint8_t>(kWidth * kHeight, 255)});
    }
    return made;
  }

  [[nodiscard]] field::LoopbackCamera::Sensor sensor() const {
    return [this](const CameraCommand& c, SimTime t) { return picture(c, t); };
  }

  [[nodiscard]] std::vector<std::string> command(std::vector<std::string> more) const {
    std::vector<std::string> all{std::string(RIGWIRE_BINARY_DIR) + "/find_rocks", "--camera",
                                 address_};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  [[nodiscard]] std::vector<json> lines(const std::filesystem::path& file) const {
    std::vector<json> all;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      if (json parsed = json::parse(line, nullptr, false); !parsed.is_discarded()) {
        all.push_back(std::move(parsed));
      }
    }
    return all;
  }

  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / ("find_rocks_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    Stage stage;
    stage.boulders = {{6.5, -0.5, 0.2, 0.6}};
    stage.noise_px = 0.06;
    stage.unmatched_columns = 40;
    pixels = stage_pixels(stage, kWidth, kHeight);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  const std::string address_ = test::own_address();
  std::filesystem::path folder;
  std::vector<std::uint8_t> pixels;
};

TEST_F(FindRocksProgram, FindsAndLogs) {
  field::LoopbackCamera camera(address_, head(), sensor());
  ChildProcess program(
      command({"--farthest", "9", "--log", folder / "log.jsonl", "--csv", folder / "rocks.csv"}),
      folder / "output");
  EXPECT_TRUE(eventually([&] {
    const auto log = lines(folder / "log.jsonl");
    return log.size() >= 5 && log.back()["rocks"].size() == 1 &&
           log.back()["rocks"].front()["confidence"] > 0.5 &&
           program.output().find("confidence") != std::string::npos;
  })) << program.output();
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(), 0);
  const auto log = lines(folder / "log.jsonl");
  ASSERT_GE(log.size(), 5U);
  const json& last = log.back();
  EXPECT_TRUE(last["ground"]);
  EXPECT_NEAR(last["camera_height_m"], 3.0, 0.1);
  EXPECT_EQ(last["exposure_us"], 5000.0);
  ASSERT_EQ(last["rocks"].size(), 1U) << last;
  const json& rock = last["rocks"].front();
  EXPECT_NEAR(rock["y_m"], -0.5, 0.15);
  EXPECT_NEAR(rock["width_m"], 1.2, 0.3);
  EXPECT_GT(rock["confidence"], 0.5);
  std::ifstream csv(folder / "rocks.csv");
  std::string header;
  std::string row;
  std::getline(csv, header);
  std::getline(csv, row);
  EXPECT_EQ(std::ranges::count(header, ','), 9);
  EXPECT_EQ(std::ranges::count(row, ','), 9);
  EXPECT_TRUE(eventually([&] { return !camera.controlled(); })) << "the camera is not released";
}

TEST_F(FindRocksProgram, EndsWhenTimeIsOver) {
  field::LoopbackCamera camera(address_, head(), sensor());
  ChildProcess program(command({"--duration", "1"}), folder / "output");
  EXPECT_EQ(program.wait(), 0);
  EXPECT_THAT(program.output(), HasSubstr("time is over"));
  EXPECT_TRUE(eventually([&] { return !camera.controlled(); })) << "the camera is not released";
}

TEST_F(FindRocksProgram, ASilentCameraEndsItWithWhy) {
  ChildProcess program(command({"--patience", "1"}), folder / "output");
  EXPECT_EQ(program.wait(), 4);
  EXPECT_THAT(program.output(), HasSubstr("the stereo camera at " + address_ + " is silent: "));
}

TEST_F(FindRocksProgram, ACameraThatGoesBlindEndsItWithWhy) {
  field::LoopbackCamera camera(address_, head(), sensor());
  ChildProcess program(command({"--patience", "2", "--log", folder / "log.jsonl"}),
                       folder / "output");
  ASSERT_TRUE(eventually([&] { return lines(folder / "log.jsonl").size() > 2; }));
  camera.blind();
  EXPECT_EQ(program.wait(), 4);
  EXPECT_THAT(program.output(), HasSubstr("is silent: it sends no pictures"));
}

TEST_F(FindRocksProgram, ACameraWithoutDisparityIsRefusedByName) {
  emulators::GigeCameraSettings plain = head();
  plain.kind = emulators::GigeCameraKind::camera;
  field::LoopbackCamera camera(address_, plain, sensor());
  // Long enough to read the camera's description on a busy machine.
  ChildProcess program(command({"--patience", "8"}), folder / "output");
  EXPECT_EQ(program.wait(), 4);
  EXPECT_THAT(program.output(), HasSubstr("no feature ComponentEnable"));
}

TEST_F(FindRocksProgram, WithWaitItGoesOnWhenTheCameraIsBack) {
  ChildProcess program(command({"--patience", "1", "--wait", "--log", folder / "log.jsonl"}),
                       folder / "output");
  EXPECT_TRUE(eventually(
      [&] { return program.output().find("waiting for the stereo camera") != std::string::npos; }));
  for (int camera = 0; camera < 2; ++camera) {
    const std::size_t before = lines(folder / "log.jsonl").size();
    field::LoopbackCamera head_again(address_, head(), sensor());
    EXPECT_TRUE(eventually([&] { return lines(folder / "log.jsonl").size() > before + 2; }));
  }
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(), 0);
  EXPECT_THAT(program.output(), HasSubstr("interrupted"));
}

TEST_F(FindRocksProgram, AnAddressThatIsNoneIsRefused) {
  ChildProcess program({std::string(RIGWIRE_BINARY_DIR) + "/find_rocks", "--camera", "here"},
                       folder / "output");
  EXPECT_EQ(program.wait(), 3);
  EXPECT_THAT(program.output(), HasSubstr("here"));
}

}  // namespace
}  // namespace rigwire::find_rocks
