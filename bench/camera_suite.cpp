#include <fmt/format.h>

#include <utility>

#include "bench/camera_bench.h"
#include "bench/camera_kinds_bench.h"
#include "bench/stereo_table.h"
#include "bench/suites.h"
#include "bench/table.h"

namespace rigwire::bench {
namespace {

constexpr int kWidth_px = 640;
constexpr int kSmall_px = 200;
constexpr int kCameraRounds = 5;
constexpr int kReferenceSamples = 64;
constexpr int kReferenceSkyRays = 64;
constexpr double kGoalRatio = 0.8;

void cost_table(const std::vector<CameraCase>& cases, std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"scene", "<9"},
                           {"samples", ">8"},
                           {"Mpx/s", ">7"},
                           {"ms", ">8"},
                           {"shadow rays", ">12"},
                           {"cast", ">5"},
                           {"bare ms", ">9"},
                           {"cast ms", ">8"},
                           {"ratio", ">6"},
                           {"least..most", ">13"}});
  table.head();
  for (const CameraCase& scene : cases) {
    for (const int samples : {1, 4}) {
      const PictureCost cost =
          measure_picture(scene, kWidth_px, samples, samples == 1 ? kCameraRounds : 3);
      json["pictures"].push_back(
          table.row({word("scene", cost.scene), count("samples", cost.samples),
                     number("pixels_per_s", static_cast<double>(cost.pixels) / cost.picture_s,
                            "{:.2f}", 1e-6),
                     number("picture_s", cost.picture_s, "{:.1f}", 1e3),
                     number("shadow_share", cost.shadow_share, "{:.2f}"),
                     number("doubtful_share", cost.doubtful_share, "{:.2f}"),
                     number("bare_s", cost.bare_s, "{:.1f}", 1e3),
                     number("doubtful_s", cost.doubtful_s, "{:.1f}", 1e3),
                     number("ratio", cost.ratio, "{:.3f}"),
                     shown(fmt::format("{:.3f}..{:.3f}", cost.least_ratio, cost.greatest_ratio)),
                     stored("pixels", cost.pixels), stored("least_ratio", cost.least_ratio),
                     stored("greatest_ratio", cost.greatest_ratio)}));
    }
  }
  json["ratio_goal"] = kGoalRatio;
  text << fmt::format(
      "640 x 480, one thread, CPU time; ratio: Embree's calls alone with the same rays (bare) "
      "over\n"
      "the picture with shading and sensor; goal: ratio >= {:g}; cast: without shadow rays that "
      "are\n"
      "certain to come through, which the picture leaves out\n\n",
      kGoalRatio);
}

void sampling_table(const std::vector<CameraCase>& cases, std::ostream& text,
                    nlohmann::json& json) {
  const Table table(
      text, {{"scene", "<9"}, {"rays of a pixel", "<20"}, {"cost", ">5"}, {"rms levels", ">11"}});
  table.head();
  for (const CameraCase& scene : cases) {
    for (const SamplingError& error :
         measure_sampling(scene, kSmall_px, sampling_ways(), kReferenceSamples, 3)) {
      json["sampling"].push_back(table.row({word("scene", error.scene), word("way", error.way),
                                            number("cost", error.cost, "{:.2f}"),
                                            number("rms_levels", error.rms_levels, "{:.2f}")}));
    }
  }
  text << fmt::format(
      "grey levels of 255, mean 100, against {} samples behind the same lens; cost: CPU time to "
      "the\n"
      "first row's\n\n",
      kReferenceSamples);
}

void sky_table(const std::vector<CameraCase>& cases, std::ostream& text, nlohmann::json& json) {
  const Table table(
      text,
      {{"scene", "<9"}, {"sky", "<12"}, {"ns/px", ">8"}, {"rms levels", ">11"}, {"bias", ">7"}});
  table.head();
  for (const CameraCase& scene : cases) {
    for (const SkyCost& cost : measure_sky(scene, kSmall_px, {-1, 0, 1, 4}, kReferenceSkyRays)) {
      json["sky"].push_back(
          table.row({word("scene", cost.scene),
                     cell("sky_rays", cost.sky_rays,
                          cost.sky_rays < 0    ? "everywhere"
                          : cost.sky_rays == 0 ? "lattice"
                                               : fmt::format("{} rays", cost.sky_rays)),
                     number("pixel_ns", cost.pixel_ns, "{:.0f}"),
                     number("rms_levels", cost.rms_levels, "{:.2f}"),
                     number("bias_levels", cost.bias_levels, "{:+.2f}")}));
    }
  }
  text << fmt::format("against {} rays per pixel\n\n", kReferenceSkyRays);
}

void air_table(const CameraCase& scene, std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"air", "<14"}, {"ns/px", ">8"}, {"above clear", ">12"}});
  table.head();
  for (const AirCost& cost : measure_air(scene, kSmall_px)) {
    json["air"].push_back(
        table.row({word("medium", cost.medium), number("pixel_ns", cost.pixel_ns, "{:.0f}"),
                   number("above_clear_ns", cost.above_clear_ns, "{:.0f}")}));
  }
  text << "in the scene " << scene.name() << "\n\n";
}

void texture_table(std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"wall seen", "<18"},
                           {"surface", "<18"},
                           {"ns/px", ">7"},
                           {"ratio", ">6"},
                           {"rms levels", ">11"}});
  table.head();
  for (const TextureCost& cost : measure_textures(kWidth_px, kCameraRounds, kReferenceSamples)) {
    json["textures"].push_back(table.row({word("view", cost.view), word("surface", cost.surface),
                                          number("pixel_ns", cost.pixel_ns, "{:.0f}"),
                                          number("ratio", cost.ratio, "{:.2f}"),
                                          number("rms_levels", cost.rms_levels, "{:.2f}")}));
  }
  text << fmt::format(
      "640 x 480, one sample, one thread, CPU time; ratio to the label's look; picture of 64 "
      "texels "
      "a\nmetre; rms against {} samples\n\n",
      kReferenceSamples);
}

void sensor_table(std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"sensor", "<28"}, {"set", ">10"}, {"found", ">10"}, {"error", ">8"}});
  table.head();
  for (const SensorFigure& figure : measure_sensor()) {
    json["sensor"].push_back(
        table.row({word("figure", figure.figure), number("set", figure.set, "{:.4g}"),
                   number("found", figure.found, "{:.4g}"),
                   number("error", figure.found / figure.set - 1.0, "{:+.2f}%", 100.0)}));
  }
  text << "photon transfer from flat frames as EMVA 1288 measures it\n\n";
}

void stereo_table(const std::vector<CameraCase>& cases, std::ostream& text, nlohmann::json& json) {
  const StereoTable table(text);
  for (const CameraCase& scene : cases) {
    using enum sim::MatchingPaths;
    const auto by = [](sim::MatchingMethod method, sim::MatchingPaths paths) {
      sim::StereoMatchingParameters matching;
      matching.method = method;
      matching.paths = paths;
      return matching;
    };
    for (const auto& [name, matching] :
         {std::pair{"census 3", by(sim::MatchingMethod::census, three)},
          {"census 5", by(sim::MatchingMethod::census, five)},
          {"truth", by(sim::MatchingMethod::truth, three)}}) {
      table.add(measure_stereo(scene, name, matching, 3), json["stereo"]);
    }
  }
  table.end();
}

void all_round_table(const std::vector<CameraCase>& cases, std::ostream& text,
                     nlohmann::json& json) {
  const Table table(text, {{"scene", "<9"},
                           {"all round by", "<15"},
                           {"samples", ">8"},
                           {"ms", ">8"},
                           {"Mrays", ">7"},
                           {"seen", ">7"},
                           {"rms levels", ">11"},
                           {"bias", ">7"}});
  table.head();
  for (const CameraCase& scene : cases) {
    for (const AllRoundCost& cost : measure_all_round(scene, kReferenceSamples, 3)) {
      json["all_round"].push_back(table.row(
          {word("scene", cost.scene), word("way", cost.way), count("samples", cost.samples),
           number("picture_s", cost.picture_s, "{:.0f}", 1e3),
           number("rays", static_cast<double>(cost.rays), "{:.2f}", 1e-6),
           number("seen", cost.seen, "{:.1f}%", 100.0),
           number("rms_levels", cost.rms_levels, "{:.2f}"),
           number("bias_levels", cost.bias_levels, "{:+.2f}")}));
    }
  }
  text << fmt::format(
      "1024 x 256, 90 degrees high, one thread, CPU time; grey levels of 255, mean 100, against "
      "rays\n"
      "with {} samples, the sensor's noise in it\n\n",
      kReferenceSamples);
}

void depth_table(const CameraCase& scene, std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"surface", "<13"},
                           {"distance", ">9"},
                           {"set mm", ">8"},
                           {"found mm", ">9"},
                           {"error", ">7"},
                           {"valid", ">7"}});
  table.head();
  for (const RangeNoise& noise : measure_range_noise()) {
    json["range_noise"].push_back(
        table.row({word("surface", noise.surface), number("distance_m", noise.distance_m, "{:.1f}"),
                   number("set_m", noise.set_m, "{:.2f}", 1e3),
                   number("found_m", noise.found_m, "{:.2f}", 1e3),
                   number("error", noise.found_m / noise.set_m - 1.0, "{:+.1f}%", 100.0),
                   number("valid", noise.valid, "{:.0f}%", 100.0)}));
  }
  const double shot_s = measure_depth_shot(scene, 3);
  json["depth_shot_s"] = shot_s;
  text << fmt::format(
      "time of flight, standard deviation of the range; above 20 mm there is none. A shot of\n"
      "640 x 480 in the scene {}: {:.0f} ms, one thread, CPU time\n",
      scene.name(), 1e3 * shot_s);
}

}  // namespace

nlohmann::json bench_camera(std::ostream& text) {
  nlohmann::json json;
  const std::vector<CameraCase> cases = camera_cases();
  cost_table(cases, text, json);
  sampling_table(cases, text, json);
  sky_table(cases, text, json);
  air_table(cases.front(), text, json);
  texture_table(text, json);
  sensor_table(text, json);
  stereo_table(cases, text, json);
  all_round_table(cases, text, json);
  depth_table(cases.front(), text, json);
  return json;
}

}  // namespace rigwire::bench
