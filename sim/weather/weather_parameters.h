// What the air of a scene holds, and how it changes: key frames of rain, snow, fog, haze, wind and
// dryness, and for each medium which law it follows. The laws and their papers are in the headers
// of the media: precipitation.h, droplets.h, dust_cloud.h, dust_field.h, wind.h.
#pragma once

#include <cstdint>
#include <vector>

#include "fields/rules.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

/// The weather at one instant. Between two key frames everything changes in proportion to time:
/// rates, dryness, the wind's vector, and of a visibility its extinction (1 / visibility).
struct WeatherFrame {
  Duration at{};                 ///< After the start of the run.
  double rain_mmph = 0.0;        ///< Rate of rainfall.
  double snow_mmph = 0.0;        ///< Rate of snowfall, as water.
  double fog_visibility_m = 0;   ///< Meteorological optical range; 0: no fog.
  double haze_visibility_m = 0;  ///< Distance at which a contrast of 2 % is left; 0: no haze.
  double wind_mps = 0.0;
  double wind_from_rad = 0.0;  ///< Where it comes from, clockwise from north.
  double dryness = 0.0;        ///< Dryness of the ground: 0 no dust, 1 as dry as AP-42 takes it.

  friend bool operator==(const WeatherFrame&, const WeatherFrame&) = default;
};
void visit(fields::Visitor& v, WeatherFrame& p);

enum class RainModel : std::uint8_t {
  marshall_palmer,  ///< Drops of the measured spectrum: extinction by its integral, echoes of
                    ///< drops.
  goodin,  ///< Extinction 0.01 R^0.6 per metre alone (Goodin et al. 2019); 24 to 27 times as much.
};

struct RainParameters {
  RainModel model = RainModel::marshall_palmer;
  double extinction_efficiency = 2.0;  ///< Q_ext of a drop; 2 for drops far above the wavelength.
  double refractive_index = 1.328;     ///< Water at 905 nm.
  double smallest_drop_m = 5e-5;
  double nearest_echo_m = 1.5;  ///< No drop is seen nearer than this, nor within the beam's near_m.

  friend bool operator==(const RainParameters&, const RainParameters&) = default;
};
void visit(fields::Visitor& v, RainParameters& p);

struct SnowParameters {
  /// Intercept of the spectrum, per m3 and mm at 1 mm/h: 3800 in Gunn and Marshall 1958; LISA takes
  /// 7600.
  double intercept = 3800.0;
  double extinction_efficiency = 2.0;
  double refractive_index = 1.304;  ///< Ice at 905 nm.
  double smallest_flake_m = 5e-5;   ///< Melted.
  double nearest_echo_m = 1.5;

  friend bool operator==(const SnowParameters&, const SnowParameters&) = default;
};
void visit(fields::Visitor& v, SnowParameters& p);

struct FogParameters {
  double backscatter = 0.046;   ///< Times 1 / visibility: per metre and steradian.
  double base_height_m = 0.0;   ///< World z up to which fog has its full density.
  double scale_height_m = 0.0;  ///< Above the base it falls to 1/e over this; 0: no upper end.

  friend bool operator==(const FogParameters&, const FogParameters&) = default;
};
void visit(fields::Visitor& v, FogParameters& p);

struct HazeParameters {
  double lidar_ratio_sr = 50.0;  ///< Extinction over back-scatter.
  double wavelength_m = 905e-9;

  friend bool operator==(const HazeParameters&, const HazeParameters&) = default;
};
void visit(fields::Visitor& v, HazeParameters& p);

enum class DustEchoModel : std::uint8_t {
  backscatter,    ///< Echo where the light scattered back first reaches the detection limit.
  optical_depth,  ///< Echo with probability optical depth / threshold, in place of the target's.
};

struct DustParameters {
  DustEchoModel echo = DustEchoModel::backscatter;
  double silt_share = 0.12;             ///< Share of the surface's mass below 75 um.
  double mass_extinction_m2pkg = 57.0;  ///< 1.5 Q_ext / (density x mean diameter): 20 um quartz.
  double lidar_ratio_sr = 45.0;         ///< Extinction over back-scatter, mineral dust.
  double diffusivity_m2ps = 1.0;        ///< Puffs grow with sqrt(2 K t).
  double settling_mps = 0.02;           ///< Settling speed of the particles.
  double threshold_depth = 0.7;         ///< Threshold of the echo model optical_depth.

  friend bool operator==(const DustParameters&, const DustParameters&) = default;
};
void visit(fields::Visitor& v, DustParameters& p);

struct WindParameters {
  double gust_intensity = 0.15;  ///< Standard deviation of each component over the mean speed.
  double gust_time_s = 8.0;      ///< Correlation time.

  friend bool operator==(const WindParameters&, const WindParameters&) = default;
};
void visit(fields::Visitor& v, WindParameters& p);

struct WeatherParameters {
  /// In order of time; before the first and after the last the air stays as there. None: clear.
  std::vector<WeatherFrame> course;
  RainParameters rain;
  SnowParameters snow;
  FogParameters fog;
  HazeParameters haze;
  DustParameters dust;
  WindParameters wind;
  /// Overlap of sender and receiver, for dust: no light from nearer than `start` arrives, all from
  /// beyond `end`, in proportion between (Hahner et al. 2021). Fog and haze: WeatherBeam::focus_m.
  double overlap_start_m = 0.9;
  double overlap_end_m = 1.0;

  /// Whether anything is in the air at any time.
  [[nodiscard]] bool any() const;

  friend bool operator==(const WeatherParameters&, const WeatherParameters&) = default;
};
void visit(fields::Visitor& v, WeatherParameters& p);

/// Throw std::invalid_argument naming the key, the value found and what is allowed.
void validate(const WeatherFrame& frame);
void validate(const WeatherParameters& parameters);

}  // namespace rigwire::sim
