#include <fmt/format.h>

#include "bench/beam_bench.h"
#include "bench/depth_image_suite.h"
#include "bench/lidar_bench.h"
#include "bench/lidar_load_tables.h"
#include "bench/private_rig.h"
#include "bench/suites.h"
#include "bench/table.h"
#include "hil/command_line/config_files.h"

namespace rigwire::bench {
namespace {

constexpr int kRounds = 15;
constexpr double kGoalRatio = 0.9;
constexpr double kLidarDistanceUnit_m = 2e-3;
constexpr Duration kSubRaySector = std::chrono::milliseconds{20};  ///< A fifth of a turn.

void stage_table(std::ostream& text, nlohmann::json& json) {
  const hil::RigConfiguration rig = hil::load_rig(hil::find_rig(kBenchRig), {}).configuration;
  const Table table(text, {{"slice ms", ">8"},
                           {"rays", ">9"},
                           {"hits", ">6"},
                           {"stage rays/s", ">12"},
                           {"bare rays/s", ">12"},
                           {"ratio", ">6"},
                           {"least..most", ">13"},
                           {"begin_slice us", ">15"}});
  table.head();
  for (const LidarStageCost& cost : measure_lidar_stage(rig, {1, 2, 5}, kRounds)) {
    const auto rays = static_cast<double>(cost.rays);
    const double hit_share = static_cast<double>(cost.hits) / rays;
    json["stage"].push_back(
        table.row({count("slice_ms", cost.slice_ms), count("rays", cost.rays),
                   number("hit_share", hit_share, "{:.1f}%", 100.0),
                   number("stage_rays_per_s", rays / cost.stage_s, "{:.0f}"),
                   number("bare_rays_per_s", rays / cost.bare_s, "{:.0f}"),
                   number("ratio", cost.ratio, "{:.3f}"),
                   shown(fmt::format("{:.3f}..{:.3f}", cost.least_ratio, cost.greatest_ratio)),
                   number("begin_slice_us", 1e6 * cost.begin_slice_s, "{:.1f}"),
                   stored("instances", cost.instances), stored("least_ratio", cost.least_ratio),
                   stored("greatest_ratio", cost.greatest_ratio)}));
  }
  json["ratio_goal"] = kGoalRatio;
  text << fmt::format("goal: ratio >= {:g}; the rig's own slice is {:g} ms\n", kGoalRatio,
                      1e3 * to_seconds(rig.slice));
}

void sub_ray_table(std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"scene", ">8"},
                           {"sub-rays", ">8"},
                           {"shots", ">7"},
                           {"wrong strongest", ">16"},
                           {"wrong last", ">11"},
                           {"rms mm", ">8"},
                           {"reflectivity rms", ">17"},
                           {"rays/s", ">12"},
                           {"cost", ">6"}});
  table.head();
  for (const SubRayError& error : measure_sub_rays(kSubRaySector)) {
    json["sub_rays"].push_back(table.row(
        {word("scene", error.scene), count("sub_rays", error.sub_rays), count("shots", error.shots),
         number("wrong_strongest", error.wrong_strongest, "{:.2f}%", 100.0),
         number("wrong_last", error.wrong_last, "{:.2f}%", 100.0),
         number("rms_m", error.rms_m, "{:.1f}", 1e3),
         number("reflectivity_rms", error.reflectivity_rms, "{:.3f}"),
         number("rays_per_s", error.rays_per_s, "{:.0f}"), number("cost", error.cost, "{:.2f}")}));
  }
  text << "against 1000 sub-rays; wrong: more than half a pulse off, or seen by one of both only\n";
}

void error_table(std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"km from the map origin", ">22"},
                           {"rays", ">8"},
                           {"leaks", ">6"},
                           {"rms um", ">10"},
                           {"worst um", ">10"},
                           {"worst / half a unit", ">24"}});
  table.head();
  for (const LidarRangeError& error :
       measure_lidar_range_error({0.0, 1e3, 10e3, 100e3, 1000e3, 10000e3})) {
    const double share = error.worst_m / (0.5 * kLidarDistanceUnit_m);
    json["range_error"].push_back(table.row(
        {number("map_offset_m", error.map_offset_m, "{:g}", 1e-3), count("rays", error.rays),
         count("leaks", error.leaks), number("rms_m", error.rms_m, "{:.2f}", 1e6),
         number("worst_m", error.worst_m, "{:.2f}", 1e6), shown(fmt::format("{:.4f}", share))}));
  }
  json["range_error_goal_m"] = 0.5 * kLidarDistanceUnit_m;
  text << fmt::format("goal: worst < {:g} mm at 1000 km\n", 1e3 * 0.5 * kLidarDistanceUnit_m);
}

}  // namespace

nlohmann::json bench_lidar(std::ostream& text) {
  nlohmann::json json;
  stage_table(text, json);
  lidar_load_tables(text, json);
  sub_ray_table(text, json);
  error_table(text, json);
  bench_depth_images(text, json);
  return json;
}

}  // namespace rigwire::bench
