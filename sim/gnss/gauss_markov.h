// First-order Gauss-Markov process of variance 1, discretised exactly: the same statistics whatever
// the step.
//
//   x(t + h) = e x(t) + sqrt(1 - e^2) w,   e = exp(-h / tau),   w white of variance 1
#pragma once

#include <cmath>

#include "sim/random.h"

namespace rigwire::sim {

class GaussMarkov {
 public:
  /// Draws a value that remembers nothing.
  void redraw(RandomStream& random) {
    value_ = random.gaussian();
    drawn_ = true;
  }
  /// One draw of `random`, whatever the step. The first call redraws; `correlation_s` 0 is white.
  void advance(double step_s, double correlation_s, RandomStream& random) {
    const double white = random.gaussian();
    if (!drawn_ || !(correlation_s > 0.0)) {
      value_ = white;
      drawn_ = true;
      return;
    }
    const double keep = std::exp(-step_s / correlation_s);
    value_ = keep * value_ + std::sqrt(1.0 - keep * keep) * white;
  }
  [[nodiscard]] double value() const { return value_; }

 private:
  double value_ = 0.0;
  bool drawn_ = false;
};

}  // namespace rigwire::sim
