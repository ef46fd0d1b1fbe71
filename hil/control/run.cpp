#include "hil/control/run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/signal_set.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "drivers/endpoints.h"
#include "drivers/loopback_claims.h"
#include "fields/check.h"
#include "fields/failure_text.h"
#include "hil/configuration/build_facts.h"
#include "hil/control/dashboard.h"
#include "hil/control/desk.h"
#include "hil/control/overrun_lines.h"
#include "hil/control/ready.h"
#include "hil/control/showing.h"
#include "hil/executive/awake_processors.h"
#include "hil/executive/background_thread.h"
#include "hil/files/new_folder.h"
#include "hil/record/output_file.h"
#include "hil/record/run_events.h"
#include "hil/record/run_log.h"
#include "hil/rig/isolated_rig.h"
#include "hil/rig/rig.h"
#include "hil/wires/client_drain.h"

namespace rigwire::hil {
namespace {

constexpr int kSignalExit = 128;

int exit_code(ExitCode code) {
  return static_cast<int>(code);
}

/// Makes a write report a reader that has closed; SIGPIPE would end the process and leave links
/// behind.
class WithoutSigpipe {
 public:
  WithoutSigpipe() : before_(std::signal(SIGPIPE, SIG_IGN)) {}
  ~WithoutSigpipe() { std::signal(SIGPIPE, before_); }
  WithoutSigpipe(const WithoutSigpipe&) = delete;
  WithoutSigpipe& operator=(const WithoutSigpipe&) = delete;

 private:
  void (*before_)(int);
};

/// First signal: ends the run cleanly, also when it comes before the run has begun. Second: ends
/// the process at once.
class Interrupts {
 public:
  Interrupts(boost::asio::io_context& io, RunLog& log) : signals_(io, SIGINT, SIGTERM, SIGHUP) {
    signals_.async_wait([this, &log](const boost::system::error_code& error, int number) {
      if (error) {
        return;
      }
      log.info("stopping, closing wires (again to stop at once)");
      for (const int next : {SIGINT, SIGTERM, SIGHUP}) {
        std::signal(next, SIG_DFL);
      }
      end_by(number);
    });
  }
  /// What to stop, null once it is gone. First to be called before the io_context runs.
  void govern(Executive* executive) {
    const std::scoped_lock lock(mutex_);
    executive_ = executive;
  }
  /// From any thread: ends the run as that signal would; the first one counts.
  void end_by(int number) {
    const std::scoped_lock lock(mutex_);
    received_ = received_ == 0 ? number : received_;
    if (executive_ != nullptr) {
      executive_->stop();
    }
  }
  [[nodiscard]] int received() const {
    const std::scoped_lock lock(mutex_);
    return received_;
  }

 private:
  boost::asio::signal_set signals_;
  mutable std::mutex mutex_;
  Executive* executive_ = nullptr;
  int received_ = 0;
};

RunOutcome execute(Rig& rig, const RigConfiguration& configuration, const RunOptions& options,
                   RunLog& log, RunEvents& events) {
  if (options.shown != nullptr) {
    // Viewers receive each slice in the time that it lasts.
    const auto shown = [&] {
      return options.shown->pace().lets_go(rig.executive().now(), std::chrono::steady_clock::now());
    };
    return rig.executive().run_free(kNever, {shown, std::chrono::nanoseconds::max(), [] {}});
  }
  const SimTime end = options.duration ? kStart + *options.duration : kNever;
  if (options.clock.kind == ClockMode::Kind::drained) {
    ClientDrain drain;
    rig.watch_clients(drain);
    return rig.executive().run_free(end, {[&drain] { return drain.taken(); }, options.patience,
                                          [&] {
                                            const std::string text =
                                                fmt::format("not taken within the patience: {}",
                                                            fmt::join(drain.give_up(), ", "));
                                            events.tell(rig.executive().now(), EventKind::impatient,
                                                        LogLevel::warning, "", text);
                                            log.apart(LogLevel::warning, text);
                                          }});
  }
  if (!options.clock.paced()) {
    return rig.executive().run_free(end);
  }
  PacedSettings settings;
  settings.factor = options.clock.factor;
  settings.lead = configuration.lead;
  settings.overrun = options.overrun;
  settings.overrun_limit = options.overrun_limit;
  OverrunLines lines(options.overrun, [&](SimTime at, const std::string& text) {
    events.tell(at, EventKind::slipped, LogLevel::warning, "", text);
    if (options.overrun != OverrunPolicy::stop) {
      log.apart(LogLevel::warning, text);
    }
  });
  settings.on_overrun = [&](const Overrun& overrun) {
    lines.take(overrun, std::chrono::steady_clock::now());
  };
  RunOutcome outcome = rig.executive().run_paced(settings, end);
  lines.flush();
  return outcome;
}

/// For the log. A log that other users can read keeps it to itself.
std::string shown_token(const std::string& token) {
  return others_can_read(STDERR_FILENO)
             ? "token not shown, since other users can read this log; give one by "
               "RIGWIRE_CONTROL_TOKEN, or make the log private (umask 077)"
             : "token " + token;
}

/// But for the stages of the truth, which may be at work.
RunReport report_of(Rig& rig, const RigConfiguration& configuration, const std::string& hash,
                    const RunOptions& options, const RunOutcome& outcome,
                    const AwakeProcessors* awake) {
  RunReport report;
  report.rig = configuration.name;
  report.seed = configuration.seed;
  report.config_hash = hash;
  report.clock = options.clock;
  report.overrun = options.overrun;
  report.outcome = outcome;
  report.cpu_s = process_cpu_seconds() - (awake != nullptr ? awake->cpu_seconds() : 0.0);
  report.peak_rss_mb = peak_resident_megabytes();
  report.wire = rig.executive().wire_stages();
  report.devices = rig.device_reports();
  report.faults = rig.faults().windows();
  std::erase_if(report.faults,
                [&](const FaultWindow& fault) { return fault.begin >= outcome.reached; });
  return report;
}

TruthFiles truth_files(const RigConfiguration& configuration, const RunOptions& options,
                       OutputFailures& failures) {
  const auto chosen = [](const std::string& option, const std::string& configured) {
    return option.empty() ? configured : option;
  };
  TruthFiles files;
  files.machine = chosen(options.truth_path, configuration.truth.path);
  files.lidar = chosen(options.lidar_truth_path, configuration.truth.lidar_path);
  files.cameras = chosen(options.camera_truth_folder, configuration.truth.camera_folder);
  files.failures = &failures;
  // Simulated time can wait for a reader only where it does not follow the wall's.
  files.patience = !options.clock.paced() ? kReaderPatience : std::chrono::milliseconds{0};
  return files;
}

/// Null where nothing is recorded and no client can ask for it.
std::unique_ptr<Recorder> make_recorder(const RigConfiguration& configuration,
                                        const RunOptions& options, const std::string& hash,
                                        OutputFailures& failures, RunEvents& events) {
  if (options.record.folder.empty() && !options.control && !options.dashboard) {
    return nullptr;
  }
  if (!options.record.folder.empty()) {
    make_new_folder("--record", options.record.folder);  // before a wire is opened
  }
  RecordedRun run;
  run.version = version();
  run.rig = configuration.name;
  run.seed = configuration.seed;
  run.config_hash = hash;
  run.clock = to_string(options.clock);
  run.start_utc = format_utc(configuration.start);
  run.start_unix_ns = unix_time(configuration.start).count();
  run.configuration = print_rig(configuration);
  run.clouds = recorded_clouds(configuration);
  return std::make_unique<Recorder>(
      std::move(run), options.clock.paced() ? std::chrono::milliseconds{0} : kReaderPatience,
      failures, events);
}

/// A run with wires of its own: where it has them, and what it has in place of the rig's.
struct Isolated {
  explicit Isolated(const RigConfiguration& configuration, const RunOptions& options)
      : folder(std::filesystem::absolute(options.isolated_folder)) {
    make_new_folder("--isolated", folder);
    replacements = isolating(
        configuration, options.origins != nullptr ? *options.origins : Origins{}, folder, claims);
    wired = with(configuration, replacements);
  }

  std::filesystem::path folder;
  drivers::LoopbackClaims claims;
  std::vector<Replacement> replacements;
  RigConfiguration wired;
};

/// Every wire is open.
void tell_ready(const RunOptions& options, const Rig& rig, const std::string& hash,
                const Isolated* isolated, const ControlServer* control, const ControlServer* page,
                const std::string& token) {
  nlohmann::ordered_json line{{"ready", true}, {"pid", ::getpid()}};
  if (control != nullptr) {
    line["control"] = control->address();
    line["token"] = options.control->path.empty() ? nlohmann::ordered_json(token) : nullptr;
  }
  if (page != nullptr) {
    line["dashboard"] = page->page_address();
  }
  for (const DeviceStatus& device : rig.status().devices) {
    line["devices"][device.name] = device.wire;
  }
  if (isolated != nullptr) {
    line["folder"] = isolated->folder.string();
    line["config_hash"] = hash;
    for (const Replacement& replacement : isolated->replacements) {
      line["replaced"][replacement.key] = replacement.value;
    }
  }
  const std::string text = line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (isolated != nullptr) {
    // It has the token.
    WholeFile("run.json", isolated->folder / "run.json", FileReaders::owner).write(text + "\n");
  }
  notify_service_manager();
  if (options.ready_descriptor) {
    hil::tell_ready(*options.ready_descriptor, text);
  }
}

int run_rig(const RigConfiguration& configuration, const RunOptions& options) {
  if (options.ready_descriptor && !can_be_written(*options.ready_descriptor)) {
    throw std::invalid_argument(fmt::format("--ready-fd: descriptor {} is not open for writing",
                                            *options.ready_descriptor));
  }
  const WithoutSigpipe without_sigpipe;
  RunLog log(options.log_level);
  OutputFailures failures([&log](const std::string& what) { log.error(what); });
  boost::asio::io_context io;
  boost::asio::io_context viewers_io;
  boost::asio::io_context control_io;  // of a control that is not at the page's port
  Interrupts interrupts(io, log);  // before the first wire is opened, so that none is left behind
  std::optional<AwakeProcessors> awake;
  if (options.awake) {
    try {
      awake.emplace();
    } catch (const std::runtime_error& refusal) {
      throw drivers::EndpointError(fmt::format("--awake: {}", refusal.what()));
    }
  }
  const AwakeProcessors* const kept_awake = awake ? &*awake : nullptr;
  std::optional<Isolated> isolated;
  if (!options.isolated_folder.empty()) {
    isolated.emplace(configuration, options);
  }
  const RigConfiguration& wired = isolated ? isolated->wired : configuration;
  std::optional<WholeFile> report_file;
  if (!options.report_path.empty()) {
    report_file.emplace("the report", options.report_path);
  }
  // Computed before a device can save settings into its file.
  const bool is_told = report_file || options.onlooker || options.control || options.dashboard ||
                       isolated || !options.record.folder.empty();
  Showing* const shown = options.shown;
  const std::string hash = shown != nullptr ? shown->rerun().contents().run.config_hash
                           : is_told        ? config_hash(configuration)
                                            : std::string();
  RunEvents events;
  const std::unique_ptr<Recorder> recorder =
      make_recorder(configuration, options, hash, failures, events);
  std::optional<RunStream> stream;
  if (options.dashboard) {
    stream.emplace(viewers_io, streamed_run(wired, fresh_token()));
    recorder->pass_on([&stream](const std::string& wire, WireKind kind) -> WireTap& {
      return stream->add_wire(wire, kind);
    });
  }
  if (shown != nullptr) {
    shown->rerun().join(*recorder);
  }
  auto rig = std::make_unique<Rig>(
      wired, io, shown != nullptr ? TruthFiles{} : truth_files(wired, options, failures), &log,
      shown != nullptr ? shown->rerun().own_ends() : OwnEnds{}, recorder.get());
  if (shown != nullptr) {
    shown->rerun().add_clients(*rig);
  }
  log.inform([&events, &rig](LogLevel level, std::string_view text) {
    events.tell(rig->executive().reached(), EventKind::notice, level, "", std::string(text));
  });
  if (!options.record.folder.empty()) {
    recorder->begin(options.record);
  }
  for (const std::string& wire : rig->wires()) {
    log.debug(wire);
  }
  interrupts.govern(&rig->executive());

  std::unique_ptr<Onlooker> onlooker;
  const auto status = [&rig, begun = std::chrono::steady_clock::now()] {
    RigStatus now = rig->status();
    now.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    return now;
  };
  if (options.onlooker) {
    onlooker =
        options.onlooker({log, io, wired, hash, rig->wires(), rig->truth().state_quantities(),
                          status, [&interrupts] { interrupts.end_by(SIGPIPE); },
                          [&failures](const std::string& what) { failures.report(what); }});
  }
  std::optional<Dashboard> dashboard;
  if (stream) {
    dashboard.emplace(io, *stream, *rig, wired,
                      shown != nullptr ? std::optional(shown->end() - kStart) : options.duration);
    events.inform_stream([&stream](const RunEvent& event) { stream->tell(event); });
  }
  std::optional<Desk> desk;
  std::optional<ControlServer> server;
  std::optional<ControlServer> page_server;  // where the control is at no port
  const ControlServer* page = nullptr;
  const std::string token = options.control_token.empty() ? fresh_token() : options.control_token;
  if (options.control || dashboard) {
    desk.emplace(
        io, rig->executive(),
        GovernedRun{configuration.name, configuration.seed, hash, options.clock,
                    rig->truth().state_quantities(), status, rig->faults(),
                    [&rig, &configuration, &hash, &options, kept_awake] {
                      return to_prometheus(report_of(*rig, configuration, hash, options,
                                                     rig->executive().outcome(), kept_awake));
                    },
                    &events, shown != nullptr ? nullptr : recorder.get(), &rig->hand(),
                    &rig->settings(), shown,
                    isolated ? isolated->folder : std::filesystem::current_path()});
  }
  if (shown != nullptr) {
    shown->rerun().govern(*desk, [&log](const std::string& what) { log.warning(what); });
    shown->steer(*desk, rig->executive(), io,
                 [&stream] { return stream->viewers().anything_wanted(); });
  }
  if (dashboard) {
    dashboard->serve(*desk);
  }
  if (options.control) {
    const bool has_page = dashboard && options.control->path.empty();
    server.emplace(has_page ? viewers_io : control_io, *options.control, token, *desk,
                   has_page ? &*dashboard : nullptr);
    log.info(options.control->path.empty()
                 ? fmt::format("control at {}, {}", server->address(), shown_token(token))
                 : "control at " + server->address());
  }
  if (dashboard) {
    const bool own = !options.control || !options.control->path.empty();
    page =
        own ? &page_server.emplace(viewers_io, options.page, token, *desk, &*dashboard) : &*server;
    if (shown != nullptr) {
      shown->served_at(page->address());
    }
    log.info(others_can_read(STDERR_FILENO)
                 ? fmt::format("dashboard at {}, {}", page->address(), shown_token(token))
                 : "dashboard at " + page->page_address());
  }
  std::optional<BackgroundThread> viewers_thread;
  if (dashboard) {
    viewers_thread.emplace(viewers_io, [&failures](const std::string& what) {
      failures.report("the dashboard: " + what);
    });
  }
  // What clients of the control send is parsed beside the wires.
  std::optional<BackgroundThread> control_thread;
  if (server) {
    control_thread.emplace(control_io, [&failures](const std::string& what) {
      failures.report("the control server: " + what);
    });
  }
  tell_ready(options, *rig, hash, isolated ? &*isolated : nullptr, server ? &*server : nullptr,
             page, token);
  const RunOutcome outcome = execute(*rig, configuration, options, log, events);
  control_thread.reset();  // no further requests while the last answers are given
  if (desk) {
    desk->end();
    io.restart();
    io.poll();
  }
  if (stream) {
    stream->flush();
    viewers_thread.reset();
  }
  // The last answers leave, and what is asked meanwhile is answered.
  for (int round = 0; round < 2 && desk; ++round) {
    for (boost::asio::io_context* const one : {&control_io, &viewers_io, &io}) {
      one->restart();
      one->poll();
    }
  }
  RunReport report = report_of(*rig, configuration, hash, options, outcome, kept_awake);
  awake.reset();
  report.truth = rig->truth().stages();
  interrupts.govern(nullptr);
  log.inform({});
  events.inform_stream({});
  page_server.reset();  // no viewer may use a rig that is gone
  server.reset();
  dashboard.reset();
  if (recorder) {
    recorder->finish(outcome.reached);
  }
  rig.reset();  // wires and truth are closed before any reader is waited for

  if (report_file) {
    try {
      report_file->write(to_json(report));
    } catch (const std::runtime_error& error) {
      failures.report(error.what());
    }
  }
  if (onlooker) {
    onlooker->conclude(report);
  }
  if (outcome.fault) {
    complain(
        fmt::format("the run ended at {:.3f} s: {}", to_seconds(outcome.reached), *outcome.fault),
        kReaderPatience);
    return exit_code(ExitCode::failure);
  }
  if (failures.any()) {
    return exit_code(ExitCode::failure);
  }
  return interrupts.received() != 0 ? kSignalExit + interrupts.received()
                                    : exit_code(ExitCode::done);
}

}  // namespace

int run(const RigConfiguration& configuration, const RunOptions& options) {
  const auto refuse = [](const std::exception& error, ExitCode code) {
    complain(error.what(), kReaderPatience);
    return exit_code(code);
  };
  try {
    return run_rig(configuration, options);
  } catch (const drivers::EndpointError& error) {
    return refuse(error, ExitCode::environment);
  } catch (const boost::system::system_error& error) {  // Asio: no descriptor left for its own
    return refuse(error, ExitCode::environment);
  } catch (const fields::Refused& refused) {
    complain(options.origins != nullptr ? placed(refused, *options.origins).line()
                                        : std::string(refused.what()),
             kReaderPatience);
    return exit_code(ExitCode::usage);
  } catch (const std::invalid_argument& error) {
    return refuse(error, ExitCode::usage);
  } catch (const std::exception& error) {
    complain(fields::failure_text(error, "the run of " + configuration.name), kReaderPatience);
    return exit_code(ExitCode::failure);
  }
}

}  // namespace rigwire::hil
