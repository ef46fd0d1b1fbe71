#include "sim/gnss/receiver_clock.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;

namespace {

constexpr double kMillisecond_s = 1e-3;
constexpr double kWarmUpBias_s = 0.5e-3;
constexpr double kStep_s = 1.0;

void check(const char* name, double value, double lower, double upper) {
  if (!(value >= lower && value <= upper)) {
    throw std::invalid_argument(std::string("receiver clock: ") + name + " is " +
                                std::to_string(value) + ", allowed are " + std::to_string(lower) +
                                " .. " + std::to_string(upper));
  }
}

/// Variance of the integral of a unit Gauss-Markov process over x correlation times, given its
/// start: 2x - 3 + 4 exp(-x) - exp(-2x), as a series where that cancels.
double integral_variance(double x) {
  if (x < 0.05) {
    return x * x * x * (2.0 / 3.0 - x * (0.5 - x * (7.0 / 30.0 - x * (1.0 / 12.0))));
  }
  return 2.0 * x - 3.0 + 4.0 * std::exp(-x) - std::exp(-2.0 * x);
}

/// The cubic through two biases with two rates over one second.
double hermite(double b0, double d0, double b1, double d1, double t) {
  const double rise = b1 - b0;
  return b0 + t * (d0 + t * ((3.0 * rise - 2.0 * d0 - d1) + t * (d0 + d1 - 2.0 * rise)));
}

double hermite_rate(double b0, double d0, double b1, double d1, double t) {
  const double rise = b1 - b0;
  return d0 + t * (2.0 * (3.0 * rise - 2.0 * d0 - d1) + 3.0 * t * (d0 + d1 - 2.0 * rise));
}

}  // namespace

void visit(fields::Visitor& v, ReceiverClockParameters& p) {
  v.number("clock_drift", p.drift, in("ppm").between(-100, 100),
           "Mean drift of the receiver's clock.");
  v.number("clock_drift_sigma", p.wander_sigma, in("ppm").between(0, 1),
           "Slow wander of the clock's drift, standard deviation.");
}

void validate(const ReceiverClockParameters& p) {
  fields::check(p);
  // These two no file can change.
  check("wander_correlation_s", p.wander_correlation_s, 1.0, 1e6);
  check("bias_limit_s", p.bias_limit_s, 5.1e-4, 1e-3);
}

ReceiverClock::ReceiverClock(const ReceiverClockParameters& parameters, std::uint64_t seed,
                             std::string_view name)
    : parameters_(parameters), random_(seed, name) {
  validate(parameters_);
  knots_[0] = {random_.uniform(-kWarmUpBias_s, kWarmUpBias_s),
               parameters_.wander_sigma * random_.gaussian()};
  for (std::size_t i = 1; i < knots_.size(); ++i) {
    knots_[i] = next(knots_[i - 1]);
  }
}

ReceiverClock::Knot ReceiverClock::next(const Knot& knot) {
  const double sigma = parameters_.wander_sigma;
  const double tau_s = parameters_.wander_correlation_s;
  const double x = kStep_s / tau_s;
  // Exact discretisation of rate and integrated rate, whose noises are correlated (Cholesky).
  const double keep = std::exp(-x);
  const double lost = -std::expm1(-x);
  const double rate_sigma = sigma * std::sqrt(-std::expm1(-2.0 * x));
  // The integral's part that goes with the rate's noise, and the part of its own.
  const double covariance = sigma * sigma * tau_s * lost * lost;
  const double along = rate_sigma > 0.0 ? covariance / rate_sigma : 0.0;
  const double variance = sigma * sigma * tau_s * tau_s * integral_variance(x);
  const double across = std::sqrt(std::max(0.0, variance - along * along));
  const double white_rate = random_.gaussian();
  const double white_integral = random_.gaussian();
  return {knot.bias_s + parameters_.drift * kStep_s + tau_s * lost * knot.wander +
              along * white_rate + across * white_integral,
          keep * knot.wander + rate_sigma * white_rate};
}

void ReceiverClock::reach(std::int64_t second) {
  while (second_ < second) {
    std::rotate(knots_.begin(), knots_.begin() + 1, knots_.end());
    knots_.back() = next(knots_[knots_.size() - 2]);
    ++second_;
  }
}

ReceiverClock::Reading ReceiverClock::read(double since_second_s) const {
  const double whole = std::clamp(std::floor(since_second_s), -1.0, 1.0);
  const auto i = static_cast<std::size_t>(whole + 1.0);
  const Knot& a = knots_[i];
  const Knot& b = knots_[i + 1];
  // Cubic Hermite between seconds, so that the drift is the bias's derivative.
  const double d0 = parameters_.drift + a.wander;
  const double d1 = parameters_.drift + b.wander;
  const double t = since_second_s - whole;
  return {hermite(a.bias_s, d0, b.bias_s, d1, t) - static_cast<double>(resets_) * kMillisecond_s,
          hermite_rate(a.bias_s, d0, b.bias_s, d1, t)};
}

ClockEpoch ReceiverClock::measure(SimTime wanted) {
  const std::int64_t wanted_ns = wanted.time_since_epoch().count();
  reach(wanted_ns / kSecond_ns);
  const double since_second_s = static_cast<double>(wanted_ns - second_ * kSecond_ns) * 1e-9;

  ClockEpoch epoch;
  for (double bias_s = read(since_second_s).bias_s; std::abs(bias_s) > parameters_.bias_limit_s;
       bias_s = read(since_second_s).bias_s) {
    resets_ += bias_s > 0.0 ? 1 : -1;
    epoch.reset = measured_before_;
  }
  measured_before_ = true;

  // Solved by substitution: measured = label - bias(measured).
  const double label_ms = std::round(read(since_second_s).bias_s / kMillisecond_s);
  const double label_s = label_ms * kMillisecond_s;
  // The drift is below 1e-4: each round gains four digits.
  for (int round = 0; round < 6; ++round) {
    epoch.measured_after_s = label_s - read(since_second_s + epoch.measured_after_s).bias_s;
  }
  epoch.measured_after = from_seconds(epoch.measured_after_s);
  epoch.label_offset = std::chrono::milliseconds(std::llround(label_ms));
  epoch.bias_s = label_s - epoch.measured_after_s;
  epoch.drift = read(since_second_s + epoch.measured_after_s).drift;
  return epoch;
}

}  // namespace rigwire::sim
