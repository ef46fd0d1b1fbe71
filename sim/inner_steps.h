// A step of a machine as a run of inner steps, none longer than the machine wants.
#pragma once

#include <algorithm>
#include <optional>

#include "sim/samples/time.h"

namespace rigwire::sim {

/// Calls step(length_s) for parts of `span`, none longer than `longest`, the last one possibly
/// shorter, until `broken` says what is wrong. `time` advances by every part that left it empty. A
/// span that is not positive does nothing.
template <class Broken, class Step>
void run_inner_steps(Duration span, Duration longest, SimTime& time,
                     const std::optional<Broken>& broken, Step step) {
  while (span > Duration{0} && !broken) {
    const Duration part = std::min(span, longest);
    step(to_seconds(part));
    span -= part;
    if (!broken) {
      time += part;
    }
  }
}

}  // namespace rigwire::sim
