// What is true behind the pictures of a run, as files: it is that of the very pictures that the
// client gets, it is complete, and what it costs or fails by changes no picture.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "camera_rig.h"
#include "file_text.h"
#include "hil/configuration/problems.h"
#include "hil/files/image_file.h"
#include "hil/record/camera_truth_tap.h"
#include "protocols/bytes.h"
#include "protocols/gige_vision/gvsp.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using nlohmann::json;
using test::text_of;
using testing::HasSubstr;

constexpr const char* kSmall =
    "    sensor: {lens: {focal_length: 0.5 mm}, image_sensor: {width: 160, height: 120}}\n";

class CameraTruth : public CameraRig {
 protected:
  /// Runs with a client that streams; what the camera sent is in `blocks` by their time stamps.
  RunOutcome run(Duration duration, const std::vector<std::string>& sets = {}, bool paced = false) {
    blocks.clear();
    TruthFiles truth;
    truth.cameras = folder;
    truth.failures = &failures;
    truth.patience = paced ? 0ms : std::chrono::milliseconds(kReaderPatience);
    open(sets, truth);
    sink.start([this](const drivers::DatagramPort::Peer&, std::span<const std::uint8_t> packet) {
      take(packet);
    });
    start_streaming();
    RunOutcome outcome = paced ? rig->executive().run_paced({}, kStart + duration)
                               : rig->executive().run_free(kStart + duration);
    counted = counts();
    hash = rig->device_reports().at(0).statistics.hash.value();
    rig.reset();
    return outcome;
  }

  void take(std::span<const std::uint8_t> packet) {
    constexpr std::size_t kLeaderTimestamp = gev::kShortHeaderSize + 4;
    switch (static_cast<gev::PacketFormat>(packet[4])) {
      case gev::PacketFormat::leader:
        present_ = &blocks[protocols::load_big<std::uint64_t>(packet, kLeaderTimestamp)];
        return;
      case gev::PacketFormat::payload:
        present_->insert(present_->end(), packet.begin() + gev::kShortHeaderSize, packet.end());
        return;
      default:
        return;
    }
  }

  [[nodiscard]] std::vector<json> lines() const {
    std::vector<json> all;
    std::istringstream stream(text_of(folder / "eye.jsonl"));
    for (std::string line; std::getline(stream, line);) {
      all.push_back(json::parse(line));
    }
    return all;
  }
  [[nodiscard]] Image image(const json& line, const char* layer) const {
    return read_png(folder / line["files"][layer].get<std::string>(), "");
  }
  [[nodiscard]] std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(folder)) {
      all.emplace(entry.path().filename(), text_of(entry.path()));
    }
    return all;
  }

  fs::path folder = wires.folder / "truth";
  std::vector<std::string> said;
  OutputFailures failures{[this](const std::string& what) { said.push_back(what); }};
  std::map<std::uint64_t, std::vector<std::uint8_t>> blocks;
  std::map<std::string, std::uint64_t> counted;
  std::uint64_t hash = 0;

 private:
  std::vector<std::uint8_t>* present_ = nullptr;
};

TEST_F(CameraTruth, is_behind_the_pictures_that_the_client_gets) {
  write(kSmall);
  ASSERT_FALSE(run(500ms).fault);
  const std::vector<json> pictures = lines();
  ASSERT_GE(pictures.size(), 7U);
  EXPECT_EQ(pictures.size(), counted.at("pictures"));
  for (const json& line : pictures) {
    const auto stamp = static_cast<std::uint64_t>(std::llround(line["sim_s"].get<double>() * 1e9));
    ASSERT_TRUE(blocks.contains(stamp)) << line;
    const Image sent = image(line, "image");
    EXPECT_TRUE(std::ranges::equal(sent.samples, blocks.at(stamp))) << line;
    EXPECT_EQ(line["region"], json({0, 0, 160, 120}));
  }
  const json tables = json::parse(text_of(folder / "labels.json"));
  EXPECT_EQ(tables["start_utc"], "2026-06-01T08:00:00Z");
  // The box ahead, its near side 7 m east of the origin; the camera is 1.5 m before the machine's,
  // which may sit a few centimetres off its place.
  const json& last = pictures.back();
  const Image depth = image(last, "depth");
  const Image labels = image(last, "labels");
  const Image instances = image(last, "instances");
  ASSERT_EQ(depth.bits, 16);
  ASSERT_EQ(labels.bits, 16);
  ASSERT_EQ(instances.channels, 3U);
  const std::size_t u = 78;  // a little to the left, where the box is
  const std::size_t v = 66;  // and below the horizon
  EXPECT_NEAR(depth.sample(u, v, 0), 5500, 150);
  const json& instance =
      tables["instances"].at(instances.sample(u, v, 0) + 256U * instances.sample(u, v, 1) +
                             65536U * instances.sample(u, v, 2));
  EXPECT_EQ(instance["label"], tables["labels"].at(labels.sample(u, v, 0)));
  EXPECT_NE(instance["label"], "ground");
  EXPECT_EQ(tables["labels"].at(labels.sample(80, 115, 0)), "ground");
  EXPECT_EQ(tables["labels"].at(labels.sample(80, 2, 0)), "") << "the sky has a label";
  EXPECT_EQ(depth.sample(80, 2, 0), 0);
}

TEST_F(CameraTruth, has_the_same_bytes_whatever_the_threads_and_changes_no_picture) {
  write(kSmall);
  ASSERT_FALSE(run(400ms, {"devices.eye.sensor.threads=1"}).fault);
  const auto first = contents();
  const std::uint64_t with_truth = hash;
  EXPECT_GE(first.size(), 1U + 1U + 4U * 5U);
  ASSERT_FALSE(run(400ms, {"devices.eye.sensor.threads=3"}).fault);
  EXPECT_EQ(contents(), first);
  folder.clear();
  ASSERT_FALSE(run(400ms).fault);
  EXPECT_EQ(hash, with_truth);
}

TEST_F(CameraTruth, of_pictures_that_a_paced_run_skips_is_not_there) {
  // A picture takes some tenths of a second, so that of ten in a second most are skipped.
  write("    rate: 10 Hz\n    processing: 300 ms\n    sensor: {samples: 8}\n");
  ASSERT_FALSE(run(2s, {}, true).fault);
  ASSERT_GT(counted.at("skipped_pictures"), 0U);
  const std::vector<json> pictures = lines();
  // The truth goes ahead of the wires: the last picture may be for after the end of the run.
  EXPECT_GE(pictures.size(), counted.at("pictures"));
  EXPECT_LE(pictures.size(), counted.at("pictures") + 1);
  std::set<std::uint64_t> exposures;
  for (const json& line : pictures) {
    exposures.insert(line["exposure"].get<std::uint64_t>());
    EXPECT_TRUE(fs::exists(folder / line["files"]["depth"].get<std::string>()));
  }
  const auto files = std::ranges::count_if(
      contents(), [](const auto& written) { return written.first.ends_with("_depth.png"); });
  EXPECT_EQ(exposures.size(), pictures.size());
  EXPECT_EQ(static_cast<std::size_t>(files), pictures.size());
  EXPECT_TRUE(said.empty());
}

TEST_F(CameraTruth, of_a_full_disk_is_said_once_and_the_run_goes_on) {
  write(kSmall);
  fs::create_directories(folder);
  fs::create_symlink("/dev/full", folder / "eye_000002_depth.png");
  const RunOutcome outcome = run(400ms);
  EXPECT_FALSE(outcome.fault);
  EXPECT_EQ(outcome.reached, kStart + 400ms);
  EXPECT_GE(counted.at("pictures"), 5U);
  EXPECT_TRUE(failures.any());
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0], HasSubstr("eye_000002_depth.png is not written: No space left on device"));
  EXPECT_EQ(lines().size(), 2U) << "lines tell of files that are not whole";
}

TEST_F(CameraTruth, is_refused_where_no_folder_can_be) {
  write(kSmall);
  std::ofstream(wires.folder / "file") << "x";
  folder = wires.folder / "file" / "truth";
  try {
    (void)run(10ms);
    FAIL() << "it ran";
  } catch (const drivers::EndpointError& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr(folder.string()));
    EXPECT_THAT(refusal.what(), HasSubstr("Not a directory"));
  }
}

TEST_F(CameraTruth, of_a_rig_without_cameras_is_refused) {
  std::ofstream(file) << "machine: {include: " RIGWIRE_SOURCE_DIR
                         "/configs/machines/gator_855d.yaml}\n"
                         "scene: {terrain: {type: level, size: 60 m, cell: 1 m}}\n";
  TruthFiles truth;
  truth.cameras = folder;
  try {
    open({}, truth);
    FAIL() << "it was accepted";
  } catch (const std::invalid_argument& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("found 0 cameras"));
  }
}

TEST_F(CameraTruth, of_a_camera_that_there_is_not_is_refused_with_its_place) {
  write(kSmall);
  std::ofstream(file, std::ios::app) << "truth: {cameras: [eyes]}\n";
  try {
    (void)load_rig(file, {});
    FAIL() << "it was accepted";
  } catch (const ConfigurationError& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("rig.yaml:"));
    EXPECT_THAT(refusal.what(), HasSubstr("truth.cameras.0"));
    EXPECT_THAT(refusal.what(), HasSubstr("found \"eyes\", allowed eye"));
  }
}

}  // namespace
}  // namespace rigwire::hil
