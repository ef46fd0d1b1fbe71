#include "sim/weather/weather_parameters.h"

#include <algorithm>
#include <array>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr double kLeastOverlap_m = 0.01;  // of a divisor
constexpr double kDensestFog_m = 5.0;
constexpr double kThinnestFog_m = 10'000.0;
constexpr double kDensestHaze_m = 500.0;
constexpr double kThinnestHaze_m = 300'000.0;

constexpr std::array<fields::Choice<RainModel>, 2> kRainModels{
    {{RainModel::marshall_palmer, "marshall_palmer",
      "Drops of the measured spectrum: extinction by its integral, echoes of single drops."},
     {RainModel::goodin, "goodin",
      "Extinction 0.01 R^0.6 per metre and no echoes; some 25 times as much."}}};
constexpr std::array<fields::Choice<DustEchoModel>, 2> kDustEchoModels{
    {{DustEchoModel::backscatter, "backscatter",
      "Where the light scattered back first reaches the limit of detection."},
     {DustEchoModel::optical_depth, "optical_depth",
      "With probability optical depth / threshold, in place of the target's echo."}}};

/// 0 means none.
void require_visibility(const char* key, double found_m, double least_m, double most_m) {
  if (found_m != 0.0 && found_m < least_m) {
    throw fields::Refused(key, "found " + fields::shortest(found_m) + " m, allowed 0 (none) or " +
                                   fields::shortest(least_m) + " .. " + fields::shortest(most_m) +
                                   " m");
  }
}

}  // namespace

bool WeatherParameters::any() const {
  return std::ranges::any_of(course, [](const WeatherFrame& frame) {
    return frame.rain_mmph > 0.0 || frame.snow_mmph > 0.0 || frame.fog_visibility_m > 0.0 ||
           frame.haze_visibility_m > 0.0 || frame.dryness > 0.0;
  });
}

void visit(fields::Visitor& v, WeatherFrame& p) {
  v.duration("at", p.at, {0, 10'000'000'000'000'000},
             "Instant of the key frame, after the start; in order.");
  v.number("rain", p.rain_mmph, in("mm/h").stored_as("mm/h").between(0, 300), "Rate of rainfall.");
  v.number("snow", p.snow_mmph, in("mm/h").stored_as("mm/h").between(0, 50),
           "Rate of snowfall, as water.");
  v.number("fog_visibility", p.fog_visibility_m, in("m").between(0, kThinnestFog_m),
           "Where 5 % of the light is left, 5 m or more; 0 = no fog.");
  v.number("haze_visibility", p.haze_visibility_m, in("m").between(0, kThinnestHaze_m),
           "Where 2 % of a contrast is left, 500 m or more; 0 = no haze.");
  v.number("wind", p.wind_mps, in("m/s").between(0, 60), "Mean speed of the wind.");
  v.number("wind_from", p.wind_from_rad, in("deg").between(-360, 360),
           "Where the wind comes from, clockwise from north.");
  v.number("dryness", p.dryness, plain().between(0, 10),
           "Dryness of the ground: 0 no dust, 1 dry, more for what is worse than AP-42's roads.");
}

void visit(fields::Visitor& v, RainParameters& p) {
  v.choice("model", p.model, kRainModels, "What rain does.");
  v.only_if(p.model == RainModel::marshall_palmer, "model", "model: marshall_palmer",
            [&p](fields::Visitor& w) {
              w.number("extinction_efficiency", p.extinction_efficiency, plain().between(0.1, 4),
                       "Q_ext of a drop: extinction over geometric cross-section.");
              w.number("refractive_index", p.refractive_index, plain().between(1, 3),
                       "Refractive index of water.");
              w.number("smallest_drop", p.smallest_drop_m, in("mm").between(1e-3, 5),
                       "Diameter of the smallest drop.");
              w.number("nearest_echo", p.nearest_echo_m, in("m").between(0.1, 1000),
                       "Nearest range at which a drop makes an echo.");
            });
}

void visit(fields::Visitor& v, SnowParameters& p) {
  v.number(
      "intercept", p.intercept, plain().between(1, 1e6),
      "Intercept of the spectrum at 1 mm/h, per m3 and mm; 3800 Gunn and Marshall, 7600 LISA.");
  v.number("extinction_efficiency", p.extinction_efficiency, plain().between(0.1, 20),
           "Q_ext of a flake: extinction over geometric cross-section.");
  v.number("refractive_index", p.refractive_index, plain().between(1, 3),
           "Refractive index of ice.");
  v.number("smallest_flake", p.smallest_flake_m, in("mm").between(1e-3, 5),
           "Diameter of the smallest flake, melted.");
  v.number("nearest_echo", p.nearest_echo_m, in("m").between(0.1, 1000),
           "Nearest range at which a flake makes an echo.");
}

void visit(fields::Visitor& v, FogParameters& p) {
  v.number("backscatter", p.backscatter, plain().between(0, 1),
           "Back-scatter of fog times its visibility, per steradian.");
  v.number("base_height", p.base_height_m, in("m").between(-1e4, 1e4),
           "World height up to which fog has its full density.");
  v.number("scale_height", p.scale_height_m, in("m").between(0, 1e4),
           "Above the base fog falls to 1/e over this; 0 = no upper end.");
}

void visit(fields::Visitor& v, HazeParameters& p) {
  v.number("lidar_ratio", p.lidar_ratio_sr, in("sr").between(1, 1000),
           "Extinction over back-scatter of haze.");
  v.number("wavelength", p.wavelength_m, in("um").between(0.3, 3), "Wavelength of the lidar.");
}

void visit(fields::Visitor& v, DustParameters& p) {
  v.choice("echo", p.echo, kDustEchoModels, "When dust sends an echo.");
  v.number("silt", p.silt_share, in("%").between(0, 100),
           "Share of the surface that is finer than 75 um.");
  v.number("mass_extinction", p.mass_extinction_m2pkg, in("m2/kg").between(0.1, 1e5),
           "Extinction per mass of dust in the air.");
  v.number("lidar_ratio", p.lidar_ratio_sr, in("sr").between(1, 1000),
           "Extinction over back-scatter of dust.");
  v.number("diffusivity", p.diffusivity_m2ps, in("m2/s").between(0, 100),
           "How dust spreads: puffs grow with the root of twice this times their age.");
  v.number("settling", p.settling_mps, in("m/s").between(0, 10),
           "Speed at which the particles settle.");
  v.only_if(p.echo == DustEchoModel::optical_depth, "echo", "echo: optical_depth",
            [&p](fields::Visitor& w) {
              w.number("threshold_depth", p.threshold_depth, plain().between(0.01, 10),
                       "Optical depth at which an echo is certain.");
            });
}

void visit(fields::Visitor& v, WindParameters& p) {
  v.number("gust_intensity", p.gust_intensity, plain().between(0, 1),
           "Standard deviation of gusts, each component, over the mean speed.");
  v.number("gust_time", p.gust_time_s, in("s").between(0.1, 3600), "Correlation time of gusts.");
}

void visit(fields::Visitor& v, WeatherParameters& p) {
  v.list("course", p.course, "Key frames; everything is interpolated between them.");
  v.section("rain", p.rain, "Laws of rain.");
  v.section("snow", p.snow, "Laws of snow.");
  v.section("fog", p.fog, "Laws and layer of fog.");
  v.section("haze", p.haze, "Laws of haze.");
  v.section("dust", p.dust, "Laws of dust.");
  v.section("wind_gusts", p.wind, "How the wind changes.");
  v.number("overlap_start", p.overlap_start_m, in("m").between(0.1, 10),
           "No light of dust from nearer arrives in a receiver.");
  v.number("overlap_end", p.overlap_end_m, in("m").between(0.11, 20),
           "All light of dust from farther arrives in a receiver.");
}

void validate(const WeatherFrame& frame) {
  fields::check(frame);
  require_visibility("fog_visibility", frame.fog_visibility_m, kDensestFog_m, kThinnestFog_m);
  require_visibility("haze_visibility", frame.haze_visibility_m, kDensestHaze_m, kThinnestHaze_m);
}

void validate(const WeatherParameters& p) {
  fields::check(p);
  for (std::size_t i = 1; i < p.course.size(); ++i) {
    if (p.course[i].at <= p.course[i - 1].at) {
      throw fields::Refused("course." + std::to_string(i) + ".at",
                            "found " + fields::print_duration(p.course[i].at.count()) +
                                ", allowed later than the key frame before");
    }
  }
  if (!(p.overlap_end_m >= p.overlap_start_m + kLeastOverlap_m)) {
    throw fields::Refused("overlap_end", "found " + fields::shortest(p.overlap_end_m) +
                                             " m, allowed from 0.01 m beyond overlap_start, " +
                                             fields::shortest(p.overlap_start_m) + " m");
  }
}

}  // namespace rigwire::sim
