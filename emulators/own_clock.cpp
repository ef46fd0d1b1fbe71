#include "emulators/own_clock.h"

#include <algorithm>
#include <cmath>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

using fields::in;

void visit(fields::Visitor& v, OwnClockSettings& p) {
  v.number("tolerance", p.tolerance, in("ppm").between(0, 1000),
           "The clock's error is drawn from within, to both sides; 0 = nothing is drawn.");
  v.number("error", p.error, in("ppm").between(-1000, 1000),
           "Error besides what is drawn; positive runs fast.");
  v.duration("jitter", p.jitter, {0, 10'000'000}, "A frame may be late by up to this.");
}

void validate(const OwnClockSettings& settings) {
  fields::check(settings);
}

OwnClock::OwnClock(double error, SimTime start, Duration period)
    : start_(start),
      own_period_(period),
      run_period_(std::llround(static_cast<double>(period.count()) / (1.0 + error))) {}

double OwnClock::error() const {
  return static_cast<double>((own_period_ - run_period_).count()) /
         static_cast<double>(run_period_.count());
}

SimTime OwnClock::run_time(SimTime own) const {
  if (own <= start_ || own == kNever) {
    return own;
  }
  // floor(own * run_period / own_period) without overflow: whole periods, then the rest.
  const std::int64_t since = (own - start_).count();
  const std::int64_t periods = since / own_period_.count();
  const std::int64_t rest = since % own_period_.count();
  return start_ + periods * run_period_ +
         Duration{rest * run_period_.count() / own_period_.count()};
}

SimTime OwnClock::own_time(SimTime run) const {
  if (run <= start_ || run == kNever) {
    return run;
  }
  // The largest x with floor(x * run_period / own_period) <= run.
  const std::int64_t since = (run - start_).count();
  const std::int64_t periods = since / run_period_.count();
  const std::int64_t rest = since % run_period_.count();
  return start_ + periods * own_period_ +
         Duration{((rest + 1) * own_period_.count() - 1) / run_period_.count()};
}

double drawn_clock_error(const OwnClockSettings& settings, std::uint64_t seed) {
  if (settings.tolerance == 0.0) {
    return settings.error;
  }
  return settings.error + settings.tolerance * (2.0 * RandomBits(seed).uniform() - 1.0);
}

void OwnClockOutput::send(SimTime due, const protocols::can::Frame& frame) {
  if (due != last_own_due_) {
    last_own_due_ = due;
    const Duration late =
        jitter_ == Duration{0}
            ? Duration{0}
            : Duration{std::llround(random_.uniform() * static_cast<double>(jitter_.count()))};
    last_due_ = std::max(last_due_, clock_.run_time(due) + late);
  }
  output_.send(last_due_, frame);
}

}  // namespace rigwire::emulators
