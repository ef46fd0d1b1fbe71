#include "sim/hydraulics/spool.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

Spool::Spool(const SpoolParameters& parameters) : parameters_(parameters) {}

bool Spool::command(double opening) {
  if (std::isnan(opening)) {
    return false;
  }
  command_ = std::clamp(opening, -1.0, 1.0);
  return true;
}

void Spool::step(double span_s) {
  const double error = command_ - position_;
  const double distance = std::abs(error);
  if (distance == 0.0 || span_s <= 0.0) {
    return;
  }
  const double rate = parameters_.rate_limit_per_s;
  const double tau = parameters_.time_constant_s;
  // At the rate limit until the lag alone would be slower, exponentially from there.
  const double linear_s = std::max(0.0, distance / rate - tau);
  double left = distance;
  if (span_s <= linear_s) {
    left -= rate * span_s;
  } else {
    left -= rate * linear_s;
    left *= tau > 0.0 ? std::exp(-(span_s - linear_s) / tau) : 0.0;
  }
  position_ = left <= 1e-12 ? command_ : command_ - std::copysign(left, error);
}

double Spool::flow_request_m3ps() const {
  // Pressure compensated: flow in proportion to travel beyond the dead band.
  const double open = std::abs(position_) - parameters_.dead_band;
  if (open <= 0.0) {
    return 0.0;
  }
  const double share = position_ < 0.0 ? parameters_.back_share : 1.0;
  return std::copysign(share * parameters_.flow_max_m3ps * open / (1.0 - parameters_.dead_band),
                       position_);
}

}  // namespace rigwire::sim
