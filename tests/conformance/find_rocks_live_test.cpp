// find_rocks against the rigs with a stereo camera, over their wires: what it logs is judged by the
// labels of the truth tap, with one set of constants and options for both.
//
// A machine stands while it looks, so every picture shows the same rocks. A report is right when
// its rectangle shows one rock for a third or more, at the distance that is reported; a rock ought
// to be found when it is seen whole where there are disparities, is as wide as the least size and
// within the distance that is judged. These are the rules of
// tests/examples/find_rocks_judge_test.cpp, which judges more views, without wires.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "child_process.h"
#include "gige_camera_rig.h"
#include "hil/files/image_file.h"
#include "private_wires.h"
#include "sim/camera/stereo_camera.h"

namespace rigwire::conformance {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using test::ChildProcess;
using test::eventually;

constexpr double kLeast_m = 0.4;
constexpr double kRightWithin_m = 1.0;
constexpr double kShareOfRectangle = 1.0 / 3.0;
/// Pictures behind what is judged: the camera's exposure is settled, and rocks are believed.
constexpr std::size_t kPictures = 5;

struct Place {
  const char* rig;
  std::vector<std::string> sets;     ///< Where its machine stands.
  std::vector<std::string> options;  ///< Of find_rocks: how the camera stands.
  double farthest_m;
};

struct Score {
  int reports = 0;
  int right = 0;
  int rocks = 0;  ///< That ought to be found.
  int found = 0;
};

/// A rock as the labels show it.
struct TrueRock {
  int left = 1 << 20, top = 1 << 20, right = 0, bottom = 0;
  double depth_m = 1e9;
  int pixels = 0;
  bool found = false;
};

std::vector<Json> lines(const std::filesystem::path& file) {
  std::vector<Json> all;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (Json parsed = Json::parse(line, nullptr, false); !parsed.is_discarded()) {
      all.push_back(std::move(parsed));
    }
  }
  return all;
}

/// What is true behind a picture.
class Truth {
 public:
  Truth(const std::filesystem::path& folder, const Json& picture)
      : names_(Json::parse(std::ifstream(folder / "labels.json"))["instances"]) {
    const auto layer = [&](const char* name) {
      return hil::read_png(folder / picture["files"][name].get<std::string>(), "truth: ");
    };
    depth_ = layer("depth");
    instances_ = layer("instances");
  }

  [[nodiscard]] int width() const { return static_cast<int>(depth_.columns); }
  [[nodiscard]] int height() const { return static_cast<int>(depth_.rows); }
  [[nodiscard]] unsigned instance(int column, int row) const {
    const auto c = static_cast<std::size_t>(column);
    const auto r = static_cast<std::size_t>(row);
    return instances_.sample(c, r, 0) + 256U * instances_.sample(c, r, 1) +
           65536U * instances_.sample(c, r, 2);
  }
  [[nodiscard]] std::map<unsigned, TrueRock> rocks() const {
    std::map<unsigned, TrueRock> all;
    for (int v = 0; v < height(); ++v) {
      for (int u = 0; u < width(); ++u) {
        const unsigned number = instance(u, v);
        if (number == 0 || names_.at(number).at("label") != "rock") {
          continue;
        }
        TrueRock& rock = all[number];
        rock.left = std::min(rock.left, u);
        rock.right = std::max(rock.right, u + 1);
        rock.top = std::min(rock.top, v);
        rock.bottom = std::max(rock.bottom, v + 1);
        rock.depth_m = std::min(rock.depth_m, 1e-3 * depth_.sample(static_cast<std::size_t>(u),
                                                                   static_cast<std::size_t>(v), 0));
        ++rock.pixels;
      }
    }
    return all;
  }

 private:
  Json names_;
  hil::Image depth_, instances_;
};

Score judge(const Json& reported, const Truth& truth, double farthest_m) {
  const sim::StereoCameraParameters camera;
  const sim::ReportedGeometry geometry = sim::stereo_geometry(camera);
  const double focal_px = geometry.focal_length_px;
  std::map<unsigned, TrueRock> rocks = truth.rocks();
  Score score;
  for (const auto& [number, report] : reported.items()) {
    const double x_m = report["x_m"];
    const double width_m = report["width_m"];
    // The rectangle that it covers, as the camera's mount has it: x ahead, y left, z up.
    const double u = geometry.principal_u_px - focal_px * report["y_m"].get<double>() / x_m;
    const double v = geometry.principal_v_px - focal_px * report["z_m"].get<double>() / x_m;
    const double half_width = 0.5 * focal_px * width_m / x_m;
    const double half_height = 0.5 * focal_px * report["height_m"].get<double>() / x_m;
    std::map<unsigned, int> shown;
    int rectangle = 0;
    for (int row = std::max(0, static_cast<int>(v - half_height));
         row < std::min<double>(truth.height(), v + half_height); ++row) {
      for (int column = std::max(0, static_cast<int>(u - half_width));
           column < std::min<double>(truth.width(), u + half_width); ++column) {
        ++shown[truth.instance(column, row)];
        ++rectangle;
      }
    }
    ++score.reports;
    bool right = false;
    for (auto& [instance, rock] : rocks) {
      const auto pixels = shown.find(instance);
      if (pixels == shown.end() || std::abs(x_m - rock.depth_m) > kRightWithin_m + 0.5 * width_m) {
        continue;
      }
      right = right || pixels->second >= kShareOfRectangle * rectangle;
      rock.found = rock.found || 2 * pixels->second >= rock.pixels;
    }
    score.right += right ? 1 : 0;
    if (!right) {
      std::printf("  wrong: %s\n", report.dump().c_str());
    }
  }
  const int first_column = camera.matching.disparities + 2;
  for (const auto& [number, rock] : rocks) {
    const bool whole = rock.left > first_column && rock.top > 2 && rock.right < truth.width() - 2 &&
                       rock.bottom < truth.height() - 2;
    if (whole && (rock.right - rock.left) * rock.depth_m / focal_px >= kLeast_m &&
        rock.depth_m < farthest_m) {
      ++score.rocks;
      score.found += rock.found ? 1 : 0;
    }
  }
  return score;
}

/// The program beside a rig at a tenth of real time, until it has looked at kPictures; its last
/// reports judged.
Score look(const Place& place) {
  const test::PrivateWires wires;
  const std::string camera = own_address();
  const auto truth = wires.folder / "truth";
  const auto log = wires.folder / "rocks.jsonl";
  std::vector<std::string> command{RIGWIRE_BINARY_DIR "/rigwire",
                                   "run",
                                   place.rig,
                                   "--status",
                                   "none",
                                   "--clock",
                                   "scaled:0.1",
                                   "--camera-truth",
                                   truth.string()};
  std::vector<std::string> sets =
      place.rig == std::string("unimog_vision") ? wires.driving_sets() : wires.sets();
  sets.insert(sets.end(), place.sets.begin(), place.sets.end());
  sets.push_back("devices.stereo.address=" + camera);
  sets.push_back("devices.stereo.rate=2 Hz");
  sets.push_back("devices.stereo.processing=450 ms");  // a picture's time on a busy machine
  sets.push_back("devices.stereo.exposure=0.3 ms");    // near where it settles
  sets.push_back(
      "devices." +
      std::string(place.rig == std::string("unimog_vision") ? "front_camera" : "surround") +
      ".address=" + own_address());
  for (const std::string& set : sets) {
    command.insert(command.end(), {"--set", set});
  }
  ChildProcess rig(command, wires.folder / "rig.log");
  std::vector<std::string> program{RIGWIRE_BINARY_DIR "/find_rocks",
                                   "--camera",
                                   camera,
                                   "--log",
                                   log.string(),
                                   "--patience",
                                   "60",
                                   "--wait"};
  program.insert(program.end(), place.options.begin(), place.options.end());
  ChildProcess finder(program, wires.folder / "finder.log");
  EXPECT_TRUE(eventually([&] { return lines(log).size() >= kPictures; }, 300s))
      << lines(log).size() << " pictures\n"
      << rig.output() << finder.output();
  finder.signal(SIGINT);
  EXPECT_EQ(finder.wait(), 0) << finder.output();
  rig.signal(SIGINT);
  EXPECT_TRUE(rig.wait()) << rig.output();
  const std::vector<Json> log_lines = lines(log);
  if (log_lines.empty()) {
    return {};
  }
  const Json& last = log_lines.back();
  for (const Json& picture : lines(truth / "stereo.jsonl")) {
    if (std::abs(picture["sim_s"].get<double>() - last["camera_s"].get<double>()) < 1e-5) {
      const Score score = judge(last["rocks"], Truth(truth, picture), place.farthest_m);
      std::printf("%s %s, up to %.0f m: precision %d of %d, recall %d of %d\n", place.rig,
                  place.sets.front().c_str(), place.farthest_m, score.right, score.reports,
                  score.found, score.rocks);
      return score;
    }
  }
  ADD_FAILURE() << "there is no truth of the picture at " << last["camera_s"];
  return {};
}

Score look(const std::vector<Place>& places) {
  Score sum;
  for (const Place& place : places) {
    const Score score = look(place);
    sum.reports += score.reports;
    sum.right += score.right;
    sum.rocks += score.rocks;
    sum.found += score.found;
  }
  return sum;
}

void expect_good(const Score& score, int rocks) {
  EXPECT_GE(score.rocks, rocks);
  EXPECT_GE(score.reports, rocks);
  EXPECT_GE(score.right, 0.75 * score.reports);
  EXPECT_GE(score.found, 0.5 * score.rocks);
}

TEST(FindRocksLive, FindsTheRocksOfThePitFromTheExcavator) {
  const std::vector<std::string> options{"--mount",  "3.15,15",    "--own-box",
                                         "-1.7,0,9", "--farthest", "8"};
  expect_good(look({{"excavator_vision", {"machine.yaw=220 deg"}, options, 8.0}}), 1);
}

TEST(FindRocksLive, FindsTheRocksOfTheForestFromTheUnimog) {
  const std::vector<std::string> options{"--mount", "2.6,15", "--farthest", "9"};
  expect_good(look({{"unimog_vision", {"machine.position=[16 m, -2 m, 0 m]"}, options, 9.0}}), 1);
}

}  // namespace
}  // namespace rigwire::conformance
