#include "hil/control/desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "fields/failure_text.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/problems.h"
#include "hil/control/live_changes.h"
#include "hil/control/ruling.h"
#include "hil/control/showing.h"
#include "hil/world/quantities.h"

namespace rigwire::hil {
namespace {

using Json = nlohmann::ordered_json;

/// Between two looks at a quantity that is waited for.
constexpr Duration kLook = std::chrono::milliseconds{1};

bool changes_the_run(const Command& command) {
  return std::holds_alternative<FaultAddCommand>(command) ||
         std::holds_alternative<FaultClearCommand>(command) ||
         std::holds_alternative<RecordCommand>(command) ||
         std::holds_alternative<SetCommand>(command);
}

}  // namespace

Desk::Desk(boost::asio::io_context& io, Executive& executive, GovernedRun run)
    : io_(io),
      executive_(executive),
      run_(std::move(run)),
      changes_(std::make_unique<LiveChanges>(LiveChanges::Parts{
          executive, run_.faults, run_.hand, run_.settings, run_.recorder, run_.events})) {
  executive_.add(*this);
  if (run_.events != nullptr) {
    // Called on the thread that logs the event.
    run_.events->inform_desk([this](const RunEvent&) { later([this] { tell_events(); }); });
  }
  if (run_.clock.kind == ClockMode::Kind::step || run_.clock.kind == ClockMode::Kind::drained ||
      (run_.shown != nullptr && run_.shown->begins_standing())) {
    executive_.pause();
  }
}

Desk::~Desk() {
  if (run_.events != nullptr) {
    run_.events->inform_desk({});
  }
}

void Desk::carry_out(const Request& request, Answer answer) {
  if (ended_) {
    refuse(answer, Reply::Outcome::ended, {{"what", "the run has ended"}});
    return;
  }
  const SimTime at = kStart + request.at;
  if (at <= executive_.now()) {
    // Brings the devices to this instant.
    executive_.arrive();
    act(request.command, std::move(answer));
    return;
  }
  const auto behind = std::ranges::upper_bound(queue_, at, {}, &Queued::at);
  queue_.insert(behind, {at, request.command, std::move(answer)});
}

void Desk::carry_out_parsed(ParsedRequest parsed, Answer answer, Asker asker) {
  if (!parsed.request) {
    refuse(answer, Reply::Outcome::wrong, json_of(*parsed.wrong));
    return;
  }
  Request& request = *parsed.request;
  if (run_.shown != nullptr && changes_the_run(request.command)) {
    refuse(answer, Reply::Outcome::refused,
           {{"what", "read-only: this is a replay"},
            {"path", "verb"},
            {"allowed", "seek, pause, resume, speed, run_until, step, wait and what only reads"}});
    return;
  }
  if (queue_.size() >= kMaxQueued && kStart + request.at > executive_.now()) {
    refuse(answer, Reply::Outcome::refused,
           {{"what", "too many commands wait for their instant"},
            {"path", "at"},
            {"found", std::to_string(queue_.size())},
            {"allowed", fmt::format("at most {}", kMaxQueued)}});
    return;
  }
  if (auto* const record = std::get_if<RecordCommand>(&request.command)) {
    record->confined = asker == Asker::anybody;
  }
  carry_out(request, std::move(answer));
}

void Desk::carry_out(const std::string& text, const std::string& name, Answer answer, Asker asker) {
  carry_out_parsed(parse_command(text, name), std::move(answer), asker);
}

void Desk::carry_out_at(SimTime at, const std::string& text, const std::string& name,
                        Answer answer) {
  ParsedRequest parsed = parse_command(text, name);
  if (!parsed.request) {
    refuse(answer, Reply::Outcome::wrong, json_of(*parsed.wrong));
    return;
  }
  parsed.request->at = at - kStart;
  carry_out(*parsed.request, std::move(answer));
}

void Desk::end() {
  tell_events();
  ended_ = true;
  const Json why{{"what", "the run ended before"}};
  for (const Queued& queued : std::exchange(queue_, {})) {
    refuse(queued.answer, Reply::Outcome::ended, why);
  }
  for (const Journey& journey : std::exchange(journey_, {})) {
    refuse(journey.answer, Reply::Outcome::ended, why);
  }
  for (const auto& [command, answer] : std::exchange(listening_, {})) {
    refuse(answer, Reply::Outcome::ended, why);
  }
}

SimTime Desk::next_event() const {
  SimTime next = queue_.empty() ? kNever : queue_.front().at;
  for (const Journey& journey : journey_) {
    next = std::min({next, journey.until, journey.waits ? journey.next_look : kNever});
  }
  return next;
}

void Desk::advance(SimTime now) {
  arrive_at(now);
  while (!queue_.empty() && queue_.front().at <= now) {
    Queued next = std::move(queue_.front());
    queue_.pop_front();
    act(next.command, std::move(next.answer));
  }
}

void Desk::arrive_at(SimTime now) {
  if (journey_.empty()) {
    return;
  }
  Journey& journey = journey_.front();
  const bool there = journey.waits && is_there(journey);
  if (!there && now < journey.until) {
    journey.next_look = std::min(journey.until, now + kLook);
    return;
  }
  if (journey.stands_then) {
    executive_.pause();
  }
  const bool in_vain = journey.waits && !there;
  later([this, in_vain, name = in_vain ? run_.quantities[journey.index].name : std::string(),
         answer = std::move(journey.answer)] {
    if (in_vain) {
      refuse(answer, Reply::Outcome::refused,
             {{"what", name + " was not where it is wanted within the limit"},
              {"machine", machine()}});
    } else {
      done(answer, {});
    }
  });
  journey_.clear();
}

bool Desk::is_there(const Journey& journey) const {
  const std::vector<double>& state = executive_.machine_state();
  return journey.index < state.size() && (journey.above ? state[journey.index] > journey.value
                                                        : state[journey.index] < journey.value);
}

void Desk::act(const Command& command, Answer answer) {
  std::visit([&](const auto& chosen) { act(chosen, answer); }, command);
}

void Desk::act(const StateCommand&, const Answer& answer) {
  done(answer, {{"rig", run_.rig},
                {"seed", run_.seed},
                {"config_hash", run_.config_hash},
                {"clock", to_string(run_.clock)},
                {"queued", queue_.size()},
                {"recorded_end_ns",
                 run_.shown != nullptr ? Json(nanoseconds(run_.shown->end())) : Json(nullptr)}});
}

void Desk::act(const PauseCommand&, const Answer& answer) {
  executive_.pause();
  later([this, answer] { done(answer, {}); });
}

void Desk::act(const ResumeCommand&, const Answer& answer) {
  if (run_.shown != nullptr && executive_.now() >= run_.shown->end()) {
    refuse(answer, Reply::Outcome::refused,
           {{"what", "the recording ends here"}, {"allowed", "seek to an instant before"}});
    return;
  }
  executive_.resume();
  done(answer, {});
}

void Desk::act(const RunUntilCommand& command, const Answer& answer) {
  const SimTime until = kStart + command.time;
  if (until <= executive_.now()) {
    refuse(answer, Reply::Outcome::refused,
           {{"what", "that instant is over"},
            {"path", "time"},
            {"found", seconds_text(until)},
            {"allowed", "later than " + seconds_text(executive_.now())}});
  } else if (!beyond_end(until, "time", answer) && !busy(answer)) {
    depart({.until = until, .stands_then = true, .answer = answer});
  }
}

void Desk::act(const SeekCommand& command, const Answer& answer) {
  const SimTime until = kStart + command.time;
  if (run_.shown == nullptr) {
    refuse(answer, Reply::Outcome::refused,
           {{"what", "a run cannot go back, devices have sent what they have sent"},
            {"path", "verb"},
            {"allowed", "seek in a recording that is shown (replay --dashboard); else run_until"}});
    return;
  }
  if (until < kStart) {  // a text cannot ask for it, a program can
    refuse(answer, Reply::Outcome::wrong, {{"what", "that is before the start"}, {"path", "time"}});
    return;
  }
  if (beyond_end(until, "time", answer)) {
    return;
  }
  bool stands_then = executive_.paused();
  for (const Journey& before : std::exchange(journey_, {})) {
    stands_then = before.stands_then;
    refuse(before.answer, Reply::Outcome::refused, {{"what", "time was sent elsewhere before"}});
  }
  stands_then = run_.shown->stands_then(stands_then);
  if (until < executive_.now()) {
    run_.shown->show_again(until, stands_then, run_.clock.factor);
    done(answer, {});
    executive_.stop();
  } else if (until == executive_.now()) {
    if (!stands_then) {
      executive_.resume();
    }
    done(answer, {});
  } else {
    run_.shown->pace().hasten(until);
    depart({.until = until, .stands_then = stands_then, .answer = answer});
  }
}

void Desk::act(const StepCommand& command, const Answer& answer) {
  const SimTime until = executive_.now() + command.length;
  if (!beyond_end(until, "length", answer) && !busy(answer)) {
    depart({.until = until, .stands_then = true, .answer = answer});
  }
}

void Desk::act(const SpeedCommand& command, const Answer& answer) {
  if (!run_.clock.paced()) {
    refuse(answer, Reply::Outcome::refused,
           {{"what", "this clock has no pace"},
            {"path", "verb"},
            {"found", "clock " + to_string(run_.clock)},
            {"allowed", "a run with --clock real or scaled:X"}});
    return;
  }
  executive_.set_factor(command.factor);
  if (run_.shown != nullptr) {
    run_.shown->pace().set_factor(command.factor);
  }
  run_.clock = {command.factor == 1.0 ? ClockMode::Kind::real : ClockMode::Kind::scaled,
                command.factor};
  done(answer, {{"clock", to_string(run_.clock)}});
}

void Desk::act(const ReadCommand&, const Answer& answer) {
  const RigStatus status = run_.status();
  Json devices = Json::object();
  for (const DeviceStatus& device : status.devices) {
    Json& told = devices[device.name] = json_of(device);
    told["settable"] = changes_->keys(device.name);
  }
  Json buses = Json::object();
  for (const BusStatus& bus : status.buses) {
    buses[bus.name] = json_of(bus);
  }
  Json faults = Json::array();
  for (const FaultWindow& fault : status.faults) {
    faults.push_back(json_of(fault));
  }
  done(answer, {{"clock", to_string(run_.clock)},
                {"machine", machine()},
                {"air", changes_->air()},
                {"devices", std::move(devices)},
                {"buses", std::move(buses)},
                {"faults", std::move(faults)},
                {"wall_s", status.wall_s},
                {"slipped_s", to_seconds(status.slipped)},
                {"recording", run_.recorder != nullptr && run_.recorder->folder()
                                  ? Json(printable(*run_.recorder->folder()))
                                  : Json(nullptr)}});
}

void Desk::act(const WaitCommand& command, const Answer& answer) {
  const auto found = find_quantity(run_.quantities, command.quantity);
  if (!found) {
    refuse(answer, Reply::Outcome::wrong,
           {{"what", "the machine has no such quantity"},
            {"path", "quantity"},
            {"found", printable(shortened(command.quantity))},
            {"allowed", allowed_quantities(run_.quantities, command.quantity)}});
  } else if (!busy(answer)) {
    const SimTime limit = executive_.now() + command.limit;
    depart({.until = run_.shown != nullptr ? std::min(limit, run_.shown->end()) : limit,
            .stands_then = executive_.paused(),
            .waits = true,
            .index = *found,
            .above = command.above,
            .value = command.value,
            .next_look = executive_.now(),
            .answer = answer});
  }
}

void Desk::act(const FaultAddCommand& command, const Answer& answer) {
  reply(answer, changes_->begin(command));
}

void Desk::act(const FaultClearCommand& command, const Answer& answer) {
  reply(answer, changes_->end(command));
}

void Desk::act(const FaultListCommand&, const Answer& answer) {
  Json targets = Json::object();
  for (const RigFaults::Target& target : run_.faults.targets()) {
    Json& kinds = targets[target.name] = Json::object();
    for (const fields::Named& kind : target.kinds) {
      kinds[std::string(kind.name)] = kind.text;
    }
  }
  Json faults = Json::array();
  for (const RigFaults::Numbered& fault : run_.faults.list()) {
    faults.push_back(json_of(fault));
  }
  done(answer, {{"targets", std::move(targets)},
                {"faults", std::move(faults)},
                {"forgotten", run_.faults.forgotten()}});
}

void Desk::act(const EventsCommand& command, const Answer& answer) {
  if (run_.events == nullptr) {
    refuse(answer, Reply::Outcome::refused, {{"what", "this run has no events"}});
  } else if (command.wait && run_.events->last() <= command.since) {
    listening_.emplace_back(command, answer);
    if (listening_.size() > kMaxListeners) {
      // Its client may have gone. One that is there asks again.
      const auto [oldest, told] = std::move(listening_.front());
      listening_.erase(listening_.begin());
      answer_events(oldest, told);
    }
  } else {
    answer_events(command, answer);
  }
}

void Desk::answer_events(const EventsCommand& command, const Answer& answer) {
  const RunEvents::Excerpt excerpt = run_.events->since(command.since);
  Json events = Json::array();
  for (const RunEvent& event : excerpt.events) {
    events.push_back(json_of(event));
  }
  done(answer, {{"events", std::move(events)}, {"last", excerpt.last}, {"lost", excerpt.lost}});
}

void Desk::tell_events() {
  if (run_.events == nullptr || ended_) {
    return;
  }
  const std::uint64_t last = run_.events->last();
  const auto told = [&](const auto& waiting) { return waiting.first.since < last; };
  std::vector<std::pair<EventsCommand, Answer>> ready;
  std::ranges::copy_if(listening_, std::back_inserter(ready), told);
  std::erase_if(listening_, told);
  for (const auto& [command, answer] : ready) {
    answer_events(command, answer);
  }
}

bool Desk::may_record(const RecordCommand& command, const Answer& answer) {
  const auto no = [&](Reply::Outcome outcome, Json why) {
    refuse(answer, outcome, std::move(why));
    return false;
  };
  if (run_.recorder == nullptr) {
    return no(Reply::Outcome::refused, {{"what", "this run cannot be recorded"}});
  }
  if (command.stop != command.folder.empty()) {
    return no(Reply::Outcome::wrong, {{"what", "either a recording begins or it ends"},
                                      {"path", "folder"},
                                      {"found", printable(shortened(command.folder))},
                                      {"allowed", "a folder, or stop: true"}});
  }
  const std::optional<std::string>& present = run_.recorder->folder();
  if (command.stop && (!present || recording_ends_)) {
    return no(Reply::Outcome::refused,
              {{"what", "nothing is recorded"}, {"allowed", "stop after a recording has begun"}});
  }
  if (!command.stop && present) {
    return no(Reply::Outcome::refused, {{"what", "a recording is on its way"},
                                        {"path", "folder"},
                                        {"found", printable(*present)},
                                        {"allowed", "one at a time; end it first"}});
  }
  return true;
}

void Desk::act(const RecordCommand& command, const Answer& answer) {
  if (!may_record(command, answer)) {
    return;
  }
  if (command.stop) {
    end_recording(answer);
  } else {
    begin_recording(command, answer);
  }
}

void Desk::begin_recording(const RecordCommand& command, const Answer& answer) {
  namespace fs = std::filesystem;
  fs::path folder = fs::path(command.folder).lexically_normal();
  if (command.confined) {
    const bool outside = folder.is_absolute() || std::ranges::count(folder, fs::path("..")) != 0;
    if (outside || folder == ".") {
      refuse(answer, Reply::Outcome::refused,
             {{"what", "at a port recordings are made below one folder"},
              {"path", "folder"},
              {"found", printable(shortened(command.folder))},
              {"allowed", "a name below " + printable(run_.records_below.string())}});
      return;
    }
    folder = run_.records_below / folder;
  } else if (!folder.is_absolute()) {
    refuse(answer, Reply::Outcome::wrong,
           {{"what", "the run may stand in another folder than who asks"},
            {"path", "folder"},
            {"found", printable(shortened(command.folder))},
            {"allowed", "an absolute path"}});
    return;
  }
  try {
    run_.recorder->begin({folder.string(), command.only});
  } catch (const std::exception& error) {
    refuse(answer, Reply::Outcome::refused,
           {{"what", fields::failure_text(error, "the recording")}, {"path", "folder"}});
    return;
  }
  done(answer, {{"folder", printable(folder.string())}});
}

void Desk::end_recording(const Answer& answer) {
  const SimTime end = executive_.now();
  run_.recorder->leave_out_after(end);
  recording_ends_ = true;
  later([this, answer, end] {
    recording_ends_ = false;
    const Json folder = printable(run_.recorder->folder().value_or(""));
    run_.recorder->finish(end);
    done(answer, {{"folder", folder}, {"end_ns", nanoseconds(end)}});
  });
}

void Desk::act(const SetCommand& command, const Answer& answer) {
  reply(answer, changes_->set(command));
}

void Desk::act(const StopCommand&, const Answer& answer) {
  done(answer, {});
  executive_.stop();
}

bool Desk::busy(const Answer& answer) {
  if (journey_.empty()) {
    return false;
  }
  refuse(answer, Reply::Outcome::refused,
         {{"what", "time is on its way for another request"},
          {"found", "until " + seconds_text(journey_.front().until) + " at the latest"},
          {"allowed", "one run_until, step or wait at a time"}});
  return true;
}

bool Desk::beyond_end(SimTime until, std::string_view path, const Answer& answer) {
  if (run_.shown == nullptr || until <= run_.shown->end()) {
    return false;
  }
  refuse(answer, Reply::Outcome::refused,
         {{"what", "the recording ends before"},
          {"path", path},
          {"found", seconds_text(until)},
          {"allowed", "up to " + seconds_text(run_.shown->end())}});
  return true;
}

void Desk::depart(Journey journey) {
  if (journey.waits && is_there(journey)) {
    done(journey.answer, {});
    return;
  }
  // A look at this very instant would not move on.
  journey.next_look = std::min(journey.until, executive_.now() + kLook);
  journey_.push_back(std::move(journey));
  executive_.resume();
}

void Desk::later(std::function<void()> what) {
  boost::asio::post(io_, std::move(what));
}

Json Desk::machine() const {
  Json values = Json::object();
  const std::vector<double>& state = executive_.machine_state();
  for (std::size_t i = 0; i < run_.quantities.size() && i < state.size(); ++i) {
    values[run_.quantities[i].name] = {{"value", state[i]}, {"unit", run_.quantities[i].unit}};
  }
  return {{"time_ns", nanoseconds(executive_.frontier())},
          {"quantities", std::move(values)},
          {"settable", changes_->set_points()}};
}

void Desk::reply(const Answer& answer, Ruling ruling) {
  if (ruling.outcome == Reply::Outcome::done) {
    done(answer, std::move(ruling.told));
  } else {
    refuse(answer, ruling.outcome, std::move(ruling.told));
  }
}

void Desk::done(const Answer& answer, Json more) {
  Json json{
      {"ok", true}, {"time_ns", nanoseconds(executive_.now())}, {"paused", executive_.paused()}};
  if (more.is_object()) {
    json.update(more);
  }
  answer({Reply::Outcome::done, json.dump()});
}

void Desk::refuse(const Answer& answer, Reply::Outcome outcome, Json why) {
  Json json{
      {"ok", false}, {"time_ns", nanoseconds(executive_.now())}, {"paused", executive_.paused()}};
  json.update(why);
  if (run_.events != nullptr && outcome != Reply::Outcome::ended) {
    const auto said = [&](const char* key) {
      const auto found = json.find(key);
      return found == json.end() || !found->is_string() ? std::string() : found->get<std::string>();
    };
    const auto behind = [](const char* word, const std::string& text) {
      return text.empty() ? text : word + text;
    };
    run_.events->tell(executive_.now(), EventKind::refused, LogLevel::info, said("path"),
                      "refused: " + said("what") + behind(", found ", said("found")) +
                          behind(", allowed ", said("allowed")));
  }
  answer({outcome, json.dump(-1, ' ', false, Json::error_handler_t::replace)});
}

}  // namespace rigwire::hil
