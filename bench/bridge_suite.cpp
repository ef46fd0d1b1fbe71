// The bridge as an instrument: how soon a run is ready, what a step costs, what recording costs,
// how far a day's replay drifts, and how many runs a machine does.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/cost.h"
#include "bench/host.h"
#include "bench/isolated_run.h"
#include "bench/private_rig.h"
#include "bench/suites.h"
#include "bench/table.h"
#include "drivers/http_server.h"
#include "hil/files/private_folder.h"
#include "hil/files/replay_reader.h"
#include "hil/record/motion_line.h"
#include "hil/rig/rig.h"

namespace rigwire::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kStarts = 20;
constexpr int kSteps = 2000;
/// Divisor of the number of runs for those one by one: their rate is constant from the first on.
constexpr int kOneByOneOf = 10;
constexpr int kRecordingRounds = 2;
constexpr int kRecorded_s = 5;
constexpr double kGoalReady_s = 0.5;
constexpr double kGoalRecording = 0.1;

int& runs_at_once() {
  static int runs = 1000;
  return runs;
}

double seconds_of(const std::function<void()>& work) {
  const auto before = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - before).count();
}

/// The value below which that share of `values` lies.
double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto index = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values[std::min(index, values.size() - 1)];
}

void require_done(const IsolatedRun::Ended& ended) {
  if (ended.exit_code != 0) {
    throw std::runtime_error(fmt::format("a run ended with exit code {}", ended.exit_code));
  }
}

nlohmann::json measure_start(std::ostream& text) {
  std::vector<double> ready_s;
  for (int i = 0; i < kStarts; ++i) {
    const hil::PrivateFolder folder("bench");
    std::unique_ptr<IsolatedRun> run;
    ready_s.push_back(seconds_of([&] {
      run =
          std::make_unique<IsolatedRun>(folder.path(), std::vector<std::string>{"--clock", "step"});
      run->wait_until_ready();
    }));
  }
  const double median_s = quantile(ready_s, 0.5);
  const double most_s = quantile(ready_s, 1.0);
  text << fmt::format(
      "from start to ready, {} starts: median {:.3f} s, largest {:.3f} s; goal < {:g} s: {}\n",
      kStarts, median_s, most_s, kGoalReady_s, median_s < kGoalReady_s ? "reached" : "MISSED");
  return {{"starts", kStarts}, {"median_s", median_s}, {"max_s", most_s}, {"goal_s", kGoalReady_s}};
}

/// Answers of a server that does nothing, on a thread of its own.
class BareServer {
 public:
  explicit BareServer(const std::filesystem::path& socket) : server_(io_, settings(socket)) {
    server_.start([](const drivers::HttpRequest&) {
      return drivers::HttpResponse{200, "application/json", R"({"ok":true})", {}, false};
    });
    thread_ = std::thread([this] { io_.run(); });
  }
  ~BareServer() {
    io_.stop();
    thread_.join();
  }
  BareServer(const BareServer&) = delete;
  BareServer& operator=(const BareServer&) = delete;

 private:
  static drivers::HttpServerSettings settings(const std::filesystem::path& socket) {
    drivers::HttpServerSettings chosen;
    chosen.path = socket.string();
    return chosen;
  }

  boost::asio::io_context io_;
  drivers::HttpServer server_;
  std::thread thread_;
};

nlohmann::json measure_steps(std::ostream& text) {
  const hil::PrivateFolder folder("bench");
  IsolatedRun run(folder.path() / "run", {"--clock", "step"});
  run.wait_until_ready();
  const BareServer bare(folder.path() / "bare");
  ControlConnection stepped(run.control());
  ControlConnection echoed(folder.path() / "bare");
  struct Asked {
    const char* name;
    ControlConnection* connection;
    std::string body;
    std::vector<double> us;
  };
  // In turns, so that all have the same host.
  std::vector<Asked> all{{"bare answer", &echoed, R"({"verb":"state"})", {}},
                         {"state", &stepped, R"({"verb":"state"})", {}},
                         {"step of 1 ms", &stepped, R"({"verb":"step","length":"1 ms"})", {}}};
  for (int i = 0; i < kSteps; ++i) {
    for (Asked& asked : all) {
      asked.us.push_back(1e6 * seconds_of([&] { asked.connection->ask(asked.body); }));
    }
  }
  const Table table(
      text, {{"round trip", "<16"}, {"p50 us", ">10"}, {"p99 us", ">10"}, {"of bare", ">10"}});
  table.head();
  nlohmann::json json;
  const double bare_us = quantile(all.front().us, 0.5);
  for (const Asked& asked : all) {
    const double p50 = quantile(asked.us, 0.5);
    json.push_back(table.row({word("request", asked.name), number("p50_us", p50, "{:.1f}"),
                              number("p99_us", quantile(asked.us, 0.99), "{:.1f}"),
                              number("of_bare", p50 / bare_us, "{:.2f}")}));
  }
  return json;
}

nlohmann::json measure_recording(std::ostream& text) {
  struct Way {
    const char* name;
    bool records;
    bool clouds = false;       ///< `/points` of each lidar, a turn a second.
    double cpu = 0.0;          ///< Share of a core, minimum of the rounds.
    double lateness_us = 0.0;  ///< p99, maximum over devices, minimum over rounds.
    double truth_mb_s = 0.0;   ///< Data rate of the MCAP file.
  };
  std::vector<Way> ways{{"not recorded", false}, {"recorded", true}, {"and /points", true, true}};
  for (int round = 0; round < kRecordingRounds; ++round) {
    for (Way& way : ways) {
      const hil::PrivateFolder folder("bench");
      std::vector<std::string> arguments{"--duration", fmt::format("{}s", kRecorded_s)};
      if (way.records) {
        arguments.insert(arguments.end(), {"--record", (folder.path() / "recording").string()});
      }
      if (way.clouds) {
        arguments.insert(arguments.end(), {"--set", "truth.clouds_every=1s"});
      }
      IsolatedRun run(folder.path() / "run", arguments);
      require_done(run.wait());
      const nlohmann::json report = run.report();
      double lateness_us = 0.0;
      for (const nlohmann::json& device : report["devices"]) {
        lateness_us = std::max(lateness_us, device["lateness_us"]["p99"].get<double>());
      }
      const double cpu = report["cpu_s"].get<double>() / report["wall_s"].get<double>();
      way.cpu = round == 0 ? cpu : std::min(way.cpu, cpu);
      way.lateness_us = round == 0 ? lateness_us : std::min(way.lateness_us, lateness_us);
      if (way.records) {
        way.truth_mb_s = 1e-6 / kRecorded_s *
                         static_cast<double>(std::filesystem::file_size(
                             folder.path() / "recording" / "truth.mcap"));
      }
    }
  }
  const Table table(
      text, {{"real time", "<16"}, {"of a core", ">10"}, {"p99 us", ">10"}, {"truth MB/s", ">12"}});
  table.head();
  nlohmann::json json;
  for (const Way& way : ways) {
    json["runs"].push_back(table.row({word("run", way.name), number("core", way.cpu, "{:.3f}"),
                                      number("lateness_p99_us", way.lateness_us, "{:.1f}"),
                                      number("truth_mb_per_s", way.truth_mb_s, "{:.3f}")}));
  }
  const double cost = ways[1].cpu - ways[0].cpu;
  text << fmt::format("recording everything: {:.3f} of a core; goal < {:g}: {}\n", cost,
                      kGoalRecording, cost < kGoalRecording ? "reached" : "MISSED");
  json["core"] = cost;
  json["goal"] = kGoalRecording;
  return json;
}

/// What one message of /motion costs and holds, by making that of a record over and over.
class MotionCost final : public hil::TruthObserver {
 public:
  struct Found {
    double ns = 0.0;
    std::size_t bytes = 0;
  };
  MotionCost(std::span<const std::string_view> links, Found& found)
      : links_(links.begin(), links.end()), found_(found) {}

  void record(const hil::TruthRecord& record) override {
    found_.bytes = hil::motion_line(record, links_).size();
    found_.ns = nanoseconds_of([&](int) {
      const std::string line = hil::motion_line(record, links_);
      keep(line.data());
    });
  }

 private:
  std::vector<std::string> links_;
  Found& found_;
};

nlohmann::json measure_motion(std::ostream& text) {
  const PrivateRig rig;
  hil::SimulatedWorld world = hil::make_world(rig.configuration());
  MotionCost::Found found;
  world.add_truth_observer(std::make_unique<MotionCost>(world.machine().link_names(), found),
                           rig.configuration().truth.period);
  hil::SampleBatch batch;
  while (found.bytes == 0) {
    if (const auto fault = world.advance({}, batch)) {
      throw std::runtime_error(*fault);
    }
  }
  const double rate_hz = 1.0 / to_seconds(rig.configuration().truth.period);
  const double core = 1e-9 * found.ns * rate_hz;
  const double mb_s = 1e-6 * static_cast<double>(found.bytes) * rate_hz;
  text << fmt::format(
      "a message of /motion: {:.1f} us, {} bytes; at {:g} Hz {:.4f} of a core, {:.3f} MB/s\n",
      1e-3 * found.ns, found.bytes, rate_hz, core, mb_s);
  return {{"us", 1e-3 * found.ns}, {"bytes", found.bytes}, {"core", core}, {"mb_per_s", mb_s}};
}

/// Period of the replayed log: a little more than a second, not a multiple of a slice.
constexpr std::int64_t kLoggedEvery_us = 1'007'919;
constexpr int kLoggedFrames = 86'400;
constexpr std::int64_t kLoggedFrom_us = 1'748'764'800'000'000;  // 2025-06-01 08:00 UTC
constexpr double kGoalDriftAnHour_us = 1000.0;

void write_replay_rig(const std::filesystem::path& folder) {
  std::ofstream log(folder / "day.log");
  for (int i = 0; i < kLoggedFrames; ++i) {
    const std::int64_t at_us = kLoggedFrom_us + i * kLoggedEvery_us;
    log << fmt::format("({}.{:06}) can0 18FEF1FE#{:016X}\n", at_us / 1'000'000, at_us % 1'000'000,
                       i);
  }
  std::ofstream(folder / "rig.yaml")
      << fmt::format(R"(machine: {{type: wheeled, wheeled: {{level: kinematic}}}}
step: 10 ms
slice: 20 ms
lead: 40 ms
buses: {{can: {{wire: slcan, path: {}}}}}
devices:
  log: {{type: replay, source: {{file: day.log}}, wire: can, bus: can}}
)",
                     (folder / "can").string());
}

/// A log of a day replayed onto a bus and recorded from it: how the instants of both part. The
/// first frame is no measure, for it cannot be complete at the run's very start.
nlohmann::json measure_replay(std::ostream& text) {
  const hil::PrivateFolder folder("bench");
  write_replay_rig(folder.path());
  const std::filesystem::path recording = folder.path() / "recording";
  const std::int64_t logged_s = kLoggedFrames * kLoggedEvery_us / 1'000'000 + 1;
  const double wall_s = seconds_of([&] {
    IsolatedRun run(folder.path() / "run",
                    {"--clock", "free", "--duration", fmt::format("{}s", logged_s), "--record",
                     recording.string(), "--only", "can"},
                    (folder.path() / "rig.yaml").string());
    require_done(run.wait());
  });
  const auto reader_of = [](const std::filesystem::path& file) {
    hil::ReplaySourceSettings source;
    source.file = file.string();
    return hil::open_replay_reader(source);
  };
  const auto logged = reader_of(folder.path() / "day.log");
  const auto replayed = reader_of(recording / "wires" / "can.log");
  hil::ReplayedUnit was;
  hil::ReplayedUnit is;
  std::int64_t was_ns = 0;
  std::int64_t is_ns = 0;
  int frames = 0;
  int differ = 0;
  double first_us = 0.0;
  double drift_us = 0.0;  // of the last
  double most_us = 0.0;
  while (logged->next(was_ns, was) && replayed->next(is_ns, is)) {
    ++frames;
    differ += was.frame == is.frame ? 0 : 1;
    const double late_us = 1e-3 * static_cast<double>(is_ns - was_ns);
    first_us = frames == 2 ? late_us : first_us;
    if (frames > 1) {
      drift_us = late_us - first_us;
      most_us = std::max(most_us, std::abs(drift_us));
    }
  }
  const int lost = kLoggedFrames - frames;
  const double hours = static_cast<double>(logged_s) / 3600.0;
  text << fmt::format(
      "replay of {:.1f} h, {} frames: {} lost, {} differ; drift {:.1f} us at the end, {:.1f} us at "
      "most; goal < {:g} us an hour: {}; {:.0f} times real time\n",
      hours, kLoggedFrames, lost, differ, drift_us, most_us, kGoalDriftAnHour_us,
      lost == 0 && differ == 0 && most_us < kGoalDriftAnHour_us * hours ? "reached" : "MISSED",
      static_cast<double>(logged_s) / wall_s);
  return {{"hours", hours},
          {"frames", kLoggedFrames},
          {"lost", lost},
          {"differ", differ},
          {"drift_us", drift_us},
          {"max_us", most_us},
          {"goal_us_per_hour", kGoalDriftAnHour_us},
          {"wall_s", wall_s}};
}

/// Measures runs per minute of 2 s of simulated time, one by one and two at a time, each in a
/// process of its own.
nlohmann::json measure_many(std::ostream& text) {
  const Table table(text, {{"runs of 2 s", "<16"},
                           {"runs/min", ">10"},
                           {"ratio", ">8"},
                           {"MB each", ">10"},
                           {"CPU s each", ">12"}});
  table.head();
  nlohmann::json json;
  double alone = 0.0;
  for (const int at_once : {1, 2}) {
    const int runs = at_once == 2 ? runs_at_once() : std::max(2, runs_at_once() / kOneByOneOf);
    const hil::PrivateFolder folder("bench");
    double cpu_s = 0.0;
    double memory_mb = 0.0;
    const double wall_s = seconds_of([&] {
      for (int i = 0; i < runs; i += at_once) {
        std::vector<std::unique_ptr<IsolatedRun>> together;
        for (int k = 0; k < at_once && i + k < runs; ++k) {
          together.push_back(std::make_unique<IsolatedRun>(
              folder.path() / std::to_string(i + k),
              std::vector<std::string>{"--clock", "free", "--duration", "2s", "--set",
                                       "seed=" + std::to_string(i + k)}));
        }
        for (const auto& run : together) {
          const IsolatedRun::Ended ended = run->wait();
          require_done(ended);
          cpu_s += ended.cpu_s;
          memory_mb = std::max(memory_mb, ended.peak_rss_mb);
        }
        for (int k = 0; k < at_once; ++k) {
          std::filesystem::remove_all(folder.path() / std::to_string(i + k));
        }
      }
    });
    const double per_minute = 60.0 * runs / wall_s;
    alone = at_once == 1 ? per_minute : alone;
    json.push_back(table.row(
        {cell("at_once", at_once, at_once == 1 ? "one by one" : fmt::format("{} at once", at_once)),
         number("runs_per_minute", per_minute, "{:.1f}"),
         number("ratio", per_minute / alone, "{:.2f}"), number("peak_rss_mb", memory_mb, "{:.0f}"),
         number("cpu_s", cpu_s / runs, "{:.2f}"), stored("runs", runs)}));
  }
  return json;
}

}  // namespace

void set_bridge_runs(int runs) {
  runs_at_once() = runs;
}

nlohmann::json bench_bridge(std::ostream& text) {
  const std::array<double, 3> load = load_average();
  text << fmt::format("load average {:.2f} before\n", load[0]);
  nlohmann::json json;
  json["load_average_before"] = load;
  json["start"] = measure_start(text);
  json["round_trips"] = measure_steps(text);
  json["recording"] = measure_recording(text);
  json["motion"] = measure_motion(text);
  json["replay"] = measure_replay(text);
  json["many"] = measure_many(text);
  return json;
}

}  // namespace rigwire::bench
