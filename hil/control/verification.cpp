#include "hil/control/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <map>
#include <stdexcept>

#include "drivers/endpoints.h"
#include "drivers/loopback_claims.h"
#include "hil/control/desk.h"
#include "hil/files/private_folder.h"
#include "hil/record/recorded_clients.h"
#include "hil/record/recorder.h"
#include "hil/rig/private_wires.h"
#include "hil/rig/rig.h"
#include "hil/wires/outlets.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;

/// A bus's way outside that leads nowhere: its client is a recorded one.
class NoCanEnd final : public drivers::CanBus {
 public:
  void start(Receiver /*receiver*/) override {}
  bool send(const protocols::can::Frame& /*frame*/) override { return true; }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {"in this program"}; }
};

/// Up to where there is something: of a run that was killed, and for what a stop cut short.
SimTime last_instant(const fs::path& folder, const RecordingContents& contents) {
  SimTime last = kStart;
  each_packet(folder, [&](std::size_t, SimTime at, const auto&) { last = std::max(last, at); });
  each_message(folder,
               [&](TruthTrack, SimTime at, std::string_view) { last = std::max(last, at); });
  return contents.end ? std::min(*contents.end, last) : last;
}

void tell_origin(const RecordedRun& run, const std::string& hash,
                 std::vector<std::string>& remarks) {
  if (run.version != RIGWIRE_VERSION) {
    remarks.push_back(
        fmt::format("recorded by rigwire {}, this is {}", run.version, RIGWIRE_VERSION));
  }
  if (run.config_hash != hash) {
    remarks.push_back(fmt::format(
        "the configuration is not the recorded one, or a file that it names has changed: found "
        "{}, recorded {}",
        hash, run.config_hash));
  }
  if (run.clock != "free" && run.clock != "step") {
    remarks.push_back(fmt::format(
        "recorded with the clock {}: what a client commanded may act up to the rig's lead later "
        "or earlier",
        run.clock));
  }
}

}  // namespace

bool Verification::equal() const {
  return std::ranges::none_of(streams,
                              [](const auto& stream) { return stream.difference.has_value(); });
}

Verification verify_recording(const fs::path& folder, RunLog* log) {
  Verification result;
  const RecordingContents contents = read_recording_description(folder);
  const RigConfiguration recorded = load_rig((folder / "rig.yaml").string(), {}).configuration;
  tell_origin(contents.run, config_hash(recorded), result.remarks);
  RecordedClients clients(folder);
  std::ranges::copy(clients.remarks(), std::back_inserter(result.remarks));
  result.client_acts = clients.size();
  result.end = last_instant(folder, contents);
  if (contents.run.clients_before) {
    result.remarks.push_back(fmt::format(
        "recorded from {:.9f} s on: what clients did before is not known and not done again",
        to_seconds(contents.run.begin)));
  }
  if (!contents.end) {
    result.remarks.push_back(
        fmt::format("the recorded run was killed; compared to {:.9f} s", to_seconds(result.end)));
  }

  const PrivateFolder own("replay");
  drivers::LoopbackClaims claims;
  const RigConfiguration rig_configuration =
      made_private(recorded, own.path(), claims, result.remarks);
  std::map<std::string, NoCanEnd> ends;
  OwnEnds own_ends;
  for (const RecordingContents::Wire& wire : contents.wires) {
    if (rig_configuration.buses.contains(wire.about.name)) {
      own_ends.buses[wire.about.name] = &ends[wire.about.name];
      // SocketCAN's client is always there; of every other hop the recording tells.
      if (wire.about.address.starts_with("slcan ") || wire.about.address.starts_with("gs_usb ")) {
        own_ends.with_known_clients.insert(wire.about.name);
      }
    }
  }
  RecordedRun run = contents.run;
  run.configuration = print_rig(rig_configuration);
  run.clouds = recorded_clouds(rig_configuration);
  std::string trouble;
  OutputFailures failures([&](const std::string& what) { trouble = what; });
  boost::asio::io_context io;
  const fs::path again = own.path() / "again";
  bool interrupted = false;
  {
    // With simulated time that waits for the disk as long as that takes.
    RunEvents events;
    Recorder recorder(std::move(run), std::chrono::minutes{10}, failures, events);
    recorder.on_outlet([&](const std::string& wire, QueuedOutlet& outlet) {
      outlet.cut_off();
      clients.join(wire, outlet);
    });
    Rig rig(rig_configuration, io, {}, log, own_ends, &recorder);
    rig.executive().add(clients);
    // What governed the run does so again.
    Desk desk(io, rig.executive(),
              {recorded.name,
               recorded.seed,
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
    for (const RecordedAct& command : recorded_commands(folder)) {
      desk.carry_out_at(command.at, command.text, "commands.log", [&, command](const Reply& reply) {
        if (reply.outcome != Reply::Outcome::done && reply.outcome != Reply::Outcome::ended) {
          result.remarks.push_back(fmt::format("{:.9f} s: not done again: {}: {}",
                                               to_seconds(command.at), command.text, reply.json));
        }
      });
    }
    recorder.begin({again.string(), {}}, contents.run.begin, contents.run.truth_begin);
    boost::asio::signal_set signals(io, SIGINT, SIGTERM);
    signals.async_wait([&](const boost::system::error_code& error, int) {
      if (!error) {
        interrupted = true;
        rig.executive().stop();
      }
    });
    const SimTime end = contents.end.value_or(result.end);
    const RunOutcome outcome = rig.executive().run_free(end);
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
    return bus_messages(recorded, bus);
  });
  return result;
}

}  // namespace rigwire::hil
