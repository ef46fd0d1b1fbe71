// The weather of a scene (sim/weather/weather_parameters.h) as configs/scenes/*.yaml write it:
//
//   weather:
//     course:
//       - {dryness: 1, wind: 4 m/s, wind_from: 270 deg}
//       - {at: 2 min, rain: 10 mm/h, fog_visibility: 150 m}
#pragma once

#include <array>

#include "fields/visitor.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::RainModel>, 2> kRainModels{
    {{sim::RainModel::marshall_palmer, "marshall_palmer",
      "Drops of the measured spectrum: extinction by its integral, echoes of single drops."},
     {sim::RainModel::goodin, "goodin",
      "Extinction 0.01 R^0.6 per metre and no echoes; some 25 times as much."}}};

inline constexpr std::array<fields::Choice<sim::DustEchoModel>, 2> kDustEchoModels{
    {{sim::DustEchoModel::backscatter, "backscatter",
      "Where the light scattered back first reaches the limit of detection."},
     {sim::DustEchoModel::optical_depth, "optical_depth",
      "With probability optical depth / threshold, in place of the target's echo."}}};

inline void visit(fields::Visitor& v, sim::WeatherFrame& p) {
  v.duration("at", p.at, {0, 10'000'000'000'000'000}, "After the start; in order.");
  v.number("rain", p.rain_mmph, fields::in("mm/h").stored_as("mm/h").between(0, 300),
           "Rate of rainfall.");
  v.number("snow", p.snow_mmph, fields::in("mm/h").stored_as("mm/h").between(0, 50),
           "Rate of snowfall, as water.");
  v.number("fog_visibility", p.fog_visibility_m, fields::in("m").between(0, 10000),
           "Where 5 % of the light is left, 5 m or more; 0 = no fog.");
  v.number("haze_visibility", p.haze_visibility_m, fields::in("m").between(0, 300000),
           "Where 2 % of a contrast is left, 500 m or more; 0 = no haze.");
  v.number("wind", p.wind_mps, fields::in("m/s").between(0, 60), "Mean speed.");
  v.number("wind_from", p.wind_from_rad, fields::in("deg").between(-360, 360),
           "Where it comes from, clockwise from north.");
  v.number("dryness", p.dryness, fields::plain().between(0, 10),
           "Of the ground: 0 no dust, 1 dry, more for what is worse than AP-42's roads.");
}

inline void visit(fields::Visitor& v, sim::RainParameters& p) {
  v.choice("model", p.model, kRainModels, "What rain does.");
  v.number("extinction_efficiency", p.extinction_efficiency, fields::plain().between(0.1, 4),
           "Q_ext.");
  v.number("refractive_index", p.refractive_index, fields::plain().between(1, 3), "Of water.");
  v.number("smallest_drop", p.smallest_drop_m, fields::in("mm").between(1e-3, 5), "Diameter.");
  v.number("nearest_echo", p.nearest_echo_m, fields::in("m").between(0.1, 1000), "Of a drop.");
}

inline void visit(fields::Visitor& v, sim::SnowParameters& p) {
  v.number("intercept", p.intercept, fields::plain().between(1, 1e6),
           "Of the spectrum at 1 mm/h, per m3 and mm; 3800 Gunn and Marshall, 7600 LISA.");
  v.number("extinction_efficiency", p.extinction_efficiency, fields::plain().between(0.1, 20),
           "Q_ext.");
  v.number("refractive_index", p.refractive_index, fields::plain().between(1, 3), "Of ice.");
  v.number("smallest_flake", p.smallest_flake_m, fields::in("mm").between(1e-3, 5),
           "Diameter, melted.");
  v.number("nearest_echo", p.nearest_echo_m, fields::in("m").between(0.1, 1000), "Of a flake.");
}

inline void visit(fields::Visitor& v, sim::FogParameters& p) {
  v.number("backscatter", p.backscatter, fields::plain().between(0, 1),
           "Times 1 / visibility: per metre and steradian.");
  v.number("base_height", p.base_height_m, fields::in("m").between(-1e4, 1e4),
           "World height up to which it has its full density.");
  v.number("scale_height", p.scale_height_m, fields::in("m").between(0, 1e4),
           "Above the base it falls to 1/e over this; 0 = no upper end.");
}

inline void visit(fields::Visitor& v, sim::HazeParameters& p) {
  v.number("lidar_ratio", p.lidar_ratio_sr, fields::plain().between(1, 1000),
           "Extinction over back-scatter, sr.");
  v.number("wavelength", p.wavelength_m, fields::in("um").between(0.3, 3), "Of the lidar.");
}

inline void visit(fields::Visitor& v, sim::DustParameters& p) {
  v.choice("echo", p.echo, kDustEchoModels, "When dust sends an echo.");
  v.number("silt", p.silt_share, fields::in("%").between(0, 100), "Of the surface, below 75 um.");
  v.number("mass_extinction", p.mass_extinction_m2pkg, fields::plain().between(0.1, 1e5),
           "m2 per kg.");
  v.number("lidar_ratio", p.lidar_ratio_sr, fields::plain().between(1, 1000),
           "Extinction over back-scatter, sr.");
  v.number("diffusivity", p.diffusivity_m2ps, fields::plain().between(0, 100),
           "m2 per s; puffs grow with the root of twice this times their age.");
  v.number("settling", p.settling_mps, fields::in("m/s").between(0, 10), "Of the particles.");
  v.number("threshold_depth", p.threshold_depth, fields::plain().between(0.01, 10),
           "Of the echo model optical_depth.");
}

inline void visit(fields::Visitor& v, sim::WindParameters& p) {
  v.number("gust_intensity", p.gust_intensity, fields::plain().between(0, 1),
           "Standard deviation of each component over the mean speed.");
  v.number("gust_time", p.gust_time_s, fields::in("s").between(0.1, 3600), "Correlation time.");
}

inline void visit(fields::Visitor& v, sim::WeatherParameters& p) {
  v.list("course", p.course, "Key frames; everything is interpolated between them.");
  v.section("rain", p.rain, "Its laws.");
  v.section("snow", p.snow, "Its laws.");
  v.section("fog", p.fog, "Its laws and layer.");
  v.section("haze", p.haze, "Its laws.");
  v.section("dust", p.dust, "Its laws.");
  v.section("wind_gusts", p.wind, "Of the wind.");
  v.number("overlap_start", p.overlap_start_m, fields::in("m").between(0.1, 10),
           "No light from nearer arrives in a receiver.");
  v.number("overlap_end", p.overlap_end_m, fields::in("m").between(0.11, 20),
           "All light from farther arrives.");
}

}  // namespace rigwire::sim
