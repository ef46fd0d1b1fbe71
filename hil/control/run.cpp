#include "hil/control/run.h"

#include <fmt/format.h>

#include <boost/asio/signal_set.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>

#include "drivers/endpoints.h"
#include "hil/record/report.h"
#include "hil/rig/rig.h"

namespace rigwire::hil {
namespace {

constexpr int kSignalExit = 128;

void complain(const std::string& what) {
  fmt::print(stderr, "rigwire: {}\n", what);
}

int exit_code(ExitCode code) {
  return static_cast<int>(code);
}

/// First signal: ends the run cleanly, also when it comes before the run has begun. Second: ends
/// the process at once.
class Interrupts {
 public:
  explicit Interrupts(boost::asio::io_context& io) : signals_(io, SIGINT, SIGTERM, SIGHUP) {
    signals_.async_wait([this](const boost::system::error_code& error, int number) {
      if (error) {
        return;
      }
      received_ = number;
      fmt::print(stderr, "\nrigwire: stopping, closing wires (again to stop at once)\n");
      for (const int next : {SIGINT, SIGTERM, SIGHUP}) {
        std::signal(next, SIG_DFL);
      }
      if (executive_ != nullptr) {
        executive_->stop();
      }
    });
  }
  /// What to stop. To be called before the io_context runs.
  void govern(Executive& executive) { executive_ = &executive; }
  [[nodiscard]] int received() const { return received_; }

 private:
  boost::asio::signal_set signals_;
  Executive* executive_ = nullptr;
  int received_ = 0;
};

RunOutcome execute(Rig& rig, const RigConfiguration& configuration, const RunOptions& options) {
  const SimTime end = options.duration ? kStart + *options.duration : kNever;
  if (options.clock.kind == ClockMode::Kind::free) {
    return rig.executive().run_free(end);
  }
  PacedSettings settings;
  settings.factor = options.clock.factor;
  settings.lead = configuration.lead;
  return rig.executive().run_paced(settings, end);
}

int run_rig(const RigConfiguration& configuration, const RunOptions& options) {
  boost::asio::io_context io;
  Interrupts interrupts(io);  // before the first wire is opened, so that none is left behind
  const auto chosen = [](const std::string& option, const std::string& configured) {
    return option.empty() ? configured : option;
  };
  Rig rig(configuration, io,
          {chosen(options.truth_path, configuration.truth.path),
           chosen(options.lidar_truth_path, configuration.truth.lidar_path)});
  interrupts.govern(rig.executive());

  RunOutcome outcome;
  {
    const auto start = std::chrono::steady_clock::now();
    std::shared_ptr<void> onlooker;
    if (options.onlooker) {
      onlooker = options.onlooker(
          {io, configuration, rig.wires(), rig.truth().state_quantities(), [&rig, start] {
             RigStatus status = rig.status();
             status.wall_s =
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
             return status;
           }});
    }
    outcome = execute(rig, configuration, options);
  }

  if (!options.report_path.empty()) {
    RunReport report;
    report.rig = configuration.name;
    report.seed = configuration.seed;
    report.config_hash = config_hash(configuration);
    report.clock = options.clock;
    report.outcome = outcome;
    report.cpu_s = process_cpu_seconds();
    report.peak_rss_mb = peak_resident_megabytes();
    report.truth = rig.truth().stages();
    report.wire = rig.executive().wire_stages();
    report.devices = rig.device_reports();
    write_report(report, options.report_path);
  }
  if (outcome.fault) {
    complain(
        fmt::format("the run ended at {:.3f} s: {}", to_seconds(outcome.reached), *outcome.fault));
    return exit_code(ExitCode::failure);
  }
  return interrupts.received() != 0 ? kSignalExit + interrupts.received()
                                    : exit_code(ExitCode::done);
}

}  // namespace

int run(const RigConfiguration& configuration, const RunOptions& options) {
  try {
    return run_rig(configuration, options);
  } catch (const drivers::EndpointError& error) {
    complain(error.what());
    return exit_code(ExitCode::environment);
  } catch (const std::invalid_argument& error) {
    complain(error.what());
    return exit_code(ExitCode::usage);
  } catch (const std::exception& error) {
    complain(error.what());
    return exit_code(ExitCode::failure);
  }
}

}  // namespace rigwire::hil
