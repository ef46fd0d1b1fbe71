#include "hil/executive/executive.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "hil/executive/short_turns.h"
#include "hil/executive/truth_source.h"

namespace rigwire::hil {
namespace {

// The truth is ahead of the clock and can wait for the wires; both go before what renders.
constexpr std::chrono::microseconds kWiresTurn{100};
constexpr std::chrono::microseconds kTruthTurn{500};

// For how long clients are served before the loop goes on, of wall time. A paced run has deadlines;
// a free one only has to move on.
constexpr std::chrono::microseconds kServedPaced{200};
constexpr std::chrono::milliseconds kServedFree{2};

// A wire thread that wakes up this much later than it meant to was held up by the host.
constexpr std::chrono::milliseconds kHeldUp{5};

/// The hand-over of sample batches from the thread that computes truth to the thread that owns the
/// devices: a ring of reused slots, bounded, so that truth never runs further ahead than the ring.
/// First in, first out. The ring owns the slots; a pointer to one holds until publish() or
/// release(). One producer thread, one consumer thread.
class BatchRing {
 public:
  explicit BatchRing(std::size_t slots) : slots_(slots) {}

  /// Producer: the slot to fill next; waits while all are full. nullptr after close().
  SampleBatch* acquire() {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [this] { return closed_ || count_ < slots_.size(); });
    return closed_ ? nullptr : &slots_[(first_ + count_) % slots_.size()];
  }
  /// Producer: hands over the acquired slot.
  void publish() {
    const std::scoped_lock lock(mutex_);
    ++count_;
  }

  /// Consumer: the oldest batch, or nullptr.
  const SampleBatch* front() {
    const std::scoped_lock lock(mutex_);
    return count_ == 0 ? nullptr : &slots_[first_];
  }
  /// Consumer: gives the front slot back. Precondition: front() != nullptr.
  void release() {
    {
      const std::scoped_lock lock(mutex_);
      first_ = (first_ + 1) % slots_.size();
      --count_;
    }
    room_.notify_one();
  }

  /// Wakes and ends the producer.
  void close() {
    {
      const std::scoped_lock lock(mutex_);
      closed_ = true;
    }
    room_.notify_one();
  }

 private:
  std::vector<SampleBatch> slots_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  bool closed_ = false;
  std::mutex mutex_;
  std::condition_variable room_;
};

/// One absolute deadline that sets a flag. Arming it again for the same instant costs nothing.
class DeadlineTimer {
 public:
  /// The flag must live as long as `io`.
  DeadlineTimer(boost::asio::io_context& io, bool& flag)
      : timer_(io), flag_(flag), armed_(std::make_shared<bool>(false)) {}

  void arm(WallTime deadline) {
    if (*armed_ && deadline == timer_.expiry()) {
      return;
    }
    timer_.expires_at(deadline);
    *armed_ = true;
    timer_.async_wait([armed = armed_, &flag = flag_](const boost::system::error_code& error) {
      if (!error) {
        *armed = false;
        flag = true;
      }
    });
  }

 private:
  boost::asio::steady_timer timer_;
  bool& flag_;
  std::shared_ptr<bool> armed_;  ///< Shared with handlers that may run after this object is gone.
};

/// Returns the item with the earliest instant, and that instant; the first of equals; null and
/// kNever when no item has one.
template <class Item, class Instant>
std::pair<Item*, SimTime> earliest(const std::vector<Item*>& items, Instant instant) {
  std::pair<Item*, SimTime> found{nullptr, kNever};
  for (Item* item : items) {
    const SimTime next = std::invoke(instant, item);
    if (next < found.second) {
      found = {item, next};
    }
  }
  return found;
}

std::string milliseconds_text(Duration span) {
  return std::to_string(span / std::chrono::milliseconds{1}) + " ms";
}

}  // namespace

/// Computes slices ahead of the clock on a thread of its own.
class Executive::TruthThread {
 public:
  TruthThread(boost::asio::io_context& io, TruthSource& truth, const PacedSettings& settings,
              bool& woken)
      : io_(io),
        truth_(truth),
        woken_(woken),
        lead_(settings.lead),
        ring_(static_cast<std::size_t>(settings.lead / truth.slice()) + 2) {}

  ~TruthThread() { join(); }
  TruthThread(const TruthThread&) = delete;
  TruthThread& operator=(const TruthThread&) = delete;

  /// Computes the first `lead` of simulated time before the clock runs.
  void preroll() {
    while (frontier_ < kStart + lead_ && !fault()) {
      compute_slice();
    }
  }

  void start(const PacedClock& clock) {
    thread_ = std::thread([this, &clock] {
      const ShortTurns short_turns(kTruthTurn);
      loop(clock);
    });
  }

  /// Gives the requests over, leaves `requests` empty, and returns the frontier at which they are
  /// taken.
  SimTime post(TruthRequests& requests) {
    const std::scoped_lock lock(mutex_);
    requests.move_to(posted_);
    return next_taken_at_;
  }

  /// From which instant on what is posted within the next slice is followed.
  [[nodiscard]] SimTime soonest_request() {
    const std::scoped_lock lock(mutex_);
    return next_taken_at_ + truth_.slice();
  }

  /// Consumer: wakes it with the next batch. False: one lies there already.
  [[nodiscard]] bool await_batch() {
    awaited_ = true;
    return ring_.front() == nullptr;
  }

  /// The clock goes otherwise than it did.
  void look_at_clock() { wake_.notify_one(); }

  [[nodiscard]] BatchRing& ring() { return ring_; }

  [[nodiscard]] std::optional<std::string> fault() {
    const std::scoped_lock lock(mutex_);
    return fault_;
  }

  void join() {
    {
      const std::scoped_lock lock(mutex_);
      ended_ = true;
    }
    wake_.notify_one();
    ring_.close();
    if (thread_.joinable()) {
      thread_.join();
    }
  }

 private:
  /// Limit of a wait, since a paused clock has no deadline.
  static constexpr Duration kLongestWait = std::chrono::seconds{1};

  void loop(const PacedClock& clock) {
    while (true) {
      {
        std::unique_lock lock(mutex_);
        while (!ended_ && !fault_) {
          const WallTime due = clock.wall_of(frontier_ + truth_.slice() - lead_);
          const WallTime now = std::chrono::steady_clock::now();
          if (due <= now) {
            break;
          }
          wake_.wait_until(lock, std::min(due, now + kLongestWait));
        }
        if (ended_ || fault_) {
          return;
        }
      }
      if (!compute_slice()) {
        return;
      }
      if (awaited_.exchange(false) || fault()) {
        boost::asio::post(io_, [&woken = woken_] { woken = true; });
      }
    }
  }

  bool compute_slice() {
    SampleBatch* batch = ring_.acquire();
    if (batch == nullptr) {
      return false;
    }
    {
      const std::scoped_lock lock(mutex_);
      std::swap(posted_, taken_);
      next_taken_at_ = frontier_ + truth_.slice();
    }
    const auto fault = truth_.advance(taken_, *batch);
    taken_.clear();
    if (fault) {
      const std::scoped_lock lock(mutex_);
      fault_ = fault;
      return true;
    }
    frontier_ = batch->until;
    ring_.publish();
    return true;
  }

  boost::asio::io_context& io_;
  TruthSource& truth_;
  bool& woken_;  ///< Wakes the wire thread, which alone writes it.
  std::atomic<bool> awaited_{false};
  Duration lead_;
  BatchRing ring_;
  SimTime frontier_ = kStart;
  TruthRequests taken_;

  std::mutex mutex_;
  std::condition_variable wake_;
  TruthRequests posted_;
  SimTime next_taken_at_ = kStart;  ///< The beginning of the slice that follows what is posted.
  std::optional<std::string> fault_;
  bool ended_ = false;
  std::thread thread_;
};

/// What a free run asks of the truth and hands over later, as a paced one did.
class Executive::LateRequests {
 public:
  /// The requests at the start are taken at once.
  explicit LateRequests(const std::vector<RequestHandover>& plan) {
    plan_.push_back({kStart, kStart});
    for (const RequestHandover& one : plan) {
      if (one.promised) {
        promised_.emplace(one.asked, one.taken);
      } else {
        plan_.push_back(one);
      }
    }
  }

  /// When the stations are asked next.
  [[nodiscard]] SimTime next_asked() const {
    return next_ == plan_.size() ? kNever : plan_[next_].asked;
  }
  /// What they ask now. Precondition: next_asked() != kNever.
  void hold(TruthRequests& requests) {
    held_.emplace_back(plan_[next_++].taken, TruthRequests());
    requests.move_to(held_.back().second);
  }
  /// Returns what was promised then, each once; nullopt: it was not asked for.
  std::optional<SimTime> promised(SimTime asked) {
    auto found = promised_.extract(asked);
    return found ? std::optional(found.mapped()) : std::nullopt;
  }
  /// Adds to `requests` those that are taken at that frontier.
  void release(SimTime frontier, TruthRequests& requests) {
    for (; !held_.empty() && held_.front().first <= frontier; held_.pop_front()) {
      held_.front().second.move_to(requests);
    }
  }

 private:
  std::vector<RequestHandover> plan_;
  std::size_t next_ = 0;
  std::multimap<SimTime, SimTime> promised_;
  std::deque<std::pair<SimTime, TruthRequests>> held_;
};

Executive::Executive(boost::asio::io_context& io, TruthSource& truth) : io_(io), truth_(truth) {}

Executive::~Executive() = default;

StationIndex Executive::add(Station& station) {
  stations_.push_back(&station);
  sources_.push_back(&station);
  return stations_.size() - 1;
}

void Executive::route(const SampleBatch& batch) {
  std::size_t taken = 0;
  for (StationIndex i = 0; i < stations_.size(); ++i) {
    taken += stations_[i]->take(i, batch.samples);
  }
  if (taken != batch.samples.size()) {
    fail(fmt::format("the truth has {} samples that no station takes at {:.9f} s",
                     batch.samples.size() - taken, to_seconds(batch.until)));
  }
  machine_state_ = batch.state;
  frontier_ = batch.until;
  slice_listener_(frontier_, machine_state_);
}

void Executive::fail(const std::string& what) {
  if (!fault_) {
    fault_ = what;
  }
  stop();
}

void Executive::run_events(SimTime until) {
  laps_.begin();
  while (!stopped_ && !paused_) {
    const auto [first, at] = earliest(sources_, &EventSource::next_event);
    if (first == nullptr || at > until) {
      break;
    }
    advance_to(std::max(now_, at));
    first->advance(now_);
    if (first->next_event() <= now_) {
      fail(fmt::format("a device does not move on from {:.9f} s", to_seconds(now_)));
    }
  }
  if (!paused_ && !stopped_) {
    advance_to(std::max(now_, until));
  }
  laps_.end(wire_stages_.encoding_s);
}

void Executive::advance_to(SimTime instant) {
  now_ = instant;
  reached_.store(instant, std::memory_order_relaxed);
}

void Executive::transmit_due(SimTime until) {
  while (true) {
    const auto [first, due] = earliest(outlets_, &Outlet::next_due);
    if (first == nullptr || due > until) {
      break;
    }
    std::optional<Duration> lateness;
    if (clock_ != nullptr) {
      lateness = std::chrono::steady_clock::now() - clock_->wall_of(due);
    }
    first->transmit_front(lateness);
  }
  laps_.end(wire_stages_.writing_s);
}

void Executive::collect_requests(TruthRequests& requests) {
  for (StationIndex i = 0; i < stations_.size(); ++i) {
    stations_[i]->collect(i, requests);
  }
  for (const auto& put : std::exchange(asked_, {})) {
    put(requests);
  }
}

void Executive::hand_over_as(const std::vector<RequestHandover>& plan) {
  late_ = std::make_unique<LateRequests>(plan);
}

SimTime Executive::next_wakeup() const {
  SimTime wakeup = kNever;
  // An instant up to now_ waits for samples beyond the frontier.
  const auto consider = [&](SimTime instant) {
    if (instant > now_) {
      wakeup = std::min(wakeup, instant);
    }
  };
  for (const EventSource* source : sources_) {
    consider(source->next_wakeup());
  }
  for (const Outlet* outlet : outlets_) {
    consider(outlet->next_due());
  }
  return wakeup;
}

SimTime Executive::present() const {
  if (clock_ == nullptr) {
    return now_;
  }
  const WallTime wall = std::chrono::steady_clock::now();
  SimTime instant = clock_->at(wall);
  if (planned_ != kNever && wall - clock_->wall_of(planned_) > kHeldUp) {
    instant = planned_ + (instant - planned_) / 2;
  }
  return std::min(frontier_, instant);
}

SimTime Executive::soonest_request(SimTime asked) {
  // What lies at the frontier itself is known.
  constexpr Duration kBehind{1};
  if (truth_thread_ != nullptr) {
    const SimTime soonest = truth_thread_->soonest_request() + kBehind;
    handover_listener_({asked, soonest, true});
    return soonest;
  }
  return (late_ ? late_->promised(asked) : std::nullopt).value_or(frontier_ + kBehind);
}

void Executive::stop() {
  stopped_ = true;
  boost::asio::post(io_, [] {});
}

void Executive::pause() {
  paused_ = true;
  if (clock_ != nullptr) {
    clock_->stand(now_);
  }
}

void Executive::resume() {
  paused_ = false;
  woken_ = true;
  if (clock_ != nullptr) {
    clock_->go_on(std::chrono::steady_clock::now());
    truth_thread_->look_at_clock();
  }
}

void Executive::set_factor(double factor) {
  if (clock_ != nullptr) {
    clock_->set_factor(std::chrono::steady_clock::now(), factor);
    truth_thread_->look_at_clock();
    woken_ = true;
  }
}

SimTime Executive::arrive() {
  woken_ = true;
  if (clock_ != nullptr) {
    watch_lag(clock_->at(std::chrono::steady_clock::now()));
  }
  run_events(std::max(now_, present()));
  return now_;
}

void Executive::wait_for(const ClientPatience& clients) {
  constexpr std::chrono::microseconds kLook{100};
  const auto began = std::chrono::steady_clock::now();
  bool waited = false;
  while (!stopped_ && !paused_ && !clients.taken()) {
    waited = true;
    if (std::chrono::steady_clock::now() - began >= clients.patience) {
      ++outcome_.expiries;
      clients.expired();
      break;
    }
    io_.run_one_for(kLook);
  }
  if (waited) {
    outcome_.waited_s +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  }
}

void Executive::serve(std::chrono::nanoseconds at_most) {
  const auto until = std::chrono::steady_clock::now() + at_most;
  while (io_.poll_one() != 0 && std::chrono::steady_clock::now() < until) {
  }
}

RunOutcome Executive::run_free(SimTime end, const ClientPatience& clients) {
  io_.restart();
  const auto keep_waiting = boost::asio::make_work_guard(io_);
  outcome_ = {};
  began_ = std::chrono::steady_clock::now();
  SampleBatch batch;
  TruthRequests requests;
  truth_.begin(false);
  while (!stopped_ && now_ < end) {
    if (paused_) {
      io_.run_one();
      continue;
    }
    // In a replay of a paced run, requests are collected and handed over as recorded.
    while (late_ && now_ >= late_->next_asked()) {
      requests.clear();
      collect_requests(requests);
      late_->hold(requests);
    }
    if (now_ >= frontier_) {
      requests.clear();
      if (late_) {
        late_->release(frontier_, requests);
      } else {
        collect_requests(requests);
      }
      if (const auto fault = truth_.advance(requests, batch)) {
        fail(*fault);
        break;
      }
      route(batch);
    }
    // Run the devices as far as samples are known, then send what is due.
    run_events(std::min({frontier_, end, late_ ? late_->next_asked() : kNever}));
    transmit_due(now_);
    serve(kServedFree);
    if (clients.taken) {
      wait_for(clients);
    }
  }
  return outcome();
}

RunOutcome Executive::run_paced(const PacedSettings& settings, SimTime end) {
  const ShortTurns short_turns(kWiresTurn);
  truth_.begin(true);
  TruthThread truth(io_, truth_, settings, woken_);
  TruthRequests requests;
  collect_requests(requests);
  truth.post(requests);
  truth.preroll();

  PacedClock clock(std::chrono::steady_clock::now(), settings.factor);
  clock_ = &clock;
  pace_ = &settings;
  truth_thread_ = &truth;
  planned_ = kNever;
  if (paused_) {
    clock.stand(kStart);
  }
  truth.start(clock);
  outcome_ = {};
  behind_ = false;
  began_ = clock.wall_of(kStart);
  DeadlineTimer timer(io_, woken_);
  io_.restart();
  const auto keep_waiting = boost::asio::make_work_guard(io_);

  while (!stopped_ && now_ < end) {
    while (const SampleBatch* batch = truth.ring().front()) {
      route(*batch);
      truth.ring().release();
    }
    if (const auto fault = truth.fault()) {
      fail(*fault);
      break;
    }
    watch_lag(clock.at(std::chrono::steady_clock::now()));
    const SimTime wanted = clock.at(std::chrono::steady_clock::now());
    run_events(std::min({frontier_, wanted, end}));
    transmit_due(now_);
    collect_requests(requests);
    if (!requests.empty()) {
      handover_listener_({now_, truth.post(requests)});
    }
    if (now_ >= end) {
      break;
    }
    // At the frontier only the next batch can help, and it wakes this thread; the deadline then
    // only makes sure that a stalled truth thread is noticed. Before it, batches are taken when
    // this thread wakes for something else.
    if (now_ >= frontier_ && !truth.await_batch()) {
      continue;
    }
    if (!paused_) {
      const SimTime wakeup = std::min(next_wakeup(), end);
      planned_ = now_ < frontier_ ? std::min(wakeup, frontier_) : now_ + settings.overrun_limit;
      timer.arm(clock.wall_of(planned_));
    }
    woken_ = false;
    while (!woken_ && !stopped_) {
      io_.run_one();
    }
    serve(kServedPaced);
  }
  // Devices may have been run further than their output was sent when the run was stopped.
  laps_.begin();
  transmit_due(now_);

  truth.join();
  if (stall_) {
    end_stall();
  }
  RunOutcome ended = outcome();
  clock_ = nullptr;
  pace_ = nullptr;
  truth_thread_ = nullptr;
  return ended;
}

void Executive::watch_lag(SimTime wanted) {
  if (stall_ && stall_->at < frontier_) {
    end_stall();
  }
  const Duration lag = wanted - std::min(frontier_, planned_);
  if (lag <= pace_->overrun_limit) {
    behind_ = behind_ && lag > Duration{0};
    return;
  }
  if (behind_) {
    return;
  }
  switch (pace_->overrun) {
    case OverrunPolicy::slip:
      // A stall longer than the limit makes the clock slip several times, and is one overrun.
      clock_->slip(lag);
      stall_ = {frontier_, (stall_ ? stall_->lag : Duration{0}) + lag};
      break;
    case OverrunPolicy::warn:
      behind_ = true;
      report_overrun({frontier_, lag});
      break;
    case OverrunPolicy::stop:
      fail(milliseconds_text(lag) + " behind the wall clock, allowed " +
           milliseconds_text(pace_->overrun_limit));
      report_overrun({frontier_, lag});
      break;
  }
}

void Executive::end_stall() {
  ++outcome_.slips;
  report_overrun(*std::exchange(stall_, std::nullopt));
}

void Executive::report_overrun(const Overrun& overrun) {
  ++outcome_.overruns;
  if (outcome_.first_overruns.size() < kOverrunsKept) {
    outcome_.first_overruns.push_back(overrun);
  }
  if (pace_->on_overrun) {
    pace_->on_overrun(overrun);
  }
}

RunOutcome Executive::outcome() const {
  RunOutcome so_far = outcome_;
  so_far.reached = now_;
  so_far.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  so_far.slipped = slipped();
  so_far.fault = fault_;
  return so_far;
}

}  // namespace rigwire::hil
