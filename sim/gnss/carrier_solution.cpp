#include "sim/gnss/carrier_solution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

/// Fewer satellites in line of sight do not carry a float or service position.
constexpr int kLeastForFloat = 4;

constexpr std::array<fields::Choice<CorrectionKind>, 5> kCorrectionKinds{
    {{CorrectionKind::none, "none", "The receiver alone."},
     {CorrectionKind::sbas, "sbas", "Orbits, clocks and ionosphere by SBAS."},
     {CorrectionKind::service, "service", "Precise point positions (StarFire SF2 class)."},
     {CorrectionKind::rtk, "rtk",
      "Real-time kinematic, by a base station's messages as they arrive at the device's ports."},
     {CorrectionKind::assumed_rtk, "assumed_rtk",
      "Real-time kinematic by corrections that are assumed to arrive; not causal."}}};

/// Kinds whose corrections come at an interval of their own.
bool comes_by_itself(CorrectionKind kind) {
  return kind != CorrectionKind::none && kind != CorrectionKind::rtk;
}
bool is_kinematic(CorrectionKind kind) {
  return kind == CorrectionKind::rtk || kind == CorrectionKind::assumed_rtk;
}

// Times to fix, see the header.
constexpr double kShortest_s = 4.0;
constexpr double kLongestOfMean = 1.2;
constexpr double kRemembered_s = 1.0;  ///< To fix by integers that are remembered.
constexpr int kGammaShape = 16;
/// Integers fail their test so often, per second and square of the share of unsound carriers beyond
/// the usual one.
constexpr double kFailures_ps = 12.0;
constexpr double kUsuallyUnsound = 0.2;
/// So many unsound carriers change nothing, however few there are: two of eight satellites of GPS
/// fade below an open sky.
constexpr double kAlwaysSpared = 2.0;
constexpr double kSlower_m = 15e3;  ///< At this distance it takes twice as long.
constexpr double kGpsAlone = 3.0;
constexpr double kOneBand = 4.0;
constexpr double kFarthestTwoBands_m = 50e3;
constexpr double kFarthestOneBand_m = 15e3;
constexpr double kByAge_mps = 0.03 / 60.0;  ///< Error of a fixed position per second of age.

}  // namespace

void visit(fields::Visitor& v, CorrectionParameters& p) {
  constexpr fields::NumberRule kMetres = in("m").between(0, 1000);
  constexpr fields::NumberRule kSeconds = in("s").between(0, 86'400);
  v.choice("kind", p.kind, kCorrectionKinds, "Corrections that arrive.");
  v.only_if(comes_by_itself(p.kind), "kind", "kind: sbas, service or assumed_rtk",
            [&p, &kSeconds](fields::Visitor& w) {
              w.number("interval", p.interval_s, in("s").between(0.01, 86'400),
                       "Between two corrections.");
              w.number("latency", p.latency_s, kSeconds,
                       "From the measurement of a correction to its arrival.");
              w.number("largest_age", p.largest_age_s, kSeconds,
                       "Older corrections are not applied.");
            });
  v.only_if(p.kind == CorrectionKind::sbas, "kind", "kind: sbas", [&p](fields::Visitor& w) {
    w.number("sbas_share", p.sbas_share, plain().between(0, 1),
             "Share of orbit, clock and ionosphere errors that SBAS leaves.");
  });
  v.only_if(p.kind == CorrectionKind::assumed_rtk, "kind", "kind: assumed_rtk",
            [&p, &kSeconds](fields::Visitor& w) {
              w.number("baseline", p.baseline_m, in("m").between(0, 1e6),
                       "Distance from the base station that is assumed.");
              w.number("first_fix", p.first_fix_s, kSeconds,
                       "From float to fixed, the first time.");
            });
  v.only_if(p.kind == CorrectionKind::rtk, "kind", "kind: rtk", [&p](fields::Visitor& w) {
    w.number("convergence", p.convergence_s, in("s").between(0, 86'400),
             "Mean time from float to fixed with two bands of several systems near the base.");
    w.number("fixed_age", p.fixed_age_s, in("s").between(0, 86'400),
             "Corrections older than this hold no ambiguities: fixed becomes float.");
  });
  v.only_if(is_kinematic(p.kind), "kind", "kind: rtk or assumed_rtk",
            [&p, &kSeconds, &kMetres](fields::Visitor& w) {
              w.number("fixed_horizontal", p.fixed_horizontal_m, kMetres,
                       "Fixed: horizontal error, radial, 1 sigma, without the baseline's part.");
              w.number("fixed_vertical", p.fixed_vertical_m, kMetres,
                       "Fixed: vertical error, 1 sigma, without the baseline's part.");
              w.number("fixed_per_baseline", p.fixed_per_baseline, in("ppm").between(0, 1e6),
                       "Fixed: share of the baseline that is added to both errors.");
              w.number("float_start", p.float_start_m, kMetres,
                       "Float: error per axis when it begins, 1 sigma.");
              w.number("float_end", p.float_end_m, kMetres,
                       "Float: error per axis that it converges to, 1 sigma.");
              w.number("float_decay", p.float_decay_s, in("s").between(0.001, 86'400),
                       "Float: time constant of its convergence.");
              w.number("refix_shortest", p.refix_shortest_s, kSeconds,
                       "Shortest time from a loss to fixed again.");
              w.number("refix_longest", p.refix_longest_s, kSeconds,
                       "Longest time from a loss to fixed again.");
              w.integer("least_satellites", p.least_satellites, IntegerRule{kLeastForFloat, 40},
                        "Fixed: satellites with sound carriers that it needs; rtk: of the base's.");
            });
  v.number("service_start", p.service_start_m, kMetres,
           "Service: error per axis when it begins, 1 sigma.");
  v.number("service_end", p.service_end_m, kMetres,
           "Service: error per axis when converged, 1 sigma.");
  v.number("service_decay", p.service_decay_s, in("s").between(0.001, 86'400),
           "Service: time constant of its convergence.");
  v.number("vertical_ratio", p.vertical_ratio, plain().between(0, 100),
           "Float and service: vertical error over that of one horizontal axis.");
  v.number("service_bridge", p.service_bridge_s, kSeconds,
           "Service: shorter losses cost no convergence.");
  v.number("correlation", p.correlation_s, kSeconds,
           "Time constant of the errors of carrier positions.");
}

void validate(const CorrectionParameters& p) {
  fields::check(p);
  if (p.refix_shortest_s > p.refix_longest_s) {
    throw fields::Refused("refix_shortest", "found " + fields::shortest(p.refix_shortest_s) +
                                                " s, allowed up to refix_longest, " +
                                                fields::shortest(p.refix_longest_s) + " s");
  }
}

CarrierEngine::CarrierEngine(const CorrectionParameters& parameters, std::uint64_t seed,
                             std::string_view name)
    : parameters_(parameters),
      noise_(seed, std::string(name) + "/carrier"),
      waits_(seed, std::string(name) + "/fixing"),
      tests_(seed, std::string(name) + "/validation") {
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

void CarrierEngine::lose() {
  floating_ = kNever;
  enough_ = kNever;
  fixed_ = false;
  fell_ = false;
  remembered_ = false;
}

/// Makes a fix a float that goes on from its place.
void CarrierEngine::fall(SimTime now) {
  floating_ = now;
  fell_ = true;
  fixed_ = false;
}

/// Returns the error of a float per axis, 1 sigma: it converges exponentially from start to end, or
/// grows from that of the fix before it.
double CarrierEngine::float_sigma_m(SimTime now) const {
  const CorrectionParameters& p = parameters_;
  const double fade = std::exp(-to_seconds(now - floating_) / p.float_decay_s);
  return fell_ ? std::hypot(fixed_sigma_m_, p.float_end_m * std::sqrt(1.0 - fade * fade))
               : p.float_end_m + (p.float_start_m - p.float_end_m) * fade;
}

void CarrierEngine::put_fixed(double horizontal_m, double vertical_m, CorrectionOutput& output) {
  output.carrier = CarrierSolution::fixed;
  put_error(horizontal_m, vertical_m, output);
  const double ratio = parameters_.vertical_ratio;
  fixed_sigma_m_ = ratio > 0.0 ? std::max(horizontal_m, vertical_m / ratio) : horizontal_m;
}

double CarrierEngine::drawn_convergence_s() {
  // Erlang: a sum of exponential waits.
  double sum = 0.0;
  for (int i = 0; i < kGammaShape; ++i) {
    sum -= std::log(1.0 - waits_.uniform());
  }
  return parameters_.convergence_s * std::min(kLongestOfMean, sum / kGammaShape);
}

/// Whether the integers differ clearly from the next best ones: the larger the share of unsound
/// carriers, the more often they do not.
bool CarrierEngine::validated(const CarrierCount& carriers, double step_s) {
  const double chance = tests_.uniform();
  const int used = std::max(1, carriers.used);
  const double usual = std::max(kUsuallyUnsound * used, kAlwaysSpared);
  const double beyond = std::max(0.0, used - carriers.held - usual) / used;
  return chance >= 1.0 - std::exp(-kFailures_ps * beyond * beyond * step_s);
}

/// By what arrived, and by nothing else.
void CarrierEngine::advance_rtk(const CorrectionInput& input, double step_s,
                                CorrectionOutput& output) {
  const CorrectionParameters& p = parameters_;
  if (!input.received) {
    return;
  }
  const ReceivedCorrections& received = *input.received;
  const double age_s = to_seconds(input.time - received.measured);
  if (received.common.line_of_sight < kLeastForFloat || !input.has_position || age_s < 0.0 ||
      age_s > to_seconds(received.largest_age)) {
    lose();
    epochs_ = 0;
    return;
  }
  if (measured_ == kNever || received.measured > measured_) {
    ++epochs_;
  }
  measured_ = received.measured;
  output.differential = true;
  output.age_s = age_s;
  if (epochs_ < 2) {
    return;
  }
  if (floating_ == kNever) {
    floating_ = input.time;
  }
  const bool two_bands = received.common.two_band >= static_cast<int>(p.least_satellites);
  const double farthest_m = two_bands ? kFarthestTwoBands_m : kFarthestOneBand_m;
  bool fixable = received.common.can_fix(p.least_satellites) && received.carriers_agree &&
                 !received.floating_only && age_s <= p.fixed_age_s &&
                 received.baseline_m <= farthest_m;
  if (fixable && !validated(received.common, step_s)) {
    fixable = false;
    remembered_ = false;
  }
  if (!fixable) {
    if (fixed_) {
      fall(input.time);
    }
    remembered_ = remembered_ && received.common.can_fix(kLeastForFloat);
    enough_ = kNever;
  } else if (enough_ == kNever) {
    enough_ = input.time;
    const double slower = 1.0 + received.baseline_m / kSlower_m;
    if (remembered_) {
      wait_s_ = kRemembered_s;
    } else if (fixed_before_) {
      wait_s_ = slower * waits_.uniform(p.refix_shortest_s, p.refix_longest_s);
    } else {
      wait_s_ = slower * std::max(kShortest_s, drawn_convergence_s()) *
                (received.gps_only ? kGpsAlone : 1.0) * (two_bands ? 1.0 : kOneBand);
    }
  }
  if (!fixed_ && enough_ != kNever && to_seconds(input.time - enough_) >= wait_s_) {
    fixed_ = true;
    fixed_before_ = true;
    remembered_ = true;
  }
  if (fixed_) {
    // Fixed: sigma + ppm x baseline + age; a radial sigma is sqrt(2) of each axis.
    const double grown_m = p.fixed_per_baseline * received.baseline_m + kByAge_mps * age_s;
    put_fixed((p.fixed_horizontal_m + grown_m) / std::numbers::sqrt2, p.fixed_vertical_m + grown_m,
              output);
  } else {
    output.carrier = CarrierSolution::floating;
    const double sigma_m = float_sigma_m(input.time);
    put_error(sigma_m, sigma_m * p.vertical_ratio, output);
  }
}

void CarrierEngine::advance_assumed_rtk(const CorrectionInput& input, CorrectionOutput& output) {
  const CorrectionParameters& p = parameters_;
  const bool usable = output.differential && input.carriers.line_of_sight >= kLeastForFloat;
  if (!usable) {
    lose();
    return;
  }
  if (floating_ == kNever) {
    floating_ = input.time;
  }
  if (!input.carriers.can_fix(p.least_satellites)) {
    if (fixed_) {
      fall(input.time);
    }
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
    // Fixed: sigma + ppm x baseline; a radial sigma is sqrt(2) of each axis.
    const double by_baseline_m = p.fixed_per_baseline * p.baseline_m;
    put_fixed((p.fixed_horizontal_m + by_baseline_m) / std::numbers::sqrt2,
              p.fixed_vertical_m + by_baseline_m, output);
  } else {
    output.carrier = CarrierSolution::floating;
    const double sigma_m = float_sigma_m(input.time);
    put_error(sigma_m, sigma_m * p.vertical_ratio, output);
  }
}

void CarrierEngine::advance_service(const CorrectionInput& input, CorrectionOutput& output) {
  const CorrectionParameters& p = parameters_;
  const bool usable = output.differential && input.carriers.line_of_sight >= kLeastForFloat;
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

/// Advances the errors of carrier positions at every epoch, then what depends on the kind of
/// corrections: SBAS scales errors of the code position, the others may replace its error.
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
  if (parameters_.kind == CorrectionKind::rtk) {
    advance_rtk(input, step_s, output);
    return output;
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
  if (parameters_.kind == CorrectionKind::assumed_rtk) {
    advance_assumed_rtk(input, output);
  } else if (parameters_.kind == CorrectionKind::service) {
    advance_service(input, output);
  }
  return output;
}

}  // namespace rigwire::sim
