// Faults in time, one shape for all: when one holds and what it does; and the book in which whoever
// acts them out keeps them.
//
// What a fault does is an alternative of a variant, declared where it acts; each carries its name
// (`static constexpr fields::Named kNamed`) and its keys (`visit`). A structure of fault is
//
//   struct LidarFault {
//     FaultPeriod when;
//     std::variant<LostPackets, MotorStall> what;
//   };
//
// with whatever says of whom it is between the two. A fault that does not hold costs a comparison
// and draws no random number, so that one which is begun during a run changes nothing else.
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
  std::string quantity{};  ///< As `read` names it; empty: nothing is waited for.
  bool above = true;       ///< Wanted above the value, else below.
  double value = 0.0;      ///< In the quantity's unit.

  friend bool operator==(const FaultCondition&, const FaultCondition&) = default;
};

/// When a fault holds: within its extent [begin(), end()), the whole of it or again and again.
/// docs/faults.md has the same for users.
struct FaultPeriod {
  Duration at{0};                    ///< From the start of the run.
  std::optional<Duration> length{};  ///< Of the extent; of each repetition where `every` alone.
  std::optional<Duration> until{};   ///< The extent's end, from the start of the run.
  Duration every{0};                 ///< From one repetition to the next; 0: it holds once.
  double duty = 0.0;                 ///< Share of `every` for which it holds; 0: `length`.
  double probability = 1.0;          ///< With which it happens, each repetition by itself.
  FaultCondition when{};             ///< While it is not met, the fault has not begun.
  std::uint64_t stream = 0;          ///< Seed of what is drawn for `probability`.
  SimTime ordered{};                 ///< When it was begun; of a rig's file the start.

  [[nodiscard]] bool waits() const { return !when.quantity.empty(); }
  [[nodiscard]] SimTime begin() const { return waits() ? kNever : kStart + at; }
  [[nodiscard]] SimTime end() const { return waits() ? kNever : latest_end(); }
  /// Where the extent lies at the widest, whatever it waits for.
  [[nodiscard]] SimTime earliest_begin() const { return kStart + at; }
  [[nodiscard]] SimTime latest_end() const;
  [[nodiscard]] bool holds(SimTime now) const {
    return begin() <= now && now < end() && (once() || holds_again(now));
  }
  /// When it began to hold, of the repetition that `now` is in. Precondition: begin() <= now.
  [[nodiscard]] SimTime began(SimTime now) const {
    return every == Duration{0} ? begin() : begin() + every * ((now - begin()) / every);
  }
  /// The next instant after that one at which it may begin to hold or cease; kNever without one.
  [[nodiscard]] SimTime next_edge(SimTime after) const;
  /// From `now` on it holds no longer, begun or not. Precondition: now < end().
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

/// The keys of a fault that is of nobody in particular: when, and what.
template <class Fault>
void visit_fault(fields::Visitor& v, Fault& p) {
  visit(v, p.when);
  v.required("type");
  v.variant("type", p.what, "Which fault it is.");
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
  /// In that order: where several hold at once it may decide.
  explicit FaultBook(std::vector<Fault> faults) {
    for (Fault& fault : faults) {
      add(std::move(fault));
    }
  }

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  /// Also what is over.
  [[nodiscard]] std::span<const Entry> list() const { return entries_; }

  /// How many of those that are over are not in the list any more.
  [[nodiscard]] std::uint64_t forgotten() const { return forgotten_; }
  [[nodiscard]] bool has(Id id) const {
    return std::ranges::binary_search(entries_, id, {}, &Entry::id);
  }

  /// Precondition: it is one of the list.
  [[nodiscard]] const Fault& find(Id id) const {
    return std::ranges::lower_bound(entries_, id, {}, &Entry::id)->fault;
  }

  /// Faults that are over are kept up to this many, and as long as somebody may look back.
  static constexpr std::size_t kKept = 1000;
  static constexpr Duration kLookBack = std::chrono::seconds{60};

  /// One more, after the others. Allocates. Where there are many, the oldest that are over are
  /// forgotten.
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
  /// From `now` on it holds no longer, begun or not. False: there is none of that number, or it is
  /// over.
  bool end(Id id, SimTime now) {
    const auto found = std::ranges::find(entries_, id, &Entry::id);
    if (found == entries_.end() || found->fault.when.end() <= now) {
      return false;
    }
    found->fault.when.cut(now);
    return true;
  }

  /// What the first of those does that holds and is a `What`; nullptr without one. Valid until the
  /// book changes.
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
  /// The same of a kind with a magnitude, as far as it has grown by then.
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
  /// take(fault) for each that holds, in the order of the list.
  template <class Take>
  void each(SimTime now, Take take) const {
    for (const Entry& entry : entries_) {
      if (entry.fault.when.holds(now)) {
        take(entry.fault);
      }
    }
  }
  /// When the next fault that is one of those may begin to hold or cease, later than `after`;
  /// kNever without one. Without a type: of all.
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
  /// The first instant from `from` on at which it is otherwise than `held` whether a `What` holds;
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

/// To whoever keeps the same book elsewhere: one fault more, or the end of one.
template <class Fault>
struct FaultChange {
  std::optional<Fault> begin;              ///< Nothing: it is an end.
  typename FaultBook<Fault>::Id end_of{};  ///< The number of the one that ends,
  SimTime end_at{};                        ///< and when.

  void apply(FaultBook<Fault>& book) const {
    if (begin) {
      book.add(*begin);
    } else {
      book.end(end_of, end_at);
    }
  }
};

}  // namespace rigwire
