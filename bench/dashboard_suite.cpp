// What viewers cost a run: the same rig without a dashboard, with one without viewers, with a
// viewer of the topics that the page subscribes to when it is opened, and with a viewer of all
// topics. Processors are kept awake, as waking them causes most of the lateness otherwise.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "bench/host.h"
#include "bench/isolated_run.h"
#include "bench/stream_viewer.h"
#include "bench/suites.h"
#include "bench/table.h"
#include "hil/executive/awake_processors.h"
#include "hil/files/private_folder.h"

namespace rigwire::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct LookedAt {
  const char* rig;
  const char* clock;
};
/// One rig with a lidar of 694 444 shots a second, one with six lidars of five million in all: two
/// processors keep up with these at half of real time.
constexpr std::array<LookedAt, 2> kRigs{{{"excavator_pit", "real"}, {"lidar_park", "scaled:0.5"}}};
constexpr int kRounds = 3;
constexpr std::chrono::seconds kWindow{8};
/// Pause before a window, so that start-up is not in it.
constexpr std::chrono::seconds kSettle{2};
constexpr std::chrono::seconds kPatience{120};
/// Wall time between two readings of a run's memory, and their number.
constexpr std::chrono::seconds kLook{15};
constexpr int kLooks = 4;
constexpr double kGoalCore = 0.1;
constexpr double kGoalPicture_s = 3.0;
/// Growth from the second reading, when queues have their full length, to the last; 1e6 bytes.
constexpr double kGoalGrowth_mb = 8.0;

/// What the page subscribes to when it is opened (hil/dashboard/).
bool of_page(std::string_view topic) {
  constexpr std::array<std::string_view, 6> kTopics{"/scene",   "/tf",     "/truth",
                                                    "/antenna", "/status", "/sensors"};
  constexpr std::array<std::string_view, 4> kOfDevices{"/points/", "/fix/", "/satellites/",
                                                       "/camera/"};
  return std::ranges::count(kTopics, topic) != 0 ||
         std::ranges::any_of(kOfDevices, [&](auto prefix) { return topic.starts_with(prefix); });
}

struct Way {
  const char* name;
  bool dashboard;
  std::function<bool(std::string_view)> wants;  ///< Empty: no viewer.

  // Minimum of the rounds, as other processes only add to them.
  double core = std::numeric_limits<double>::infinity();  ///< CPU time per simulated second.
  double p50_us = std::numeric_limits<double>::infinity();
  double p99_us = std::numeric_limits<double>::infinity();
  double p99_most_us = 0.0;  ///< Maximum of the rounds: shows the scatter.
  double picture_s = std::numeric_limits<double>::infinity();
  // Values of the last round.
  double pace = 0.0;  ///< Simulated time per wall time.
  double mb_per_s = 0.0;
  std::uint64_t dropped = 0;
  std::uint64_t not_shown = 0;
};

/// A run with its viewer, from the first picture on.
class Looked {
 public:
  Looked(const char* rig, const Way& way, const std::vector<std::string>& more)
      : run_(folder_.path() / "run", arguments(way, more), rig) {
    run_.wait_until_ready();
    control_.emplace(run_.control());
    if (way.wants) {
      viewer_.emplace(run_.told()["dashboard"].get<std::string>(), way.wants);
      for (const auto end = Clock::now() + kPatience; figures().first_picture_s < 0.0;) {
        if (Clock::now() > end) {
          throw std::runtime_error(
              fmt::format("{}: no picture within {} s", rig, kPatience.count()));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
      }
    }
    std::this_thread::sleep_for(kSettle);
  }

  [[nodiscard]] StreamViewer::Figures figures() const {
    return viewer_ ? viewer_->figures() : StreamViewer::Figures{};
  }
  [[nodiscard]] IsolatedRun::Usage usage() const { return run_.usage(); }
  double simulated_s() {
    return 1e-9 *
           nlohmann::json::parse(control_->ask(R"({"verb":"state"})"))["time_ns"].get<double>();
  }
  /// Its report.
  nlohmann::json end() {
    control_->ask(R"({"verb":"stop"})");
    if (const auto ended = run_.wait(); ended.exit_code != 0) {
      throw std::runtime_error(fmt::format("a run ended with exit code {}", ended.exit_code));
    }
    return run_.report();
  }

 private:
  static std::vector<std::string> arguments(const Way& way, const std::vector<std::string>& more) {
    std::vector<std::string> all = more;
    if (way.dashboard) {
      all.emplace_back("--dashboard");
    }
    return all;
  }

  hil::PrivateFolder folder_{"bench"};
  IsolatedRun run_;
  std::optional<ControlConnection> control_;
  std::optional<StreamViewer> viewer_;
};

/// The maximum over the devices.
double lateness_us(const nlohmann::json& report, const char* quantile) {
  double greatest = 0.0;
  for (const nlohmann::json& device : report["devices"]) {
    greatest = std::max(greatest, device["lateness_us"][quantile].get<double>());
  }
  return greatest;
}

void measure(const LookedAt& looked_at, Way& way) {
  Looked run(looked_at.rig, way, {"--clock", looked_at.clock});
  const double begin_s = run.simulated_s();
  const IsolatedRun::Usage before = run.usage();
  const StreamViewer::Figures heard = run.figures();
  const auto begin = Clock::now();
  std::this_thread::sleep_for(kWindow);
  const double simulated_s = run.simulated_s() - begin_s;
  const double wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  const StreamViewer::Figures after = run.figures();
  way.core = std::min(way.core, (run.usage().cpu_s - before.cpu_s) / simulated_s);
  way.pace = simulated_s / wall_s;
  way.mb_per_s = 1e-6 * static_cast<double>(after.bytes - heard.bytes) / wall_s;
  way.dropped = after.dropped;
  way.not_shown = after.not_shown;
  if (way.wants) {
    way.picture_s = std::min(way.picture_s, after.first_picture_s);
  }
  const nlohmann::json report = run.end();
  way.p50_us = std::min(way.p50_us, lateness_us(report, "p50"));
  const double p99_us = lateness_us(report, "p99");
  way.p99_us = std::min(way.p99_us, p99_us);
  way.p99_most_us = std::max(way.p99_most_us, p99_us);
}

nlohmann::json measure_memory(std::ostream& text, const char* rig, const Way& way) {
  Looked run(rig, way, {"--clock", "scaled:2"});
  nlohmann::json looks = nlohmann::json::array();
  std::vector<double> resident_mb;
  std::vector<std::string> words;
  for (int i = 0; i <= kLooks; ++i) {
    const double at_s = run.simulated_s();
    resident_mb.push_back(run.usage().resident_mb);
    words.push_back(fmt::format("{:.1f} at {:.0f} s", resident_mb.back(), at_s));
    looks.push_back({{"simulated_s", at_s}, {"resident_mb", resident_mb.back()}});
    if (i < kLooks) {
      std::this_thread::sleep_for(kLook);
    }
  }
  run.end();
  const double growth_mb = resident_mb.back() - resident_mb[1];
  text << fmt::format(
      "{}, the server's memory with {}, MB: {}; goal: grows by < {:g} from the second on: {}\n",
      rig, way.name, fmt::join(words, ", "), kGoalGrowth_mb,
      growth_mb < kGoalGrowth_mb ? "reached" : "MISSED");
  return {{"looks", std::move(looks)}, {"growth_mb", growth_mb}, {"goal_mb", kGoalGrowth_mb}};
}

nlohmann::json measure_rig(std::ostream& text, const LookedAt& looked_at) {
  std::array<Way, 4> ways{{{"no dashboard", false, {}},
                           {"nobody looks", true, {}},
                           {"the page", true, of_page},
                           {"every channel", true, [](std::string_view) { return true; }}}};
  for (int round = 0; round < kRounds; ++round) {
    for (Way& way : ways) {
      measure(looked_at, way);
    }
  }
  const Table table(text, {{looked_at.rig, "<16"},
                           {"of a core", ">10"},
                           {"more", ">8"},
                           {"pace", ">8"},
                           {"p50 us", ">10"},
                           {"p99 us", ">10"},
                           {"to", ">8"},
                           {"picture s", ">10"},
                           {"MB/s", ">8"},
                           {"dropped", ">8"},
                           {"not shown", ">10"}});
  table.head();
  nlohmann::json json;
  for (const Way& way : ways) {
    json["ways"].push_back(table.row(
        {word("way", way.name), number("core", way.core, "{:.3f}"),
         number("more_core", way.core - ways.front().core, "{:.3f}"),
         number("pace", way.pace, "{:.3f}"), number("lateness_p50_us", way.p50_us, "{:.0f}"),
         number("lateness_p99_us", way.p99_us, "{:.0f}"),
         number("lateness_p99_most_us", way.p99_most_us, "{:.0f}"),
         way.wants ? number("first_picture_s", way.picture_s, "{:.2f}")
                   : cell("first_picture_s", nullptr, "-"),
         number("mb_per_s", way.mb_per_s, "{:.2f}"), count("dropped", way.dropped),
         count("not_shown", way.not_shown)}));
  }
  const Way& page = ways[2];
  const double more = page.core - ways.front().core;
  text << fmt::format(
      "the page: {:.3f} of a core; goal < {:g}: {}; first picture {:.2f} s; goal < {:g} s: {}\n",
      more, kGoalCore, more < kGoalCore ? "reached" : "MISSED", page.picture_s, kGoalPicture_s,
      page.picture_s < kGoalPicture_s ? "reached" : "MISSED");
  json["goal_core"] = kGoalCore;
  json["goal_picture_s"] = kGoalPicture_s;
  json["memory"] = measure_memory(text, looked_at.rig, page);
  return json;
}

}  // namespace

nlohmann::json bench_dashboard(std::ostream& text) {
  const hil::AwakeProcessors awake;
  nlohmann::json json;
  for (const LookedAt& looked_at : kRigs) {
    const std::array<double, 3> load = load_average();
    text << fmt::format("load average {:.2f} before\n", load[0]);
    json[looked_at.rig] = measure_rig(text, looked_at);
    json[looked_at.rig]["load_average_before"] = load;
    text << std::flush;
  }
  return json;
}

}  // namespace rigwire::bench
