// Executes the commands of a run, whatever their origin.
//
// Everything is on the thread that runs the executive, which serves the wires, too. A client's text
// is parsed on the client's side of the hand-over (parse_command()), and comes here as a bounded
// structure. What a command costs here is bounded by what it has: at most kMaximumRequestKeys keys
// and kMaximumRequestNodes values (hil/configuration/document.h) of kMaxRequestWord bytes each
// (commands.h) that are checked and applied, an answer of the size of the rig or of the events that
// are kept (RunEvents::kKept), at most kMaxQueued commands that wait for their instant and
// kMaxListeners that wait for events. However many clients ask, time moves on between their
// commands (Executive, "Clients"). The desk is an event source, the last one
// added: a command with an instant acts when everything that is due up to it has been done, and
// several of one instant act in the order in which they came. Time pauses exactly at the instant
// that run_until, step or a queued pause names; what was due by then has been sent.
//
// Answers. Each request is answered once: when it is done (run_until: when time has paused there),
// when it is refused, or when the run ends before. Only one request at a time may move time: while
// a run_until, a step or a wait is under way, another one is refused; a seek replaces it.
//
// In a replay time goes no further than the recorded end, and commands that would change the run
// are refused. A seek backward is answered when the run is about to end and begin again.
//
// `read` and `wait` use the machine's state at the end of the newest slice, and report that instant
// with it: while time is paused within a slice, it is up to a slice ahead; while the run is paced,
// up to the lead.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/control/commands.h"
#include "hil/control/reply.h"
#include "hil/executive/clock.h"
#include "hil/executive/event_source.h"
#include "hil/executive/executive.h"
#include "hil/executive/truth_source.h"
#include "hil/record/recorder.h"
#include "hil/record/run_events.h"
#include "hil/rig/rig_faults.h"
#include "hil/rig/rig_settings.h"
#include "hil/rig/rig_status.h"
#include "hil/world/hand.h"

namespace rigwire::hil {

class LiveChanges;
class Showing;
struct Ruling;

/// The run that the desk governs.
struct GovernedRun {
  std::string rig;
  std::uint64_t seed = 0;
  std::string config_hash;
  ClockMode clock;
  std::vector<StateQuantity> quantities;  ///< What RigStatus::machine holds.
  std::function<RigStatus()> status;
  RigFaults& faults;
  /// Returns the metrics in Prometheus' text format.
  std::function<std::string()> metrics = [] { return std::string(); };
  RunEvents* events = nullptr;      ///< Receives the events; null: no events.
  Recorder* recorder = nullptr;     ///< Null: the run cannot be recorded.
  Hand* hand = nullptr;             ///< Null: no manual override.
  RigSettings* settings = nullptr;  ///< Null: no device can be configured.
  Showing* shown = nullptr;         ///< The replayed recording; null: this is no replay.
  /// Only folder below which clients with a port's token may make recordings.
  std::filesystem::path records_below{};
};

class Desk final : public EventSource {
 public:
  using Answer = std::function<void(const Reply&)>;
  /// Maximum number of commands of clients that wait for their instant; one more is refused.
  static constexpr std::size_t kMaxQueued = 1024;
  /// Maximum number of requests that wait for events. For one more, the oldest is answered with no
  /// events.
  static constexpr std::size_t kMaxListeners = 256;

  /// Adds itself to the executive; the executive and all that `run` refers to must outlive it. With
  /// a clock that steps or waits for clients, time is paused at the start, so that clients can
  /// connect.
  Desk(boost::asio::io_context& io, Executive& executive, GovernedRun run);
  ~Desk() override;

  /// Returns the io_context of its thread, which is the executive's.
  [[nodiscard]] boost::asio::io_context& io() { return io_; }
  /// Executes a request. `answer` may be called before this returns.
  void carry_out(const Request& request, Answer answer);
  /// Origin of a request.
  enum class Asker {
    owner,    ///< This user.
    anybody,  ///< A client with a port's token.
  };
  /// Executes a parsed request, or answers with what is wrong with it. Also refuses it when
  /// kMaxQueued commands wait for their instant, and in a replay when it would change the run.
  void carry_out_parsed(ParsedRequest parsed, Answer answer, Asker asker);
  /// Parses and executes text, JSON or YAML, on this thread: for callers in this process, not for
  /// texts of clients. `name` is the text's name in messages.
  void carry_out(const std::string& text, const std::string& name, Answer answer,
                 Asker asker = Asker::owner);
  /// Executes a text at the instant `at`, whatever instant the text gives.
  void carry_out_at(SimTime at, const std::string& text, const std::string& name, Answer answer);
  [[nodiscard]] std::string metrics() const { return run_.metrics(); }
  [[nodiscard]] ClockMode clock() const { return run_.clock; }
  /// Returns the replayed recording; null: this is no replay.
  [[nodiscard]] const Showing* shown() const { return run_.shown; }
  /// Returns what has been, and can be, changed in the run.
  [[nodiscard]] const LiveChanges& changes() const { return *changes_; }
  /// Answers all waiting requests: the run has ended.
  void end();

  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SimTime next_wakeup() const override { return next_event(); }
  void advance(SimTime now) override;

 private:
  struct Queued {
    SimTime at{};
    Command command;
    Answer answer;
  };
  /// A run_until, seek, step or wait under way.
  struct Journey {
    SimTime until{};  ///< Latest instant at which it ends.
    bool stands_then = false;
    bool waits = false;  ///< For the quantity at `index`.
    std::size_t index = 0;
    bool above = true;
    double value = 0.0;
    SimTime next_look{};
    Answer answer;
  };

  void act(const Command& command, Answer answer);
  void act(const StateCommand&, const Answer& answer);
  void act(const PauseCommand&, const Answer& answer);
  void act(const ResumeCommand&, const Answer& answer);
  void act(const RunUntilCommand& command, const Answer& answer);
  void act(const SeekCommand& command, const Answer& answer);
  void act(const StepCommand& command, const Answer& answer);
  void act(const SpeedCommand& command, const Answer& answer);
  void act(const ReadCommand&, const Answer& answer);
  void act(const WaitCommand& command, const Answer& answer);
  void act(const FaultAddCommand& command, const Answer& answer);
  void act(const FaultClearCommand& command, const Answer& answer);
  void act(const FaultListCommand&, const Answer& answer);
  void act(const EventsCommand& command, const Answer& answer);
  void act(const RecordCommand& command, const Answer& answer);
  void act(const SetCommand& command, const Answer& answer);
  void act(const StopCommand&, const Answer& answer);

  void begin_recording(const RecordCommand& command, const Answer& answer);
  void end_recording(const Answer& answer);
  /// False: the answer has been given.
  [[nodiscard]] bool may_record(const RecordCommand& command, const Answer& answer);
  /// Answers the requests that wait for events.
  void tell_events();
  void answer_events(const EventsCommand& command, const Answer& answer);

  /// Returns whether another journey is under way; refuses the request then.
  bool busy(const Answer& answer);
  /// Returns whether `until` is beyond the end of the replayed recording; refuses the request then.
  bool beyond_end(SimTime until, std::string_view path, const Answer& answer);
  void depart(Journey journey);
  void arrive_at(SimTime now);
  [[nodiscard]] bool is_there(const Journey& journey) const;

  void reply(const Answer& answer, Ruling ruling);
  void done(const Answer& answer, nlohmann::ordered_json more);
  /// Answers with a refusal, and logs it as an event unless the run has ended.
  void refuse(const Answer& answer, Reply::Outcome outcome, nlohmann::ordered_json why);
  /// Runs `what` after everything due up to now has been sent.
  void later(std::function<void()> what);
  [[nodiscard]] nlohmann::ordered_json machine() const;

  boost::asio::io_context& io_;
  Executive& executive_;
  GovernedRun run_;
  std::list<Queued> queue_;     ///< Sorted by time; of equal times in order of arrival.
  std::list<Journey> journey_;  ///< At most one.
  std::vector<std::pair<EventsCommand, Answer>> listening_;  ///< The oldest first.
  std::unique_ptr<LiveChanges> changes_;
  bool recording_ends_ = false;
  bool ended_ = false;
};

}  // namespace rigwire::hil
