// Where faults of a running rig begin and end, whatever acts them out: one port for each list of
// faults that a device, bus or line has.
//
// A port keeps a book of its own beside that of whoever acts the faults out: in the run's time, and
// numbered alike, since both are filled in the same order.
#pragma once

#include <fmt/format.h>

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
  /// Gives a fault its keys; one without `at` begins at `soonest`. False: they are none, and
  /// whoever gave them has been told.
  using Fill = std::function<bool(const fields::Part& fault, SimTime soonest)>;

  virtual ~FaultPort() = default;

  /// What its faults can be.
  [[nodiscard]] virtual std::vector<fields::Named> kinds() const = 0;
  /// One more fault, filled by `fill`. nullopt where that says so. Throws std::invalid_argument for
  /// a fault that cannot be acted out here, or whose beginning is over.
  virtual std::optional<Id> begin(SimTime now, const Fill& fill) = 0;
  /// From `now` on, or as soon as it can, it holds no longer, begun or not. False: there is none of
  /// that number, or it is over.
  virtual bool end(Id id, SimTime now) = 0;
  /// In the order of their numbers, also what is over. `where` is left empty.
  [[nodiscard]] virtual std::vector<std::pair<Id, FaultWindow>> list() const = 0;
};

/// How the faults of one list are acted out. What is empty is done as said.
template <class Fault>
struct FaultActs {
  using Id = typename FaultBook<Fault>::Id;

  /// Throws std::invalid_argument for a fault that it refuses.
  std::function<void(const Fault&)> begin;
  std::function<bool(Id, SimTime)> end;
  /// The first instant from which a fault can act that is begun at that instant: at once.
  std::function<SimTime(SimTime)> soonest{};
  /// What it is called: its kind.
  std::function<std::string(const Fault&)> name{};
};

template <class Fault>
class FaultPortOf final : public FaultPort {
 public:
  /// `configured`: those that are acted out from the start, in the order of their numbers.
  FaultPortOf(const std::vector<Fault>& configured, FaultActs<Fault> acts)
      : acts_(std::move(acts)), book_(configured) {}

  [[nodiscard]] std::vector<fields::Named> kinds() const override { return fault_kinds<Fault>(); }

  std::optional<Id> begin(SimTime now, const Fill& fill) override {
    const SimTime soonest = acts_.soonest ? acts_.soonest(now) : now;
    Fault fault;
    if (!fill(fields::Part::of(fault), soonest)) {
      return std::nullopt;
    }
    if (fault.when.begin() < soonest) {
      throw std::invalid_argument(fmt::format("at: found {}, allowed {} and later",
                                              fields::print_duration(fault.when.at.count()),
                                              fields::print_duration((soonest - kStart).count())));
    }
    fields::check(fault);
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
      all.push_back({id,
                     {{},
                      acts_.name ? acts_.name(fault) : kind_name(fault),
                      fault.when.begin(),
                      fault.when.end()}});
    }
    return all;
  }

 private:
  FaultActs<Fault> acts_;
  FaultBook<Fault> book_;
};

/// Acted out by something with begin(fault) and end(id, now), which must outlive the port.
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
