#include <fmt/format.h>

#include "hil/bench/beam_bench.h"
#include "hil/bench/depth_image_suite.h"
#include "hil/bench/lidar_bench.h"
#include "hil/bench/lidar_load_tables.h"
#include "hil/bench/private_rig.h"
#include "hil/bench/suites.h"
#include "hil/command_line/config_files.h"

namespace rigwire::hil {
namespace {

constexpr int kRounds = 15;
constexpr double kGoalRatio = 0.9;
constexpr double kDistanceUnit_m = 2e-3;

void stage_table(std::ostream& text, nlohmann::json& json) {
  const RigConfiguration rig = load_rig(find_rig(kBenchRig), {}).configuration;
  text << fmt::format("{:>8} {:>9} {:>6} {:>12} {:>12} {:>6} {:>13} {:>16}\n", "slice ms", "rays",
                      "hits", "stage rays/s", "bare rays/s", "ratio", "least..most",
                      "begin_slice us");
  for (const LidarStageCost& cost : measure_lidar_stage(rig, {1, 2, 5}, kRounds)) {
    const auto rays = static_cast<double>(cost.rays);
    const double hit_share = static_cast<double>(cost.hits) / rays;
    text << fmt::format(
        "{:>8} {:>9} {:>5.1f}% {:>12.0f} {:>12.0f} {:>6.3f} {:>6.3f}..{:.3f} {:>15.1f}\n",
        cost.slice_ms, cost.rays, 100.0 * hit_share, rays / cost.stage_s, rays / cost.bare_s,
        cost.ratio, cost.least_ratio, cost.greatest_ratio, 1e6 * cost.begin_slice_s);
    json["stage"].push_back({{"slice_ms", cost.slice_ms},
                             {"instances", cost.instances},
                             {"rays", cost.rays},
                             {"hit_share", hit_share},
                             {"stage_rays_per_s", rays / cost.stage_s},
                             {"bare_rays_per_s", rays / cost.bare_s},
                             {"ratio", cost.ratio},
                             {"least_ratio", cost.least_ratio},
                             {"greatest_ratio", cost.greatest_ratio},
                             {"begin_slice_us", 1e6 * cost.begin_slice_s}});
  }
  json["ratio_goal"] = kGoalRatio;
  text << fmt::format("goal: ratio >= {:g}; the rig's own slice is {:g} ms\n", kGoalRatio,
                      1e3 * to_seconds(rig.slice));
}

void error_table(std::ostream& text, nlohmann::json& json) {
  text << fmt::format("{:>22} {:>8} {:>6} {:>10} {:>10} {:>24}\n", "km from the map origin", "rays",
                      "leaks", "rms um", "worst um", "worst / half a unit");
  for (const LidarRangeError& error :
       measure_lidar_range_error({0.0, 1e3, 10e3, 100e3, 1000e3, 10000e3})) {
    const double share = error.worst_m / (0.5 * kDistanceUnit_m);
    text << fmt::format("{:>22g} {:>8} {:>6} {:>10.2f} {:>10.2f} {:>24.4f}\n",
                        1e-3 * error.map_offset_m, error.rays, error.leaks, 1e6 * error.rms_m,
                        1e6 * error.worst_m, share);
    json["range_error"].push_back({{"map_offset_m", error.map_offset_m},
                                   {"rays", error.rays},
                                   {"leaks", error.leaks},
                                   {"rms_m", error.rms_m},
                                   {"worst_m", error.worst_m}});
  }
  json["range_error_goal_m"] = 0.5 * kDistanceUnit_m;
  text << fmt::format("goal: worst < {:g} mm at 1000 km\n", 1e3 * 0.5 * kDistanceUnit_m);
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

}  // namespace rigwire::hil
