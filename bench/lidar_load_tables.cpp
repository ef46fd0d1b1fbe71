#include "bench/lidar_load_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "bench/lidar_geometry.h"
#include "bench/lidar_load.h"
#include "bench/table.h"
#include "hil/command_line/config_files.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/world/scene.h"

namespace rigwire::bench {
namespace {

constexpr std::string_view kForest = "forest";
constexpr double kCoreShareGoal = 0.35;
constexpr double kWallShareGoal = 1.0;
constexpr double kBeginSliceGoal_s = 2e-3;
constexpr double kEncodingShareGoal = 0.02;
constexpr double kDistanceUnit_m = 2e-3;
constexpr std::uint64_t kLeakRays = 100'000'000;

hil::SceneConfiguration load_scene(std::string_view name) {
  const std::vector<hil::ConfigFile> files = hil::config_files("scenes");
  const auto file = std::ranges::find(files, name, &hil::ConfigFile::name);
  if (file == files.end()) {
    throw std::invalid_argument(fmt::format("there is no scene '{}'", name));
  }
  hil::Problems problems;
  hil::Origins origins;
  hil::SceneConfiguration scene;
  const hil::Value document = hil::load_document(file->path, problems);
  hil::read(document, scene, problems, origins);
  problems.throw_if_any();
  return scene;
}

void load_rows(LidarLoadPlace place, const Table& table, std::ostream& text, nlohmann::json& json) {
  const std::vector<LidarLoad> loads =
      measure_lidar_load(std::move(place), {
                                               {.lidars = 1, .threads = 1, .slice_ms = 2},
                                               {.lidars = 1, .threads = 1, .slice_ms = 5},
                                               {.lidars = 4, .threads = 2, .slice_ms = 5},
                                           });
  text << fmt::format("{}: {} instances, 20 bodies in motion\n", loads.front().place,
                      loads.front().instances);
  for (const LidarLoad& load : loads) {
    json["load"].push_back(table.row(
        {count("lidars", load.of.lidars), count("threads", load.of.threads),
         count("slice_ms", load.of.slice_ms), number("hit_share", load.hit_share, "{:.1f}%", 100.0),
         number("bare_ratio", load.bare_ratio, "{:.3f}"),
         number("core_share", load.core_share, "{:.3f}"),
         number("wall_share", load.wall_share, "{:.3f}"),
         number("encoding_share", load.encoding_share, "{:.2f}%", 100.0),
         number("begin_slice_us", 1e6 * load.begin_slice_s, "{:.1f}"), stored("place", load.place),
         stored("instances", load.instances), stored("rays", load.rays)}));
  }
}

void load_table(std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"lidars", ">6"},
                           {"threads", ">7"},
                           {"slice ms", ">8"},
                           {"hits", ">6"},
                           {"of bare", ">8"},
                           {"cores", ">10"},
                           {"elapsed / real", ">15"},
                           {"encoding", ">12"},
                           {"begin_slice us", ">15"}});
  table.head();
  load_rows(make_instanced_forest(), table, text, json);
  const hil::SceneConfiguration forest = load_scene(kForest);
  load_rows(make_described_place(forest.name, forest.description), table, text, json);
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
  const Table table(text, {{"bodies rebuilt ms", ">17"},
                           {"moving", ">8"},
                           {"rays", ">6"},
                           {"missed", ">7"},
                           {"rms mm", ">10"},
                           {"worst mm", ">10"},
                           {"worst / half a unit", ">20"},
                           {"cores", ">10"}});
  table.head();
  for (const RebuildInterval& interval : measure_rebuild_intervals({1, 2, 5, 10, 20, 50, 100})) {
    json["rebuild"].push_back(
        table.row({count("slice_ms", interval.slice_ms),
                   cell("blended", interval.blended, interval.blended ? "yes" : "no"),
                   count("rays", interval.rays), count("missed", interval.missed),
                   number("rms_m", interval.rms_m, "{:.4f}", 1e3),
                   number("worst_m", interval.worst_m, "{:.4f}", 1e3),
                   shown(fmt::format("{:.3f}", interval.worst_m / (0.5 * kDistanceUnit_m))),
                   number("core_share", interval.core_share, "{:.5f}"),
                   stored("begin_slice_us", 1e6 * interval.begin_slice_s)}));
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

}  // namespace rigwire::bench
