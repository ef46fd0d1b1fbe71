#include <fmt/format.h>

#include <vector>

#include "bench/host.h"
#include "bench/rig_bench.h"
#include "bench/suites.h"
#include "bench/table.h"

namespace rigwire::bench {
namespace {

constexpr Duration kFreeSpan = std::chrono::seconds{10};
constexpr Duration kPacedSpan = std::chrono::seconds{10};
constexpr double kGoalFactor = 3.0;
constexpr double kGoalMemory_mb = 600.0;

const char* verdict(bool reached) {
  return reached ? "reached" : "MISSED";
}

std::vector<Cell> cells(const FreeRun& run) {
  const auto per_second = [&](double stage_s) {
    return fmt::format("{:.1f}", 1e3 * stage_s / run.sim_s);
  };
  return {count("threads", run.threads),
          number("realtime_factor", run.realtime_factor, "{:.2f}"),
          number("points_per_s", run.points_per_s, "{:.0f}"),
          shown(per_second(run.truth.physics_s)),
          shown(per_second(run.truth.ray_casting_s)),
          shown(per_second(run.truth.sensors_s)),
          shown(per_second(run.wire.encoding_s)),
          shown(per_second(run.wire.writing_s)),
          cell("cpu_s", run.cpu_s, per_second(run.cpu_s)),
          stored("sim_s", run.sim_s),
          stored("wall_s", run.wall_s),
          stored("stages_cpu_s", {{"physics", run.truth.physics_s},
                                  {"ray_casting", run.truth.ray_casting_s},
                                  {"sensors", run.truth.sensors_s},
                                  {"encoding", run.wire.encoding_s},
                                  {"writing", run.wire.writing_s}}),
          stored("peak_rss_mb", run.peak_rss_mb)};
}

double microseconds(Duration span) {
  return 1e6 * to_seconds(span);
}

}  // namespace

nlohmann::json bench_rig(std::ostream& text) {
  std::vector<FreeRun> runs;
  for (const int threads : {1, 2}) {
    runs.push_back(measure_free_run(kFreeSpan, threads));
  }
  text << fmt::format("{:<20} {:>10} {:>12} {:>53}\n", "", "x real", "points/s",
                      "CPU ms per simulated second");
  const Table table(text, {{"threads that cast", "<20"},
                           {"time", ">10"},
                           {"", ">12"},
                           {"physics", ">8"},
                           {"rays", ">8"},
                           {"sensors", ">8"},
                           {"encode", ">8"},
                           {"write", ">8"},
                           {"process", ">8"}});
  table.head();
  nlohmann::json json;
  for (const FreeRun& run : runs) {
    json["runs"].push_back(table.row(cells(run)));
  }
  text << "stages count the thread that runs the rig; the process also the second one that casts\n";
  const double factor = runs[0].realtime_factor;
  const double memory_mb = runs.back().peak_rss_mb;
  const bool equal = same_bytes(runs[0], runs[1]);
  text << fmt::format("real-time factor, one thread   {:8.2f}      goal >= {:g}: {}\n", factor,
                      kGoalFactor, verdict(factor >= kGoalFactor));
  text << fmt::format("peak memory of the process     {:8.1f} MB   goal < {:g} MB: {}\n", memory_mb,
                      kGoalMemory_mb, verdict(memory_mb < kGoalMemory_mb));
  text << fmt::format("bytes with one and two threads {:>8}\n", equal ? "equal" : "DIFFER");
  json["realtime_factor"] = factor;
  json["realtime_factor_goal"] = kGoalFactor;
  json["peak_rss_mb"] = memory_mb;
  json["peak_rss_mb_goal"] = kGoalMemory_mb;
  json["same_bytes"] = equal;
  return json;
}

nlohmann::json bench_pacing(std::ostream& text) {
  const std::array<double, 3> load_before = load_average();
  const double stolen_before_s = stolen_seconds();
  const PacedRun run = measure_paced_run(kPacedSpan);
  const double stolen_s = stolen_seconds() - stolen_before_s;
  const std::array<double, 3> load = load_average();
  const HostFacts host = host_facts();
  text << fmt::format(
      "{:.0f} s on {}, {} cores, load average {:.2f} before and {:.2f} after; {:.0f} % of a core\n",
      to_seconds(run.outcome.reached), host.kernel, host.cores, load_before[0], load[0],
      100.0 * run.cpu_share);
  const Table table(text, {{"device", "<12"},
                           {"units", ">8"},
                           {"dropped", ">8"},
                           {"p50 us", ">10"},
                           {"p99 us", ">10"},
                           {"p99.9 us", ">10"},
                           {"max us", ">10"}});
  table.head();
  nlohmann::json devices = nlohmann::json::object();
  for (const hil::DeviceReport& device : run.devices) {
    const hil::LatencyHistogram& lateness = device.statistics.lateness;
    const double p50 = microseconds(lateness.percentile(0.5));
    const double p99 = microseconds(lateness.percentile(0.99));
    const double p999 = microseconds(lateness.percentile(0.999));
    const double most = microseconds(lateness.max());
    devices[device.name] = table.row(
        {shown(device.name), count("units", device.statistics.units),
         count("dropped", device.statistics.dropped), shown(fmt::format("{:.1f}", p50)),
         shown(fmt::format("{:.1f}", p99)), shown(fmt::format("{:.1f}", p999)),
         shown(fmt::format("{:.1f}", most)),
         stored("lateness_us", {{"p50", p50}, {"p99", p99}, {"p999", p999}, {"max", most}})});
  }
  text << fmt::format("clock slips {}, {:.3f} s given up; {} register exchanges, one per {} ms\n",
                      run.outcome.slips, to_seconds(run.outcome.slipped), run.exchanges,
                      run.exchange_period.count());
  text << fmt::format("stolen from this machine by its hypervisor meanwhile: {:.2f} s\n", stolen_s);
  return {{"sim_s", to_seconds(run.outcome.reached)},
          {"cpu_share", run.cpu_share},
          {"load_average_before", load_before},
          {"load_average_after", load},
          {"stolen_s", stolen_s},
          {"clock_slips", run.outcome.slips},
          {"slipped_s", to_seconds(run.outcome.slipped)},
          {"modbus_exchanges", run.exchanges},
          {"devices", devices}};
}

}  // namespace rigwire::bench
