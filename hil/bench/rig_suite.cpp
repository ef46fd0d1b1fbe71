#include <fmt/format.h>

#include <vector>

#include "hil/bench/host.h"
#include "hil/bench/rig_bench.h"
#include "hil/bench/suites.h"

namespace rigwire::hil {
namespace {

constexpr Duration kFreeSpan = std::chrono::seconds{10};
constexpr Duration kPacedSpan = std::chrono::seconds{10};
constexpr double kGoalFactor = 3.0;
constexpr double kGoalMemory_mb = 600.0;

const char* verdict(bool reached) {
  return reached ? "reached" : "MISSED";
}

nlohmann::json free_run_json(const FreeRun& run) {
  return {{"threads", run.threads},
          {"sim_s", run.sim_s},
          {"wall_s", run.wall_s},
          {"cpu_s", run.cpu_s},
          {"realtime_factor", run.realtime_factor},
          {"points_per_s", run.points_per_s},
          {"stages_cpu_s",
           {{"physics", run.truth.physics_s},
            {"ray_casting", run.truth.ray_casting_s},
            {"sensors", run.truth.sensors_s},
            {"encoding", run.wire.encoding_s},
            {"writing", run.wire.writing_s}}},
          {"peak_rss_mb", run.peak_rss_mb}};
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
  text << fmt::format("{:<20} {:>10} {:>12} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}\n",
                      "threads that cast", "time", "", "physics", "rays", "sensors", "encode",
                      "write", "process");
  nlohmann::json json;
  for (const FreeRun& run : runs) {
    const auto per_second = [&](double stage_s) { return 1e3 * stage_s / run.sim_s; };
    text << fmt::format(
        "{:<20} {:>10.2f} {:>12.0f} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f}\n",
        run.threads, run.realtime_factor, run.points_per_s, per_second(run.truth.physics_s),
        per_second(run.truth.ray_casting_s), per_second(run.truth.sensors_s),
        per_second(run.wire.encoding_s), per_second(run.wire.writing_s), per_second(run.cpu_s));
    json["runs"].push_back(free_run_json(run));
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
  text << fmt::format("{:<12} {:>8} {:>8} {:>10} {:>10} {:>10} {:>10}\n", "device", "units",
                      "dropped", "p50 us", "p99 us", "p99.9 us", "max us");
  nlohmann::json devices = nlohmann::json::object();
  for (const DeviceReport& device : run.devices) {
    const LatencyHistogram& lateness = device.statistics.lateness;
    const double p50 = microseconds(lateness.percentile(0.5));
    const double p99 = microseconds(lateness.percentile(0.99));
    const double p999 = microseconds(lateness.percentile(0.999));
    const double most = microseconds(lateness.max());
    text << fmt::format("{:<12} {:>8} {:>8} {:>10.1f} {:>10.1f} {:>10.1f} {:>10.1f}\n", device.name,
                        device.statistics.units, device.statistics.dropped, p50, p99, p999, most);
    devices[device.name] = {
        {"units", device.statistics.units},
        {"dropped", device.statistics.dropped},
        {"lateness_us", {{"p50", p50}, {"p99", p99}, {"p999", p999}, {"max", most}}}};
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

}  // namespace rigwire::hil
