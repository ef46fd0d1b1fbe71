#include "hil/control/overrun_lines.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <string_view>

namespace rigwire::hil {
namespace {

constexpr std::chrono::seconds kLinePeriod{1};

double milliseconds(Duration span) {
  return 1e3 * to_seconds(span);
}

}  // namespace

void OverrunLines::take(const Overrun& overrun, WallTime now) {
  ++counted_;
  last_ = overrun;
  together_ += overrun.lag;
  if (now >= next_) {
    next_ = now + kLinePeriod;
    flush();
  }
}

void OverrunLines::flush() {
  // By OverrunPolicy.
  constexpr std::array<std::string_view, 3> kConsequences{"simulated time slipped by as much",
                                                          "wires are late until the lag is made up",
                                                          "the run ends"};
  if (counted_ == 0) {
    return;
  }
  const std::string stall =
      counted_ == 1
          ? fmt::format("the host stalled for {:.0f} ms at {:.3f} s", milliseconds(last_.lag),
                        to_seconds(last_.at))
          : fmt::format("the host stalled {} times up to {:.3f} s, for {:.0f} ms together",
                        counted_, to_seconds(last_.at), milliseconds(together_));
  use_(last_.at, stall + ": " + std::string(kConsequences[static_cast<std::size_t>(policy_)]));
  counted_ = 0;
  together_ = Duration{0};
}

}  // namespace rigwire::hil
