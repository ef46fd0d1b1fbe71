#include "hil/control/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/signal_set.hpp>
#include <csignal>

#include "drivers/endpoints.h"
#include "hil/control/desk.h"
#include "hil/control/rerun.h"
#include "hil/record/recorder.h"
#include "hil/rig/rig.h"

namespace rigwire::hil {

namespace fs = std::filesystem;

bool Verification::equal() const {
  return std::ranges::none_of(streams,
                              [](const auto& stream) { return stream.difference.has_value(); });
}

Verification verify_recording(const fs::path& folder, RunLog* log) {
  Rerun rerun(folder);
  Verification result;
  result.remarks = rerun.remarks();
  result.client_acts = rerun.client_acts();
  result.end = rerun.last_instant();
  const RecordingContents& contents = rerun.contents();
  if (!contents.end) {
    result.remarks.push_back(
        fmt::format("the recorded run was killed; compared to {:.9f} s", to_seconds(result.end)));
  }

  RecordedRun run = contents.run;
  run.configuration = print_rig(rerun.configuration());
  run.clouds = recorded_clouds(rerun.configuration());
  std::string trouble;
  OutputFailures failures([&](const std::string& what) { trouble = what; });
  boost::asio::io_context io;
  const fs::path again = rerun.folder() / "again";
  bool interrupted = false;
  {
    // With simulated time that waits for the disk as long as that takes.
    RunEvents events;
    Recorder recorder(std::move(run), std::chrono::minutes{10}, failures, events);
    rerun.join(recorder);
    Rig rig(rerun.configuration(), io, {}, log, rerun.own_ends(), &recorder);
    rerun.add_clients(rig);
    Desk desk(io, rig.executive(),
              {rerun.recorded().name,
               rerun.recorded().seed,
               contents.run.config_hash,
               {ClockMode::Kind::free, 1.0},
               rig.truth().state_quantities(),
               [&rig] { return rig.status(); },
               rig.faults(),
               [] { return std::string(); },
               nullptr,
               nullptr,
               &rig.hand(),
               &rig.settings()});
    rerun.govern(desk, [&](const std::string& what) { result.remarks.push_back(what); });
    recorder.begin({again.string(), {}}, contents.run.begin, contents.run.truth_begin);
    boost::asio::signal_set signals(io, SIGINT, SIGTERM);
    signals.async_wait([&](const boost::system::error_code& error, int) {
      if (!error) {
        interrupted = true;
        rig.executive().stop();
      }
    });
    const RunOutcome outcome = rig.executive().run_free(rerun.end());
    if (outcome.fault) {
      result.remarks.push_back(fmt::format("the run ended at {:.3f} s: {}",
                                           to_seconds(outcome.reached), *outcome.fault));
    }
    desk.end();
    recorder.finish(outcome.reached);
  }
  if (interrupted) {
    throw drivers::EndpointError("replay: interrupted before the end was reached");
  }
  if (!trouble.empty()) {
    throw drivers::EndpointError(trouble);
  }
  result.streams = compare_recordings(folder, again, result.end, [&](const std::string& bus) {
    return bus_messages(rerun.recorded(), bus);
  });
  return result;
}

}  // namespace rigwire::hil
