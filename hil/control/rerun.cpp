#include "hil/control/rerun.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <iterator>
#include <utility>

#include "drivers/endpoints.h"
#include "hil/control/desk.h"
#include "hil/record/recorder.h"
#include "hil/rig/private_wires.h"
#include "hil/wires/outlets.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;

/// Who looks on is waited for this long before the instant: a turn of any lidar, a picture, a fix.
constexpr Duration kSeenBefore = std::chrono::milliseconds{500};
/// A page loads again, and asks for what it shows; at most.
constexpr std::chrono::seconds kReturn{20};
constexpr std::chrono::milliseconds kLook{100};

const auto kNobody = [](const Reply& /*reply*/) {};

std::vector<RecordedAct> recorded_events(const fs::path& folder) {
  std::vector<RecordedAct> events;
  each_message(folder, [&](TruthTrack track, SimTime at, std::string_view text) {
    if (track == TruthTrack::events) {
      events.push_back({at, std::string(text)});
    }
  });
  return events;
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
      own_("replay"),
      pace_(course_.factor) {
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
      // SocketCAN's client is always there; of every other hop the recording tells.
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
  executive_ = &rig.executive();
  executive_->add(clients_);
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

void Rerun::show(const Course& course) {
  clients_.begin_again();
  course_ = course;
  pace_ = FreePace(course.factor);
  again_.reset();
  is_coming_ = false;
  was_looked_at_ = false;
}

void Rerun::steer(Desk& desk, boost::asio::io_context& io, std::function<bool()> is_looked_at) {
  is_looked_at_ = std::move(is_looked_at);
  desk.carry_out(Request{PauseCommand{}, end() - kStart}, kNobody);
  boost::asio::post(io, [this, &desk, &io] {
    is_coming_ = course_.looked_at || course_.from > executive_->now();
    if (!course_.looked_at) {
      if (is_coming_) {
        desk.carry_out(Request{SeekCommand{course_.from - kStart}}, kNobody);
      }
      return;
    }
    const auto wait = [this, &desk, &io](const Reply& reply) {
      if (reply.outcome == Reply::Outcome::done) {
        go_on_when_looked_at(desk, io, std::chrono::steady_clock::now() + kReturn);
      }
    };
    const Duration earlier = course_.from - kStart - kSeenBefore;
    if (earlier > Duration{0}) {
      pace_.hasten(kStart + earlier);
      desk.carry_out(Request{RunUntilCommand{earlier}}, wait);
    } else {
      wait({});
    }
  });
}

void Rerun::go_on_when_looked_at(Desk& desk, boost::asio::io_context& io,
                                 std::chrono::steady_clock::time_point latest) {
  const auto timer = std::make_shared<boost::asio::steady_timer>(io, kLook);
  timer->async_wait([this, &desk, &io, latest, timer,
                     at = executive_->now()](const boost::system::error_code& error) {
    if (error || !executive_->paused() || executive_->now() != at) {
      is_coming_ = false;  // it has been sent elsewhere meanwhile
      return;
    }
    // Once more after they are there, so that they have asked for what they want.
    const bool is_there = std::exchange(was_looked_at_, is_looked_at_()) && was_looked_at_;
    if (!is_there && std::chrono::steady_clock::now() < latest) {
      go_on_when_looked_at(desk, io, latest);
      return;
    }
    desk.carry_out(Request{SeekCommand{course_.from - kStart}}, kNobody);
  });
}

void Rerun::show_again(SimTime from, bool stands, double factor) {
  again_ = Course{from, stands, factor, is_looked_at_()};
}

}  // namespace rigwire::hil
