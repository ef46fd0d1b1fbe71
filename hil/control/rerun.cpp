#include "hil/control/rerun.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "drivers/endpoints.h"
#include "hil/configuration/build_facts.h"
#include "hil/control/desk.h"
#include "hil/record/recorder.h"
#include "hil/rig/private_wires.h"
#include "hil/wires/outlets.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;

std::vector<RecordedAct> recorded_events(const fs::path& folder) {
  std::vector<RecordedAct> events;
  each_message(folder, [&](TruthTrack track, SimTime at, std::string_view text) {
    if (track == TruthTrack::events) {
      events.push_back({at, std::string(text)});
    }
  });
  return events;
}

bool is_paced(const RecordedRun& run) {
  const auto clock = parse_clock_mode(run.clock);
  return clock && clock->paced();
}

void tell_origin(const RecordedRun& run, const std::string& hash,
                 std::vector<std::string>& remarks) {
  if (run.version != version()) {
    remarks.push_back(fmt::format("recorded by rigwire {}, this is {}", run.version, version()));
  }
  if (run.config_hash != hash) {
    remarks.push_back(fmt::format(
        "the configuration is not the recorded one, or a file that it names has changed: found "
        "{}, recorded {}",
        hash, run.config_hash));
  }
  if (is_paced(run) && !run.tells_requests) {
    remarks.push_back(
        fmt::format("recorded with the clock {} before there was requests.log: what a client "
                    "commanded may act up to the rig's lead later or earlier",
                    run.clock));
  }
}

}  // namespace

/// A bus's way outside that leads nowhere: its client is a recorded one.
class Rerun::NoCanEnd final : public drivers::CanBus {
 public:
  void start(Receiver /*receiver*/) override {}
  bool send(const protocols::can::Frame& /*frame*/) override { return true; }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {"in this program"}; }
};

Rerun::Rerun(const fs::path& recording)
    : recording_(recording),
      contents_(read_recording_description(recording)),
      recorded_(load_rig((recording / "rig.yaml").string(), {}).configuration),
      clients_(recording),
      end_(contents_.end ? *contents_.end : last_instant()),
      events_(recorded_events(recording)),
      own_("replay") {
  tell_origin(contents_.run, config_hash(recorded_), remarks_);
  std::ranges::copy(clients_.remarks(), std::back_inserter(remarks_));
  if (contents_.run.clients_before) {
    remarks_.push_back(fmt::format(
        "recorded from {:.9f} s on: what clients did before is not known and not done again",
        to_seconds(contents_.run.begin)));
  }
  configuration_ = made_private(recorded_, own_.path(), claims_, remarks_);
  for (const RecordingContents::Wire& wire : contents_.wires) {
    if (configuration_.buses.contains(wire.about.name)) {
      auto& end = can_ends_[wire.about.name] = std::make_unique<NoCanEnd>();
      own_ends_.buses[wire.about.name] = end.get();
      // SocketCAN's client is always there; the recording has those of every other hop.
      if (wire.about.address.starts_with("slcan ") || wire.about.address.starts_with("gs_usb ")) {
        own_ends_.with_known_clients.insert(wire.about.name);
      }
    }
  }
}

Rerun::~Rerun() = default;

SimTime Rerun::last_instant() const {
  SimTime last = kStart;
  each_packet(recording_, [&](std::size_t, SimTime at, const auto&) { last = std::max(last, at); });
  each_message(recording_,
               [&](TruthTrack, SimTime at, std::string_view) { last = std::max(last, at); });
  return contents_.end ? std::min(*contents_.end, last) : last;
}

void Rerun::add_clients(Rig& rig) {
  rig.executive().add(clients_);
  if (is_paced(contents_.run) && contents_.run.tells_requests) {
    rig.executive().hand_over_as(recorded_handovers(recording_));
  }
}

void Rerun::join(Recorder& recorder) {
  recorder.on_outlet([this](const std::string& wire, QueuedOutlet& outlet) {
    outlet.cut_off();
    clients_.join(wire, outlet);
  });
}

void Rerun::govern(Desk& desk, const std::function<void(const std::string& what)>& refused) const {
  for (const RecordedAct& command : recorded_commands(recording_)) {
    desk.carry_out_at(command.at, command.text, "commands.log", [refused, command](const Reply& r) {
      if (r.outcome != Reply::Outcome::done && r.outcome != Reply::Outcome::ended) {
        refused(fmt::format("{:.9f} s: not done again: {}: {}", to_seconds(command.at),
                            command.text, r.json));
      }
    });
  }
}

}  // namespace rigwire::hil
