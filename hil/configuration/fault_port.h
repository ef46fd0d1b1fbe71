// Begins and ends faults of a running rig, whatever simulates them: one port for each list of
// faults that a device, bus or line has.
//
// A port keeps its own list beside that of the code that simulates the faults: in the run's time,
// and with the same numbers, since both are filled in the same order.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "fields/check.h"
#include "fields/visitor.h"
#include "hil/configuration/fault_window.h"
#include "sim/samples/fault_book.h"

namespace rigwire::hil {

class FaultPort {
 public:
  using Id = std::uint32_t;
  /// Gives a fault its keys; one without `at` begins at `soonest`. False: the keys are wrong, and
  /// that has been reported.
  using Fill = std::function<bool(const fields::Part& fault, SimTime soonest)>;
  using StreamOf = std::function<std::uint64_t(const std::string& name, Duration at)>;

  virtual ~FaultPort() = default;

  /// Returns the kinds that its faults can have.
  [[nodiscard]] virtual std::vector<fields::Named> kinds() const = 0;
  /// Begins a fault, filled by `fill`; nullopt when `fill` returns false. Throws
  /// std::invalid_argument for a fault that cannot be simulated here, or whose beginning is over.
  /// `stream_of` is the seed of what is drawn for it (fault_stream()).
  virtual std::optional<Id> begin(SimTime now, const Fill& fill, const StreamOf& stream_of) = 0;
  /// Begins a fault whose condition has become true: at `at`, or as soon as it can, under the
  /// number that is returned. nullopt: it would be over by then.
  virtual std::optional<Id> meet(Id id, SimTime now, SimTime at) = 0;
  /// Ends a fault, begun or not, at `now`, or as soon as it can. False: there is none of that
  /// number, or it is over.
  virtual bool end(Id id, SimTime now) = 0;
  /// Returns the faults in the order of their numbers, ended ones included, as far as they are
  /// kept. `where` is empty.
  [[nodiscard]] virtual std::vector<std::pair<Id, FaultWindow>> list() const = 0;
  /// Returns the conditions of the waiting faults.
  struct Waiting {
    Id id;
    FaultCondition condition;
    SimTime from{};  ///< Earliest begin.
  };
  [[nodiscard]] virtual std::vector<Waiting> waiting() const = 0;
};

/// How the faults of one list are simulated. Empty members have the stated default.
template <class Fault>
struct FaultActs {
  using Id = typename FaultBook<Fault>::Id;

  /// Throws std::invalid_argument for a fault that it refuses.
  std::function<void(const Fault&)> begin;
  std::function<bool(Id, SimTime)> end;
  /// Returns the first instant at which a fault can act that is begun at that instant. Default: at
  /// once.
  std::function<SimTime(SimTime)> soonest{};
  /// Returns a fault's name. Default: its kind.
  std::function<std::string(const Fault&)> name{};
  /// Kinds that it can have. Default: every kind of `Fault`.
  std::vector<fields::Named> kinds = fault_kinds<Fault>();
};

template <class Fault>
class FaultPortOf final : public FaultPort {
 public:
  /// `configured`: those that are simulated from the start, in the order of their numbers.
  FaultPortOf(const std::vector<Fault>& configured, FaultActs<Fault> acts)
      : acts_(std::move(acts)), book_(configured) {}

  [[nodiscard]] std::vector<fields::Named> kinds() const override { return acts_.kinds; }

  std::optional<Id> begin(SimTime now, const Fill& fill, const StreamOf& stream_of) override {
    const SimTime soonest = acts_.soonest ? acts_.soonest(now) : now;
    Fault fault;
    if (!fill(fields::Part::of(fault), soonest)) {
      return std::nullopt;
    }
    if (fault.when.earliest_begin() < soonest) {
      throw std::invalid_argument(fmt::format("at: found {}, allowed {} and later",
                                              fields::print_duration(fault.when.at.count()),
                                              fields::print_duration((soonest - kStart).count())));
    }
    fields::check(fault);
    fault.when.ordered = now;
    fault.when.stream = stream_of(name_of(fault), fault.when.at);
    acts_.begin(fault);
    return book_.add(std::move(fault));
  }

  std::optional<Id> meet(Id id, SimTime now, SimTime at) override {
    Fault fault = book_.find(id);
    const SimTime begin = std::max(at, acts_.soonest ? acts_.soonest(at) : now);
    // Replaces the waiting fault, which never began, by one that begins.
    end(id, now);
    fault.when.when = {};
    fault.when.at = begin - kStart;
    fault.when.ordered = now;
    if (fault.when.end() <= begin) {
      return std::nullopt;
    }
    acts_.begin(fault);
    return book_.add(std::move(fault));
  }

  bool end(Id id, SimTime now) override {
    const SimTime soonest = acts_.soonest ? acts_.soonest(now) : now;
    return book_.end(id, soonest) && acts_.end(id, soonest);
  }

  [[nodiscard]] std::vector<std::pair<Id, FaultWindow>> list() const override {
    std::vector<std::pair<Id, FaultWindow>> all;
    for (const auto& [id, fault] : book_.list()) {
      all.emplace_back(id, fault_window({}, name_of(fault), fault.when));
    }
    return all;
  }

  [[nodiscard]] std::vector<Waiting> waiting() const override {
    std::vector<Waiting> all;
    for (const auto& [id, fault] : book_.list()) {
      if (fault.when.waits()) {
        all.push_back({id, fault.when.when, fault.when.earliest_begin()});
      }
    }
    return all;
  }

 private:
  [[nodiscard]] std::string name_of(const Fault& fault) const {
    return acts_.name ? acts_.name(fault) : kind_name(fault);
  }

  FaultActs<Fault> acts_;
  FaultBook<Fault> book_;
};

/// Lets `actor`, which must outlive the port, simulate the faults by begin(fault) and end(id, now).
template <class Fault, class Actor>
[[nodiscard]] FaultActs<Fault> acted_by(Actor& actor) {
  return {[&actor](const Fault& fault) { actor.begin(fault); },
          [&actor](std::uint32_t id, SimTime now) { return actor.end(id, now); }};
}

template <class Fault>
[[nodiscard]] std::unique_ptr<FaultPort> make_fault_port(const std::vector<Fault>& configured,
                                                         FaultActs<Fault> acts) {
  return std::make_unique<FaultPortOf<Fault>>(configured, std::move(acts));
}

}  // namespace rigwire::hil
