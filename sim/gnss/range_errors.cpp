#include "sim/gnss/range_errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/gnss/observations.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr double kReferenceCn0_dbhz = 45.0;
constexpr double kFadingCorrelation_s = 6.0;
constexpr double kFadingLength_m = 15.0;
constexpr double kLeavesCorrelation_s = 3.0;  // of what leaves and branches take, at rest ...
constexpr double kLeavesLength_m = 4.0;       // ... and over this way in motion
constexpr double kRateCorrelation_s = 2.5;    // of reflections in a range rate, at rest ...
constexpr double kRateLength_m = 8.0;         // ... and over this way in motion
/// Multipath of a weak signal as share of its mistrust.
constexpr double kWeakShare = 0.75;
constexpr double kUsual_db = 3.0;  // fading of an open sky: no reason to distrust a signal
constexpr double kLowestMappedSine = 0.087;  // 5 degrees: below, mappings are held
constexpr double kEarthRadius_km = 6371.0;
constexpr double kLayerRadius_km = 6371.0 + 350.0;  // of the thin shell of the ionosphere

/// Great-circle distance from the antenna to where the signal passes the ionosphere's shell.
double pierce_distance_km(double elevation_rad) {
  // Law of sines in the triangle of earth's centre, antenna and pierce point.
  const double at_shell = std::asin(kEarthRadius_km / kLayerRadius_km * std::cos(elevation_rad));
  return kEarthRadius_km * (0.5 * std::numbers::pi - elevation_rad - at_shell);
}

double weaker_by(double db) {
  return std::pow(10.0, db / 20.0);
}

double code_sigma_m(const RangeErrorParameters& p, double cn0_dbhz) {
  return p.code_noise_m * weaker_by(kReferenceCn0_dbhz - cn0_dbhz);
}

/// 1 / tau = 1 / tau_rest + speed / length.
double multipath_correlation_s(const RangeErrorParameters& p, double speed_mps) {
  const double rest_s = p.multipath_correlation_s;
  return rest_s / (1.0 + rest_s * speed_mps / p.multipath_length_m);
}

double over_sine(double elevation_rad) {
  return 1.0 / std::max(std::sin(elevation_rad), kLowestMappedSine);
}

}  // namespace

void visit(fields::Visitor& v, RangeErrorParameters& p) {
  constexpr fields::NumberRule kMetres = in("m").between(0, 1000);
  constexpr fields::NumberRule kSeconds = in("s").between(0, 1e6);
  v.number(
      "broadcast_share", p.broadcast_share, plain().between(0, 1),
      "Share of the errors of broadcast orbits, clocks and ionosphere that this receiver leaves "
      "in the ranges that it uses.");
  v.number("orbit_clock_sigma", p.orbit_clock_sigma_m, kMetres,
           "Standard deviation of broadcast orbits and clocks.");
  v.number("orbit_clock_correlation", p.orbit_clock_correlation_s, kSeconds,
           "Time constant of the errors of orbits and clocks.");
  v.number("ionosphere_sigma", p.ionosphere_sigma_m, kMetres,
           "Vertical ionospheric delay that the broadcast model leaves, standard deviation.");
  v.number("ionosphere_gradient_sigma", p.ionosphere_gradient_sigma_mpkm, in("m/km").between(0, 1),
           "Horizontal gradient of that ionospheric delay per axis, standard deviation.");
  v.number("ionosphere_correlation", p.ionosphere_correlation_s, kSeconds,
           "Time constant of the ionospheric error.");
  v.number("troposphere_sigma", p.troposphere_sigma_m, kMetres,
           "Vertical tropospheric delay that the model leaves, standard deviation.");
  v.number("troposphere_correlation", p.troposphere_correlation_s, kSeconds,
           "Time constant of the tropospheric error.");
  v.number("code_noise", p.code_noise_m, kMetres,
           "Noise of a pseudorange at 45 dBHz; doubles every 6 dB below.");
  v.number("code_noise_correlation", p.code_noise_correlation_s, kSeconds,
           "Time constant of the code loop's noise.");
  v.number("multipath_sigma", p.multipath_sigma_m, kMetres,
           "Multipath error at 45 dBHz; doubles every 6 dB below.");
  v.number("multipath_correlation", p.multipath_correlation_s, kSeconds,
           "Time constant of multipath at rest.");
  v.number("multipath_length", p.multipath_length_m, in("m").between(0.001, 1e6),
           "Way over which multipath stays correlated in motion.");
  v.number("weak_signal_sigma", p.weak_signal_sigma_mpdb, in("m/dB").between(0, 1000),
           "Added to the receiver's own belief for what a signal is too weak beyond 3 dB.");
  v.number("foliage_multipath", p.foliage_multipath_mpdb, in("m/dB").between(0, 100),
           "Multipath for each dB that tree crowns take from a signal, standard deviation.");
  v.number("foliage_slips", p.foliage_slips_psdb, plain().between(0, 100),
           "Slips of a carrier per second for each dB that tree crowns take.");
  v.number("carrier_multipath", p.carrier_multipath_m, in("mm").between(0, 100),
           "Multipath of the carrier phase at the zenith; over sin E at elevation E.");
  v.number("rate_noise", p.rate_noise_mps, in("m/s").between(0, 100),
           "White noise of a range rate at 45 dBHz; doubles every 6 dB below.");
  v.number("rate_multipath", p.rate_multipath_mps, in("m/s").between(0, 100),
           "What reflections add to a range rate, standard deviation.");
}

void validate(const RangeErrorParameters& p) {
  fields::check(p);
}

double ionosphere_mapping(double elevation_rad) {
  const double x = 0.53 - elevation_rad / std::numbers::pi;
  return 1.0 + 16.0 * x * x * x;
}

double troposphere_mapping(double elevation_rad) {
  return over_sine(elevation_rad);
}

SatelliteErrors::SatelliteErrors(std::uint64_t seed, std::string_view name)
    : random_(seed, name),
      fading_random_(seed, std::string(name) + "/fading"),
      foliage_random_(seed, std::string(name) + "/foliage"),
      scatter_random_(seed, std::string(name) + "/scatter"),
      rate_random_(seed, std::string(name) + "/rate"),
      second_random_(seed, std::string(name) + "/second"),
      slip_random_(seed, std::string(name) + "/slips") {}

void SatelliteErrors::fade(double step_s, double speed_mps) {
  // 1 / tau = 1 / tau_rest + speed / length.
  const double correlation_s =
      kFadingCorrelation_s / (1.0 + kFadingCorrelation_s * speed_mps / kFadingLength_m);
  fading_.advance(step_s, correlation_s, fading_random_);
  foliage_fading_.advance(
      step_s, kLeavesCorrelation_s / (1.0 + kLeavesCorrelation_s * speed_mps / kLeavesLength_m),
      foliage_random_);
}

bool SatelliteErrors::scatter(double step_s, double rest_s, double speed_mps, double length_m) {
  // Two draws at every step, whatever happens. Renewals: 1 / tau = 1 / tau_rest + speed / length.
  const double chance = scatter_random_.uniform();
  const double excess = -std::log(1.0 - scatter_random_.uniform());
  const double expected = step_s * (1.0 / rest_s + speed_mps / length_m);
  const bool renewed = scattered_ < 0.0 || chance < 1.0 - std::exp(-expected);
  scattered_ = renewed ? excess : scattered_;
  return renewed;
}

void SatelliteErrors::advance_second(const RangeErrorParameters& p, double step_s,
                                     double speed_mps) {
  const double moving_s = multipath_correlation_s(p, speed_mps);
  second_.code_noise.advance(step_s, p.code_noise_correlation_s, second_random_);
  second_.code_multipath.advance(step_s, moving_s, second_random_);
  second_.carrier_noise.advance(step_s, 0.0, second_random_);
  second_.carrier_multipath.advance(step_s, moving_s, second_random_);
}

void SatelliteErrors::advance(const RangeErrorParameters& p, double step_s, double speed_mps) {
  code_noise_.advance(step_s, p.code_noise_correlation_s, random_);
  const double moving_s = multipath_correlation_s(p, speed_mps);
  multipath_.advance(step_s, moving_s, random_);
  carrier_noise_.advance(step_s, 0.0, rate_random_);
  carrier_multipath_.advance(step_s, moving_s, rate_random_);
  rate_.advance(step_s, 0.0, random_);
  rate_noise_.advance(step_s, 0.0, rate_random_);
  rate_multipath_.advance(
      step_s, kRateCorrelation_s / (1.0 + kRateCorrelation_s * speed_mps / kRateLength_m),
      rate_random_);
}

void SatelliteErrors::acquired() {
  code_noise_.redraw(random_);
  multipath_.redraw(random_);
  second_.code_noise.redraw(second_random_);
  second_.code_multipath.redraw(second_random_);
}

bool SatelliteErrors::slips(const RangeErrorParameters& p, double foliage_db, double step_s) {
  const double expected = p.foliage_slips_psdb * foliage_db * step_s;
  return expected > 0.0 && slip_random_.uniform() < 1.0 - std::exp(-expected);
}

RangeError SatelliteErrors::error(const RangeErrorParameters& p, const SignalArrival& arrival,
                                  const CorrectedShare& share) const {
  const double elevation = arrival.elevation_rad;
  const double orbit_sigma_m = share.orbit_clock * p.orbit_clock_sigma_m;
  const double noise_sigma_m = code_sigma_m(p, arrival.cn0_dbhz);
  const double open_multipath_m =
      p.multipath_sigma_m * weaker_by(kReferenceCn0_dbhz - (arrival.cn0_dbhz - arrival.fade_db));
  // An envelope is a sine's amplitude, amplitude / sqrt(2) its deviation.
  const double multipath_sigma_m =
      std::hypot(open_multipath_m, arrival.reflection_envelope_m / std::numbers::sqrt2,
                 p.foliage_multipath_mpdb * arrival.foliage_db);
  RangeError error;
  error.orbit_clock_m = p.orbit_clock_sigma_m * arrival.shared.orbit_clock;
  error.ionosphere_m =
      ionosphere_mapping(elevation) * p.ionosphere_sigma_m * arrival.shared.ionosphere;
  error.corrected_m = (1.0 - share.orbit_clock) * error.orbit_clock_m +
                      (1.0 - share.ionosphere) * error.ionosphere_m;
  error.troposphere_m =
      p.troposphere_sigma_m * arrival.shared.troposphere * troposphere_mapping(elevation);
  const double carrier_noise_m = kGpsL1Wavelength_m * carrier_sigma_cycles(arrival.cn0_dbhz);
  const double carrier_multipath_m = p.carrier_multipath_m * over_sine(elevation);
  error.carrier_m =
      carrier_noise_m * carrier_noise_.value() + carrier_multipath_m * carrier_multipath_.value();
  const double second_dbhz = arrival.cn0_dbhz - arrival.second_weaker_db;
  error.second_carrier_m =
      kGpsL1Wavelength_m * carrier_sigma_cycles(second_dbhz) * second_.carrier_noise.value() +
      carrier_multipath_m * second_.carrier_multipath.value();
  error.second_local_m = code_sigma_m(p, second_dbhz) * second_.code_noise.value() +
                         multipath_sigma_m * second_.code_multipath.value();
  error.rate_mps = rate_.value();
  const double rate_noise_mps =
      p.rate_noise_mps * std::pow(10.0, (kReferenceCn0_dbhz - arrival.cn0_dbhz) / 20.0);
  error.range_rate_mps =
      rate_noise_mps * rate_noise_.value() + p.rate_multipath_mps * rate_multipath_.value();
  error.range_rate_noise_mps = std::hypot(rate_noise_mps, p.rate_multipath_mps);
  error.local_m = noise_sigma_m * code_noise_.value() + multipath_sigma_m * multipath_.value();
  error.detour_m = arrival.extra_path_m;
  const double slant = share.ionosphere * ionosphere_mapping(elevation);
  // A smooth field at distance d from the zenith's pierce point, rho = exp(-d^2 / 2 L^2): what is
  // that of the zenith, what grows along the azimuth, and the rest, a satellite's own.
  const double lengths =
      p.ionosphere_sigma_m > 0.0
          ? p.ionosphere_gradient_sigma_mpkm * pierce_distance_km(elevation) / p.ionosphere_sigma_m
          : 0.0;
  const double rho = std::exp(-0.5 * lengths * lengths);
  const double ionosphere_m = slant * p.ionosphere_sigma_m;
  const double gradient_m = ionosphere_m * rho * std::sqrt(1.0 - rho * rho);
  const double rest_m = ionosphere_m * (1.0 - rho * rho);
  error.common_m = {ionosphere_m * rho, gradient_m * std::cos(arrival.azimuth_rad),
                    gradient_m * std::sin(arrival.azimuth_rad),
                    p.troposphere_sigma_m * troposphere_mapping(elevation)};
  const double weak_m = p.weak_signal_sigma_mpdb * std::max(0.0, arrival.missing_db - kUsual_db);
  // What the receiver believes: the variances of own and common parts.
  error.noise_sigma_m = noise_sigma_m;
  error.multipath_sigma_m = std::hypot(open_multipath_m, kWeakShare * weak_m);
  error.orbit_sigma_m = std::hypot(orbit_sigma_m, rest_m);
  error.mistrust_sigma_m = weak_m;
  double variance_m2 = error.orbit_sigma_m * error.orbit_sigma_m + noise_sigma_m * noise_sigma_m +
                       open_multipath_m * open_multipath_m + weak_m * weak_m;
  for (const double common_m : error.common_m) {
    variance_m2 += common_m * common_m;
  }
  constexpr double kLeastSigma_m = 1e-3;  // errors switched off still need a weight
  error.sigma_m = std::max(kLeastSigma_m, std::sqrt(variance_m2));
  return error;
}

}  // namespace rigwire::sim
