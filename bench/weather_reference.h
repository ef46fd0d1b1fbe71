// A costly reference for beams in weather: small steps along the beam, each puff of dust evaluated
// at each, and double integrals over the drops. Written from the definitions, sharing nothing with
// sim/weather but its parameters and the puffs.
#pragma once

#include <span>

#include "sim/weather/dust_cloud.h"
#include "sim/weather/weather.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::bench {

/// Result of a beam in steps of `step_m`: transmission, and the first echo of dust.
struct MarchedBeam {
  double transmission = 1.0;
  bool dust_echo = false;
  sim::AirEcho dust{};
};

/// For a constant weather: the first key frame. Wind is left out: puffs do not move.
[[nodiscard]] MarchedBeam march_beam(const sim::WeatherParameters& parameters,
                                     std::span<const sim::DustPuff> puffs,
                                     const sim::WeatherBeam& beam, double step_m);

/// Drops of rain in the beam whose echo is detected, to be expected, by a double integral of the
/// spectrum; `extinction_pm` is that of the air.
[[nodiscard]] double expected_drop_echoes(double rain_mmph, double extinction_pm,
                                          const sim::RainParameters& rain,
                                          const sim::WeatherBeam& beam);

/// Expected echoes of uniform fog: cells of a pulse's length whose energy has a negative
/// exponential distribution about the pulse integral, which is summed up here.
struct ExpectedClutter {
  double echoes = 0.0;
  double mean_range_m = 0.0;
};
[[nodiscard]] ExpectedClutter expected_clutter(double visibility_m, const sim::FogParameters& fog,
                                               const sim::WeatherBeam& beam);

/// Returns the extinction of rain of that rate, by an integral of the spectrum.
[[nodiscard]] double integrated_rain_extinction_pm(double rain_mmph,
                                                   const sim::RainParameters& rain);

}  // namespace rigwire::bench
