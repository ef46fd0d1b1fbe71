#include "sim/gnss/carrier_solution.h"

#include <cmath>
#include <numbers>
#include <string>

#include "sim/gnss/parameter_check.h"

namespace rigwire::sim {
namespace {

/// Fewer satellites in line of sight do not carry a float or service position.
constexpr int kLeastForFloat = 4;

}  // namespace

void validate(const CorrectionParameters& p) {
  constexpr double kLongest_s = 86'400.0;
  constexpr double kMost_m = 1000.0;
  check_parameter("corrections interval_s", p.interval_s, 0.01, kLongest_s);
  check_parameter("corrections latency_s", p.latency_s, 0.0, kLongest_s);
  check_parameter("corrections largest_age_s", p.largest_age_s, 0.0, kLongest_s);
  check_parameter("corrections sbas_share", p.sbas_share, 0.0, 1.0);
  check_parameter("corrections baseline_m", p.baseline_m, 0.0, 1e6);
  check_parameter("corrections fixed_horizontal_m", p.fixed_horizontal_m, 0.0, kMost_m);
  check_parameter("corrections fixed_vertical_m", p.fixed_vertical_m, 0.0, kMost_m);
  check_parameter("corrections fixed_per_baseline", p.fixed_per_baseline, 0.0, 1.0);
  check_parameter("corrections float_start_m", p.float_start_m, 0.0, kMost_m);
  check_parameter("corrections float_end_m", p.float_end_m, 0.0, kMost_m);
  check_parameter("corrections float_decay_s", p.float_decay_s, 0.001, kLongest_s);
  check_parameter("corrections first_fix_s", p.first_fix_s, 0.0, kLongest_s);
  check_parameter("corrections refix_shortest_s", p.refix_shortest_s, 0.0, p.refix_longest_s);
  check_parameter("corrections refix_longest_s", p.refix_longest_s, 0.0, kLongest_s);
  check_parameter("corrections least_satellites", p.least_satellites, kLeastForFloat, 40.0);
  check_parameter("corrections service_start_m", p.service_start_m, 0.0, kMost_m);
  check_parameter("corrections service_end_m", p.service_end_m, 0.0, kMost_m);
  check_parameter("corrections service_decay_s", p.service_decay_s, 0.001, kLongest_s);
  check_parameter("corrections vertical_ratio", p.vertical_ratio, 0.0, 100.0);
  check_parameter("corrections service_bridge_s", p.service_bridge_s, 0.0, kLongest_s);
  check_parameter("corrections correlation_s", p.correlation_s, 0.0, kLongest_s);
}

CarrierEngine::CarrierEngine(const CorrectionParameters& parameters, std::uint64_t seed,
                             std::string_view name)
    : parameters_(parameters),
      noise_(seed, std::string(name) + "/carrier"),
      waits_(seed, std::string(name) + "/fixing") {
  validate(parameters_);
}

/// Corrections are measured at whole intervals and arrive a latency later.
void CarrierEngine::receive(const CorrectionInput& input) {
  if (!input.link) {
    return;
  }
  // Newest whole interval that is older than the latency.
  const double arrived_s = to_seconds(input.time) - parameters_.latency_s;
  const SimTime newest = kStart + from_seconds(std::floor(arrived_s / parameters_.interval_s) *
                                               parameters_.interval_s);
  if (measured_ == kNever || newest > measured_) {
    measured_ = newest;
  }
}

void CarrierEngine::put_error(double horizontal_m, double vertical_m,
                              CorrectionOutput& output) const {
  output.error_ned_m = Eigen::Vector3d(horizontal_m * north_.value(), horizontal_m * east_.value(),
                                       vertical_m * down_.value());
  output.horizontal_sigma_m = horizontal_m;
  output.vertical_sigma_m = vertical_m;
}

void CarrierEngine::advance_rtk(const CorrectionInput& input, CorrectionOutput& output) {
  const CorrectionParameters& p = parameters_;
  const bool usable = output.differential && input.line_of_sight >= kLeastForFloat;
  if (!usable) {
    floating_ = kNever;
    enough_ = kNever;
    fixed_ = false;
    return;
  }
  if (floating_ == kNever) {
    floating_ = input.time;
  }
  if (input.line_of_sight < static_cast<int>(p.least_satellites)) {
    if (fixed_) {
      floating_ = input.time;
    }
    fixed_ = false;
    enough_ = kNever;
  } else if (enough_ == kNever) {
    enough_ = input.time;
    wait_s_ = fixed_before_ ? waits_.uniform(p.refix_shortest_s, p.refix_longest_s) : p.first_fix_s;
  }
  if (!fixed_ && enough_ != kNever && to_seconds(input.time - enough_) >= wait_s_) {
    fixed_ = true;
    fixed_before_ = true;
  }
  if (fixed_) {
    output.carrier = CarrierSolution::fixed;
    // Fixed: sigma + ppm x baseline; a radial sigma is sqrt(2) of each axis.
    const double by_baseline_m = p.fixed_per_baseline * p.baseline_m;
    put_error((p.fixed_horizontal_m + by_baseline_m) / std::numbers::sqrt2,
              p.fixed_vertical_m + by_baseline_m, output);
  } else {
    output.carrier = CarrierSolution::floating;
    // Float: exponential convergence from start to end.
    const double fade = std::exp(-to_seconds(input.time - floating_) / p.float_decay_s);
    const double sigma_m = p.float_end_m + (p.float_start_m - p.float_end_m) * fade;
    put_error(sigma_m, sigma_m * p.vertical_ratio, output);
  }
}

void CarrierEngine::advance_service(const CorrectionInput& input, CorrectionOutput& output) {
  const CorrectionParameters& p = parameters_;
  const bool usable = output.differential && input.line_of_sight >= kLeastForFloat;
  if (!usable) {
    if (good_ != kNever && to_seconds(input.time - good_) > p.service_bridge_s) {
      floating_ = kNever;
    }
    return;
  }
  if (floating_ == kNever) {
    floating_ = input.time;
  }
  good_ = input.time;
  output.carrier = CarrierSolution::floating;
  // Precise point service: exponential convergence from start to end.
  const double fade = std::exp(-to_seconds(input.time - floating_) / p.service_decay_s);
  const double sigma_m = p.service_end_m + (p.service_start_m - p.service_end_m) * fade;
  put_error(sigma_m, sigma_m * p.vertical_ratio, output);
}

CorrectionOutput CarrierEngine::advance(const CorrectionInput& input) {
  CorrectionOutput output;
  if (parameters_.kind == CorrectionKind::none) {
    return output;
  }
  const double step_s = last_ == kNever ? 0.0 : to_seconds(input.time - last_);
  last_ = input.time;
  for (GaussMarkov* axis : {&north_, &east_, &down_}) {
    axis->advance(step_s, parameters_.correlation_s, noise_);
  }
  receive(input);
  if (measured_ != kNever) {
    const double age_s = to_seconds(input.time - measured_);
    if (age_s <= parameters_.largest_age_s && input.has_position) {
      output.differential = true;
      output.age_s = age_s;
      if (parameters_.kind == CorrectionKind::sbas) {
        output.share = {parameters_.sbas_share, parameters_.sbas_share};
      }
    }
  }
  if (parameters_.kind == CorrectionKind::rtk) {
    advance_rtk(input, output);
  } else if (parameters_.kind == CorrectionKind::service) {
    advance_service(input, output);
  }
  return output;
}

}  // namespace rigwire::sim
