#include "hil/bench/lidar_load_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "hil/bench/lidar_geometry.h"
#include "hil/bench/lidar_load.h"
#include "hil/command_line/config_files.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/world/scene_configuration.h"

namespace rigwire::hil {
namespace {

constexpr std::string_view kForest = "forest";
constexpr double kCoreShareGoal = 0.35;
constexpr double kWallShareGoal = 1.0;
constexpr double kBeginSliceGoal_s = 2e-3;
constexpr double kEncodingShareGoal = 0.02;
constexpr double kDistanceUnit_m = 2e-3;
constexpr std::uint64_t kLeakRays = 100'000'000;

SceneConfiguration load_scene(std::string_view name) {
  const std::vector<ConfigFile> files = config_files("scenes");
  const auto file = std::ranges::find(files, name, &ConfigFile::name);
  if (file == files.end()) {
    throw std::invalid_argument(fmt::format("there is no scene '{}'", name));
  }
  Problems problems;
  Origins origins;
  SceneConfiguration scene;
  const Value document = load_document(file->path, problems);
  read(document, scene, problems, origins);
  problems.throw_if_any();
  return scene;
}

void load_rows(LidarLoadPlace place, std::ostream& text, nlohmann::json& json) {
  const std::vector<LidarLoad> loads =
      measure_lidar_load(std::move(place), {
                                               {.lidars = 1, .threads = 1, .slice_ms = 2},
                                               {.lidars = 1, .threads = 1, .slice_ms = 5},
                                               {.lidars = 4, .threads = 2, .slice_ms = 5},
                                           });
  text << fmt::format("{}: {} instances, 20 bodies in motion\n", loads.front().place,
                      loads.front().instances);
  for (const LidarLoad& load : loads) {
    text << fmt::format(
        "{:>6} {:>7} {:>8} {:>5.1f}% {:>8.3f} {:>10.3f} {:>15.3f} {:>11.2f}% {:>15.1f}\n",
        load.of.lidars, load.of.threads, load.of.slice_ms, 100.0 * load.hit_share, load.bare_ratio,
        load.core_share, load.wall_share, 100.0 * load.encoding_share, 1e6 * load.begin_slice_s);
    json["load"].push_back({{"place", load.place},
                            {"lidars", load.of.lidars},
                            {"threads", load.of.threads},
                            {"slice_ms", load.of.slice_ms},
                            {"instances", load.instances},
                            {"rays", load.rays},
                            {"hit_share", load.hit_share},
                            {"bare_ratio", load.bare_ratio},
                            {"core_share", load.core_share},
                            {"wall_share", load.wall_share},
                            {"encoding_share", load.encoding_share},
                            {"begin_slice_us", 1e6 * load.begin_slice_s}});
  }
}

void load_table(std::ostream& text, nlohmann::json& json) {
  text << fmt::format("{:>6} {:>7} {:>8} {:>6} {:>8} {:>10} {:>15} {:>12} {:>15}\n", "lidars",
                      "threads", "slice ms", "hits", "of bare", "cores", "elapsed / real",
                      "encoding", "begin_slice us");
  load_rows(make_instanced_forest(), text, json);
  const SceneConfiguration forest = load_scene(kForest);
  load_rows(make_described_place(forest.name, forest.description), text, json);
  json["core_share_goal"] = kCoreShareGoal;
  json["wall_share_goal"] = kWallShareGoal;
  json["begin_slice_goal_us"] = 1e6 * kBeginSliceGoal_s;
  json["encoding_share_goal"] = kEncodingShareGoal;
  text << fmt::format(
      "goals: of bare >= 0.9, cores < {:g} for one lidar, elapsed < {:g} for four on two "
      "threads,\nencoding < {:g} % of casting, begin_slice < {:g} ms\n",
      kCoreShareGoal, kWallShareGoal, 100.0 * kEncodingShareGoal, 1e3 * kBeginSliceGoal_s);
}

void rebuild_table(std::ostream& text, nlohmann::json& json) {
  text << fmt::format("{:>16} {:>8} {:>6} {:>7} {:>10} {:>10} {:>20} {:>10}\n", "bodies rebuilt ms",
                      "moving", "rays", "missed", "rms mm", "worst mm", "worst / half a unit",
                      "cores");
  for (const RebuildInterval& interval : measure_rebuild_intervals({1, 2, 5, 10, 20, 50, 100})) {
    text << fmt::format("{:>17} {:>8} {:>6} {:>7} {:>10.4f} {:>10.4f} {:>20.3f} {:>10.5f}\n",
                        interval.slice_ms, interval.blended ? "yes" : "no", interval.rays,
                        interval.missed, 1e3 * interval.rms_m, 1e3 * interval.worst_m,
                        interval.worst_m / (0.5 * kDistanceUnit_m), interval.core_share);
    json["rebuild"].push_back({{"slice_ms", interval.slice_ms},
                               {"blended", interval.blended},
                               {"rays", interval.rays},
                               {"missed", interval.missed},
                               {"rms_m", interval.rms_m},
                               {"worst_m", interval.worst_m},
                               {"begin_slice_us", 1e6 * interval.begin_slice_s},
                               {"core_share", interval.core_share}});
  }
  text << "a plate on a boom of 8 m that swings at 1 rad/s; moving: within the slice, else held\n";
}

void leak_line(std::ostream& text, nlohmann::json& json) {
  const LidarLeaks leaks = count_lidar_leaks(kLeakRays);
  text << fmt::format("{} rays inside a closed mesh: {} leaks, {} strayed; goal: none\n",
                      leaks.rays, leaks.leaks, leaks.strayed);
  json["leaks"] = {{"rays", leaks.rays}, {"leaks", leaks.leaks}, {"strayed", leaks.strayed}};
}

}  // namespace

void lidar_load_tables(std::ostream& text, nlohmann::json& json) {
  load_table(text, json);
  rebuild_table(text, json);
  leak_line(text, json);
}

}  // namespace rigwire::hil
