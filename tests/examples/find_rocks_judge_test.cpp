// How good find_rocks is: precision and recall in the scenes of the two rigs with a stereo camera,
// judged by the labels of what each pixel shows. In the pit the camera stands as on the excavator's
// cab, the upper structure turned step by step; in the forest as on the Unimog, metre by metre
// along the track. Its pictures are rendered, with the sensor's noise, and matched.
//
// A report is right when its rectangle shows one rock for a third or more, at the distance that is
// reported. A rock ought to be found when it is seen whole where there are disparities, is as wide
// as the least size and within the distance that is judged.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>

#include "find_rocks/rock_finder.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/world/scene.h"
#include "sim/camera/stereo_camera.h"

namespace rigwire::find_rocks {
namespace {

using namespace std::chrono_literals;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRightWithin_m = 1.0;
constexpr double kShareOfRectangle = 1.0 / 3.0;

struct Score {
  int reports = 0;
  int right = 0;
  int rocks = 0;  ///< Rocks that ought to be found.
  int found = 0;

  [[nodiscard]] double precision() const { return static_cast<double>(right) / reports; }
  [[nodiscard]] double recall() const { return static_cast<double>(found) / rocks; }
};

/// A rock as the labels show it.
struct TrueRock {
  PictureArea area{1 << 20, 1 << 20, 0, 0};
  double depth_m = 1e9;
  int pixels = 0;
  bool found = false;
};

/// Where on its machine a camera is: pitched down by an angle.
struct Mount {
  Eigen::Vector3d position_m;  ///< Over what the machine stands on.
  double pitch_deg = 15.0;
};

class FindRocksJudge : public testing::Test {
 protected:
  FindRocksJudge(const char* file, const Mount& mount) : mounted(mount) {
    hil::Problems problems;
    hil::Origins origins;
    hil::SceneConfiguration scene;
    hil::read(
        hil::load_document(std::string(RIGWIRE_SOURCE_DIR) + "/configs/scenes/" + file, problems),
        scene, problems, origins);
    problems.throw_if_any();
    const hil::SceneFiles files = hil::load_scene_files(scene.description, {});
    built = sim::build_scene(files.description, files.meshes, 1);
  }

  /// The camera of a machine that stands there, turned left from east.
  [[nodiscard]] Eigen::Isometry3d camera_at(const Eigen::Vector2d& place, double yaw_deg) const {
    Eigen::Isometry3d X_WS = Eigen::Isometry3d::Identity();
    X_WS.translate(
        Eigen::Vector3d(place.x(), place.y(), built.ground.height_m(place.x(), place.y())));
    X_WS.rotate(Eigen::AngleAxisd(yaw_deg * kDegree, Eigen::Vector3d::UnitZ()));
    X_WS.translate(mounted.position_m);
    X_WS.rotate(Eigen::AngleAxisd(mounted.pitch_deg * kDegree, Eigen::Vector3d::UnitY()));
    return X_WS;
  }

  struct View {
    StereoPicture picture;
    sim::CameraTruth truth;
  };

  /// What the camera sees from there.
  [[nodiscard]] View view(const Eigen::Isometry3d& X_WS) const {
    const auto camera = sim::make_stereo_camera(parameters, 1, "front_camera");
    const sim::Daylight light({}, Eigen::Vector3d(0.45, -0.45, 0.77).normalized());
    sim::CameraShot shot;
    const int width = parameters.camera.sensor.width_px;
    const int height = parameters.camera.sensor.height_px;
    shot.command.region = {0, 0, width, height};
    shot.command.disparity = true;
    shot.command.confidence = true;
    shot.exposure = 150us;
    shot.start = kStart + 10ms;
    shot.light = &light;
    for (int i = 0; i <= 1; ++i) {
      sim::CameraPose pose;
      pose.time = kStart + i * 100ms;
      pose.mount.X_WL = X_WS;
      shot.poses.push_back(pose);
    }
    built.scene->begin_slice(kStart, kStart + 100ms, X_WS.translation(), {});
    sim::CameraTruth truth;
    const auto taken = camera->take(*built.scene, shot, &truth);

    const sim::ReportedGeometry reported = sim::stereo_geometry(parameters);
    const StereoGeometry geometry{reported.focal_length_px, reported.baseline_m,
                                  reported.principal_u_px,  reported.principal_v_px,
                                  reported.coding.scale,    reported.coding.offset,
                                  reported.coding.invalid};
    const auto part = [&taken](PictureComponent component) {
      return std::ranges::find(taken.picture->parts, component, &PicturePart::component)->bytes;
    };
    return {{geometry, width, height, part(PictureComponent::disparity),
             part(PictureComponent::confidence), 128},
            truth};
  }

  /// A picture, judged up to a distance.
  void judge(const View& view, double least_m, double farthest_m, Score& score) const {
    RockSettings settings;
    settings.least_m = least_m;
    settings.farthest_m = farthest_m;
    settings.ground.mount = CameraMount{mounted.position_m.z(), mounted.pitch_deg};
    const FoundRocks found = find_rocks(view.picture, settings);
    const sim::CameraTruth& truth = view.truth;
    std::map<std::uint32_t, TrueRock> rocks = rocks_in(truth);
    for (const SeenRock& rock : found.rocks) {
      ++score.reports;
      score.right += right(rock, truth, rocks) ? 1 : 0;
    }
    const int first_column = parameters.matching.disparities + 2;
    const double focal_px = view.picture.geometry().focal_px;
    const int width = view.picture.width();
    const int height = view.picture.height();
    for (const auto& [label, rock] : rocks) {
      const double width_m = (rock.area.right - rock.area.left) * rock.depth_m / focal_px;
      const bool whole = rock.area.left > first_column && rock.area.top > 2 &&
                         rock.area.right < width - 2 && rock.area.bottom < height - 2;
      if (whole && width_m >= settings.least_m && rock.depth_m < farthest_m) {
        ++score.rocks;
        score.found += rock.found ? 1 : 0;
      }
    }
  }

  [[nodiscard]] std::map<std::uint32_t, TrueRock> rocks_in(const sim::CameraTruth& truth) const {
    std::map<std::uint32_t, TrueRock> rocks;
    for (int v = 0; v < truth.height; ++v) {
      for (int u = 0; u < truth.width; ++u) {
        const auto at = static_cast<std::size_t>(v * truth.width + u);
        const std::uint32_t instance = truth.instance[at];
        if (instance == ~0U || built.scene->label(instance) != "rock") {
          continue;
        }
        TrueRock& rock = rocks[instance];
        rock.area = {std::min(rock.area.left, u), std::min(rock.area.top, v),
                     std::max(rock.area.right, u + 1), std::max(rock.area.bottom, v + 1)};
        rock.depth_m = std::min(rock.depth_m, static_cast<double>(truth.depth_m[at]));
        ++rock.pixels;
      }
    }
    return rocks;
  }

  /// Marks what the report found.
  static bool right(const SeenRock& report, const sim::CameraTruth& truth,
                    std::map<std::uint32_t, TrueRock>& rocks) {
    std::map<std::uint32_t, int> shown;
    for (int v = report.area.top; v < report.area.bottom; ++v) {
      for (int u = report.area.left; u < report.area.right; ++u) {
        ++shown[truth.instance[static_cast<std::size_t>(v * truth.width + u)]];
      }
    }
    const int rectangle =
        (report.area.right - report.area.left) * (report.area.bottom - report.area.top);
    bool any = false;
    for (auto& [instance, rock] : rocks) {
      const auto pixels = shown.find(instance);
      if (pixels == shown.end() ||
          std::abs(report.x_m - rock.depth_m) > kRightWithin_m + 0.5 * report.width_m) {
        continue;
      }
      any = any || pixels->second >= kShareOfRectangle * rectangle;
      rock.found = rock.found || 2 * pixels->second >= rock.pixels;
    }
    return any;
  }

  Mount mounted;
  sim::BuiltScene built;
  const sim::StereoCameraParameters parameters;
};

/// Least rock and distance, each within what the program computes for itself.
struct Range {
  double least_m;
  double farthest_m;
};
using Ranges = std::array<Range, 2>;
using Scores = std::array<Score, 2>;

void print(const char* where, const Ranges& ranges, const Scores& scores) {
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const Score& score = scores[i];
    std::printf("%s, rocks of %.1f m up to %.0f m: precision %d of %d, recall %d of %d\n", where,
                ranges[i].least_m, ranges[i].farthest_m, score.right, score.reports, score.found,
                score.rocks);
  }
}

/// Under the cabin's roof of an excavator at the origin.
class FindRocksInThePit : public FindRocksJudge {
 protected:
  FindRocksInThePit() : FindRocksJudge("stony_pit.yaml", {{1.6, 0.9, 3.15}}) {}
};

/// Over the Unimog's bonnet, on the track through the forest.
class FindRocksInTheForest : public FindRocksJudge {
 protected:
  FindRocksInTheForest() : FindRocksJudge("stony_forest.yaml", {{4.6, 0.08, 2.6}}) {}
};

TEST_F(FindRocksInThePit, PrecisionAndRecallWhereStereoResolves) {
  constexpr Ranges kRanges{{{0.4, 8.0}, {0.6, 11.0}}};
  Scores scores;
  // To the east the heap hides the floor, and the working face begins.
  for (double swing_deg = 60.0; swing_deg <= 300.0; swing_deg += 20.0) {
    const View seen = view(camera_at({0.0, 0.0}, swing_deg));
    for (std::size_t i = 0; i < kRanges.size(); ++i) {
      judge(seen, kRanges[i].least_m, kRanges[i].farthest_m, scores[i]);
    }
  }
  print("pit", kRanges, scores);
  for (const Score& score : scores) {
    ASSERT_GE(score.rocks, 8);
    EXPECT_GE(score.precision(), 0.9);
    EXPECT_GE(score.recall(), 0.7);
  }
}

TEST_F(FindRocksInTheForest, TrunksBushesAndLeavesAreNoRocks) {
  constexpr Ranges kRanges{{{0.4, 9.0}, {0.6, 11.0}}};
  Scores scores;
  // Along the lane, which runs straight east here; the machine looks to its sides as it would in
  // bends.
  for (double east = 0.0; east <= 40.0; east += 4.0) {
    for (const double yaw_deg : {-25.0, 0.0, 25.0}) {
      const View seen = view(camera_at({east, -2.0}, yaw_deg));
      for (std::size_t i = 0; i < kRanges.size(); ++i) {
        judge(seen, kRanges[i].least_m, kRanges[i].farthest_m, scores[i]);
      }
    }
  }
  print("forest", kRanges, scores);
  ASSERT_GE(scores[0].rocks, 12);
  EXPECT_GE(scores[0].precision(), 0.85);
  EXPECT_GE(scores[0].recall(), 0.7);
  // Farther off trunks and bushes hide half of a rock or grow together with it.
  ASSERT_GE(scores[1].rocks, 12);
  EXPECT_GE(scores[1].precision(), 0.65);
  // Six or seven of thirteen: one of them hangs on the confidence of a few pixels.
  EXPECT_GE(scores[1].recall(), 0.4);
}

}  // namespace
}  // namespace rigwire::find_rocks
