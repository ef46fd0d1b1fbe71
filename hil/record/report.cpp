#include "hil/record/report.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/utsname.h>

#include <nlohmann/json.hpp>

namespace rigwire::hil {
namespace {

using Json = nlohmann::ordered_json;

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

Json lateness_us(const LatencyHistogram& lateness) {
  const auto us = [](Duration span) { return to_seconds(span) * 1e6; };
  return {{"p50", us(lateness.percentile(0.5))},
          {"p99", us(lateness.percentile(0.99))},
          {"p999", us(lateness.percentile(0.999))},
          {"max", us(lateness.max())}};
}

std::string kernel() {
  utsname name{};
  uname(&name);
  return fmt::format("{} {}", name.sysname, name.release);
}

}  // namespace

std::string to_json(const RunReport& report) {
  Json json;
  json["rig"] = report.rig;
  json["version"] = RIGWIRE_VERSION;
  json["seed"] = report.seed;
  json["config_hash"] = report.config_hash;
  json["clock"] = to_string(report.clock);
  json["kernel"] = kernel();
  const double sim_s = to_seconds(report.outcome.reached);
  json["sim_s"] = sim_s;
  json["wall_s"] = report.outcome.wall_s;
  json["cpu_s"] = report.cpu_s;
  json["realtime_factor"] = report.outcome.wall_s > 0.0 ? sim_s / report.outcome.wall_s : 0.0;
  json["peak_rss_mb"] = report.peak_rss_mb;
  json["clock_slips"] = report.outcome.slips;
  json["slipped_s"] = to_seconds(report.outcome.slipped);
  json["fault"] = report.outcome.fault ? Json(*report.outcome.fault) : Json(nullptr);
  json["stages"] = {{"physics", report.truth.physics_s},
                    {"ray_casting", report.truth.ray_casting_s},
                    {"sensors", report.truth.sensors_s},
                    {"encoding", report.wire.encoding_s},
                    {"writing", report.wire.writing_s}};
  Json devices = Json::object();
  for (const auto& device : report.devices) {
    devices[device.name] = {
        {"wire", device.wire},
        {"frames", device.frames},
        {"bytes", device.statistics.bytes},
        {"dropped", device.statistics.dropped},
        {"lateness_us", lateness_us(device.statistics.lateness)},
        {"last_request", device.last_request ? Json{{"sim_s", to_seconds(device.last_request->at)},
                                                    {"text", device.last_request->text}}
                                             : Json(nullptr)},
        {"stream_hash", fmt::format("{:016x}", device.statistics.hash.value())}};
    for (const NamedCount& counted : device.counts) {
      devices[device.name]["counts"][std::string(counted.name)] = counted.count;
    }
  }
  json["devices"] = std::move(devices);
  json["faults"] = Json::array();
  for (const FaultWindow& fault : report.faults) {
    json["faults"].push_back(
        {{"where", fault.where},
         {"type", fault.type},
         {"begin_s", to_seconds(fault.begin)},
         {"end_s", fault.end == kNever ? Json(nullptr) : Json(to_seconds(fault.end))}});
  }
  // What clients sent need not be UTF-8; the report must not be lost by it.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

double process_cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double peak_resident_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024.0 * 1e-6;
}

}  // namespace rigwire::hil
