// Cost of weather per beam, and difference of its closed forms and tables from small steps.
#pragma once

#include <string>
#include <vector>

namespace rigwire::bench {

/// Cost and errors of one weather, over the beams of a lidar 2.2 m above level ground.
struct WeatherCost {
  std::string medium;
  double beam_ns = 0.0;       ///< CPU time of one beam.
  double reference_ns = 0.0;  ///< CPU time of the same beam in small steps.
  double echo_share = 0.0;    ///< Share of beams with an echo from the air.
  /// Maximum differences from small steps, over the beams compared.
  double transmission_error = 0.0;
  double echo_energy_error = 0.0;  ///< Relative; 0 where no echo was compared.
  double echo_range_error_m = 0.0;
};

[[nodiscard]] std::vector<WeatherCost> measure_weather_cost();

/// Beams that return from rain, counted and by a double integral.
struct RainReturns {
  double rain_mmph = 0.0;
  int beams = 0;
  double counted_share = 0.0;
  double expected_share = 0.0;
  double sigma = 0.0;  ///< Standard deviation of the counted share.
  double extinction_pm = 0.0;
  double integrated_extinction_pm = 0.0;
};

[[nodiscard]] std::vector<RainReturns> measure_rain_returns(int beams);

/// Beams of an HDL-32E that return from fog, counted and by the integral over cells.
struct FogReturns {
  double visibility_m = 0.0;
  int beams = 0;
  double counted_share = 0.0;
  double expected_share = 0.0;
  double sigma = 0.0;  ///< Standard deviation of the counted share.
  double mean_range_m = 0.0;
  double expected_mean_range_m = 0.0;
};

[[nodiscard]] std::vector<FogReturns> measure_fog_returns(int beams);

/// One step of the dust of a vehicle that drives (20 ms: emission, drift, preparation for beams).
struct DustStepCost {
  std::size_t puffs = 0;
  double step_us = 0.0;
};

[[nodiscard]] DustStepCost measure_dust_step();

}  // namespace rigwire::bench
