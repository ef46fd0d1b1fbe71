#include "bench/depth_image_suite.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "bench/depth_image_bench.h"
#include "bench/lidar_rebase_bench.h"
#include "bench/table.h"

namespace rigwire::bench {
namespace {

std::string_view name_of(sim::DepthSampling sampling) {
  switch (sampling) {
    case sim::DepthSampling::nearest:
      return "nearest";
    case sim::DepthSampling::bilinear_depth:
      return "bilinear z";
    case sim::DepthSampling::bilinear_inverse_depth:
      return "bilinear 1/z";
    case sim::DepthSampling::edge_aware:
      return "edge-aware";
    case sim::DepthSampling::tangent_plane:
      return "tangent plane";
  }
  return "";
}

/// Three digits, without exponent.
std::string millimetres(double length_m) {
  const double length_mm = 1e3 * length_m;
  return length_mm >= 100.0 ? fmt::format("{:.0f}", length_mm) : fmt::format("{:.3g}", length_mm);
}

nlohmann::json classes_json(const DepthImageError& error) {
  nlohmann::json classes;
  for (const RangeClassError& range : error.classes) {
    classes.push_back({{"to_m", range.to_m},
                       {"shots", range.shots},
                       {"rms_m", range.rms_m},
                       {"p99_m", range.p99_m},
                       {"p999_m", range.p999_m}});
  }
  return classes;
}

std::vector<Cell> cells(const DepthImageError& error) {
  std::vector<Cell> row{word("variant", error.variant),
                        count("width_px", error.parameters.width_px),
                        word("sampling", name_of(error.parameters.sampling))};
  for (const RangeClassError& range : error.classes) {
    row.push_back(shown(millimetres(range.rms_m) + " / " + millimetres(range.p999_m)));
  }
  row.insert(row.end(),
             {count("ghosts", error.ghosts), count("one_sided", error.one_sided),
              number("cost_of_rays", (error.render_s + error.look_up_s) / error.rays_s, "{:.1f}"),
              stored("scene", error.scene), stored("cameras", error.parameters.cameras),
              stored("pixels", error.pixels), stored("render_s", error.render_s),
              stored("look_up_s", error.look_up_s), stored("rays_s", error.rays_s),
              stored("shots", error.shots), stored("classes", classes_json(error))});
  return row;
}

void error_table(const LidarCase& scene, std::ostream& text, nlohmann::json& json) {
  text << fmt::format(
      "{}: depth images against rays, one revolution; rms / 99.9 % of the range error in mm by "
      "range\n",
      scene.name);
  std::vector<Column> columns{{"mapping", "<20"}, {"width", ">6"}, {"sampling", "<14"}};
  double from_m = 0.0;
  for (const double to_m : kRangeClasses_m) {
    columns.push_back({fmt::format("{:g}-{:g} m", from_m, to_m), ">15"});
    from_m = to_m;
  }
  columns.insert(columns.end(), {{"ghosts", ">7"}, {"1-sided", ">7"}, {"cost / rays", ">11"}});
  const Table table(text, columns);
  table.head();
  for (const int width_px : {512, 1024, 2048}) {
    for (const DepthImageVariant& variant : depth_image_variants(width_px)) {
      if (width_px != 1024 && variant.name != "exact") {
        continue;
      }
      for (const DepthImageError& error : measure_depth_images(scene, variant)) {
        json["depth_images"].push_back(table.row(cells(error)));
      }
    }
  }
}

void motion_table(std::ostream& text, nlohmann::json& json) {
  const LidarCase pit = pit_case();
  text << "moving at 5 m/s and 60 deg/s in the pit, exact mapping, 1024 pixels\n";
  const Table table(text, {{"images per revolution", ">22"},
                           {"pixels", ">12"},
                           {"cast ms", ">10"},
                           {"rms mm", ">10"},
                           {"99 % mm", ">10"}});
  table.head();
  for (const int images : {1, 3, 10, 36}) {
    const DepthImageMotionError error = measure_depth_image_motion(pit, images);
    json["depth_image_motion"].push_back(table.row(
        {count("images_per_revolution", images), count("pixels", error.pixels),
         number("cast_s", error.cast_s, "{:.1f}", 1e3), number("rms_m", error.rms_m, "{:.1f}", 1e3),
         number("p99_m", error.p99_m, "{:.1f}", 1e3)}));
  }
}

void ring_data(nlohmann::json& json) {
  constexpr int kWidth_px = 1024;
  for (const DepthImageVariant& variant : depth_image_variants(kWidth_px)) {
    sim::DepthImageParameters parameters = variant.parameters;
    if (variant.name != "as printed") {
      parameters.sampling = sim::DepthSampling::bilinear_inverse_depth;
    }
    nlohmann::json rings;
    for (const DepthImageRing& ring : depth_image_rings(parameters)) {
      rings.push_back({{"elevation_deg", ring.elevation_deg},
                       {"azimuth_deg", ring.azimuth_deg},
                       {"radius_m", ring.radius_m}});
    }
    json["depth_image_rings"].push_back(
        {{"variant", variant.name}, {"cameras", parameters.cameras}, {"rings", rings}});
  }
}

void rebase_table(std::ostream& text, nlohmann::json& json) {
  text << "slanting plane, rays against closed form in double; mm\n";
  const Table table(text, {{"km from the map origin", ">22"},
                           {"rms", ">10"},
                           {"worst", ">10"},
                           {"leaks", ">7"},
                           {"raw float:", ">12"},
                           {"rms", ">10"},
                           {"worst", ">10"},
                           {"leaks", ">7"}});
  table.head();
  const auto to_json = [](const RangeErrorSummary& summary) {
    return nlohmann::json{{"rays", summary.rays},
                          {"leaks", summary.leaks},
                          {"rms_m", summary.rms_m},
                          {"p99_m", summary.p99_m},
                          {"worst_m", summary.worst_m}};
  };
  for (const RebaseError& error : measure_rebasing({0.0, 1e3, 10e3, 100e3, 500e3, 4000e3})) {
    json["rebasing"].push_back(
        table.row({number("map_offset_m", error.map_offset_m, "{:g}", 1e-3),
                   shown(fmt::format("{:.4f}", 1e3 * error.rebased.rms_m)),
                   shown(fmt::format("{:.4f}", 1e3 * error.rebased.worst_m)),
                   shown(fmt::format("{}", error.rebased.leaks)), shown(""),
                   shown(fmt::format("{:.3f}", 1e3 * error.raw.rms_m)),
                   shown(fmt::format("{:.2f}", 1e3 * error.raw.worst_m)),
                   shown(fmt::format("{}", error.raw.leaks)),
                   stored("rebased", to_json(error.rebased)), stored("raw", to_json(error.raw))}));
  }
}

}  // namespace

void bench_depth_images(std::ostream& text, nlohmann::json& json) {
  error_table(level_ground_case(), text, json);
  error_table(pit_case(), text, json);
  motion_table(text, json);
  ring_data(json);
  rebase_table(text, json);
}

}  // namespace rigwire::bench
