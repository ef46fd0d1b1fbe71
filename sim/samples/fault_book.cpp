#include "sim/samples/fault_book.h"

#include "fields/units.h"

namespace rigwire {
namespace {

using fields::in;
using fields::kYear_ns;

constexpr Duration kShortestRepetition = std::chrono::milliseconds{1};
constexpr double kLeastProbability = 1e-3;

/// Uniform in [0, 1), of that repetition: SplitMix64 (Steele, Lea and Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014), at any place of its sequence.
double drawn(std::uint64_t stream, std::int64_t repetition) {
  std::uint64_t z = stream + 0x9E3779B97F4A7C15U * (static_cast<std::uint64_t>(repetition) + 1U);
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  z ^= z >> 31U;
  return static_cast<double>(z >> 11U) * 0x1.0p-53;
}

}  // namespace

SimTime FaultPeriod::latest_end() const {
  if (until) {
    return kStart + *until;
  }
  if (waits()) {
    return kNever;  // `length` counts from a beginning that is not known
  }
  const bool is_of_extent = every == Duration{0} || duty > 0.0;
  return length && is_of_extent ? kStart + at + *length : kNever;
}

Duration FaultPeriod::held() const {
  return duty > 0.0 ? from_seconds(duty * to_seconds(every)) : length.value_or(every);
}

bool FaultPeriod::holds_again(SimTime now) const {
  const Duration since = now - begin();
  const std::int64_t repetition = every == Duration{0} ? 0 : since / every;
  return (every == Duration{0} || since - every * repetition < held()) &&
         (probability >= 1.0 || drawn(stream, repetition) < probability);
}

SimTime FaultPeriod::next_edge(SimTime after) const {
  if (after < begin()) {
    return begin();
  }
  if (after >= end()) {
    return kNever;
  }
  if (every == Duration{0}) {
    return end();
  }
  const SimTime began_last = began(after);
  const SimTime edge = after < began_last + held() ? began_last + held() : began_last + every;
  return std::min(edge, end());
}

void FaultPeriod::cut(SimTime now) {
  // What still waits has not begun.
  at = waits() ? now - kStart : std::min(at, now - kStart);
  when = {};
  if (every == Duration{0}) {
    length = now - begin();
    until.reset();
  } else {
    until = now - kStart;
  }
}

void visit(fields::Visitor& v, FaultCondition& p) {
  v.text("quantity", p.quantity, "Name of a quantity of the machine, as `read` has it.");
  v.boolean("above", p.above, "Whether it is wanted above the value; else below.");
  v.number("value", p.value, fields::plain(), "In the quantity's unit.");
}

void visit(fields::Visitor& v, FaultPeriod& p) {
  // In a file 0 is no end; in a structure it would be a fault that never holds.
  const bool empty = p.length && *p.length <= Duration{0};
  const auto open_ended = [&v](std::string_view key, std::optional<Duration>& member,
                               std::string_view text) {
    Duration span = member.value_or(Duration{0});
    v.duration(key, span, {0, kYear_ns}, text);
    member = span == Duration{0} ? std::nullopt : std::optional(span);
  };
  v.duration("at", p.at, {0, kYear_ns},
             "When it begins, from the start of the run; with `when` not before.");
  open_ended("for", p.length,
             "How long it lasts, with `every` alone each repetition; 0 = to the end of the run.");
  open_ended("until", p.until, "When it is over, from the start of the run; 0 = as `for` says.");
  v.duration("every", p.every, {0, kYear_ns},
             "From the begin of one repetition to the next; 0 = it happens once.");
  v.number("duty", p.duty, in("%").between(0, 99.9),
           "Share of `every` for which each repetition lasts; 0 = as `for` says.");
  v.number("probability", p.probability, in("%").between(100.0 * kLeastProbability, 100),
           "Probability with which it happens, of each repetition by itself.");
  v.section("when", p.when, "It begins when this becomes true, once.");

  const auto text = [](Duration span) { return fields::print_duration(span.count()); };
  v.check(!empty, "for", "the fault has no length", text(Duration{0}), "longer, or none: no end");
  v.check(!p.until || *p.until > p.at, "until", "the fault is over before it begins",
          text(p.until.value_or(Duration{0})), "later than at: " + text(p.at));
  if (p.every == Duration{0}) {
    v.check(!p.until || !p.length, "until", "two ends of one fault", "for and until",
            "one of them");
    v.check(p.duty == 0.0, "duty", "nothing is repeated", "duty without every",
            "with every: its period");
    return;
  }
  v.check(p.every >= kShortestRepetition, "every", "out of range", text(p.every),
          text(kShortestRepetition) + " and more");
  if (p.duty > 0.0) {
    v.check(!p.until || !p.length, "until", "two ends of one fault", "for and until",
            "one of them; with duty both are of all repetitions");
    v.check(!p.length || *p.length >= p.every, "for", "shorter than one repetition",
            text(p.length.value_or(Duration{0})), "at least every: " + text(p.every));
  } else {
    v.check(p.length && *p.length < p.every, "for", "the repetitions have no length of their own",
            p.length ? text(*p.length) : "nothing",
            "less than every: " + text(p.every) + ", or duty");
  }
}

void visit_ramp(fields::Visitor& v, Duration& ramp) {
  v.duration("ramp", ramp, {0, kYear_ns},
             "In which it grows from nothing, evenly, whenever it begins.");
}

}  // namespace rigwire
