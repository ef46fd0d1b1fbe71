#include <fmt/format.h>

#include <cmath>

#include "hil/bench/suites.h"
#include "hil/bench/weather_bench.h"
#include "hil/bench/weather_views.h"

namespace rigwire::hil {
namespace {

constexpr int kRainBeams = 400000;

void cost_table(std::ostream& text, nlohmann::json& json) {
  text << fmt::format("{:<24} {:>9} {:>12} {:>13} {:>12} {:>13} {:>9} {:>9}\n", "medium", "ns/beam",
                      "less clear", "in steps ns", "with echo", "transmission", "energy",
                      "range mm");
  const auto costs = measure_weather_cost();
  for (const WeatherCost& cost : costs) {
    const double extra_ns = cost.beam_ns - costs.front().beam_ns;
    text << fmt::format(
        "{:<24} {:>9.1f} {:>12.1f} {:>13.0f} {:>11.1f}% {:>13.1e} {:>8.2f}% {:>9.1f}\n",
        cost.medium, cost.beam_ns, extra_ns, cost.reference_ns, 100.0 * cost.echo_share,
        cost.transmission_error, 100.0 * cost.echo_energy_error, 1e3 * cost.echo_range_error_m);
    json["media"].push_back({{"medium", cost.medium},
                             {"beam_ns", cost.beam_ns},
                             {"above_clear_ns", extra_ns},
                             {"reference_ns", cost.reference_ns},
                             {"echo_share", cost.echo_share},
                             {"transmission_error", cost.transmission_error},
                             {"echo_energy_error", cost.echo_energy_error},
                             {"echo_range_error_m", cost.echo_range_error_m}});
  }
  text << "errors: greatest difference from steps of 20 mm\n\n";
}

void rain_table(std::ostream& text, nlohmann::json& json) {
  text << fmt::format("{:>9} {:>14} {:>14} {:>12} {:>12} {:>7}\n", "rain mm/h", "alpha 1/m",
                      "integrated", "returns", "expected", "sigmas");
  for (const RainReturns& row : measure_rain_returns(kRainBeams)) {
    const double sigmas = (row.counted_share - row.expected_share) / row.sigma;
    text << fmt::format("{:>9g} {:>14.6e} {:>14.6e} {:>11.4f}% {:>11.4f}% {:>7.2f}\n",
                        row.rain_mmph, row.extinction_pm, row.integrated_extinction_pm,
                        100.0 * row.counted_share, 100.0 * row.expected_share, sigmas);
    json["rain"].push_back({{"rain_mmph", row.rain_mmph},
                            {"beams", row.beams},
                            {"extinction_pm", row.extinction_pm},
                            {"integrated_extinction_pm", row.integrated_extinction_pm},
                            {"returned_share", row.counted_share},
                            {"expected_share", row.expected_share},
                            {"sigmas", sigmas}});
  }
}

/// For scripts/plot-weather.py alone.
void views(nlohmann::json& json) {
  for (const TransmissionCurve& curve : transmission_curves()) {
    json["transmission"].push_back(
        {{"medium", curve.medium}, {"range_m", curve.range_m}, {"two_way", curve.two_way}});
  }
  const DustView view = dust_view();
  nlohmann::json& dust = json["dust_view"];
  dust = {{"sensor_m", {view.sensor_x_m, view.sensor_y_m}}, {"lost", view.lost}};
  for (const sim::DustPuff& puff : view.puffs) {
    dust["puffs"].push_back(
        {puff.centre_W.x(), puff.centre_W.y(), std::sqrt(puff.variance_m2), puff.mass_kg});
  }
  for (const PlanPoint& point : view.returns) {
    dust["returns"].push_back({point.x_m, point.y_m, point.from_dust ? 1 : 0});
  }
}

}  // namespace

nlohmann::json bench_weather(std::ostream& text) {
  nlohmann::json json;
  cost_table(text, json);
  rain_table(text, json);
  const DustStepCost step = measure_dust_step();
  text << fmt::format(
      "\n20 ms of dust behind four wheels, {} puffs: {:.1f} us ({:.2f} % of a core)\n", step.puffs,
      step.step_us, 100.0 * step.step_us / 20e3);
  views(json);
  json["dust_step"] = {{"puffs", step.puffs}, {"step_us", step.step_us}};
  return json;
}

}  // namespace rigwire::hil
