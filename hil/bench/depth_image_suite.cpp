#include "hil/bench/depth_image_suite.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "hil/bench/depth_image_bench.h"
#include "hil/bench/lidar_rebase_bench.h"

namespace rigwire::hil {
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

nlohmann::json to_json(const DepthImageError& error) {
  nlohmann::json classes;
  for (const RangeClassError& range : error.classes) {
    classes.push_back({{"to_m", range.to_m},
                       {"shots", range.shots},
                       {"rms_m", range.rms_m},
                       {"p99_m", range.p99_m},
                       {"p999_m", range.p999_m}});
  }
  return {{"scene", error.scene},
          {"variant", error.variant},
          {"cameras", error.parameters.cameras},
          {"width_px", error.parameters.width_px},
          {"sampling", name_of(error.parameters.sampling)},
          {"pixels", error.pixels},
          {"render_s", error.render_s},
          {"look_up_s", error.look_up_s},
          {"rays_s", error.rays_s},
          {"cost_of_rays", (error.render_s + error.look_up_s) / error.rays_s},
          {"shots", error.shots},
          {"one_sided", error.one_sided},
          {"ghosts", error.ghosts},
          {"classes", classes}};
}

void error_table(const LidarCase& scene, std::ostream& text, nlohmann::json& json) {
  text << fmt::format(
      "{}: depth images against rays, one revolution; rms / 99.9 % of the range error in mm by "
      "range\n{:<20} {:>6} {:<14}",
      scene.name, "mapping", "width", "sampling");
  double from_m = 0.0;
  for (const double to_m : kRangeClasses_m) {
    text << fmt::format(" {:>15}", fmt::format("{:g}-{:g} m", from_m, to_m));
    from_m = to_m;
  }
  text << fmt::format(" {:>7} {:>7} {:>11}\n", "ghosts", "1-sided", "cost / rays");
  for (const int width_px : {512, 1024, 2048}) {
    for (const DepthImageVariant& variant : depth_image_variants(width_px)) {
      if (width_px != 1024 && variant.name != "exact") {
        continue;
      }
      for (const DepthImageError& error : measure_depth_images(scene, variant)) {
        text << fmt::format("{:<20} {:>6} {:<14}", error.variant, width_px,
                            name_of(error.parameters.sampling));
        for (const RangeClassError& range : error.classes) {
          text << fmt::format(" {:>15}",
                              millimetres(range.rms_m) + " / " + millimetres(range.p999_m));
        }
        text << fmt::format(" {:>7} {:>7} {:>11.1f}\n", error.ghosts, error.one_sided,
                            (error.render_s + error.look_up_s) / error.rays_s);
        json["depth_images"].push_back(to_json(error));
      }
    }
  }
}

void motion_table(std::ostream& text, nlohmann::json& json) {
  const LidarCase pit = pit_case();
  text << fmt::format(
      "moving at 5 m/s and 60 deg/s in the pit, exact mapping, 1024 pixels\n"
      "{:>22} {:>12} {:>10} {:>10} {:>10}\n",
      "images per revolution", "pixels", "cast ms", "rms mm", "99 % mm");
  for (const int images : {1, 3, 10, 36}) {
    const DepthImageMotionError error = measure_depth_image_motion(pit, images);
    text << fmt::format("{:>22} {:>12} {:>10.1f} {:>10.1f} {:>10.1f}\n", images, error.pixels,
                        1e3 * error.cast_s, 1e3 * error.rms_m, 1e3 * error.p99_m);
    json["depth_image_motion"].push_back({{"images_per_revolution", images},
                                          {"pixels", error.pixels},
                                          {"cast_s", error.cast_s},
                                          {"rms_m", error.rms_m},
                                          {"p99_m", error.p99_m}});
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
  text << fmt::format(
      "slanting plane, rays against closed form in double; mm\n"
      "{:>22} {:>10} {:>10} {:>7} {:>12} {:>10} {:>10} {:>7}\n",
      "km from the map origin", "rms", "worst", "leaks", "raw float:", "rms", "worst", "leaks");
  const auto to_json = [](const RangeErrorSummary& summary) {
    return nlohmann::json{{"rays", summary.rays},
                          {"leaks", summary.leaks},
                          {"rms_m", summary.rms_m},
                          {"p99_m", summary.p99_m},
                          {"worst_m", summary.worst_m}};
  };
  for (const RebaseError& error : measure_rebasing({0.0, 1e3, 10e3, 100e3, 500e3, 4000e3})) {
    text << fmt::format("{:>22g} {:>10.4f} {:>10.4f} {:>7} {:>12} {:>10.3f} {:>10.2f} {:>7}\n",
                        1e-3 * error.map_offset_m, 1e3 * error.rebased.rms_m,
                        1e3 * error.rebased.worst_m, error.rebased.leaks, "", 1e3 * error.raw.rms_m,
                        1e3 * error.raw.worst_m, error.raw.leaks);
    json["rebasing"].push_back({{"map_offset_m", error.map_offset_m},
                                {"rebased", to_json(error.rebased)},
                                {"raw", to_json(error.raw)}});
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

}  // namespace rigwire::hil
