#include "sim/weather/weather_parameters.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rigwire::sim {
namespace {

struct Range {
  double least;
  double most;
};

[[noreturn]] void refuse(std::string_view member, double found, std::string_view allowed) {
  std::ostringstream what;
  what << "weather: " << member << " is " << found << ", allowed: " << allowed;
  throw std::invalid_argument(what.str());
}

void require(std::string_view member, double value, Range range) {
  // Written so that not-a-number fails.
  if (!(value >= range.least && value <= range.most)) {
    std::ostringstream allowed;
    allowed << range.least << " to " << range.most;
    refuse(member, value, allowed.str());
  }
}

/// 0 stands for: not there.
void require_visibility(std::string_view member, double value_m, Range range) {
  if (value_m != 0.0 && !(value_m >= range.least && value_m <= range.most)) {
    std::ostringstream allowed;
    allowed << "0 (none) or " << range.least << " to " << range.most;
    refuse(member, value_m, allowed.str());
  }
}

void validate(const WeatherFrame& frame, std::size_t index) {
  const std::string in = "course[" + std::to_string(index) + "].";
  require(in + "at", to_seconds(frame.at), {0.0, 1e7});
  require(in + "rain_mmph", frame.rain_mmph, {0.0, 300.0});
  require(in + "snow_mmph", frame.snow_mmph, {0.0, 50.0});
  require_visibility(in + "fog_visibility_m", frame.fog_visibility_m, {5.0, 10000.0});
  require_visibility(in + "haze_visibility_m", frame.haze_visibility_m, {500.0, 300000.0});
  require(in + "wind_mps", frame.wind_mps, {0.0, 60.0});
  require(in + "wind_from_rad", frame.wind_from_rad, {-6.2832, 6.2832});
  require(in + "dryness", frame.dryness, {0.0, 10.0});
}

}  // namespace

bool WeatherParameters::any() const {
  return std::ranges::any_of(course, [](const WeatherFrame& frame) {
    return frame.rain_mmph > 0.0 || frame.snow_mmph > 0.0 || frame.fog_visibility_m > 0.0 ||
           frame.haze_visibility_m > 0.0 || frame.dryness > 0.0;
  });
}

void validate(const WeatherParameters& p) {
  for (std::size_t i = 0; i < p.course.size(); ++i) {
    validate(p.course[i], i);
    if (i > 0 && p.course[i].at <= p.course[i - 1].at) {
      refuse("course[" + std::to_string(i) + "].at", to_seconds(p.course[i].at),
             "later than the key frame before");
    }
  }
  require("rain.extinction_efficiency", p.rain.extinction_efficiency, {0.1, 4.0});
  require("rain.refractive_index", p.rain.refractive_index, {1.0, 3.0});
  require("rain.smallest_drop_m", p.rain.smallest_drop_m, {1e-6, 5e-3});
  require("rain.nearest_echo_m", p.rain.nearest_echo_m, {0.1, 1000.0});
  require("snow.intercept", p.snow.intercept, {1.0, 1e6});
  require("snow.extinction_efficiency", p.snow.extinction_efficiency, {0.1, 20.0});
  require("snow.refractive_index", p.snow.refractive_index, {1.0, 3.0});
  require("snow.smallest_flake_m", p.snow.smallest_flake_m, {1e-6, 5e-3});
  require("snow.nearest_echo_m", p.snow.nearest_echo_m, {0.1, 1000.0});
  require("fog.backscatter", p.fog.backscatter, {0.0, 1.0});
  require("fog.base_height_m", p.fog.base_height_m, {-1e4, 1e4});
  require("fog.scale_height_m", p.fog.scale_height_m, {0.0, 1e4});
  require("haze.lidar_ratio_sr", p.haze.lidar_ratio_sr, {1.0, 1000.0});
  require("haze.wavelength_m", p.haze.wavelength_m, {3e-7, 3e-6});
  require("dust.silt_share", p.dust.silt_share, {0.0, 1.0});
  require("dust.mass_extinction_m2pkg", p.dust.mass_extinction_m2pkg, {0.1, 1e5});
  require("dust.lidar_ratio_sr", p.dust.lidar_ratio_sr, {1.0, 1000.0});
  require("dust.diffusivity_m2ps", p.dust.diffusivity_m2ps, {0.0, 100.0});
  require("dust.settling_mps", p.dust.settling_mps, {0.0, 10.0});
  require("dust.threshold_depth", p.dust.threshold_depth, {0.01, 10.0});
  require("wind.gust_intensity", p.wind.gust_intensity, {0.0, 1.0});
  require("wind.gust_time_s", p.wind.gust_time_s, {0.1, 3600.0});
  require("overlap_start_m", p.overlap_start_m, {0.1, 10.0});
  require("overlap_end_m", p.overlap_end_m, {p.overlap_start_m + 0.01, 20.0});
}

}  // namespace rigwire::sim
