#include <fmt/format.h>

#include <cmath>

#include "bench/suites.h"
#include "bench/table.h"
#include "bench/weather_bench.h"
#include "bench/weather_views.h"

namespace rigwire::bench {
namespace {

constexpr int kRainBeams = 400000;
constexpr int kFogBeams = 400000;

void cost_table(std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"medium", "<24"},
                           {"ns/beam", ">9"},
                           {"less clear", ">12"},
                           {"in steps ns", ">13"},
                           {"with echo", ">12"},
                           {"transmission", ">13"},
                           {"energy", ">9"},
                           {"range mm", ">9"}});
  table.head();
  const auto costs = measure_weather_cost();
  for (const WeatherCost& cost : costs) {
    const double extra_ns = cost.beam_ns - costs.front().beam_ns;
    json["media"].push_back(
        table.row({word("medium", cost.medium), number("beam_ns", cost.beam_ns, "{:.1f}"),
                   number("above_clear_ns", extra_ns, "{:.1f}"),
                   number("reference_ns", cost.reference_ns, "{:.0f}"),
                   number("echo_share", cost.echo_share, "{:.1f}%", 100.0),
                   number("transmission_error", cost.transmission_error, "{:.1e}"),
                   number("echo_energy_error", cost.echo_energy_error, "{:.2f}%", 100.0),
                   number("echo_range_error_m", cost.echo_range_error_m, "{:.1f}", 1e3)}));
  }
  text << "errors: greatest difference from steps of 20 mm\n\n";
}

void rain_table(std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"rain mm/h", ">9"},
                           {"alpha 1/m", ">14"},
                           {"integrated", ">14"},
                           {"returns", ">12"},
                           {"expected", ">12"},
                           {"sigmas", ">7"}});
  table.head();
  for (const RainReturns& row : measure_rain_returns(kRainBeams)) {
    const double sigmas = (row.counted_share - row.expected_share) / row.sigma;
    json["rain"].push_back(
        table.row({number("rain_mmph", row.rain_mmph, "{:g}"),
                   number("extinction_pm", row.extinction_pm, "{:.6e}"),
                   number("integrated_extinction_pm", row.integrated_extinction_pm, "{:.6e}"),
                   number("returned_share", row.counted_share, "{:.4f}%", 100.0),
                   number("expected_share", row.expected_share, "{:.4f}%", 100.0),
                   number("sigmas", sigmas, "{:.2f}"), stored("beams", row.beams)}));
  }
}

void fog_table(std::ostream& text, nlohmann::json& json) {
  text << '\n';
  const Table table(text, {{"visibility m", ">12"},
                           {"returns", ">12"},
                           {"expected", ">12"},
                           {"sigmas", ">7"},
                           {"mean range m", ">13"},
                           {"expected m", ">11"}});
  table.head();
  for (const FogReturns& row : measure_fog_returns(kFogBeams)) {
    const double sigmas = (row.counted_share - row.expected_share) / row.sigma;
    json["fog"].push_back(table.row(
        {number("visibility_m", row.visibility_m, "{:g}"),
         number("returned_share", row.counted_share, "{:.4f}%", 100.0),
         number("expected_share", row.expected_share, "{:.4f}%", 100.0),
         number("sigmas", sigmas, "{:.2f}"), number("mean_range_m", row.mean_range_m, "{:.2f}"),
         number("expected_mean_range_m", row.expected_mean_range_m, "{:.2f}"),
         stored("beams", row.beams)}));
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
  fog_table(text, json);
  const DustStepCost step = measure_dust_step();
  text << fmt::format(
      "\n20 ms of dust behind four wheels, {} puffs: {:.1f} us ({:.2f} % of a core)\n", step.puffs,
      step.step_us, 100.0 * step.step_us / 20e3);
  views(json);
  json["dust_step"] = {{"puffs", step.puffs}, {"step_us", step.step_us}};
  return json;
}

}  // namespace rigwire::bench
