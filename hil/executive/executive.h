// The executive: runs truth, devices and wires against one clock.
//
// Two threads when paced. The truth thread computes slices of simulated time ahead of the clock by
// `lead` and hands their samples over. The wire thread (the caller's) is where stations, buses,
// outlets and endpoints live: it takes samples as simulated time reaches them, runs what is due in
// order of time, and hands every unit of output to its wire at its absolute deadline. What clients
// send is given to the device at once, on the wire thread; commands and changed sample plans travel
// back and act from the truth's frontier on, that is up to `lead` later.
//
// Free-running, one thread does both, slice by slice, and what is sent does not depend on wall
// time. Running freely repeats a paced run when the truth follows the requests from the same
// frontiers on (hand_over_as()).
//
// Pause. pause() takes effect between two events, so that an event source can pause time at an
// instant of its own with everything before it done. Clients are still served then; what they send
// arrives at that instant, and devices answer when time resumes.
//
// Clients. What they send is served between two turns of the loop for a bounded time: clients that
// send without end hold up neither time nor a wire.
//
// Order. Events run in order of time, at equal instants in the order of add(); so do outlets, among
// themselves, when the events up to that instant have run. Stations take samples and ask of the
// truth in the order of their indices.
//
// Ownership. It owns nothing: the io_context, the truth and what is added must live as long as it
// runs. Errors. A fault (of the truth, or a device that does not advance) ends the run and is
// reported in its outcome; what a handler of the io_context throws comes out of run_free() and
// run_paced().
//
// It knows no kind of sensor, no device and no wire: samples, plans and commands lie on shelves
// (hil/executive/shelves.h) that only the truth's sensor and the device's station read.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/executive/clock.h"
#include "hil/executive/cpu_time.h"
#include "hil/executive/event_source.h"
#include "hil/executive/station.h"
#include "hil/executive/truth_source.h"

namespace boost::asio {
class io_context;
}

namespace rigwire::hil {

/// What to do when a paced run lies behind the wall clock by more than a limit, because the host
/// stalled or is too slow.
enum class OverrunPolicy {
  slip,  ///< Simulated time gives up the lag.
  warn,  ///< Everything is late, and is sent as fast as possible until the lag is made up.
  stop,  ///< The run ends with a fault.
};
inline constexpr std::array<std::string_view, 3> kOverrunPolicies{"slip", "warn", "stop"};

/// One stall of the host. With `slip`, `lag` is by how much the clock slipped in all of it; with
/// `warn`, it lasts from when the limit was exceeded until the lag is made up.
struct Overrun {
  SimTime at{};
  Duration lag{0};

  friend bool operator==(const Overrun&, const Overrun&) = default;
};

/// How a run ended and what it cost.
struct RunOutcome {
  SimTime reached{};                    ///< Simulated time up to which devices were run.
  double wall_s = 0.0;                  ///< From the first slice's deadline to the end.
  Duration slipped{0};                  ///< Given up against wall time because the host stalled.
  std::uint64_t slips = 0;              ///< Number of slips.
  std::uint64_t overruns = 0;           ///< Slips, and overruns with other policies.
  std::vector<Overrun> first_overruns;  ///< At most kOverrunsKept.
  std::uint64_t expiries = 0;           ///< Number of waits for clients that reached their limit.
  double waited_s = 0.0;                ///< Wall time spent waiting for clients.
  std::optional<std::string> fault;     ///< Why it ended early, if it did.
};

inline constexpr std::size_t kOverrunsKept = 100;

/// CPU seconds of the wire side, by stage.
struct WireStages {
  double encoding_s = 0.0;  ///< Devices: taking samples, encoding, answering.
  double writing_s = 0.0;   ///< Handing units of output to the system.
};

struct PacedSettings {
  double factor = 1.0;  ///< Simulated seconds per wall second.
  Duration lead =
      std::chrono::milliseconds{6};  ///< How far truth is computed ahead; at least one slice.
  OverrunPolicy overrun = OverrunPolicy::slip;
  Duration overrun_limit = std::chrono::milliseconds{100};
  std::function<void(const Overrun&)> on_overrun;  ///< On the wire thread; may be empty.
};

/// For a free run that waits for its clients.
struct ClientPatience {
  /// Whether they have taken all that was sent so far. Polled on the wire thread.
  std::function<bool()> taken;
  /// Maximum wall time of the wait for one slice.
  std::chrono::nanoseconds patience = std::chrono::seconds{1};
  /// Called when that was exceeded; the result of `taken` may differ from then on.
  std::function<void()> expired;
};

/// Requests of stations to the truth up to an instant, and the frontier from which it followed
/// them.
struct RequestHandover {
  SimTime asked{};
  SimTime taken{};
  bool promised = false;  ///< No request was handed over; soonest_request() returned `taken`.

  friend bool operator==(const RequestHandover&, const RequestHandover&) = default;
};

class Executive {
 public:
  /// Refers to both, and to what is given to add().
  Executive(boost::asio::io_context& io, TruthSource& truth);
  ~Executive();
  Executive(const Executive&) = delete;
  Executive& operator=(const Executive&) = delete;

  /// Adds a station; its index counts up from 0 in order of the calls.
  StationIndex add(Station& station);
  /// Adds something else that happens in simulated time: a bus, a Modbus line.
  void add(EventSource& source) { sources_.push_back(&source); }
  void add(Outlet& outlet) { outlets_.push_back(&outlet); }
  /// In the order of the calls.
  [[nodiscard]] const std::vector<Outlet*>& outlets() const { return outlets_; }

  /// To be called by a handler that got bytes from a client: runs all devices up to the present and
  /// returns it. If the host has stalled this thread, the bytes came at an unknown instant: the
  /// middle of the stall is taken for the present. So the host costs a client at most half of a
  /// stall on either side of its bytes, and a device does not time out a client because of the
  /// stall.
  SimTime arrive();

  /// Ends the run after the present event; what is due by then still leaves. From any thread.
  void stop();
  [[nodiscard]] bool stopped() const { return stopped_; }

  /// Calls `listener` on the wire thread for every slice when it is known, before the devices enter
  /// it: with its end, and the machine's state then. To be called before a run.
  using SliceListener = std::function<void(SimTime until, const std::vector<double>& state)>;
  void on_slice(SliceListener listener) { slice_listener_ = std::move(listener); }

  /// Calls `listener` on the wire thread for every request to the truth, and every promise, of a
  /// paced run, where the wall clock determines when the truth follows; the requests come in order
  /// of time.
  using HandoverListener = std::function<void(const RequestHandover&)>;
  void on_handover(HandoverListener listener) { handover_listener_ = std::move(listener); }
  /// Makes run_free() follow requests as that paced run did, so that it repeats it. To be called
  /// before it.
  void hand_over_as(const std::vector<RequestHandover>& plan);

  // On the wire thread, before a run or within it.
  /// Sends `request` to the truth with what the stations ask next, on the first one's shelves.
  template <class Request>
  void ask(const Request& request) {
    asked_.push_back(
        [request](TruthRequests& requests) { requests.of<Request>(0).push_back(request); });
  }
  /// Pauses time after the present event.
  void pause();
  void resume();
  [[nodiscard]] bool paused() const { return paused_; }
  /// Sets another pace; without effect when it runs freely. Precondition: factor > 0.
  void set_factor(double factor);

  /// Runs as fast as possible until `end` (kNever: until stop()).
  RunOutcome run_free(SimTime end) { return run_free(end, {}); }
  /// Runs like run_free(end), and after each slice waits until clients have taken what was due in
  /// it. They are served meanwhile. An empty `taken` does not wait.
  RunOutcome run_free(SimTime end, const ClientPatience& clients);
  /// Runs against wall time until `end` (kNever: until stop()).
  RunOutcome run_paced(const PacedSettings& settings, SimTime end);

  /// Returns the present simulated time on the wire side.
  [[nodiscard]] SimTime now() const { return now_; }
  /// Returns the end of the known samples, the time of machine_state(); not before now().
  [[nodiscard]] SimTime frontier() const { return frontier_; }
  /// Returns the first instant from which the truth follows a request made now.
  [[nodiscard]] SimTime soonest_request() { return soonest_request(now_); }
  /// Returns the first instant from which the truth follows a request made in the slice up to
  /// `asked`.
  [[nodiscard]] SimTime soonest_request(SimTime asked);
  /// Returns now(); may be called from any thread.
  [[nodiscard]] SimTime reached() const { return reached_.load(std::memory_order_relaxed); }
  /// Returns the wall time given up so far because the host stalled.
  [[nodiscard]] Duration slipped() const {
    return clock_ == nullptr ? Duration{0} : clock_->slipped();
  }
  /// Returns the outcome of the run so far. To be called on the wire thread.
  [[nodiscard]] RunOutcome outcome() const;
  /// The machine's state at the newest sample batch; empty before the first.
  [[nodiscard]] const std::vector<double>& machine_state() const { return machine_state_; }
  [[nodiscard]] const WireStages& wire_stages() const { return wire_stages_; }

 private:
  class TruthThread;
  class LateRequests;

  void route(const SampleBatch& batch);
  void advance_to(SimTime instant);
  void run_events(SimTime until);
  /// After run_events(), or with laps_ begun.
  void transmit_due(SimTime until);
  void collect_requests(TruthRequests& requests);
  [[nodiscard]] SimTime next_wakeup() const;
  [[nodiscard]] SimTime present() const;
  void fail(const std::string& what);
  // While paced.
  /// Applies the policy when the truth, or this thread, is too far behind `wanted`.
  void watch_lag(SimTime wanted);
  void end_stall();
  void report_overrun(const Overrun& overrun);
  void wait_for(const ClientPatience& clients);
  /// Runs the handlers of the io_context that are ready, at least one, until that time is over.
  void serve(std::chrono::nanoseconds at_most);

  boost::asio::io_context& io_;
  TruthSource& truth_;
  std::vector<Station*> stations_;
  std::vector<EventSource*> sources_;
  std::vector<Outlet*> outlets_;

  SimTime now_ = kStart;                  ///< Devices have been run up to here.
  std::atomic<SimTime> reached_{kStart};  ///< Copy of now_ for other threads.
  SimTime frontier_ = kStart;             ///< Samples are known up to here.
  PacedClock* clock_ = nullptr;           ///< Set while paced.
  const PacedSettings* pace_ = nullptr;   ///< Set while paced.
  TruthThread* truth_thread_ = nullptr;   ///< Set while paced.
  SimTime planned_ = kNever;              ///< When this thread means to be awake, while paced.
  std::unique_ptr<LateRequests> late_;    ///< Null: requests are followed in the next slice.
  std::vector<std::function<void(TruthRequests&)>> asked_;
  WireStages wire_stages_;
  StageLaps laps_;
  RunOutcome outcome_;   ///< Counts of the present run.
  WallTime began_{};     ///< Start of the present run.
  bool behind_ = false;  ///< An overrun that is not made up.
  /// Stall of the host while it lasts; `lag` is its sum so far.
  std::optional<Overrun> stall_;
  std::vector<double> machine_state_;
  SliceListener slice_listener_ = [](SimTime, const std::vector<double>&) {};
  HandoverListener handover_listener_ = [](const RequestHandover&) {};
  std::optional<std::string> fault_;
  bool paused_ = false;
  bool woken_ = false;  ///< Something happened that the paced loop must handle. Wire thread only.
  std::atomic<bool> stopped_{false};
};

}  // namespace rigwire::hil
