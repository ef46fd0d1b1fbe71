// The events of a run with their simulated instants: faults, slips, contacts, clients that come and
// go, refusals, manual overrides, recordings. The control surface reads this list by number, a
// recording as it grows.
//
// Order. Events are numbered from 1 as they are reported. Events of the truth lie ahead of the
// wires and wait until their time has reached them, so that the instants rise, but for events that
// happen beside simulated time (a warning of the log).
//
// Memory. The newest kKept are kept; since() counts the older ones that are lost.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hil/executive/event_source.h"
#include "hil/record/run_log.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

enum class EventKind : std::uint8_t {
  fault_begun,
  fault_ended,
  slipped,        ///< The host was too slow for the clock.
  impatient,      ///< Clients that did not take what was sent are not waited for any longer.
  contact_begun,  ///< Something solid began to push the machine.
  contact_ended,  ///< Nothing has pushed it for a while.
  client_came,    ///< A client opened a wire.
  client_left,
  set,       ///< A set point or setting was set manually.
  released,  ///< A manual override was released.
  refused,   ///< A request to the control surface was refused.
  recording_began,
  recording_ended,
  notice,  ///< A warning or an error of the log.
};
inline constexpr std::array<std::string_view, 14> kEventKinds{
    "fault_begun",   "fault_ended",     "slipped",         "impatient", "contact_begun",
    "contact_ended", "client_came",     "client_left",     "set",       "released",
    "refused",       "recording_began", "recording_ended", "notice"};

struct RunEvent {
  std::uint64_t number = 0;  ///< From 1.
  SimTime at{};
  EventKind kind = EventKind::notice;
  LogLevel level = LogLevel::info;
  std::string where;  ///< A device, wire or part of the machine; empty: the run.
  std::string text;   ///< A sentence.
};

class RunEvents final : public EventSource {
 public:
  /// Number of events of tell() that are kept.
  static constexpr std::size_t kKept = 2000;

  /// Reports an event that happens now. May be called from any thread.
  void tell(SimTime at, EventKind kind, LogLevel level, std::string where, std::string text);
  /// Reports on the thread of the truth, in order of time, an event that will happen at `at`, which
  /// the wires have not reached.
  void tell_ahead(SimTime at, EventKind kind, LogLevel level, std::string where, std::string text);

  /// The events after number `since`, as far as they are kept.
  struct Excerpt {
    std::vector<RunEvent> events;
    std::uint64_t lost = 0;  ///< Number of those after `since` that are not kept any more.
    std::uint64_t last = 0;  ///< Number of the newest there is, to be the next `since`.
  };
  [[nodiscard]] Excerpt since(std::uint64_t number) const;
  [[nodiscard]] std::uint64_t last() const;

  /// Called with each event when it gets its number, on the thread that reports it; must not report
  /// one.
  using Listener = std::function<void(const RunEvent&)>;
  /// Sets the listeners of the recorder, the desk and the stream. Empty: removes the listener;
  /// returns when it is not being called.
  void inform(Listener listener) { inform(0, std::move(listener)); }
  void inform_desk(Listener listener) { inform(1, std::move(listener)); }
  void inform_stream(Listener listener) { inform(2, std::move(listener)); }

  [[nodiscard]] SimTime next_event() const override {
    return next_.load(std::memory_order_acquire);
  }
  [[nodiscard]] SimTime next_wakeup() const override { return next_event(); }
  /// Numbers the events up to `now` that were reported in advance.
  void advance(SimTime now) override;

 private:
  void inform(std::size_t who, Listener listener);
  void add(RunEvent event);

  mutable std::mutex mutex_;
  std::deque<RunEvent> kept_;
  std::uint64_t last_ = 0;
  std::deque<RunEvent> ahead_;
  std::atomic<SimTime> next_{kNever};  ///< Time of the first event reported in advance.
  std::array<Listener, 3> listeners_;
};

}  // namespace rigwire::hil
