#include <fmt/format.h>

#include <cmath>

#include "hil/bench/gnss_bench.h"
#include "hil/bench/gnss_lap.h"
#include "hil/bench/suites.h"
#include "hil/command_line/config_files.h"

namespace rigwire::hil {
namespace {

constexpr const char* kLapRig = "gator_campus";
constexpr double kLapSpeed_mps = 2.0;
constexpr double kLapSpacing_m = 1.0;
constexpr double kBuildingReach_m = 25.0;

void dilution_table(std::ostream& text, nlohmann::json& json, const RigConfiguration& rig) {
  text << fmt::format("{:<22} {:>6} {:>5} {:>10} {:>9}  {}\n", "sky", "epochs", "sats", "Eq. 1 ns",
                      "exact ns", "Eq. 1 / exact, and scatter factor: H, V, P");
  for (const DilutionCost& c :
       measure_dilution(rig.origin.latitude_deg, rig.origin.longitude_deg)) {
    text << fmt::format(
        "{:<22} {:>6} {:>5.1f} {:>10.0f} {:>9.0f}  {:.2f} x/{:.2f}  {:.2f} x/{:.2f}  {:.2f} "
        "x/{:.2f}\n",
        c.sky, c.epochs, c.satellites, c.regression_ns, c.geometric_ns, c.horizontal_ratio,
        c.horizontal_scatter, c.vertical_ratio, c.vertical_scatter, c.position_ratio,
        c.position_scatter);
    json["dilution"].push_back({{"sky", c.sky},
                                {"epochs", c.epochs},
                                {"satellites", c.satellites},
                                {"regression_ns", c.regression_ns},
                                {"geometric_ns", c.geometric_ns},
                                {"horizontal_ratio", c.horizontal_ratio},
                                {"horizontal_scatter", c.horizontal_scatter},
                                {"vertical_ratio", c.vertical_ratio},
                                {"vertical_scatter", c.vertical_scatter},
                                {"position_ratio", c.position_ratio},
                                {"position_scatter", c.position_scatter}});
  }
}

void tangent_table(std::ostream& text, nlohmann::json& json, const RigConfiguration& rig) {
  text << fmt::format("{:>8} {:>9} {:>9} {:>16} {:>16} {:>16}\n", "km", "plane ns", "frame ns",
                      "plane error m", "plane height m", "frame error m");
  for (const TangentCost& c :
       measure_tangent(rig.origin.latitude_deg, {100.0, 1e3, 10e3, 50e3, 100e3, 500e3})) {
    text << fmt::format("{:>8g} {:>9.1f} {:>9.1f} {:>16.3g} {:>16.3g} {:>16.2g}\n",
                        1e-3 * c.distance_m, c.plane_ns, c.frame_ns, c.plane_error_m,
                        c.plane_height_error_m, c.frame_error_m);
    json["tangent"].push_back({{"distance_m", c.distance_m},
                               {"plane_ns", c.plane_ns},
                               {"frame_ns", c.frame_ns},
                               {"plane_error_m", c.plane_error_m},
                               {"plane_height_error_m", c.plane_height_error_m},
                               {"frame_error_m", c.frame_error_m}});
  }
}

void sampling_table(std::ostream& text, nlohmann::json& json, const RigConfiguration& rig) {
  text << fmt::format("{:>16} {:>9} {:>8} {:>13} {:>10}\n", "rays / satellite", "epoch us", "views",
                      "state differs", "C/N0 rms");
  for (const SkySampling& c : measure_sky_sampling(rig, {1, 4, 16})) {
    text << fmt::format("{:>16} {:>9.1f} {:>8} {:>12.2f}% {:>7.2f} dB\n", c.samples, c.epoch_us,
                        c.views, 100.0 * c.differing, c.cn0_error_db);
    json["sky_sampling"].push_back({{"samples", c.samples},
                                    {"epoch_us", c.epoch_us},
                                    {"views", c.views},
                                    {"differing_share", c.differing},
                                    {"cn0_error_db", c.cn0_error_db}});
  }
}

void receiver_table(std::ostream& text, nlohmann::json& json, const RigConfiguration& rig) {
  text << fmt::format("{:<22} {:>9} {:>6} {:>10} {:>12} {:>11}\n", "errors", "receivers", "Hz",
                      "sensor us", "emulator us", "of one core");
  for (const ReceiverLoad& c : measure_receivers(rig, 100, 10.0, 20)) {
    text << fmt::format("{:<22} {:>9} {:>6g} {:>10.1f} {:>12.1f} {:>10.1f}%\n", c.model,
                        c.receivers, c.rate_hz, c.sensor_us, c.emulator_us, 100.0 * c.core_share);
    json["receivers"].push_back({{"model", c.model},
                                 {"receivers", c.receivers},
                                 {"rate_hz", c.rate_hz},
                                 {"sensor_us", c.sensor_us},
                                 {"emulator_us", c.emulator_us},
                                 {"core_share", c.core_share}});
  }
}

void encoding_table(std::ostream& text, nlohmann::json& json) {
  text << fmt::format("{:<28} {:>9} {:>12} {:>12}  {}\n", "position in", "positions", "worst",
                      "half a unit", "unit");
  for (const PositionEncoding& c : measure_position_encoding(100'000)) {
    text << fmt::format("{:<28} {:>9} {:>12.4g} {:>12.4g}  {}\n", c.message, c.positions, c.worst,
                        c.half_unit, c.unit);
    json["position_encoding"].push_back({{"message", c.message},
                                         {"positions", c.positions},
                                         {"worst", c.worst},
                                         {"half_unit", c.half_unit},
                                         {"unit", c.unit}});
  }
}

/// JSON has no number that is none.
nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

void lap_table(std::ostream& text, nlohmann::json& json, const RigConfiguration& rig) {
  text << fmt::format("{:<12} {:<16} {:>7} {:>10} {:>12} {:>12} {:>12}\n", "receiver", "type",
                      "epochs", "satellites", "HDOP", "VDOP", "PDOP");
  for (const Lap& lap : drive_lap(rig, kLapSpeed_mps, kLapSpacing_m)) {
    const LapRange range = lap_range(lap);
    const auto span = [](const LapRange::Span& s) {
      return fmt::format("{:.2f}..{:.2f}", s.least, s.greatest);
    };
    text << fmt::format(
        "{:<12} {:<16} {:>7} {:>10} {:>12} {:>12} {:>12}\n", lap.device, lap.type,
        lap.epochs.size(),
        fmt::format("{:g}..{:g}", range.satellites.least, range.satellites.greatest),
        span(range.horizontal), span(range.vertical), span(range.position));
    nlohmann::json epochs;
    for (const LapEpoch& epoch : lap.epochs) {
      epochs["along_m"].push_back(epoch.along_m);
      epochs["satellites"].push_back(epoch.satellites);
      epochs["horizontal_dilution"].push_back(number(epoch.horizontal_dilution));
      epochs["vertical_dilution"].push_back(number(epoch.vertical_dilution));
      epochs["position_dilution"].push_back(number(epoch.position_dilution));
      epochs["horizontal_error_m"].push_back(number(epoch.horizontal_error_m));
    }
    json["lap"]["receivers"].push_back(
        {{"device", lap.device}, {"type", lap.type}, {"epochs", std::move(epochs)}});
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
  const RigConfiguration rig = load_rig(find_rig(kLapRig), {}).configuration;
  nlohmann::json json;
  dilution_table(text, json, rig);
  tangent_table(text, json, rig);
  sampling_table(text, json, rig);
  receiver_table(text, json, rig);
  encoding_table(text, json);
  lap_table(text, json, rig);
  return json;
}

}  // namespace rigwire::hil
