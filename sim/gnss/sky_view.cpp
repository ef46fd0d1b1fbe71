#include "sim/gnss/sky_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;

namespace {

constexpr std::size_t kRim = 4;
constexpr std::size_t kMostSamples = 16;
/// First Fresnel zone at L1 of a crown ten metres away: sqrt(0.19 m x 10 m) = 1.4 m.
constexpr double kCrownZone_rad = 8.0 * kDegree;

/// Places in the unit disc: the rim, then what fills it evenly (Vogel's spiral: each takes the same
/// area).
std::array<Eigen::Vector2d, kMostSamples> make_disc() {
  std::array<Eigen::Vector2d, kMostSamples> disc;
  for (std::size_t i = 0; i < kRim; ++i) {
    const double angle = (static_cast<double>(i) + 0.5) * 0.5 * std::numbers::pi;
    disc[i] = {std::cos(angle), std::sin(angle)};
  }
  constexpr double kInner = kMostSamples - kRim;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t i = kRim; i < kMostSamples; ++i) {
    const double k = static_cast<double>(i - kRim);
    const double radius = std::sqrt((k + 0.5) / kInner);
    disc[i] = {radius * std::cos(golden * k), radius * std::sin(golden * k)};
  }
  return disc;
}

constexpr std::array<fields::Choice<SkySamples>, 3> kSkySamples{
    {{SkySamples::one, "one", "Sharp edges."},
     {SkySamples::four, "four", "Soft edges."},
     {SkySamples::sixteen, "sixteen", "Soft edges, finer where there is one."}}};

}  // namespace

void visit(fields::Visitor& v, SkyViewParameters& p) {
  v.number("elevation_mask", p.elevation_mask_deg, in("deg").stored_as("deg").between(0, 89.9),
           "Satellites below this elevation are not used.");
  v.number("antenna_clearance", p.antenna_clearance_m, in("mm").between(0, 100'000),
           "Things nearer to the antenna do not block the sky.");
  v.number("cn0_zenith", p.cn0_zenith_dbhz, in("dBHz").between(0, 99),
           "Carrier-to-noise density of a satellite overhead.");
  v.number("cn0_horizon", p.cn0_horizon_dbhz, in("dBHz").between(0, 99),
           "Carrier-to-noise density of a satellite on the horizon.");
  v.number("cn0_threshold", p.cn0_threshold_dbhz, in("dBHz").between(0, 99),
           "Weakest carrier-to-noise density that is tracked.");
  v.number("cn0_hysteresis", p.cn0_hysteresis_db, in("dB").between(0, 30),
           "Above the threshold for a lost satellite to be acquired again.");
  v.number("cn0_sigma", p.cn0_sigma_db, in("dB").between(0, 10),
           "Standard deviation of the fading of a satellite overhead, antenna at rest.");
  v.number("cn0_sigma_moving", p.cn0_sigma_moving_db, in("dB").between(0, 10),
           "Standard deviation of the fading of a satellite overhead, antenna in motion.");
  v.number("reacquisition_time", p.reacquisition_time_s, in("s").between(0, 600),
           "From signal to tracking after a loss.");
  v.number("foliage_attenuation", p.foliage_attenuation_dbpm, in("dB/m").between(0, 100),
           "What tree crowns take from a signal on its way through them.");
  v.choice("sky_samples", p.samples, kSkySamples, "Rays per satellite.");
  v.only_if(p.samples != SkySamples::one, "sky_samples", "more than one ray",
            [&p](fields::Visitor& w) {
              w.number("cone_half_angle", p.cone_half_angle_deg,
                       in("deg").stored_as("deg").between(0, 10),
                       "Half angle of the cone of rays to a satellite.");
            });
  v.integer("maximum_channels", p.maximum_channels, IntegerRule{1, 184},
            "Satellites that are tracked at once, at most.");
}

void validate(const SkyViewParameters& p) {
  fields::check(p);
}

SkyArrival sky_arrival(const SkyViewParameters& parameters, const Visibility& visibility,
                       const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                       bool near_crowns) {
  SkyArrival arrival;
  int open = 0;
  double foliage_m = 0.0;
  const auto cast = [&](const Eigen::Vector3d& direction) {
    const SkyPath path = visibility.sky_path(p_W, direction, parameters.antenna_clearance_m);
    ++arrival.rays;
    open += path.blocked ? 0 : 1;
    foliage_m += path.blocked ? 0.0 : path.foliage_m;
  };
  if (parameters.samples == SkySamples::one) {
    cast(direction_W);
  } else {
    static const std::array<Eigen::Vector2d, kMostSamples> kDisc = make_disc();
    // A disc across the direction at distance 1.
    const Eigen::Vector3d u = direction_W.unitOrthogonal();
    const Eigen::Vector3d v = direction_W.cross(u);
    const double radius = std::tan(parameters.cone_half_angle_deg * kDegree);
    const auto cast_range = [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        const Eigen::Vector3d aside = radius * (kDisc[i].x() * u + kDisc[i].y() * v);
        cast((direction_W + aside).normalized());
      }
    };
    cast_range(0, kRim);
    const bool near_edge = open != 0 && open != static_cast<int>(kRim);
    if (parameters.samples == SkySamples::sixteen && near_edge) {
      cast_range(kRim, kMostSamples);
    }
  }
  arrival.open_share = static_cast<double>(open) / arrival.rays;
  if (near_crowns && open > 0) {
    // The ring's mean, where it is not blocked, counts as much as the cone's.
    const Eigen::Vector3d u = direction_W.unitOrthogonal();
    const Eigen::Vector3d v = direction_W.cross(u);
    int free = 0;
    double around_m = 0.0;
    for (std::size_t i = 0; i < kRim; ++i) {
      const double angle = static_cast<double>(i) * 0.5 * std::numbers::pi;
      const Eigen::Vector3d aside =
          std::tan(kCrownZone_rad) * (std::cos(angle) * u + std::sin(angle) * v);
      const SkyPath path = visibility.sky_path(p_W, (direction_W + aside).normalized(),
                                               parameters.antenna_clearance_m);
      ++arrival.rays;
      free += path.blocked ? 0 : 1;
      around_m += path.blocked ? 0.0 : path.foliage_m;
    }
    if (free > 0) {
      foliage_m = 0.5 * (foliage_m + around_m * open / free);
    }
  }
  arrival.foliage_m = open > 0 ? foliage_m / open : 0.0;
  return arrival;
}

double direct_cn0_dbhz(const SkyViewParameters& parameters, double sin_elevation,
                       const SkyArrival& arrival) {
  if (!(arrival.open_share > 0.0)) {
    return -std::numeric_limits<double>::infinity();
  }
  // The gain rises exponentially with elevation (sky_view.h). Foliage takes dB per metre; an open
  // share of 1/2 costs 6 dB (Parsons, 3.3).
  constexpr double kRise_rad = 20.0 * kDegree;
  const auto risen = [](double elevation_rad) {
    return 1.0 - std::exp(-elevation_rad / kRise_rad);
  };
  static const double kOverhead = risen(0.5 * std::numbers::pi);
  const double elevation_rad = std::asin(std::clamp(sin_elevation, 0.0, 1.0));
  return parameters.cn0_horizon_dbhz +
         (parameters.cn0_zenith_dbhz - parameters.cn0_horizon_dbhz) * risen(elevation_rad) /
             kOverhead -
         parameters.foliage_attenuation_dbpm * arrival.foliage_m +
         20.0 * std::log10(arrival.open_share);
}

double fading_sigma_db(const SkyViewParameters& parameters, double sin_elevation,
                       double speed_mps) {
  constexpr double kTowardsHorizon = 2.2;
  constexpr double kMoving_mps = 2.0;
  const double moving = 1.0 - std::exp(-speed_mps / kMoving_mps);
  const double overhead_db =
      parameters.cn0_sigma_db + moving * (parameters.cn0_sigma_moving_db - parameters.cn0_sigma_db);
  return overhead_db * (1.0 + kTowardsHorizon * (1.0 - sin_elevation));
}

double foliage_sigma_db(double foliage_db) {
  constexpr double kLeastShare = 2.5;
  constexpr double kGreatest_db = 7.0;
  return std::min(kGreatest_db, kLeastShare * std::sqrt(std::max(0.0, foliage_db)));
}

bool SatelliteTracker::advance(const SkyViewParameters& parameters, const Step& step) {
  const double wanted_dbhz =
      parameters.cn0_threshold_dbhz +
      (tracked_ || !begun_ || step.instantly ? 0.0 : parameters.cn0_hysteresis_db);
  const bool strong = step.cn0_dbhz >= wanted_dbhz;
  if (!strong) {
    tracked_ = false;
    strong_since_ = kNever;
  } else if (!tracked_) {
    strong_since_ = strong_since_ == kNever ? step.time : strong_since_;
    // What is in view when the receiver starts is the cold start's business, not this one's.
    const bool waited = step.instantly || !begun_ ||
                        to_seconds(step.time - strong_since_) >= parameters.reacquisition_time_s;
    if (waited && step.channel_free) {
      tracked_ = true;
      since_ = step.time;
    }
  }
  begun_ = true;
  return tracked_;
}

}  // namespace rigwire::sim
