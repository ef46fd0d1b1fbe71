#include <fmt/format.h>

#include <cmath>

#include "bench/gnss_bench.h"
#include "bench/gnss_lap.h"
#include "bench/suites.h"
#include "bench/table.h"
#include "hil/command_line/config_files.h"

namespace rigwire::bench {
namespace {

constexpr const char* kLapRig = "gator_campus";
constexpr double kLapSpeed_mps = 2.0;
constexpr double kLapSpacing_m = 1.0;
constexpr double kBuildingReach_m = 25.0;

void dilution_table(std::ostream& text, nlohmann::json& json, const hil::RigConfiguration& rig) {
  const Table table(text, {{"sky", "<22"},
                           {"epochs", ">6"},
                           {"sats", ">5"},
                           {"Eq. 1 ns", ">10"},
                           {"exact ns", ">9"},
                           {" Eq. 1 / exact, and scatter factor: H, V, P", ""}});
  table.head();
  for (const DilutionCost& c :
       measure_dilution(rig.origin.latitude_deg, rig.origin.longitude_deg)) {
    json["dilution"].push_back(table.row(
        {word("sky", c.sky), count("epochs", c.epochs),
         number("satellites", c.satellites, "{:.1f}"),
         number("regression_ns", c.regression_ns, "{:.0f}"),
         number("geometric_ns", c.geometric_ns, "{:.0f}"),
         shown(fmt::format(" {:.2f} x/{:.2f}  {:.2f} x/{:.2f}  {:.2f} x/{:.2f}", c.horizontal_ratio,
                           c.horizontal_scatter, c.vertical_ratio, c.vertical_scatter,
                           c.position_ratio, c.position_scatter)),
         stored("horizontal_ratio", c.horizontal_ratio),
         stored("horizontal_scatter", c.horizontal_scatter),
         stored("vertical_ratio", c.vertical_ratio), stored("vertical_scatter", c.vertical_scatter),
         stored("position_ratio", c.position_ratio),
         stored("position_scatter", c.position_scatter)}));
  }
}

void tangent_table(std::ostream& text, nlohmann::json& json, const hil::RigConfiguration& rig) {
  const Table table(text, {{"km", ">8"},
                           {"plane ns", ">9"},
                           {"frame ns", ">9"},
                           {"plane error m", ">16"},
                           {"plane height m", ">16"},
                           {"frame error m", ">16"}});
  table.head();
  for (const TangentCost& c :
       measure_tangent(rig.origin.latitude_deg, {100.0, 1e3, 10e3, 50e3, 100e3, 500e3})) {
    json["tangent"].push_back(table.row(
        {number("distance_m", c.distance_m, "{:g}", 1e-3), number("plane_ns", c.plane_ns, "{:.1f}"),
         number("frame_ns", c.frame_ns, "{:.1f}"),
         number("plane_error_m", c.plane_error_m, "{:.3g}"),
         number("plane_height_error_m", c.plane_height_error_m, "{:.3g}"),
         number("frame_error_m", c.frame_error_m, "{:.2g}")}));
  }
}

void sampling_table(std::ostream& text, nlohmann::json& json, const hil::RigConfiguration& rig) {
  const Table table(text, {{"rays / satellite", ">16"},
                           {"epoch us", ">9"},
                           {"views", ">8"},
                           {"state differs", ">13"},
                           {"C/N0 rms", ">10"}});
  table.head();
  for (const SkySampling& c : measure_sky_sampling(rig, {1, 4, 16})) {
    json["sky_sampling"].push_back(table.row(
        {count("samples", c.samples), number("epoch_us", c.epoch_us, "{:.1f}"),
         count("views", c.views), number("differing_share", c.differing, "{:.2f}%", 100.0),
         number("cn0_error_db", c.cn0_error_db, "{:.2f} dB")}));
  }
}

void receiver_table(std::ostream& text, nlohmann::json& json, const hil::RigConfiguration& rig) {
  const Table table(text, {{"errors", "<30"},
                           {"receivers", ">9"},
                           {"Hz", ">6"},
                           {"sensor us", ">10"},
                           {"emulator us", ">12"},
                           {"of one core", ">11"}});
  table.head();
  for (const ReceiverLoad& c : measure_receivers(rig, 100, 10.0, 20)) {
    json["receivers"].push_back(
        table.row({word("model", c.model), count("receivers", c.receivers),
                   number("rate_hz", c.rate_hz, "{:g}"), number("sensor_us", c.sensor_us, "{:.1f}"),
                   number("emulator_us", c.emulator_us, "{:.1f}"),
                   number("core_share", c.core_share, "{:.1f}%", 100.0)}));
  }
}

void model_table(std::ostream& text, nlohmann::json& json, const hil::RigConfiguration& rig) {
  const Table table(text, {{"place", "<8"},
                           {"errors", "<10"},
                           {"epoch us", ">9"},
                           {"fixes", ">7"},
                           {"error m", ">8"},
                           {"95 % m", ">8"},
                           {"/HDOP 50 %", ">11"},
                           {"68 %", ">8"},
                           {"95 %", ">8"},
                           {"step m", ">8"},
                           {"lag 1", ">6"},
                           {"err2/acc2", ">10"},
                           {"HDOP ratio", ">11"}});
  table.head();
  for (const ModelError& c : measure_models(rig, 10, 300)) {
    json["models"].push_back(table.row(
        {word("place", c.place), word("model", c.model), number("epoch_us", c.epoch_us, "{:.1f}"),
         number("fixes", c.fixes, "{:.1f}%", 100.0),
         number("error_median_m", c.error_median_m, "{:.3g}"),
         number("error_95_m", c.error_95_m, "{:.3g}"),
         number("over_dilution_50_m", c.over_dilution_50_m, "{:.3g}"),
         number("over_dilution_68_m", c.over_dilution_68_m, "{:.3g}"),
         number("over_dilution_95_m", c.over_dilution_95_m, "{:.3g}"),
         number("step_median_m", c.step_median_m, "{:.2g}"),
         number("step_correlation", c.step_correlation, "{:.2f}"),
         number("error_over_accuracy", c.error_over_accuracy, "{:.2f}"),
         number("dilution_ratio", c.dilution_ratio, "{:.2f}")}));
  }
}

void accuracy_table(std::ostream& text, nlohmann::json& json, const hil::RigConfiguration& rig) {
  const hil::RigConfiguration forest =
      hil::load_rig(hil::find_rig("unimog_forest"), {}).configuration;
  const Table table(text, {{"place", "<12"},
                           {"receiver", "<13"},
                           {"days", ">5"},
                           {"fixes", ">7"},
                           {"50 % m", ">7"},
                           {"95 % m", ">7"},
                           {"most m", ">7"},
                           {"up sd m", ">8"},
                           {"hAcc m", ">7"},
                           {"v/h", ">5"},
                           {"in hAcc", ">8"},
                           {"in vAcc", ">8"},
                           {"1 s", ">5"},
                           {"5 s", ">5"},
                           {"10 s", ">5"},
                           {"used", ">5"},
                           {"fixed", ">7"}});
  table.head();
  constexpr int kDays = 20;
  for (const ReceiverAccuracy& c : measure_accuracies(rig, forest, kDays)) {
    json["accuracies"].push_back(table.row(
        {word("place", c.place), word("receiver", c.receiver),
         count("days", static_cast<std::size_t>(c.days)),
         number("fixes", c.fixes, "{:.1f}%", 100.0), number("error_50_m", c.error_50_m, "{:.2f}"),
         number("error_95_m", c.error_95_m, "{:.2f}"),
         number("error_most_m", c.error_most_m, "{:.1f}"),
         number("up_deviation_m", c.up_deviation_m, "{:.2f}"),
         number("horizontal_accuracy_m", c.horizontal_accuracy_m, "{:.2f}"),
         number("vertical_over_horizontal", c.vertical_over_horizontal, "{:.2f}"),
         number("inside_horizontal", c.inside_horizontal, "{:.0f}%", 100.0),
         number("inside_vertical", c.inside_vertical, "{:.0f}%", 100.0),
         number("correlation_1s", c.correlation_1s, "{:.2f}"),
         number("correlation_5s", c.correlation_5s, "{:.2f}"),
         number("correlation_10s", c.correlation_10s, "{:.2f}"),
         number("satellites", c.satellites, "{:.1f}"),
         number("rtk_fixed", c.rtk_fixed, "{:.1f}%", 100.0)}));
  }
}

void encoding_table(std::ostream& text, nlohmann::json& json) {
  const Table table(text, {{"position in", "<28"},
                           {"positions", ">9"},
                           {"worst", ">12"},
                           {"half a unit", ">12"},
                           {" unit", ""}});
  table.head();
  for (const PositionEncoding& c : measure_position_encoding(100'000)) {
    json["position_encoding"].push_back(
        table.row({word("message", c.message), count("positions", c.positions),
                   number("worst", c.worst, "{:.4g}"), number("half_unit", c.half_unit, "{:.4g}"),
                   cell("unit", c.unit, fmt::format(" {}", c.unit))}));
  }
}

void lap_table(std::ostream& text, nlohmann::json& json, const hil::RigConfiguration& rig) {
  const Table table(text, {{"receiver", "<12"},
                           {"type", "<16"},
                           {"epochs", ">7"},
                           {"satellites", ">10"},
                           {"HDOP", ">12"},
                           {"VDOP", ">12"},
                           {"PDOP", ">12"}});
  table.head();
  for (const Lap& lap : drive_lap(rig, kLapSpeed_mps, kLapSpacing_m)) {
    const LapRange range = lap_range(lap);
    const auto span = [](const LapRange::Span& s) {
      return fmt::format("{:.2f}..{:.2f}", s.least, s.greatest);
    };
    nlohmann::json epochs;
    for (const LapEpoch& epoch : lap.epochs) {
      epochs["along_m"].push_back(epoch.along_m);
      epochs["satellites"].push_back(epoch.satellites);
      epochs["horizontal_dilution"].push_back(number_or_null(epoch.horizontal_dilution));
      epochs["vertical_dilution"].push_back(number_or_null(epoch.vertical_dilution));
      epochs["position_dilution"].push_back(number_or_null(epoch.position_dilution));
      epochs["horizontal_error_m"].push_back(number_or_null(epoch.horizontal_error_m));
    }
    json["lap"]["receivers"].push_back(table.row(
        {word("device", lap.device), word("type", lap.type),
         cell("epochs", std::move(epochs), fmt::format("{}", lap.epochs.size())),
         shown(fmt::format("{:g}..{:g}", range.satellites.least, range.satellites.greatest)),
         shown(span(range.horizontal)), shown(span(range.vertical)), shown(span(range.position))}));
  }
  for (const PassedBuilding& building : passed_buildings(rig, kBuildingReach_m)) {
    text << fmt::format("{:<12} passes {:.0f} m beside the track at {:.0f} m, {:g} m high\n",
                        building.name, building.distance_m, building.along_m, building.height_m);
    json["lap"]["buildings"].push_back({{"name", building.name},
                                        {"along_m", building.along_m},
                                        {"distance_m", building.distance_m},
                                        {"height_m", building.height_m}});
  }
}

}  // namespace

nlohmann::json bench_gnss(std::ostream& text) {
  const hil::RigConfiguration rig = hil::load_rig(hil::find_rig(kLapRig), {}).configuration;
  nlohmann::json json;
  dilution_table(text, json, rig);
  tangent_table(text, json, rig);
  sampling_table(text, json, rig);
  model_table(text, json, rig);
  accuracy_table(text, json, rig);
  receiver_table(text, json, rig);
  encoding_table(text, json);
  lap_table(text, json, rig);
  return json;
}

}  // namespace rigwire::bench
