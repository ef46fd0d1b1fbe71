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
#include <utility>
#include <variant>
#include <vector>

#include "fields/visitor.h"
#include "sim/samples/time.h"

namespace rigwire {

/// It holds in [begin(), end()).
struct FaultPeriod {
  Duration at{0};                                             ///< From the start of the run.
  std::optional<Duration> length = std::chrono::seconds{10};  ///< Nothing: to the end of the run.

  [[nodiscard]] constexpr SimTime begin() const { return kStart + at; }
  [[nodiscard]] constexpr SimTime end() const { return length ? begin() + *length : kNever; }
  [[nodiscard]] constexpr bool holds(SimTime now) const { return begin() <= now && now < end(); }

  friend bool operator==(const FaultPeriod&, const FaultPeriod&) = default;
};

/// Its keys `at` and `for`, among those of the fault.
void visit(fields::Visitor& v, FaultPeriod& p);
/// The same where `for: 0 s` is to the end of the run.
void visit_open_ended(fields::Visitor& v, FaultPeriod& p);

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

  /// Precondition: it is one of the list.
  [[nodiscard]] const Fault& find(Id id) const {
    return std::ranges::find(entries_, id, &Entry::id)->fault;
  }

  /// One more, after the others. Allocates.
  Id add(Fault fault) {
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
    FaultPeriod& when = found->fault.when;
    when.at = std::min(when.at, now - kStart);
    when.length = now - when.begin();
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
  /// take(fault) for each that holds, in the order of the list.
  template <class Take>
  void each(SimTime now, Take take) const {
    for (const Entry& entry : entries_) {
      if (entry.fault.when.holds(now)) {
        take(entry.fault);
      }
    }
  }
  /// When the next fault that is one of those begins or ends, later than `after`; kNever without
  /// one. Without a type: of all.
  template <class... What>
  [[nodiscard]] SimTime next_change(SimTime after) const {
    SimTime next = kNever;
    for (const Entry& entry : entries_) {
      if (sizeof...(What) == 0 || (std::holds_alternative<What>(entry.fault.what) || ...)) {
        for (const SimTime edge : {entry.fault.when.begin(), entry.fault.when.end()}) {
          next = edge > after ? std::min(next, edge) : next;
        }
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
