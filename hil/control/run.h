// Runs one rig to its end: what `rigwire run` does after everything was read and checked.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil/control/control_server.h"
#include "hil/executive/clock.h"
#include "hil/executive/truth_source.h"
#include "hil/record/recorder.h"
#include "hil/record/report.h"
#include "hil/record/run_log.h"
#include "hil/rig/rig_configuration.h"
#include "hil/rig/rig_status.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

class Showing;

/// A run as an Onlooker sees it.
struct RunView {
  RunLog& log;
  boost::asio::io_context& io;  ///< The run's io_context; runs on the wire thread.
  const RigConfiguration& configuration;
  std::string config_hash;                ///< Hash of the configuration at the start.
  std::vector<std::string> wires;         ///< What carries each bus, one line each.
  std::vector<StateQuantity> quantities;  ///< What RigStatus::machine holds.
  std::function<RigStatus()> status;      ///< To be called on the wire thread.
  /// From any thread: the reader of standard output is gone, and the run ends as by SIGPIPE.
  std::function<void()> reader_gone;
  /// From any thread: something of it cannot be shown, and the run ends with exit code 1.
  std::function<void(const std::string& what)> failed;
};

/// An observer of a run, from when every wire is open to the end of the run.
class Onlooker {
 public:
  virtual ~Onlooker() = default;
  Onlooker(const Onlooker&) = delete;
  Onlooker& operator=(const Onlooker&) = delete;

  /// Called once, when the wires are closed and the report is written; RunView::status is invalid
  /// then.
  virtual void conclude(const RunReport& report) = 0;

 protected:
  Onlooker() = default;
};
using MakeOnlooker = std::function<std::unique_ptr<Onlooker>(const RunView& run)>;

struct RunOptions {
  ClockMode clock;
  OverrunPolicy overrun = OverrunPolicy::slip;  ///< With a clock that follows the wall's.
  Duration overrun_limit = std::chrono::milliseconds{100};
  /// With a clock that follows the wall's: processors do not sleep
  /// (hil/executive/awake_processors.h).
  bool awake = false;
  /// With the clock that waits for clients: maximum wall time of each wait.
  std::chrono::nanoseconds patience = std::chrono::seconds{1};
  std::optional<Duration> duration;  ///< Simulated time; without it until a signal.
  std::string report_path;           ///< Empty: no report; "-": standard output.
  std::string truth_path;            ///< Empty: as the rig says.
  std::string lidar_truth_path;      ///< Empty: as the rig says.
  RecordOptions record;
  std::string camera_truth_folder;  ///< Empty: as the rig says.
  LogLevel log_level = LogLevel::info;
  std::optional<ControlEndpoint> control;  ///< Where it is controlled from; empty: nowhere.
  /// Token for requests at a port; empty: one is generated and reported with the address.
  std::string control_token;
  /// A page that shows what happens (hil/control/dashboard.h), at the control's port; without one
  /// at a port of its own.
  bool dashboard = false;
  ControlEndpoint page;  ///< Where, when it is at no control's port.
  /// A line of JSON is written to it, and it is closed, when every wire is open: `control` and
  /// `token` of the control server, `dashboard` where there is one, and the wire of each device by
  /// its name.
  std::optional<int> ready_descriptor;
  /// New or empty: the run has private wires (hil/rig/isolated_rig.h), and reports them in run.json
  /// there when it is ready. Empty text: the rig's wires.
  std::string isolated_folder;
  MakeOnlooker onlooker;  ///< May be empty.
  /// The replayed recording, whose configuration() this run has; null: this is no replay. Needs the
  /// page and a clock that follows the wall's, and excludes a duration, files and folders.
  Showing* shown = nullptr;
  /// Origins of the configuration, for messages that refuse the start; may be null.
  const Origins* origins = nullptr;
};

/// Exit codes of every verb (docs/command-line.md). 128 + n after signal n.
enum class ExitCode : int { done = 0, failure = 1, usage = 2, environment = 3, different = 5 };

/// Opens the wires, runs, closes them, writes the report. Returns the exit code; writes to standard
/// error what it logs, and always why it could not run or was ended. A reader that stalls cannot
/// hold it up (hil/record/output_file.h): a signal always ends it.
[[nodiscard]] int run(const RigConfiguration& configuration, const RunOptions& options);

}  // namespace rigwire::hil
