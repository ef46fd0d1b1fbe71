// find_rocks against the rigs with a stereo camera, over their wires: what it logs is judged by the
// labels of the truth tap, with one set of constants and options for both.
//
// A machine stands while it looks, so that every picture shows the same rocks. A report is right
// when its rectangle shows one rock for a third or more, at the distance that is reported; a rock
// ought to be found when it is seen whole where there are disparities, is as wide as the least size
// and within the distance that is judged. These are the rules of
// tests/examples/find_rocks_judge_test.cpp, which judges more views, without wires.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "child_process.h"
#include "drivers/modbus_master.h"
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
  std::vector<std::string> options;  ///< Options of find_rocks: how the camera stands.
  double farthest_m;
};

struct Score {
  int reports = 0;
  int right = 0;
  int rocks = 0;  ///< Rocks that ought to be found.
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

/// A rock that ought to be found in a picture.
struct Due {
  double width_m = 0.0;
  double depth_m = 0.0;
  bool found = false;
};

/// `due`: filled unless null, by instance.
Score judge(const Json& reported, const Truth& truth, double farthest_m,
            std::map<unsigned, Due>* due = nullptr) {
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
    const double width_m = (rock.right - rock.left) * rock.depth_m / focal_px;
    if (whole && width_m >= kLeast_m && rock.depth_m < farthest_m) {
      if (due != nullptr) {
        due->emplace(number, Due{width_m, rock.depth_m, rock.found});
      }
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
  EXPECT_TRUE(eventually([&] { return lines(log).size() >= kPictures; }))
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

/// What field-program.md has of the pit up to 8 m, one picture each of views without wires.
constexpr Score kOfThePage{.reports = 14, .right = 14, .rocks = 15, .found = 12};

/// Lower end of the 95 % interval of a share of which `good` of `all` were seen (E. B. Wilson,
/// "Probable inference", 1927).
double at_least(int good, int all) {
  constexpr double kZ = 1.96;
  const double n = all;
  const double p = good / n;
  const double middle = p + kZ * kZ / (2.0 * n);
  const double half = kZ * std::sqrt(p * (1.0 - p) / n + kZ * kZ / (4.0 * n * n));
  return (middle - half) / (1.0 + kZ * kZ / n);
}

/// Turns the upper structure by its valve section over the wire.
class Swing {
 public:
  explicit Swing(std::uint16_t port)
      : master_({.port = port, .connect_timeout = 5000ms, .response_timeout = 5000ms}) {}

  void begin() {
    ASSERT_TRUE(eventually([&] { return static_cast<bool>(master_.connect()); }));
    ASSERT_TRUE(master_.write_register(16, 0));  // without a watchdog
    ASSERT_TRUE(master_.write_register(0, 1));   // enabled
  }
  /// Left from where it began, past that angle.
  void to(double angle_deg) {
    ASSERT_TRUE(master_.write_register(1, 600));
    EXPECT_TRUE(eventually([&] { return angle_deg_now() >= angle_deg; }));
    ASSERT_TRUE(master_.write_register(1, 0));
  }
  double angle_deg_now() {
    std::array<std::uint16_t, 2> angle{};  // 0.001 deg, the high word first
    EXPECT_TRUE(master_.read_input_registers(30, angle));
    return 1e-3 * static_cast<std::int32_t>(std::uint32_t{angle[0]} << 16U | angle[1]);
  }

 private:
  drivers::ModbusMaster master_;
};

/// One run of the rig: the machine swings from stop to stop over three quarters of what the judge
/// without wires looks at, and at each stop the last picture is judged when as many have been
/// looked at as the program remembers. The bounds are the lower ends of the 95 % intervals of the
/// page's figures without wires, set before any live result was seen. A first form judged every
/// picture of a swing without stops, and did not meet them: field-program.md says why. The stops
/// were set before they were first judged, and moved once, as the bucket stands in a heap at 80
/// deg. Not one of the suite's: it took 172 s on a busy machine. To run it:
/// --gtest_also_run_disabled_tests --gtest_filter='*Swinging*'
TEST(FindRocksLive, DISABLED_SwingingOverThePitItReportsTheRocksInRange) {
  constexpr double kFarthest_m = 8.0;
  constexpr double kYaw_deg = 120.0;
  constexpr std::size_t kRemembered = 10;  // pictures
  const test::PrivateWires wires;
  const std::string camera = own_address();
  const auto truth = wires.folder / "truth";
  const auto log = wires.folder / "rocks.jsonl";
  std::vector<std::string> command{RIGWIRE_BINARY_DIR "/rigwire",
                                   "run",
                                   "excavator_vision",
                                   "--status",
                                   "none",
                                   "--clock",
                                   "scaled:0.2",
                                   "--camera-truth",
                                   truth.string()};
  std::vector<std::string> sets = wires.sets();
  sets.insert(sets.end(), {"machine.yaw=120 deg", "devices.stereo.address=" + camera,
                           "devices.stereo.processing=450 ms",  // a picture's on a busy machine
                           "devices.stereo.exposure=0.06 ms",   // near where it settles
                           "devices.surround.address=" + own_address()});
  for (const std::string& set : sets) {
    command.insert(command.end(), {"--set", set});
  }
  ChildProcess rig(command, wires.folder / "rig.log");
  ChildProcess finder(
      {RIGWIRE_BINARY_DIR "/find_rocks", "--camera", camera, "--mount", "3.15,15", "--own-box",
       "-1.7,0,9", "--farthest", "8", "--log", log.string(), "--patience", "60", "--wait"},
      wires.folder / "finder.log");
  Swing swing(wires.modbus_port);
  swing.begin();
  ASSERT_FALSE(HasFatalFailure()) << rig.output();
  struct Stop {
    double yaw_deg;
    Json last;  ///< Picture's line of the log.
  };
  std::vector<Stop> stops;
  for (const double stop_deg : {0.0, 45.0, 90.0, 135.0, 180.0}) {
    if (stop_deg > 0.0) {
      swing.to(stop_deg);
      ASSERT_FALSE(HasFatalFailure()) << rig.output();
    }
    const std::size_t before = lines(log).size();
    ASSERT_TRUE(eventually([&] { return lines(log).size() >= before + kRemembered; }))
        << lines(log).size() - before << " pictures\n"
        << rig.output() << finder.output();
    stops.push_back({kYaw_deg + swing.angle_deg_now(), lines(log).back()});
  }
  finder.signal(SIGINT);
  EXPECT_EQ(finder.wait(), 0) << finder.output();
  rig.signal(SIGINT);
  EXPECT_TRUE(rig.wait()) << rig.output();

  Score sum;
  const std::vector<Json> taken = lines(truth / "stereo.jsonl");
  for (const auto& [yaw_deg, last] : stops) {
    const auto picture = std::ranges::find_if(taken, [&at = last](const Json& other) {
      return std::abs(other["sim_s"].get<double>() - at["camera_s"].get<double>()) < 1e-5;
    });
    ASSERT_NE(picture, taken.end()) << last["camera_s"];
    std::map<unsigned, Due> due;
    const Score score = judge(last["rocks"], Truth(truth, *picture), kFarthest_m, &due);
    std::printf("at %.0f deg: %d of %d reports right\n", yaw_deg, score.right, score.reports);
    for (const auto& [number, rock] : due) {
      std::printf("  %s rock %u, %.2f m wide, %.1f m ahead\n", rock.found ? "found " : "missed",
                  number, rock.width_m, rock.depth_m);
    }
    sum.reports += score.reports;
    sum.right += score.right;
    sum.rocks += score.rocks;
    sum.found += score.found;
  }
  std::printf("%zu stops: precision %d of %d, recall %d of %d\n", stops.size(), sum.right,
              sum.reports, sum.found, sum.rocks);
  ASSERT_GE(sum.rocks, 4);
  ASSERT_GE(sum.reports, 3);
  EXPECT_GE(sum.right, at_least(kOfThePage.right, kOfThePage.reports) * sum.reports);
  EXPECT_GE(sum.found, at_least(kOfThePage.found, kOfThePage.rocks) * sum.rocks);
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
