// Timed faults in one common form: when one holds and what it does; and the book that keeps the
// faults of one target.
//
// What a fault does is an alternative of a variant, declared where it acts; each carries its name
// (`static constexpr fields::Named kNamed`) and its keys (`visit`). A structure of fault is
//
//   struct LidarFault {
//     FaultPeriod when;
//     std::variant<LostPackets, MotorStall> what;
//   };
//
// with members that name its target, if any, between the two. A fault that does not hold costs a
// comparison and draws no random number, so that one which is begun during a run changes nothing
// else.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "fields/visitor.h"
#include "sim/samples/time.h"

namespace rigwire {

/// What must become true before a fault begins: a quantity of the machine beyond a value.
struct FaultCondition {
  std::string quantity{};  ///< Name of the quantity, as `read` has it; empty: none.
  bool above = true;       ///< Wanted above the value, else below.
  double value = 0.0;      ///< In the quantity's unit.

  friend bool operator==(const FaultCondition&, const FaultCondition&) = default;
};

/// When a fault holds: within its extent [begin(), end()), the whole of it or again and again.
/// docs/faults.md has the same for users.
struct FaultPeriod {
  Duration at{0};  ///< From the start of the run.
  /// Length of the extent; with `every` alone, of each repetition.
  std::optional<Duration> length{};
  std::optional<Duration> until{};  ///< The extent's end, from the start of the run.
  Duration every{0};                ///< From one repetition to the next; 0: it holds once.
  double duty = 0.0;                ///< Share of `every` for which it holds; 0: `length`.
  double probability = 1.0;         ///< Probability that it happens, each repetition by itself.
  FaultCondition when{};            ///< The fault begins only once this is fulfilled.
  std::uint64_t stream = 0;         ///< Seed of what is drawn for `probability`.
  SimTime ordered{};                ///< When it was ordered; for a rig file's fault the start.

  [[nodiscard]] bool waits() const { return !when.quantity.empty(); }
  [[nodiscard]] SimTime begin() const { return waits() ? kNever : kStart + at; }
  [[nodiscard]] SimTime end() const { return waits() ? kNever : latest_end(); }
  /// Widest bounds of the extent, whatever the fault waits for.
  [[nodiscard]] SimTime earliest_begin() const { return kStart + at; }
  [[nodiscard]] SimTime latest_end() const;
  [[nodiscard]] bool holds(SimTime now) const {
    return begin() <= now && now < end() && (once() || holds_again(now));
  }
  /// Returns when the repetition that `now` is in began to hold. Precondition: begin() <= now.
  [[nodiscard]] SimTime began(SimTime now) const {
    return every == Duration{0} ? begin() : begin() + every * ((now - begin()) / every);
  }
  /// Returns the next instant after `after` at which it may begin to hold or cease; kNever without
  /// one.
  [[nodiscard]] SimTime next_edge(SimTime after) const;
  /// Ends it at `now`, begun or not. Precondition: now < end().
  void cut(SimTime now);

  friend bool operator==(const FaultPeriod&, const FaultPeriod&) = default;

 private:
  [[nodiscard]] bool once() const { return every == Duration{0} && probability >= 1.0; }
  [[nodiscard]] bool holds_again(SimTime now) const;
  [[nodiscard]] Duration held() const;
};

/// Its keys among those of the fault: at, for, until, every, duty, probability and when.
void visit(fields::Visitor& v, FaultCondition& p);
void visit(fields::Visitor& v, FaultPeriod& p);

/// The key `ramp` of a kind with a magnitude, which grows from nothing to all of it in that time
/// whenever the fault begins to hold. The kind has `Duration ramp` and `void grow(double share)`.
void visit_ramp(fields::Visitor& v, Duration& ramp);
template <class What>
[[nodiscard]] What grown(What what, const FaultPeriod& when, SimTime now) {
  if (what.ramp > Duration{0} && now - when.began(now) < what.ramp) {
    what.grow(to_seconds(now - when.began(now)) / to_seconds(what.ramp));
  }
  return what;
}

/// Visits the keys of a fault that names no target: when, and what.
template <class Fault>
void visit_fault(fields::Visitor& v, Fault& p) {
  visit(v, p.when);
  v.required("type");
  v.variant("type", p.what, "Kind of the fault.");
}

template <class Fault>
class FaultBook {
 public:
  using Id = std::uint32_t;
  struct Entry {
    Id id;
    Fault fault;
  };

  FaultBook() = default;
  /// Keeps the order of `faults`, which may decide when several hold at once.
  explicit FaultBook(std::vector<Fault> faults) {
    for (Fault& fault : faults) {
      add(std::move(fault));
    }
  }

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  /// Returns all faults, including those that are over.
  [[nodiscard]] std::span<const Entry> list() const { return entries_; }

  /// Number of faults that are over and have been dropped from the list.
  [[nodiscard]] std::uint64_t forgotten() const { return forgotten_; }
  [[nodiscard]] bool has(Id id) const {
    return std::ranges::binary_search(entries_, id, {}, &Entry::id);
  }

  /// Precondition: has(id).
  [[nodiscard]] const Fault& find(Id id) const {
    return std::ranges::lower_bound(entries_, id, {}, &Entry::id)->fault;
  }

  /// Faults that are over are kept until there are this many faults, and for kLookBack at least.
  static constexpr std::size_t kKept = 1000;
  static constexpr Duration kLookBack = std::chrono::seconds{60};

  /// Appends a fault and returns its number. Allocates. When there are kKept, first drops those
  /// that were over kLookBack ago.
  Id add(Fault fault) {
    if (entries_.size() >= kKept) {
      const SimTime past = fault.when.ordered - kLookBack;
      const auto over = [&](const Entry& entry) { return entry.fault.when.end() <= past; };
      const std::size_t before = entries_.size();
      std::erase_if(entries_, over);
      forgotten_ += before - entries_.size();
    }
    entries_.push_back({next_id_, std::move(fault)});
    return next_id_++;
  }
  /// Ends a fault at `now`, begun or not. Returns false if there is none of that number, or it is
  /// over.
  bool end(Id id, SimTime now) {
    const auto found = std::ranges::find(entries_, id, &Entry::id);
    if (found == entries_.end() || found->fault.when.end() <= now) {
      return false;
    }
    found->fault.when.cut(now);
    return true;
  }

  /// Returns the first fault that holds and is a `What`; nullptr without one. Valid until the book
  /// changes.
  template <class What>
  [[nodiscard]] const What* first(SimTime now) const {
    for (const Entry& entry : entries_) {
      if (const What* what = std::get_if<What>(&entry.fault.what);
          what != nullptr && entry.fault.when.holds(now)) {
        return what;
      }
    }
    return nullptr;
  }
  /// Returns first() of a kind with a magnitude, as far as it has grown by then.
  template <class What>
  [[nodiscard]] std::optional<What> first_grown(SimTime now) const {
    for (const Entry& entry : entries_) {
      if (const What* what = std::get_if<What>(&entry.fault.what);
          what != nullptr && entry.fault.when.holds(now)) {
        return grown(*what, entry.fault.when, now);
      }
    }
    return std::nullopt;
  }
  /// Calls take(fault) for each that holds, in the order of the list.
  template <class Take>
  void each(SimTime now, Take take) const {
    for (const Entry& entry : entries_) {
      if (entry.fault.when.holds(now)) {
        take(entry.fault);
      }
    }
  }
  /// Returns when the next fault of the kinds `What` may begin to hold or cease, later than
  /// `after`; kNever without one. Without a kind: of all faults.
  template <class... What>
  [[nodiscard]] SimTime next_change(SimTime after) const {
    SimTime next = kNever;
    for (const Entry& entry : entries_) {
      if (sizeof...(What) == 0 || (std::holds_alternative<What>(entry.fault.what) || ...)) {
        next = std::min(next, entry.fault.when.next_edge(after));
      }
    }
    return next;
  }
  /// Returns the first instant from `from` on at which whether a `What` holds differs from `held`;
  /// kNever: it stays so.
  template <class What>
  [[nodiscard]] SimTime next_turn(SimTime from, bool held) const {
    while (from != kNever && (first<What>(from) != nullptr) == held) {
      from = next_change<What>(from);
    }
    return from;
  }

 private:
  std::vector<Entry> entries_;
  std::uint64_t forgotten_ = 0;
  Id next_id_ = 1;
};

/// A change for other copies of a book: one more fault, or the end of one.
template <class Fault>
struct FaultChange {
  std::optional<Fault> begin;              ///< Empty: a fault ends.
  typename FaultBook<Fault>::Id end_of{};  ///< Number of the fault that ends.
  SimTime end_at{};                        ///< When it ends.

  void apply(FaultBook<Fault>& book) const {
    if (begin) {
      book.add(*begin);
    } else {
      book.end(end_of, end_at);
    }
  }
};

}  // namespace rigwire
