#include "hil/record/report.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/utsname.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "hil/configuration/build_facts.h"

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
          {"max", us(lateness.max())},
          {"histogram", lateness_json(classes_of(lateness))}};
}

std::string kernel() {
  utsname name{};
  uname(&name);
  return fmt::format("{} {}", name.sysname, name.release);
}

}  // namespace

Json lateness_json(const LatencyClasses& classes) {
  Json list = Json::array();
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const Json edge_us = i < kLatencyEdges.size()
                             ? Json(kLatencyEdges[i] / std::chrono::microseconds{1})
                             : Json(nullptr);
    list.push_back({edge_us, classes[i]});
  }
  return list;
}

std::string to_json(const RunReport& report) {
  Json json;
  json["rig"] = report.rig;
  json["version"] = version();
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
  if (report.clock.kind == ClockMode::Kind::drained) {
    json["clients_waited_for_s"] = report.outcome.waited_s;
    json["patience_expiries"] = report.outcome.expiries;
  }
  json["overrun"] = {{"policy", kOverrunPolicies[static_cast<std::size_t>(report.overrun)]},
                     {"count", report.outcome.overruns},
                     {"first", Json::array()}};
  for (const Overrun& overrun : report.outcome.first_overruns) {
    json["overrun"]["first"].push_back(
        {{"sim_s", to_seconds(overrun.at - kStart)}, {"behind_s", to_seconds(overrun.lag)}});
  }
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
    if (!device.remark.empty()) {
      devices[device.name]["remark"] = device.remark;
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

namespace {

/// Escapes a label's value for Prometheus' text format.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '\\':
        result += "\\\\";
        break;
      case '"':
        result += "\\\"";
        break;
      case '\n':
        result += "\\n";
        break;
      default:
        result += c;
    }
  }
  return result;
}

class MetricsText {
 public:
  using Labels = std::vector<std::pair<std::string_view, std::string_view>>;

  void begin(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    text_ += fmt::format("# HELP rigwire_{0} {2}\n# TYPE rigwire_{0} {1}\n", name, type, help);
  }
  template <class Number>
  void sample(const Labels& labels, Number value, std::string_view suffix = {}) {
    std::string list;
    for (const auto& [key, label] : labels) {
      list += fmt::format("{}{}=\"{}\"", list.empty() ? "" : ",", key, escaped(label));
    }
    text_ += fmt::format("rigwire_{}{}{} {}\n", name_, suffix, list.empty() ? "" : "{" + list + "}",
                         value);
  }
  template <class Number>
  void single(std::string_view name, std::string_view type, std::string_view help, Number value) {
    begin(name, type, help);
    sample({}, value);
  }
  [[nodiscard]] std::string take() && { return std::move(text_); }

 private:
  std::string_view name_;
  std::string text_;
};

}  // namespace

std::string to_prometheus(const RunReport& report) {
  MetricsText text;
  text.begin("run_info", "gauge", "The run.");
  text.sample({{"rig", report.rig},
               {"version", version()},
               {"seed", std::to_string(report.seed)},
               {"config_hash", report.config_hash},
               {"clock", to_string(report.clock)}},
              1);
  text.single("simulated_seconds", "gauge", "Simulated time since the start.",
              to_seconds(report.outcome.reached));
  text.single("wall_seconds_total", "counter", "Wall time since the start.", report.outcome.wall_s);
  text.single("cpu_seconds_total", "counter",
              "CPU time of the process, but for what keeps processors awake.", report.cpu_s);
  text.single("peak_resident_bytes", "gauge", "Peak memory of the whole process.",
              std::llround(report.peak_rss_mb * 1e6));
  text.single("overruns_total", "counter", "Times that the host was too slow for the clock.",
              report.outcome.overruns);
  text.single("clock_slipped_seconds_total", "counter", "Given up against wall time.",
              to_seconds(report.outcome.slipped));
  text.begin("wire_stage_seconds_total", "counter", "CPU time of the wire thread, by stage.");
  text.sample({{"stage", "encoding"}}, report.wire.encoding_s);
  text.sample({{"stage", "writing"}}, report.wire.writing_s);

  text.begin("device_messages_total", "counter", "Messages on the wire.");
  for (const DeviceReport& device : report.devices) {
    text.sample({{"device", device.name}, {"wire", device.wire}}, device.frames);
  }
  text.begin("device_bytes_total", "counter", "Bytes in units of output.");
  for (const DeviceReport& device : report.devices) {
    text.sample({{"device", device.name}}, device.statistics.bytes);
  }
  text.begin("device_dropped_total", "counter", "Units of output that the wire had no room for.");
  for (const DeviceReport& device : report.devices) {
    text.sample({{"device", device.name}}, device.statistics.dropped);
  }
  text.begin("device_lateness_seconds", "histogram",
             "Wall time of a write after it was due; of clocks that follow the wall's.");
  for (const DeviceReport& device : report.devices) {
    const LatencyHistogram& lateness = device.statistics.lateness;
    // Buckets are cumulative: `le` is the upper edge, "+Inf" counts all.
    for (const Duration edge : kLatencyEdges) {
      text.sample({{"device", device.name}, {"le", fmt::format("{}", to_seconds(edge))}},
                  lateness.up_to(edge), "_bucket");
    }
    text.sample({{"device", device.name}, {"le", "+Inf"}}, lateness.count(), "_bucket");
    text.sample({{"device", device.name}}, to_seconds(lateness.sum()), "_sum");
    text.sample({{"device", device.name}}, lateness.count(), "_count");
  }
  text.begin("device_events_total", "counter", "What a device counts for itself.");
  for (const DeviceReport& device : report.devices) {
    for (const NamedCount& counted : device.counts) {
      text.sample({{"device", device.name}, {"event", counted.name}}, counted.count);
    }
  }
  text.begin("faults_active", "gauge", "Faults that act now.");
  std::map<std::pair<std::string, std::string>, unsigned> acting;
  for (const FaultWindow& fault : report.faults) {
    acting[{fault.where, fault.type}] += fault.acts_at(report.outcome.reached) ? 1U : 0U;
  }
  for (const auto& [fault, count] : acting) {
    text.sample({{"on", fault.first}, {"type", fault.second}}, count);
  }
  return std::move(text).take();
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
